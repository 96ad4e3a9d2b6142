"""Plans: which runs a study asks for, and the keys of what they depend on."""

from __future__ import annotations

import json
import pickle
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.algorithms import CAPABILITIES
from pymoo_gridpath.errors import StudyError
from pymoo_gridpath.maps import load_map, read_scen
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.operators import paper_operators, path_operators
from pymoo_gridpath.problems import GridPathProblem
from pymoo_gridpath.representations import Representation
from pymoo_gridpath.study.planning import canonical
from pymoo_gridpath.study.planning.build import build_grid, build_problem
from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.planning.plan import Plan, has_own_budget
from pymoo_gridpath.study.specification.kinds import of_package
from pymoo_gridpath.study.specification.operators import make_operator
from pymoo_gridpath.study.specification.study import AlgorithmSpec, ProblemSpec, Study
from pymoo_gridpath.study.specification.toml_file import load_study

RANDOM = {"random": {"size": 8, "p0": 0.1, "seeds": 3}}
NSGA2 = {"algorithm": "NSGA2", "pop_size": 10}


def make(problems=(RANDOM,), algorithms=(NSGA2,), seeds=2, budget=None, **others) -> Plan:
    return plan_study(
        Study.from_dict(
            {"problems": problems, "algorithms": algorithms, "seeds": seeds, "budget": budget or {"generations": 3}, **others}
        )
    )


def keys(problem=RANDOM, algorithm=NSGA2, **others) -> set[str]:
    """Return the keys of the runs of one algorithm, without the references."""
    return {run.key for run in make([problem], [algorithm], **others).runs if run.algorithm is not None}


# -- which runs ---------------------------------------------------------------------------------------------------------


def test_product_with_a_reference_for_each_problem():
    plan = make(algorithms=[NSGA2, {"preset": "ahmed-deb-2013", "pop_size": 12}], seeds=[4, 7])
    assert [problem.label for problem in plan.problems] == ["random-8-0.1/1", "random-8-0.1/2", "random-8-0.1/3"]
    assert {problem.group for problem in plan.problems} == {"random-8-0.1"}
    assert [(run.problem, run.algorithm, run.seed) for run in plan.runs] == [
        *((k, None, 0) for k in range(3)),
        *((k, j, seed) for k in range(3) for j in range(2) for seed in (4, 7)),
    ]
    assert [problem.reference for problem in plan.problems] == [run.key for run in plan.runs[:3]]
    assert len({run.key for run in plan.runs}) == len(plan.runs)


def test_exact_is_one_run_and_shared_with_the_reference():
    plan = make(algorithms=[NSGA2, {"algorithm": "exact"}], seeds=5)
    assert len(plan.runs) == 3 * 5 + 3
    assert [(run.algorithm, run.seed) for run in plan.runs[:3]] == [(1, 0)] * 3
    other = make(algorithms=[NSGA2, {"algorithm": "exact", "max_seconds": 5}], seeds=5)
    assert len(other.runs) == 3 * 5 + 3 + 3
    assert len(make(algorithms=[NSGA2, {"algorithm": "exact", "max_seconds": 5}], reference={"max_seconds": 5}).runs) == 9


def test_no_reference():
    plan = make(algorithms=[NSGA2, {"algorithm": "exact"}], reference=False)
    assert all(problem.reference is None for problem in plan.problems)
    assert len(plan.runs) == 3 * 2 + 3
    assert plan.task(plan.runs[2]).algorithm == {"algorithm": "exact", "max_seconds": None, "max_labels": None}


