"""Settings of algorithms that would fail, or mean nothing, in a run: refused before, and nothing that would work is."""

from __future__ import annotations

import random
import time
from inspect import Parameter

import numpy as np
import pytest

from pymoo_gridpath.algorithms import CAPABILITIES, make_algorithm
from pymoo_gridpath.errors import CapabilityError, StudyError
from pymoo_gridpath.problems import OBSTACLES, GridPathProblem, random_dense_grid
from pymoo_gridpath.representations import REPRESENTATIONS
from pymoo_gridpath.study.planning import trial
from pymoo_gridpath.study.planning.build import build_algorithm, build_problem, build_termination
from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.planning.plan import is_truth
from pymoo_gridpath.study.running.execute import execute
from pymoo_gridpath.study.running.record import from_bytes
from pymoo_gridpath.study.specification import parameters as further
from pymoo_gridpath.study.specification.study import Study
from pymoo_gridpath.study.specification.toml_file import load_study
from pymoo_gridpath.testing.enumeration import RULES

POINTS = [[10, 1], [12, 0.5]]


def plan_of(algorithm, problem=None, **others):
    """Return the plan of a study of one algorithm, or of several, on one random grid."""
    return plan_study(
        Study.from_dict(
            {
                "problems": [{"random": {"size": 8, "p0": 0.2}} | (problem or {})],
                "algorithms": [algorithm] if isinstance(algorithm, dict) else algorithm,
                "seeds": 1,
                "budget": {"generations": 3},
                "reference": False,
                **others,
            }
        )
    )


def refusal(algorithm, problem=None, **others) -> str:
    with pytest.raises(StudyError) as info:
        plan_of(algorithm, problem, **others)
    assert "\n" not in str(info.value)
    return str(info.value)


def run(plan) -> None:
    """Carry out the first run of a plan."""
    task = plan.task(plan.runs[0])
    problem = build_problem(task.problem, task.grid)
    algorithm = build_algorithm(task.algorithm, problem)
    algorithm.setup(problem, termination=build_termination(task.budget, algorithm), seed=task.seed)
    algorithm.run()


# -- short runs ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("slot", ["crossover", "mutation"])
@pytest.mark.parametrize("representation", ["integer", "cells"])
def test_operators_that_do_not_fit_are_refused_with_the_line(tmp_path, slot, representation):
    path = tmp_path / "tiny.toml"
    path.write_text(
        f"""seeds = 1
budget = {{ generations = 2 }}
[[problems]]
random = {{ size = 8, p0 = 0.2 }}
representation = "mixed"
[[algorithms]]
algorithm = "NSGA2"
[[algorithms]]
name = "own"
algorithm = "NSGA2"
representation = "{representation}"
operators = {{ {slot} = "Mixed{slot.capitalize()}" }}
"""
    )
    with pytest.raises(StudyError) as info:
        plan_study(load_study(path))
    assert str(info.value) == (
        f"{path}, line 8: 'own' fails on the problem 'random-8-0.2': "
        f"the mixed operators need the mixed representation, the problem has {representation}"
    )


def test_other_errors_are_named(monkeypatch):
    from pymoo_gridpath.operators import PathMutation

    def stop(*args, **kwargs):
        raise TypeError("two\nlines")

    monkeypatch.setattr(PathMutation, "_do", stop)
    algorithm = {"algorithm": "NSGA2", "operators": "scalarized", "name": "x"}
    assert refusal(algorithm) == "algorithms[0]: 'x' fails on the problem 'random-8-0.2': TypeError: two lines"


def test_what_fails_in_the_small_alone_is_not_refused(monkeypatch):
    """With few members, or on the grid that stands in; the last try is the run itself."""
    tried = []
    real = trial.build_algorithm

    def picky(algorithm, problem):
        tried.append((algorithm["pop_size"], problem.grid.width))
        if algorithm["pop_size"] < 40 or problem.grid.width < 120:
            raise RuntimeError("too small")
        return real(algorithm, problem)

    monkeypatch.setattr(trial, "build_algorithm", picky)
    plan_of({"algorithm": "NSGA2", "pop_size": 40}, {"random": {"size": 120, "p0": 0.2}})
    assert tried == [(12, 32), (40, 120)]
    assert "RuntimeError: too small" in refusal({"algorithm": "NSGA2", "pop_size": 30}, {"random": {"size": 120, "p0": 0.2}})


