"""Studies of problems whose obstacles move: what they may say, what their runs find, and what the report makes of it."""

from __future__ import annotations

import copy
import csv
import dataclasses
import json
from importlib.util import find_spec

import numpy as np
import pytest
from pymoo.optimize import minimize
from small_studies import Coordinator, same_runs, stored, wait_until

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.errors import GridPathError, StudyError
from pymoo_gridpath.problems import MovingObstaclesProblem, ObstacleClock, random_dense_grid, random_movers
from pymoo_gridpath.quality import hypervolume_ratio, igd_plus, mean_hypervolume_ratio, mean_igd_plus, merge_fronts
from pymoo_gridpath.study import MovingObstacles, ProblemSpec, Study, compare, load_study, plan_study, run_study, write_report
from pymoo_gridpath.study.planning.estimate import estimate
from pymoo_gridpath.study.planning.plan import Plan
from pymoo_gridpath.study.report.results import collect
from pymoo_gridpath.study.report.tables.moving import epochs_table
from pymoo_gridpath.study.running.record import from_bytes, to_bytes
from pymoo_gridpath.study.running.store import Store

NAMES = ["DNSGA2", "NSGA2", *(["KGB"] if find_spec("sklearn") is not None else [])]
FAMILY = {"size": 10, "p0": 0.1, "seeds": 2}
AT_RANDOM = {"movers": 4, "every": 3, "epochs": 4, "seed": 7}


def make_study(**changes):
    values = {
        "problems": [{"name": "crossing", "random": FAMILY, "moving": AT_RANDOM}],
        "algorithms": [*({"algorithm": name, "pop_size": 16} for name in NAMES), {"algorithm": "exact"}],
        "seeds": 2,
    }
    return Study(**(values | changes))


# By hand KGB says that it makes genes between others.
pytestmark = pytest.mark.filterwarnings("ignore:genes that are no whole numbers")


@pytest.fixture(scope="module")
def plan():
    return plan_study(make_study())


@pytest.fixture(scope="module")
def done(plan, tmp_path_factory):
    folder = tmp_path_factory.mktemp("moving")
    outcome = run_study(plan, folder)
    assert (outcome.n_run, outcome.n_failed, outcome.messages) == (len(plan.runs), 0, [])
    return Store(folder)


def by_hand(seed, **options):
    """The problem of the study's family with a seed, made by hand."""
    grid = random_dense_grid(10, 0.1, seed)
    movers, _ = random_movers(grid, (0, 0), (9, 9), 4, 4, 7)
    return MovingObstaclesProblem(grid, movers, (0, 0), (9, 9), 3, **options)


# -- what a study may say -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("moving", "said"),
    [
        ({}, "moving has no movers"),
        (3, "moving is 3, expected a table"),
        ({"movers": 3}, "moving has no epochs"),
        ({"movers": 0, "epochs": 2}, "movers is 0, expected a whole number, 1"),
        ({"movers": True, "epochs": 2}, "movers is true, expected how many"),
        ({"movers": []}, r"movers is \[\], expected how many"),
        ({"movers": "three"}, "movers is 'three', expected how many"),
        ({"movers": [[]]}, r"mover 0 is \[\], expected its cells"),
        ({"movers": [[[1, 1]], [3]]}, "movers is 3, expected a cell"),
        ({"movers": [[[1, 1, 2]]]}, r"movers is \[1, 1, 2\], expected a cell"),
        ({"movers": [[[1, 1]]], "seed": 3}, "seed is for movers at random"),
        ({"movers": [[[1, 1]]], "every": 0}, "every is 0, expected a whole number"),
        ({"movers": [[[1, 1]]], "epochs": 0}, "epochs is 0, expected a whole number"),
        ({"movers": [[[1, 1]]], "evry": 2}, "moving has no key 'evry'; did you mean 'every'"),
    ],
)
def test_wrong_tables_are_refused(moving, said):
    with pytest.raises(StudyError, match=said):
        make_study(problems=[{"random": FAMILY, "moving": moving}])


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"representation": "integer"}, "representation is 'integer', expected 'cells' where obstacles move"),
        ({"obstacles": "constraint"}, "obstacles is 'constraint', expected 'penalty' where obstacles move"),
        ({"axis": "x"}, "axis is 'x', expected 'auto' where obstacles move"),
    ],
)
def test_what_does_not_go_with_movers_is_refused(changes, said):
    with pytest.raises(StudyError, match=said):
        make_study(problems=[{"random": FAMILY, "moving": AT_RANDOM, **changes}])