def test_tasks_are_self_contained():
    plan = make([RANDOM, {"map": "warehouse", "radius": 0.3}], [NSGA2, {"algorithm": "exact"}])
    for run in plan.runs:
        task = plan.task(run)
        assert pickle.loads(pickle.dumps(task)) == task
        assert len(pickle.dumps(task)) < 4000
        assert task.key == run.key
        assert (task.budget is None) == has_own_budget(task.algorithm)
        problem = build_problem(task.problem, task.grid)
        assert isinstance(problem, GridPathProblem)
    warehouse = build_grid(plan.problems[3].spec["grid"], plan.problems[3].grid)
    assert (warehouse.occupied == load_map("warehouse").inflate(0.3).occupied).all()


def test_json_and_back():
    plan = make([RANDOM, {"map": "warehouse"}], [NSGA2, {"algorithm": "exact"}], name="a study", target=0.9)
    text = json.dumps(plan.to_json())
    back = Plan.from_json(json.loads(text))
    assert json.dumps(back.to_json()) == text
    assert (back.name, back.target, back.budget, back.runs) == (plan.name, plan.target, plan.budget, plan.runs)
    assert back.algorithms == plan.algorithms
    assert [problem.grid for problem in back.problems] == [None] * 4
    for run in plan.runs:
        assert back.task(run) == plan.task(run)._replace(grid=None)


def test_ten_thousand_runs_are_planned_fast():
    problem = {"random": {"size": 16, "p0": 0.2, "seeds": 100}}
    algorithms = [{**NSGA2, "name": f"reach {k}", "operators": _splice(k)} for k in range(10)]
    make([RANDOM], algorithms)
    begin = time.process_time()
    plan = make([problem], algorithms, seeds=10)
    took = time.process_time() - begin
    assert len({run.key for run in plan.runs}) == 10_100
    assert took < 2.0


def _splice(reach):
    return {"base": "scalarized", "crossover": {"class": "SpliceCrossover", "reach": reach}}


# -- maps and queries ---------------------------------------------------------------------------------------------------

MAP = """\
type octile
height 4
width 6
map
......
.@@@..
......
...@..
"""
SCEN = "version 1\n" + "".join(
    f"0\tarena.map\t6\t4\t{column}\t{row}\t5\t0\t5.0\n" for column, row in [(0, 0), (0, 1), (0, 2), (0, 3), (1, 2), (2, 2)]
)


@pytest.fixture
def arena(tmp_path):
    (tmp_path / "arena.map").write_text(MAP)
    (tmp_path / "arena.map.scen").write_text(SCEN)
    return tmp_path


def arena_plan(arena, queries="", more="", algorithm="pop_size = 4"):
    text = f"""
        seeds = 1
        budget = {{ generations = 1 }}
        [[problems]]
        scen = "arena.map.scen"
        {f"queries = {queries}" if queries else ""}
        {more}
        [[algorithms]]
        algorithm = "NSGA2"
        {algorithm}
    """
    (arena / "tiny.toml").write_text(text)
    return plan_study(load_study(arena / "tiny.toml"))


@pytest.mark.parametrize(
    ("queries", "numbers"),
    [
        ("", [0, 1, 2, 3, 4, 5]),
        ("[4, 1]", [4, 1]),
        ("{ first = 1 }", [1, 2, 3, 4, 5]),
        ("{ first = 0, last = 4, step = 2 }", [0, 2, 4]),
        ("{ last = 3, step = 2 }", [0, 2]),
    ],
)
def test_scen_ranges(arena, monkeypatch, queries, numbers):
    monkeypatch.chdir("/")  # paths are relative to the study file
    plan = arena_plan(arena, queries)
    assert [problem.label for problem in plan.problems] == [f"arena/{n}" for n in numbers]
    known = read_scen(arena / "arena.map.scen")
    assert [(tuple(p.spec["start"]), tuple(p.spec["goal"])) for p in plan.problems] == [
        (known[n].start, known[n].goal) for n in numbers
    ]
    assert build_grid(plan.problems[0].spec["grid"], plan.problems[0].grid) == load_map(arena / "arena.map").replace(
        name="grid"
    )