@pytest.mark.parametrize("steps", RULES, ids=str)
@pytest.mark.parametrize("axis", ["auto", "x", "y"])
def test_every_representation_has_a_path_on_the_grid_that_stands_in(monkeypatch, steps, axis):
    monkeypatch.setattr(trial, "_MOST_CELLS", 1)
    small = []
    monkeypatch.setattr(trial, "_run", lambda pair: small.append(build_problem(pair.problem, pair.grid)))
    for name in REPRESENTATIONS:
        if name == "cells" and axis != "auto":
            continue
        family = {"size": 32, "p0": 0.1, "corner_cutting": False} | steps
        plan_of({"algorithm": "NSGA2"}, {"random": family, "representation": name, "axis": axis})
        assert (small[-1].grid.width, small[-1].grid) == (32, small[-1].grid.replace(**steps))
        assert small[-1].goal == (31, 31)
    assert len(small) == len(REPRESENTATIONS) - (axis != "auto")


def test_one_trial_of_each_kind_on_the_smallest_grid(monkeypatch):
    tried = []
    monkeypatch.setattr(trial, "_run", lambda pair: tried.append((pair.index, pair.label, pair.problem["representation"])))
    problems = [
        {"name": "large", "random": {"size": 16, "p0": 0.2, "seeds": 3}},
        {"name": "small", "random": {"size": 8, "p0": 0.2}},
        {"name": "binary", "random": {"size": 16, "p0": 0.2}, "representation": "binary"},
    ]
    algorithms = [{"algorithm": "NSGA2"}, {"algorithm": "SPEA2"}, {"algorithm": "exact"}]
    plan_of(algorithms, problems=problems)
    assert sorted(tried) == [(k, *where) for k in (0, 1) for where in (("binary", "binary"), ("small", "integer"))]


def test_checking_draws_from_no_global_generator():
    def state():
        return str(np.random.get_state()), random.getstate()  # noqa: NPY002

    before = state()
    plan_of([{"algorithm": "NSGA2", "operators": "random"}, {"algorithm": "KGB"}, {"algorithm": "NSGA3"}])
    assert state() == before


def test_large_maps_are_checked_fast():
    problem = {"random": {"size": 512, "p0": 0.2}}
    algorithms = [{"algorithm": "NSGA2", "name": f"{k}", "pop_size": 100 + k, "operators": "random"} for k in range(20)]
    plan_of(algorithms[:1])  # functions compiled
    plan_of(algorithms[:1], problem)
    begin = time.process_time()
    plan_of(algorithms, problem)
    assert time.process_time() - begin < 4.0  # one generation of random paths on this map takes more than half a second


USABLE = [row for row in CAPABILITIES.values() if not row.unfit and row.needs != "automated_dm"]


def test_every_run_ends_where_there_are_but_few_paths(monkeypatch):
    """Some algorithms would make generations without new paths for ever."""
    monkeypatch.setattr("pymoo_gridpath.study.running.execute._LONGEST", (1, 2))
    algorithms = [
        {"algorithm": row.name, "pop_size": 10} | ({"parameters": {"ref_points": POINTS}} if row.needs == "ref_points" else {})
        for row in USABLE
        if row.max_objectives is None
    ]
    problem = {"random": {"size": 2, "p0": 1.0}, "representation": "cells"}
    plan = plan_study(
        Study.from_dict(
            {"problems": [problem], "algorithms": algorithms, "seeds": 1, "budget": {"evaluations": 40}, "reference": False}
        )
    )
    records = [from_bytes(execute(plan.task(run))) for run in plan.runs]
    assert len(records) > 15 and all(record.status == "finished" and len(record.F) for record in records)
    stopped = [record for record in records if record.message]
    assert stopped and all(record.message.startswith("ended after 6 generations, in which it made but") for record in stopped)


@pytest.mark.parametrize("representation", REPRESENTATIONS)
@pytest.mark.parametrize("obstacles", OBSTACLES)
def test_nothing_that_the_capability_table_allows_is_refused(representation, obstacles):
    problem = {"representation": representation, "obstacles": obstacles, "objectives": ["length", "vulnerability", "turn"]}
    if obstacles == "limit":
        problem["potential_limit"] = 3.0
    constrained = obstacles != "penalty"
    algorithms = [
        {"algorithm": row.name}
        | ({"parameters": {"ref_points": [[10, 1, 90], [12, 0.5, 45]]}} if row.needs == "ref_points" else {})
        for row in USABLE
        if row.max_objectives is None and not (constrained and not (row.constraints and row.reproducible_constrained))
    ]
    for few in (algorithms, [{**item, "pop_size": 20} for item in algorithms]):
        assert not any(is_truth(item.spec) for item in plan_of(few, problem).algorithms)