def test_runs_end_after_their_epochs_whatever_the_budget(plan):
    still = {"name": "still", "random": {"size": 8, "p0": 0.1}, "representation": "cells"}
    both = make_study(problems=[{"name": "crossing", "random": FAMILY, "moving": AT_RANDOM}, still], budget={"evaluations": 50})
    other = plan_study(both)
    budgets = {other.problems[run.problem].group: other.task(run).budget for run in other.runs if run.seed}
    assert budgets == {"crossing": {"generations": 12}, "still": {"evaluations": 50}}
    # Beside others they are the same runs.
    assert {run.key for run in plan.runs} < {run.key for run in other.runs}
    with pytest.raises(StudyError, match="the study has no budget"):
        make_study(problems=[still])
    with pytest.raises(StudyError, match="the study has a budget, and the obstacles of all its problems move"):
        make_study(budget={"generations": 5})


def test_one_problem_has_one_form(plan):
    ways = [[[int(x) for x in cell] for cell in way] for way in by_hand(1).movers]
    assert plan.problems[0].spec["moving"] == {"every": 3, "movers": ways}
    # However it is written: after its last cell a mover stays, and what comes after the last epoch is nothing.
    short = [[[5, 5], [5, 6]], [[1, 8]]]
    forms = (
        {"movers": short},
        {"movers": [[[5, 5], [5, 6], [5, 7]], [[1, 8], [1, 8]]], "epochs": 2, "every": 5},
        MovingObstacles(movers=np.array([[[5, 5], [5, 6]], [[1, 8], [1, 8]]])),
    )
    one = {"random": {"size": 10, "p0": 0.0}}
    keys = {tuple(run.key for run in plan_study(make_study(problems=[{**one, "moving": form}])).runs) for form in forms}
    assert len(keys) == 1
    more = plan_study(make_study(problems=[{**one, "moving": {"movers": short, "epochs": 3}}]))
    assert keys != {tuple(run.key for run in more.runs)} and more.task(more.runs[-1]).budget == {"generations": 15}
    # As they are to stay, so that what is stored stays valid.
    first = make_study(problems=[{**one, "moving": forms[0]}], algorithms=[{"algorithm": "DNSGA2"}], seeds=1)
    assert [run.key for run in plan_study(first).runs] == [
        "94ec543472917c828fa6a3d7365ed52d",
        "431f33dddfc7667915c5ede41a36fe40",
    ]


def test_a_file_says_it_as_well(tmp_path):
    (tmp_path / "crossing.toml").write_text(
        """
seeds = 2

[[problems]]
map = "paper16"
start = [0, 0]
goal = [15, 15]

[problems.moving]
movers = [[[3, 12], [3, 11]], [[12, 3]]]
every = 4

[[algorithms]]
algorithm = "DNSGA2"
pop_size = 12
""",
        encoding="utf-8",
    )
    study = load_study(tmp_path / "crossing.toml")
    assert study.problems[0].moving == MovingObstacles(movers=(((3, 12), (3, 11)), ((12, 3),)), every=4)
    assert study.budget is None
    again = Study.from_dict(json.loads(json.dumps(study.to_dict())))
    assert again == dataclasses.replace(study, folder=again.folder)
    text = (tmp_path / "crossing.toml").read_text(encoding="utf-8")
    (tmp_path / "crossing.toml").write_text(text.replace("[12, 3]", "[0, 0]"), encoding="utf-8")
    with pytest.raises(StudyError, match=r"line \d+: .*in epoch 0 mover 1 stands on the start \(0, 0\)"):
        plan_study(load_study(tmp_path / "crossing.toml"))