def test_the_plan_says_where_maps_come_from(arena):
    def source(*given):
        return {problem.source for problem in arena_plan(arena, *given).problems}

    assert source() == {"arena.map, numbered queries of arena.map.scen"}
    assert source("[3]", "resolution = 0.5\nradius = 0.2\nrepresentation = 'cells'") == {
        "arena.map, query 3 of arena.map.scen, resolution 0.5, obstacles grown by 0.2 m"
    }
    assert {problem.source for problem in make(seeds=1).problems} == {""}
    plan = arena_plan(arena)
    assert Plan.from_json(json.loads(json.dumps(plan.to_json()))).problems[0].source == plan.problems[0].source


@pytest.mark.parametrize(
    ("queries", "more", "algorithm", "line", "message"),
    [
        ("[3, 6]", "", "", 6, "queries go up to 6, but arena.map.scen has 6 of them"),
        ("{ first = 6 }", "", "", 6, "queries go up to 6"),
        ("{ first = 3, last = 1 }", "", "", 6, "before first"),
        ("", "start = [0, 0]", "", 7, "start comes from the scen file"),
        ("", "radius = 0.6\nresolution = 1", "", 7, "query 0: with obstacles grown"),
        ("", 'representation = "integer"', "", 4, "problem 'arena/1': "),
        ("", "", 'representation = "integer"', 8, "problem 'arena/1': "),
    ],
)
def test_queries_refused(arena, queries, more, algorithm, line, message):
    if "integer" in more + algorithm:
        # The second query must first turn back, to the left and down.
        (arena / "arena.map").write_text("type octile\nheight 5\nwidth 6\nmap\n@@@@@.\n@@@@@.\n...@@.\n.@@@@.\n......\n")
        rows = [f"0\tarena.map\t6\t5\t{column}\t{row}\t5\t2\t9.0\n" for column, row in [(0, 4), (2, 2)]]
        (arena / "arena.map.scen").write_text("version 1\n" + "".join(rows))
    with pytest.raises(StudyError) as info:
        arena_plan(arena, queries, more, algorithm or "pop_size = 4")
    assert message in str(info.value)
    assert info.value.line == line


def test_missing_scen(tmp_path):
    (tmp_path / "arena.map").write_text(MAP)
    with pytest.raises(StudyError, match=r"tiny\.toml, line 5: .*arena\.map\.scen"):
        arena_plan(tmp_path)


def test_defaults_of_the_command_line(tmp_path):
    plan = make([{"map": "warehouse"}, {"map": "paper16"}, {"map": "warehouse", "name": "x", "axis": "x"}])
    assert [problem.spec["representation"] for problem in plan.problems] == ["cells", "integer", "integer"]
    assert plan.problems[0].spec["start"] == [2, 3]
    (tmp_path / "warehouse").write_text("start: 0 0\ngoal: 2 0\n...\n...\n")
    study = Study(
        problems=[ProblemSpec(map="warehouse")],
        algorithms=[AlgorithmSpec(algorithm="exact")],
        seeds=1,
        budget={"generations": 1},
        folder=tmp_path,
    )
    # A file beside the study goes before the shipped map of that name.
    assert plan_study(study).problems[0].spec["grid"]["width"] == 3


def test_missing_query(tmp_path):
    with pytest.raises(StudyError, match=r"needs start and goal, expected a cell x,y with x from 0 to 2"):
        make([ProblemSpec(grid=OccupancyGrid(np.zeros((3, 3))))])


# -- keys ---------------------------------------------------------------------------------------------------------------


def test_keys_do_not_change_between_versions():
    """A change here means that stored results are run again: raise SCHEMA, or do not."""
    plan = make(seeds=1)
    assert [run.key for run in plan.runs if run.problem == 0] == REMEMBERED


REMEMBERED = ["45b020c0e4fa0989696a3207693f2a35", "bf40087f70acfa1b15510cdcc9e1650d"]