def test_a_population_that_others_decide_is_not_given_too():
    few = {"algorithm": "RNSGA3", "parameters": {"ref_points": POINTS, "pop_per_ref_point": 5}}
    assert "pop_size is 30, but pop_per_ref_point makes it" in refusal(few | {"pop_size": 30})
    # Ten or so, where the default of 100 would not fit into the budget.
    plan_of(few, budget={"evaluations": 50})
    many = {"algorithm": "RNSGA3", "parameters": {"ref_points": POINTS, "pop_per_ref_point": 100}}
    assert "expected at most the 50 evaluations" in refusal(many, budget={"evaluations": 50})
    directions = {"algorithm": "MOEAD", "parameters": {"ref_dirs": [[0, 1], [0.5, 0.5], [1, 0]], "n_neighbors": 2}}
    assert "pop_size is 30, but ref_dirs makes it 3; leave pop_size out" in refusal(directions | {"pop_size": 30})
    plan_of(directions)


# -- parameters ---------------------------------------------------------------------------------------------------------

REFUSED = [
    ("MOEAD", {"n_neighbors": 50}, "n_neighbors is 50, expected at most the 20 reference directions of "),
    ("ParallelMOEAD", {"n_neighbors": 21}, "n_neighbors is 21, expected at most the 20 reference directions of "),
    ("MOEAD", {"n_neighbors": 1}, "n_neighbors is 1, expected a whole number of at least 2 and at most 100,000 for MOEAD"),
    ("MOEAD", {"prob_neighbor_mating": 2}, "prob_neighbor_mating is 2.0, expected a number from 0 to 1 for "),
    ("MOEAD", {"batch_size": 2.5}, "batch_size is 2.5, expected a whole number"),
    ("MOEAD", {"ref_dirs": [[0, 1], [-1, 0]]}, "holds a row that is no direction, expected shares of 0 or more, not all 0"),
    ("MOEAD", {"ref_dirs": [[0, 1], [0, 0]]}, "holds a row that is no direction, expected shares of 0 or more, not all 0"),
    ("MOEAD", {"ref_dirs": [[0, 1], [1]]}, "expected rows of values, one an objective, such as [[0, 1], [1, 0]]"),
    ("RNSGA2", {"ref_points": POINTS, "normalization": "fornt"}, "normalization is 'fornt'; did you mean 'front'?"),
    ("RNSGA2", {"ref_points": POINTS, "weights": [1]}, "weights has 1 entries, expected one for each of the 2 objectives"),
    ("RNSGA2", {"ref_points": POINTS, "weights": 3}, "weights is 3, expected a weight of 0 or more for each objective"),
    ("RNSGA2", {"ref_points": POINTS, "weights": [-1, 2]}, "weights is [-1, 2], expected a weight of 0 or more"),
    ("RNSGA2", {"ref_points": [1, 2]}, "ref_points has shape (2,), expected rows of values"),
    ("RNSGA2", {"ref_points": [[1, 2, 3]]}, "expected rows of 2 finite numbers"),
    ("RNSGA3", {"ref_points": POINTS, "mu": 3}, "mu is 3.0, expected a number from 0 to 1 for "),
    ("RNSGA3", {"ref_points": POINTS, "pop_per_ref_point": 2.5}, "pop_per_ref_point is 2.5, expected a whole number"),
    ("DNSGA2", {"version": "C"}, "version is 'C'; expected one of A, B"),
    ("DNSGA2", {"perc_detect_change": 2}, "perc_detect_change is 2.0, expected a number from 0 to 1 for "),
    ("KGB", {"perc_diversity": 1.5}, "perc_diversity is 1.5, expected a number from 0 to 1 for "),
    ("RVEA", {"adapt_freq": 0}, "adapt_freq is 0.0, expected a number above 0, at most 1 for RVEA"),
    ("NSGA2", {"n_offsprings": 10**6}, "n_offsprings is 1000000, expected a whole number of at least 1 and at most 100,000"),
    ("NSDE", {"variant": "DE/rnd/1/bin"}, "variant is 'DE/rnd/1/bin'; did you mean 'DE/rand/1/bin'?"),
    ("NSDE", {"variant": "DE/rand-to-best/2/exp"}, "did you mean 'DE/current-to-best/2/exp'?"),
    ("NSDE", {"variant": "DE/rand/0/bin"}, "did you mean 'DE/rand/1/bin'?"),
    ("NSDE", {"variant": "DE/rand/1/bun"}, "did you mean 'DE/rand/1/bin'?"),
    ("NSDE", {"variant": 3}, "variant is 3; expected one of DE/rand/1/bin, "),
    ("NSDE", {"de_repair": "bounce"}, "de_repair is 'bounce'; did you mean 'bounce-back'?"),
    ("NSDE", {"CR": 2}, "CR is 2.0, expected a number from 0 to 1 for "),
    ("NSDE", {"F": [0.2]}, "F is [0.2], expected a number above 0, at most 2, or a range such as [0.2, 0.8]"),
    ("NSDE", {"F": [0.8, 0.2]}, "F is [0.8, 0.2], expected"),
    ("NSDE", {"F": -3}, "F is -3, expected"),
    ("NSDE", {"F": True}, "F is True, expected"),
]