@pytest.mark.parametrize(
    ("algorithm", "said"),
    [
        ({"algorithm": "CTAEA"}, "CTAEA keeps members beside its population"),
        ({"preset": "ahmed-deb-2013"}, "it asks for representation='integer', and where obstacles move there is 'cells' alone"),
        ({"algorithm": "NSGA2", "representation": "mixed"}, "it asks for representation='mixed'"),
        ({"algorithm": "NSGA2", "obstacles": "constraint"}, "it asks for obstacles='constraint'"),
    ],
)
def test_algorithms_that_cannot_are_refused_in_a_sentence(algorithm, said):
    with pytest.raises(StudyError, match=said) as caught:
        plan_study(make_study(algorithms=[algorithm]))
    assert "\n" not in str(caught.value)


def test_movers_that_cut_off_a_query_are_refused_with_its_seed():
    wall = [[[1, y]] for y in range(10)]
    with pytest.raises(StudyError, match=r"problem 'w', 1: in epoch 0: goal .* cannot be reached"):
        plan_study(make_study(problems=[{"name": "w", "random": FAMILY, "moving": {"movers": wall}}]))
    with pytest.raises(StudyError, match="there is room for"):
        plan_study(make_study(problems=[{"random": FAMILY, "moving": {"movers": 99, "epochs": 2}}]))


def test_a_stored_plan_is_read_and_checked(plan):
    data = json.loads(json.dumps(plan.to_json()))
    again = Plan.from_json(data)
    assert again.runs == plan.runs and again.budget == {}
    assert [again.task(run) for run in plan.runs] == [plan.task(run)._replace(grid=None) for run in plan.runs]
    for key, value in (
        ("every", 0),
        ("movers", []),
        ("movers", 3),
        ("movers", [[[1, 1]], [[1, 1], [2, 2]]]),
        ("movers", [[[1, 1.5]]]),
        ("moves", 1),
    ):
        damaged = copy.deepcopy(data)
        damaged["problems"][0]["spec"]["moving"][key] = value
        with pytest.raises(StudyError, match=r"every|movers|mover|moves"):
            Plan.from_json(damaged)
    damaged = copy.deepcopy(data)
    damaged["problems"][1]["spec"]["moving"]["movers"] = [[[1, 1]]]
    with pytest.raises(StudyError, match="moving has other epochs than those of its group"):
        Plan.from_json(damaged)


def test_time_is_estimated(plan):
    found = estimate(plan, max_seconds=30)
    assert found.n_measured == found.n_kinds == len(NAMES) + 1 and 0 < found.seconds < 600 and not found.open_ended


# -- what runs find -----------------------------------------------------------------------------------------------------


def test_a_run_is_that_of_minimize_with_a_clock(plan, done):
    n_checked = 0
    for run in plan.runs:
        record = done.read(run.key)
        epochs = record.epochs
        assert record.status == "finished" and epochs is not None and len(epochs) == 4
        assert not (epochs.stale.any() or epochs.wrong.any() or epochs.illegal.any())
        problem = by_hand(plan.problems[run.problem].spec["grid"]["random"]["seed"])
        name = plan.algorithms[run.algorithm].spec["algorithm"]
        if name == "exact":
            for still, found in zip(problem.stills, epochs.fronts(), strict=True):
                np.testing.assert_array_equal(found, still.pareto_front())
            continue
        clock = ObstacleClock()
        algorithm = make_algorithm(name, problem, 16)
        minimize(problem, algorithm, ("n_gen", 12), seed=run.seed, callback=clock)
        for found, F in zip(epochs.fronts(), clock.F, strict=True):
            np.testing.assert_array_equal(found, F)
        assert epochs.evaluations.tolist() == clock.evaluations and epochs.missed.tolist() == clock.missed
        assert (record.n_eval, record.n_gen) == (clock.evaluations[-1], 12)
        np.testing.assert_array_equal(record.F, clock.F[-1])
        np.testing.assert_array_equal(record.X, clock.X[-1])
        assert epochs.of_records.tolist() == [0] * 3 + [1] * 3 + [2] * 3 + [3] * 3
        n_checked += 1
    assert n_checked == 4 * len(NAMES)


def test_planners_plan_anew_on_each_map(plan, tmp_path):
    study = make_study(algorithms=[{"algorithm": "astar"}], seeds=1)
    outcome = run_study(plan_study(study), tmp_path)
    assert outcome.n_failed == 0
    record = Store(tmp_path).read(plan_study(study).runs[-1].key)
    shortest = [still.pareto_front()[0, 0] for still in by_hand(2).stills]
    assert [front[0, 0] for front in record.epochs.fronts()] == pytest.approx(shortest)
    assert record.message.splitlines()[1].startswith("epoch 1: found a path")