PROBLEM_DEFAULTS = {
    "objectives": ["length", "vulnerability"],
    "representation": "integer",
    "obstacles": "penalty",
    "penalty": 2,
    "axis": "auto",
    "name": "another name",
}
ALGORITHM_DEFAULTS = {
    "smoothness": True,
    "operators": "default",
    "parameters": {},
    "name": "another name",
    "algorithm": "nsga-II",
}
OPERATOR_DEFAULTS = [
    "paper",
    {"base": "paper"},
    {"sampling": "RandomSampling"},
    {"crossover": {"class": "DiscreteSBX", "eta": 10.0, "prob": 0.9}, "repair": {"class": "EdgeFixing"}},
    {"base": "random", "crossover": "DiscreteSBX", "sampling": "RandomSampling", "repair": "EdgeFixing"},
]


def shuffled(table: dict, order: list[int]) -> dict:
    items = list(table.items())
    return dict(sorted(items, key=lambda item: order[items.index(item) % len(order)]))


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_keys_do_not_depend_on_order_names_or_defaults_written_out(data):
    def some(table):
        chosen = data.draw(st.lists(st.sampled_from(sorted(table)), unique=True))
        return {key: table[key] for key in chosen}

    order = data.draw(st.permutations(list(range(8))))
    problem = shuffled(RANDOM | some(PROBLEM_DEFAULTS), order)
    if data.draw(st.booleans()):
        problem["random"] = shuffled({**RANDOM["random"], "corner_cutting": True, "seeds": [1, 2, 3], "p0": 0.1}, order)
    algorithm = shuffled(NSGA2 | some(ALGORITHM_DEFAULTS), order)
    if data.draw(st.booleans()):
        algorithm["operators"] = data.draw(st.sampled_from(OPERATOR_DEFAULTS[:4]))
    seeds = data.draw(st.sampled_from([2, [1, 2], [2, 1], {"first": 1, "count": 2}, {"count": 2}]))
    others = data.draw(st.sampled_from([{}, {"name": "x"}, {"target": 0.5}, {"reference": False}]))
    assert keys(problem, algorithm, seeds=seeds, **others) == keys()


def test_defaults_of_cells_and_of_parameters():
    problem = {"map": "warehouse"}
    plain = {"algorithm": "MOEAD", "pop_size": 20}
    same = [
        {"operators": "scalarized"},
        {"operators": {"base": "random", "sampling": "ScalarizedSampling"}},
        {"operators": {"mutation": {"class": "PathMutation", "margin": 16, "prob": 1.0}}},
        {"parameters": {"n_neighbors": 20, "prob_neighbor_mating": 0.9}},
        {"parameters": {"n_neighbors": 20.0}},
        {"representation": "cells"},
        {"axis": "auto"},
        {"penalty": 2},
        {"smoothness": True},
    ]
    for change in same:
        assert keys(problem, plain | change) == keys(problem, plain), change
    # With turn among the objectives there is no tie-break by default.
    turn = {"map": "warehouse", "objectives": ["length", "turn"]}
    assert keys(turn, plain | {"smoothness": False}) == keys(turn, plain)
    assert keys({"map": "paper16", "corner_cutting": True}) == keys({"map": "paper16"})
    assert keys({"map": "paper16", "moves": 8}) == keys({"map": "paper16"})
    assert keys({"map": "paper16", "start": [0, 0], "goal": [15, 15]}) == keys({"map": "paper16"})