@pytest.mark.parametrize(("name", "parameters", "message"), REFUSED)
def test_values_that_mean_nothing_are_refused(name, parameters, message):
    found = refusal({"algorithm": name, "pop_size": 20, "parameters": parameters})
    assert message in found
    assert found.startswith("algorithms[0]")
    # Not by the study: whoever makes it is told the same.
    problem = GridPathProblem(random_dense_grid(8, 0.2, 1), (0, 0), (7, 7))
    with pytest.raises(CapabilityError) as error:
        make_algorithm(name, problem, 20, **parameters)
    said = str(error.value)
    assert message.replace(".0, exp", ", exp") in said
    # A study writes the whole numbers that stand for others as those.
    assert found.replace(".0, expected", ", expected").endswith(said)


def test_three_objectives_have_fewer_directions():
    problem = {"objectives": ["length", "vulnerability", "turn"]}
    message = refusal({"algorithm": "MOEAD", "pop_size": 20, "parameters": {"n_neighbors": 16}}, problem)
    assert "n_neighbors is 16, expected at most the 15 reference directions" in message
    points = {"ref_points": [[10, 1, 90], [12, 0.5, 45]], "pop_per_ref_point": 5}
    assert "can not be created uniformly" in refusal({"algorithm": "RNSGA3", "parameters": points}, problem)


@pytest.mark.parametrize("name", [row.name for row in USABLE])
def test_defaults_written_out_are_left_out(name):
    others = (*further._ELSEWHERE, *further._NO_EFFECT, *further._OBJECTS)
    accepted = {key: value for key, value in further.accepted_parameters(name).items() if key not in others}
    given = {key: value for key, value in accepted.items() if value is not Parameter.empty}
    assert further.parameters(name, given, ()) == {}


TAKEN = [
    ("MOEAD", {"n_neighbors": 2, "prob_neighbor_mating": 1, "batch_size": 1}),
    ("MOEAD", {"n_neighbors": 50, "ref_dirs": [[k, 50 - k] for k in range(51)]}),
    ("RNSGA2", {"ref_points": POINTS, "normalization": "no", "weights": [1, 0]}),
    ("RNSGA3", {"ref_points": POINTS, "mu": 0.2, "pop_per_ref_point": 3}),
    ("DNSGA2", {"version": "B", "perc_detect_change": 1}),
    ("NSDE", {"variant": "DE/current-to-best/2/exp", "F": 0.5, "CR": 0}),
    ("GDE3", {"variant": "DE/ranked/1/bin", "F": [0, 1], "de_repair": "midway"}),
    ("RVEA", {"adapt_freq": 1}),
    ("NSGA2", {"n_offsprings": 300}),
]


@pytest.mark.parametrize(("name", "parameters"), TAKEN)
def test_values_at_the_ends_of_their_ranges_are_taken_and_run(name, parameters):
    size = {} if {"ref_dirs", "pop_per_ref_point"} & parameters.keys() else {"pop_size": 20}
    plan = plan_of({"algorithm": name, "parameters": parameters} | size)
    assert plan.algorithms[0].spec["parameters"].keys() == parameters.keys()
    run(plan)