def test_other_processes_find_the_same_bits_after_a_kill(plan, done, tmp_path):
    folder = tmp_path / "results"
    coordinator = Coordinator(plan, folder, most=3)
    wait_until(lambda: len(stored(folder)) >= 3)
    coordinator.process.kill()
    coordinator.process.wait()
    before = stored(folder)
    assert 3 == len(before) < len(plan.runs)
    outcome = run_study(plan, folder)
    assert (outcome.n_failed, outcome.n_done_before) == (0, len(before))
    same_runs(plan, done, Store(folder))
    for run in plan.runs:
        one, other = (store.read(run.key).epochs.packed() for store in (done, Store(folder)))
        assert all(one[name].tobytes() == other[name].tobytes() for name in one)
    assert {key: when for key, when in stored(folder).items() if key in before} == before


def test_a_record_is_read_as_it_was_written_and_others_have_no_epochs(plan, done):
    record = done.read(plan.runs[-1].key)
    again = from_bytes(to_bytes(record))
    assert all(
        np.array_equal(a, b) for a, b in zip(again.epochs.packed().values(), record.epochs.packed().values(), strict=True)
    )
    still = dataclasses.replace(record, epochs=None)
    assert from_bytes(to_bytes(still)).epochs is None
    with pytest.raises(GridPathError, match="epoch is 4, expected"):
        record.epochs.front(4)


# -- what the report makes of it ----------------------------------------------------------------------------------------