def test_every_setting_changes_the_key():
    problems = [
        RANDOM,
        {"random": {"size": 9, "p0": 0.1, "seeds": 3}},
        {"random": {"size": 8, "p0": 0.2, "seeds": 3}},
        {"random": {"size": 8, "p0": 0.1, "seeds": [11, 12, 13]}},
        *(
            RANDOM | change
            for change in (
                {"objectives": ["vulnerability", "length"]},
                {"objectives": ["length", "turn"]},
                {"representation": "binary"},
                {"representation": "cells"},
                {"obstacles": "constraint"},
                {"obstacles": "limit", "potential_limit": 3},
                {"obstacles": "limit", "potential_limit": 4},
                {"obstacles": "limit", "potential_limit": 4, "penalty": 5},
                {"penalty": 3},
                {"axis": "x"},
            )
        ),
        *({"map": "paper16"} | change for change in ({}, {"corner_cutting": False}, {"goal": [15, 14]}, {"start": [0, 1]})),
        *({"map": "paper16"} | change for change in ({"corner_cutting": "one side"}, {"moves": 4})),
        {"random": {"size": 8, "p0": 0.1, "seeds": 3, "moves": 4}},
        {"map": "warehouse"},
        {"map": "warehouse", "radius": 0.3},
    ]
    algorithms = [
        NSGA2,
        *(
            NSGA2 | change
            for change in (
                {"pop_size": 11},
                {"smoothness": False},
                {"operators": "scalarized"},
                {"operators": "random"},
                {"operators": {"mutation": "PathMutation"}},
                {"operators": {"crossover": {"class": "DiscreteSBX", "eta": 11}}},
                {"parameters": {"n_offsprings": 4}},
                {"representation": "mixed"},
                {"penalty": 5},
            )
        ),
        {"algorithm": "SPEA2", "pop_size": 10},
        {"preset": "ahmed-deb-2013", "pop_size": 10},
        {"algorithm": "exact"},
        {"algorithm": "exact", "max_labels": 10_000},
    ]
    found = [keys(problem) for problem in problems] + [keys(algorithm=algorithm) for algorithm in algorithms[1:]]
    found += [keys(budget={"generations": 4}), keys(budget={"evaluations": 30}), keys(seeds=[8, 9])]
    every = [key for some in found for key in some]
    assert len(set(every)) == len(every)


# -- what is the same ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("problems", "algorithms", "message"),
    [
        ([RANDOM], [NSGA2, NSGA2 | {"name": "b", "operators": "paper"}], "'b' is the same on the problem 'random-8-0.1/1' as"),
        ([RANDOM, RANDOM | {"name": "b"}], [NSGA2], "the problem 'b/1' is the same as 'random-8-0.1/1' (problems[0])"),
        (
            [RANDOM, RANDOM | {"name": "b", "representation": "binary"}],
            [NSGA2 | {"representation": "mixed"}],
            "'NSGA2' makes the problem 'b/1' the same as 'random-8-0.1/1' is to 'NSGA2'",
        ),
        ([RANDOM], [{"algorithm": "exact"}, {"algorithm": "exact", "name": "b", "max_seconds": 60}], "compared with itself"),
    ],
)
def test_twins_are_refused(problems, algorithms, message):
    with pytest.raises(StudyError) as info:
        make(problems, algorithms)
    assert message in str(info.value)


# -- overrides ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("problem", "algorithm", "expected"),
    [
        ({}, {"obstacles": "constraint"}, {"obstacles": "constraint", "penalty": None}),
        ({"penalty": 7}, {"obstacles": "limit", "potential_limit": 3}, {"penalty": 64.0, "potential_limit": 3.0}),
        ({"obstacles": "limit", "potential_limit": 3}, {"obstacles": "penalty"}, {"penalty": 2.0, "potential_limit": None}),
        ({"obstacles": "limit", "potential_limit": 3}, {"potential_limit": 4}, {"penalty": 64.0, "potential_limit": 4.0}),
        ({"axis": "x"}, {"representation": "cells"}, {"representation": "cells", "axis": "auto"}),
        ({}, {"representation": "binary", "axis": "y"}, {"representation": "binary", "axis": "y", "penalty": 2.0}),
    ],
)
def test_overrides(problem, algorithm, expected):
    plan = make([RANDOM | problem], [NSGA2 | algorithm])
    task = plan.task(plan.runs[-1])
    assert {key: task.problem[key] for key in expected} == expected
    # The reference is that of the problem as it stands.
    assert plan.task(plan.runs[0]).problem == plan.problems[0].spec


