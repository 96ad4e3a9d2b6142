"""Problems of suites in a study: named by a table, planned as any other, refused in a sentence."""

from __future__ import annotations

import pytest

from pymoo_gridpath.errors import StudyError
from pymoo_gridpath.maps import load_map, save_map
from pymoo_gridpath.problems import Asletismac, GuardsGrid, make_suite
from pymoo_gridpath.study import ProblemSpec, load_study
from pymoo_gridpath.study.planning.build import build_problem
from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.planning.plan import Plan
from pymoo_gridpath.study.specification.study import Study

FORWARD = "ASLETISMAC_NO_X6_Y6_P2_K3_BF"


def plan_of(problem, algorithm=None):
    return plan_study(
        Study.from_dict(
            {
                "problems": [problem],
                "algorithms": [{"algorithm": "NSGA2", "pop_size": 8} | (algorithm or {})],
                "seeds": 1,
                "budget": {"generations": 2},
                "reference": False,
            }
        )
    )


def built(plan):
    task = plan.task(plan.runs[0])
    return build_problem(task.problem, task.grid)


@pytest.mark.parametrize(
    "table",
    [
        {"class": "asletismac", "instance": FORWARD},
        {"class": "asletismac", "instance": "ASLETISMAC_CH_X5_Y5_PM_K2_BT"},
        {"class": "random-cost", "width": 5, "height": 4, "n_obj": 3, "seed": 4},
        {"class": "guards", "map": "warehouse", "guards": [[20, 20], [44, 12]]},
        {"class": "small-environments", "environment": "caved"},
        {"class": "region-of-sight", "kind": "maze"},
    ],
)
def test_a_table_means_the_problem_of_the_suite(table):
    suite = make_suite(table["class"], **{key: value for key, value in table.items() if key != "class"})
    plan = plan_of({"suite": table})
    problem, expected = built(plan), suite.problem()
    assert problem.grid.digest == expected.grid.digest
    assert (problem.start, problem.goal, problem.n_var) == (expected.start, expected.goal, expected.n_var)
    assert repr(problem.objectives) == repr(expected.objectives)
    planned = plan.problems[0]
    assert planned.label == suite.label and suite.follows in planned.source
    # A file says the same, and an object too.
    assert Plan.from_json(plan.to_json()).to_json() == plan.to_json()
    if table["class"] != "guards":
        assert plan_of({"suite": suite}).runs == plan.runs
    spec = ProblemSpec(suite=table)
    assert spec.suite == table and spec.objectives is None and len(spec.scored_by) == expected.n_obj


def test_objectives_of_the_suite_go_by_their_names():
    given = ["turn", "ascent", {"class": "vulnerability", "variance": 2.0}]
    plan = plan_of({"suite": {"class": "asletismac", "instance": FORWARD}, "objectives": given})
    problem = built(plan)
    assert problem.objective_names == ["turn", "ascent", "vulnerability"]
    assert repr(problem.objectives[1]) == repr(Asletismac(FORWARD).objectives[2])
    assert problem.representation.backtracking is False


def test_maps_of_guards_lie_beside_the_study(tmp_path):
    save_map(load_map("warehouse"), tmp_path / "hall.txt")
    file = tmp_path / "study.toml"
    file.write_text(
        "seeds = 1\nbudget = { generations = 1 }\n[[algorithms]]\nalgorithm = 'NSGA2'\npop_size = 8\n[[problems]]\n"
        "suite = { class = 'guards', map = 'hall.txt', guards = [[20, 20]], start = [2, 3], goal = [57, 36] }\n"
    )
    plan = plan_study(load_study(file))
    assert built(plan).grid.digest == GuardsGrid("warehouse", [(20, 20)]).query[0].digest
    file.write_text(file.read_text().replace("hall.txt", "hull.txt"))
    with pytest.raises(StudyError, match=r"study.toml, line 7: .*hull.txt"):
        plan_study(load_study(file))


@pytest.mark.parametrize(
    ("problem", "message"),
    [
        ({"suite": "asletismak"}, "suite is 'asletismak'; did you mean 'asletismac'"),
        ({"suite": {"class": "zdt"}}, "class is 'zdt'; expected one of asletismac"),
        ({"suite": "asletismac"}, "'asletismac' cannot be made: missing a required argument: 'instance'"),
        ({"suite": {"class": "asletismac", "name": FORWARD}}, "asletismac takes no argument 'name'; did you mean 'instance'"),
        ({"suite": {"class": "asletismac", "instance": "ZDT1"}}, "instance is 'ZDT1', expected a name such as ASLETISMAC_NO"),
        ({"suite": {"class": "random-cost", "width": 4, "height": 3}, "start": [1, 1]}, "start is for maps from a file"),
        (
            {"suite": {"class": "guards", "map": "warehouse", "guards": [[20, 20]]}, "start": [1, 1]},
            "not for a problem with suite; write it into the table suite",
        ),
        ({"suite": {"class": "guards", "map": "warehouse", "guards": [[24, 1]]}}, r"guard 0 stands on \(24, 1\)"),
        (
            {"suite": {"class": "asletismac", "instance": FORWARD}, "representation": "cells"},
            "representation is not for a suite",
        ),
        ({"suite": {"class": "asletismac", "instance": FORWARD}, "map": "warehouse"}, "the problem has suite and map"),
        ({"suite": {"class": "asletismac", "instance": FORWARD}, "objectives": ["delays"]}, "there is no objective 'delays'"),
        ({"suite": {"class": "asletismac", "instance": "ASLETISMAC_LA_X3_Y3_P1_K2_BF"}}, r"goal \(2, 2\) lies on an obstacle"),
    ],
)
def test_what_is_no_problem_of_a_suite_is_refused(problem, message):
    with pytest.raises(StudyError, match=message) as info:
        plan_of(problem)
    assert "\n" not in str(info.value)


def test_an_algorithm_may_not_change_how_paths_are_coded_that_do_not_backtrack():
    problem = {"suite": {"class": "asletismac", "instance": FORWARD}, "objectives": ["length", "turn"]}
    with pytest.raises(StudyError, match="it changes the representation, and paths of the suite do not backtrack"):
        plan_of(problem, {"representation": "cells"})