def rows_of(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_the_report_measures_each_epoch_against_its_own_front(plan, done, tmp_path):
    files = {path.name for path in write_report(done.folder, tmp_path, formats=["png"])}
    assert {"epochs.csv", "epochs-crossing.png", "convergence-crossing.png", "report.md"} <= files
    fronts = {f"crossing/{seed}": [still.pareto_front() for still in by_hand(seed).stills] for seed in (1, 2)}
    records = {run.key: done.read(run.key) for run in plan.runs}
    for row in rows_of(tmp_path / "runs.csv"):
        found, exact = records[row["key"]].epochs.fronts(), fronts[row["problem"]]
        assert row["reference"] == "exact" and row["feasible"] == "true"
        assert float(row["ratio"]) == pytest.approx(mean_hypervolume_ratio(found, exact))
        assert float(row["igd_plus"]) == pytest.approx(mean_igd_plus(found, exact), abs=1e-12)
    rows = rows_of(tmp_path / "epochs.csv")
    assert len(rows) == 4 * (2 + 4 * len(NAMES))
    for row in rows:
        found, exact = records[row["key"]].epochs.front(int(row["epoch"])), fronts[row["problem"]][int(row["epoch"])]
        assert float(row["ratio"]) == pytest.approx(hypervolume_ratio(found, exact))
        assert float(row["igd_plus"]) == pytest.approx(igd_plus(found, exact), abs=1e-12)
        assert int(row["n_points"]) == len(found) and int(row["reference_points"]) == len(exact)
        assert [row[count] for count in ("stale", "wrong", "illegal")] == ["0"] * 3
    # Or there would be nothing to measure.
    assert any(float(row["ratio"]) < 1 for row in rows if row["algorithm"] != "exact")
    text = (tmp_path / "report.md").read_text(encoding="utf-8")
    assert "4 movers, a move every 3 generations, 4 epochs" in text and "mean hypervolume ratio" in text
    assert "Budget of each run" not in text and "Obstacles that move: every so many generations" in text
    tests = rows_of(tmp_path / "tests.csv")
    assert {"ratio", "igd_plus"} <= {row["measure"] for row in tests}


def test_the_curve_is_measured_against_the_front_of_then(plan, done):
    results = collect(done)
    for run in results.runs:
        if run.curve is None:
            continue
        record, fronts = done.read(run.key), [front.points for front in results.references[run.problem].epochs]
        wanted = [hypervolume_ratio(record.history.front(k), fronts[e]) for k, e in enumerate(record.epochs.of_records)]
        np.testing.assert_allclose(run.curve.ratio, wanted, atol=1e-12)
        shortest = np.array([front[:, 0].min() for front in fronts])[record.epochs.of_records]
        np.testing.assert_allclose(run.curve.length, record.history.best_length / shortest)
        # At the end of each epoch it is what the epoch is measured by.
        np.testing.assert_allclose(run.curve.ratio[2::3], run.epochs.ratio, atol=1e-12)


def test_stale_values_are_counted_in_the_report(plan, done, tmp_path):
    """Of a made-up run whose members were not what they passed for."""
    key = next(run.key for run in plan.runs if run.algorithm == 1)
    store = Store(tmp_path)
    store.write_plan(plan)
    for run in plan.runs:
        record = done.read(run.key)
        if run.key == key:
            faulty = dataclasses.replace(record.epochs, stale=np.array([0, 2, 0, 3]), illegal=np.array([0, 1, 0, 0]))
            record = dataclasses.replace(record, epochs=faulty)
        store.path(run.key).parent.mkdir(parents=True, exist_ok=True)
        store.path(run.key).write_bytes(to_bytes(record))
    table = epochs_table(collect(store), [0, 1], "crossing", "on crossing")
    assert table.header[-4:] == ["missed", "stale", "wrong", "illegal"]
    assert table.rows[1][1:2] + table.rows[1][-4:] == ["NSGA2", "0", "5", "0", "1"]
    assert table.rows[0][-3:] == ["0", "0", "0"]


def test_without_a_reference_each_epoch_is_measured_against_the_best_of_its_runs(tmp_path):
    study = make_study(reference=False, algorithms=[{"algorithm": "NSGA2", "pop_size": 16}])
    run_study(plan_study(study), tmp_path)
    results = collect(Store(tmp_path))
    reference = results.references[0]
    assert not reference.front.exact and len(reference.epochs) == 4
    for epoch, front in enumerate(reference.epochs):
        runs = [run for run in results.runs if run.problem == 0]
        assert len(front) and max(run.epochs.ratio[epoch] for run in runs) <= 1 and all(run.feasible for run in runs)
        best = merge_fronts([Store(tmp_path).read(run.key).epochs.front(epoch) for run in runs])
        np.testing.assert_array_equal(front.points, best)


def test_a_study_that_has_not_begun_has_a_report(plan, tmp_path):
    store = Store(tmp_path)
    store.write_plan(plan)
    write_report(tmp_path, formats=["svg"])
    key = plan.runs[0].key
    assert not store.path(key).exists()


def test_plain_results_are_compared_by_their_clocks():
    problem, runs = by_hand(1), {}
    for name in ("DNSGA2", "NSGA2"):
        for seed in (1, 2, 3):
            problem.restart()
            algorithm = make_algorithm(name, problem, 16)
            result = minimize(problem, algorithm, ("n_gen", 12), seed=seed, callback=ObstacleClock())
            runs.setdefault(("crossing", name), []).append(result)
    tables = compare(runs)
    fronts = [still.pareto_front() for still in problem.stills]
    for row in tables["runs"]:
        clock = runs["crossing", row["algorithm"]][int(row["seed"]) - 1].algorithm.callback
        assert float(row["ratio"]) == pytest.approx(mean_hypervolume_ratio(clock.F, fronts))
    assert len(tables["epochs"]) == 6 * 4 and tables["problems"][0]["movers"] == "4"
    problem.restart()
    short = minimize(problem, make_algorithm("NSGA2", problem, 16), ("n_gen", 4), seed=1, callback=ObstacleClock())
    with pytest.raises(GridPathError, match="has no clock that kept all 4 epochs"):
        compare({("crossing", "NSGA2"): [short]})


def test_a_map_and_a_grid_may_have_movers_too():
    grid = OccupancyGrid(np.zeros((6, 9)), corner_cutting=False)
    one = ProblemSpec(name="open", grid=grid, start=(0, 0), goal=(8, 5), moving={"movers": [[(4, 2), (4, 3)]]})
    plan = plan_study(make_study(problems=[one], seeds=1))
    assert plan.problems[0].spec["representation"] == "cells" and plan.problems[0].grid is not None