@pytest.mark.parametrize(
    ("problem", "algorithm", "expected"),
    [
        (RANDOM, {}, {"representation": "integer", "penalty": 1.0}),
        (RANDOM | {"representation": "mixed", "penalty": 5}, {}, {"representation": "mixed", "penalty": 1.0}),
        (RANDOM, {"representation": "binary", "penalty": 3}, {"representation": "binary", "penalty": 3.0}),
        (RANDOM | {"representation": "cells"}, {}, {"representation": "integer", "penalty": 1.0}),
        (RANDOM | {"objectives": ["length"]}, {}, {"obstacles": "constraint", "penalty": None}),
        (RANDOM | {"objectives": ["length"]}, {"obstacles": "penalty"}, {"obstacles": "penalty", "penalty": 1.0}),
        (RANDOM | {"obstacles": "constraint"}, {}, {"obstacles": "constraint", "penalty": None}),
    ],
)
def test_preset_brings_what_the_paper_says(problem, algorithm, expected):
    plan = make([problem], [{"preset": "ahmed-deb-2013", "pop_size": 10} | algorithm])
    task = plan.task(plan.runs[-1])
    assert {key: task.problem[key] for key in expected} == expected


# -- tables that repeat what the factories do ---------------------------------------------------------------------------


@pytest.mark.parametrize("representation", ["integer", "binary", "mixed", "absolute", "cells"])
@pytest.mark.parametrize("base", ["default", "paper", "scalarized", "random"])
def test_named_sets_are_those_of_the_factories(representation, base):
    plan = make([RANDOM | {"representation": representation}])
    problem = build_problem(plan.problems[0].spec)
    if base == "paper" and representation == "cells":
        return
    paper = base == "paper" or (base == "default" and representation != "cells")
    sampling = "random" if base == "random" else "scalarized"
    expected = paper_operators(problem) if paper else path_operators(problem, sampling)
    _, algorithm = canonical.resolve(
        plan.problems[0].spec,
        {"algorithm": "NSGA2", "pop_size": 10, "smoothness": None, "operators": {"base": base}, "parameters": {}},
        {},
    )
    for slot, spec in algorithm["operators"].items():
        if spec == "paper":
            assert (slot, paper) == ("mutation", True)
            continue
        made = make_operator(slot, spec)
        assert type(made) is type(expected[slot])
        assert settings_of(made) == settings_of(expected[slot])


def settings_of(operator):
    """Return what an operator was made with, as text, since some of it are arrays and objects of pymoo."""
    return {
        key: str(getattr(value, "value", value)) for key, value in vars(operator).items() if key not in ("bits", "integers")
    }


@pytest.mark.parametrize("name", [row.name for row in CAPABILITIES.values() if not row.unfit and row.needs != "automated_dm"])
def test_every_usable_algorithm_can_be_studied(name):
    problem = RANDOM | ({"objectives": ["length"]} if name == "GA" else {})
    parameters = {"ref_points": [[10, 1], [12, 0.5]]} if name in ("RNSGA2", "RNSGA3") else {}
    plan = make([problem], [{"algorithm": name, "pop_size": 20, "parameters": parameters}])
    assert plan.algorithms[0].spec["algorithm"] == name


def test_what_was_stored_is_looked_for_among_what_has_a_name():
    """A coding or an objective that is made for one problem, such as paths in time, is none that a study names."""
    assert set(of_package(Representation)) == {"integer", "binary", "mixed", "absolute", "cells"}
    of_suites = {"ascent", "delay", "travel_time", "random_cost", "integer_length", "exposure"}
    general = {"length", "vulnerability", "turn", "inflation", "clearance", "ground", "climb"}
    assert set(of_package(Objective)) == general | of_suites
