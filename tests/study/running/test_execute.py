"""One run: what is kept of it against what pymoo returns and what the paths themselves say."""

from __future__ import annotations

import numpy as np
import pytest
from pymoo.core.callback import CallbackCollection
from pymoo.optimize import minimize
from small_studies import HISTORY, without_grids

from pymoo_gridpath.algorithms import CAPABILITIES
from pymoo_gridpath.convergence import ConvergenceRecorder
from pymoo_gridpath.decision.measures import PathMeasures
from pymoo_gridpath.study.planning.build import build_algorithm, build_problem, build_termination
from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.planning.plan import Task
from pymoo_gridpath.study.running.execute import MAX_RECORDS, Recorder, execute
from pymoo_gridpath.study.running.record import from_bytes
from pymoo_gridpath.study.specification.study import AlgorithmSpec, ProblemSpec, Study


def one_task(problem: dict, algorithm: dict, budget: dict, seed: int = 1) -> Task:
    study = Study(
        problems=[ProblemSpec(**problem)], algorithms=[AlgorithmSpec(**algorithm)], seeds=[seed], budget=budget, reference=False
    )
    plan = plan_study(study)
    return plan.task(plan.runs[0])


def dense(**others) -> dict:
    return {"random": {"size": 12, "p0": 0.2, "seeds": 1}, **others}


def non_dominated(F: np.ndarray) -> np.ndarray:
    """Return the non-dominated rows by comparing every pair, each once, sorted."""
    rows = sorted({tuple(row) for row in F.tolist()})
    kept = [a for a in rows if not any(b != a and all(x <= y for x, y in zip(b, a, strict=True)) for b in rows)]
    return np.array(kept).reshape(-1, F.shape[1])


THREE = ["length", "vulnerability", "turn"]
TASKS = [
    (dense(), {"algorithm": "NSGA2", "pop_size": 30}, {"generations": 30}),
    (dense(), {"preset": "ahmed-deb-2013", "pop_size": 30}, {"evaluations": 600}),
    (dense(obstacles="constraint", objectives=THREE), {"algorithm": "SPEA2", "pop_size": 20}, {"generations": 15}),
    (dense(obstacles="limit", potential_limit=6.0), {"algorithm": "MOEA/D", "pop_size": 20}, {"generations": 15}),
    (dense(objectives=THREE[1:], representation="cells"), {"algorithm": "NSGA3", "pop_size": 20}, {"generations": 15}),
    (dense(objectives=["length"]), {"algorithm": "GA", "pop_size": 20}, {"generations": 15}),
    ({"map": "paper16", "representation": "cells"}, {"algorithm": "exact"}, {"generations": 1}),
]


@pytest.mark.parametrize(("problem", "algorithm", "budget"), TASKS)
def test_a_record_is_what_minimize_finds(problem, algorithm, budget):
    task = one_task(problem, algorithm, budget)
    record = from_bytes(execute(task))
    assert record.status == "finished", record.message
    built = build_problem(task.problem, task.grid)
    recorder = ConvergenceRecorder()
    termination = None if task.budget is None else build_termination(task.budget)
    result = minimize(built, build_algorithm(task.algorithm, built), termination, seed=task.seed, callback=recorder)
    recorder = result.algorithm.callback

    # The paths themselves, decoded and measured anew.
    X = np.array([one.X for one in result.pop])
    paths = built.decode(X)
    legal = PathMeasures(built).legal(paths)
    F = np.asarray(built.score(paths), dtype=float)
    assert record.F.tolist() == non_dominated(F[legal]).tolist()
    assert record.F.tolist() == built.score(built.decode(record.X)).tolist() if len(record.F) else True
    assert {tuple(row) for row in record.X.tolist()} <= {tuple(row) for row in X[legal].tolist()}
    turn = paths.turn[legal]
    assert record.turn.tolist() == [turn[(F[legal] == point).all(axis=1)].min() for point in record.F]
    assert (record.n_legal, record.n_members) == (legal.sum(), len(X))
    assert (record.n_eval, record.n_gen) == (result.algorithm.evaluator.n_eval, result.algorithm.n_iter - 1)
    assert (record.objectives, record.complete) == (built.objective_names, True)
    assert record.X.dtype == X.dtype or not len(record.X)

    history = record.history
    assert history is not None
    assert history.evaluations.tolist() == recorder.evaluations
    assert history.n_legal.tolist() == recorder.n_feasible
    assert history.n_members[-1] == len(X)
    if "length" in built.objective_names:
        np.testing.assert_array_equal(history.best_length, recorder.best_length)
    else:
        assert np.isnan(history.best_length).all()
    for k, front in enumerate(recorder.fronts):
        assert history.front(k).tolist() == front.tolist(), k
    assert (np.diff(history.seconds) > 0).all() and history.seconds[-1] <= record.seconds


@pytest.mark.parametrize("generations", [1, 100, 101, 200, 333])
def test_long_histories_are_thinned_evenly(generations):
    task = one_task(dense(), {"algorithm": "NSGA2", "pop_size": 8}, {"generations": generations})
    problem = build_problem(task.problem)
    recorder, every = Recorder(problem.objective_names), ConvergenceRecorder()
    algorithm = build_algorithm(task.algorithm, problem)
    algorithm.setup(problem, seed=1, termination=("n_gen", generations), callback=CallbackCollection(recorder, every))
    while algorithm.has_next():
        algorithm.next()
    recorder.finish(algorithm)
    history = recorder.history()
    chosen = [every.evaluations.index(number) for number in history.evaluations]
    assert chosen[0] == 0 and chosen[-1] == generations - 1
    assert min(generations, MAX_RECORDS // 2) <= len(chosen) <= MAX_RECORDS
    steps = np.diff(chosen)
    assert len(set(steps[:-1].tolist())) <= 1, "evenly spaced but for the last"
    for k, index in enumerate(chosen):
        assert history.front(k).tolist() == every.fronts[index].tolist()
        assert history.n_legal[k] == every.n_feasible[index]
    alone = from_bytes(execute(task)).history
    assert alone is not None
    for name in HISTORY:
        assert getattr(alone, name).tobytes() == getattr(history, name).tobytes(), name


# Those that suit grids and need nothing beside the problem.
PLAIN = [name for name, row in CAPABILITIES.items() if not row.unfit and row.needs in (None, "", "ref_dirs")]


@pytest.mark.parametrize("name", PLAIN)
def test_every_algorithm_leaves_a_record(name):
    row = CAPABILITIES[name]
    objectives = ["length"] if row.max_objectives == 1 else ["length", "vulnerability"]
    task = one_task(dense(objectives=objectives), {"algorithm": name, "pop_size": 12}, {"generations": 3})
    a, b = (from_bytes(execute(task)) for _ in range(2))
    assert a.status == "finished", a.message
    assert a.n_gen >= 1 and a.n_legal <= a.n_members
    assert a.history is not None and a.history.front(-1).tolist() == a.F.tolist()
    assert a.F.tobytes() == b.F.tobytes() and a.X.tobytes() == b.X.tobytes()


def test_an_incomplete_exact_front_says_so():
    task = one_task({"map": "office"}, {"algorithm": "exact", "max_labels": 50}, {"generations": 1})
    record = from_bytes(execute(task))
    assert (record.status, record.complete) == ("finished", False)
    assert "labels" in record.message
    assert record.F.shape[1] == 2 and record.history is not None


def test_a_run_that_raises_is_recorded_with_its_traceback(plan):
    broken = without_grids(plan)
    task = next(broken.task(run) for run in broken.runs if broken.problems[run.problem].group == "field")
    # The problem was built before in this process, and is kept.
    task = task._replace(problem={**task.problem, "goal": [14, 15]})
    record = from_bytes(execute(task))
    assert (record.status, record.complete, record.history, record.n_eval) == ("failed", False, None, 0)
    assert record.message.startswith("Traceback (most recent call last):")
    assert record.message.strip().endswith("the cells of the map are missing, expected those that were planned with")
    assert (record.X.shape, record.F.shape) == ((0, 0), (0, 2))
    assert (record.key, record.problem) == (task.key, task.problem)


@pytest.mark.parametrize("at", ["_search", "build_termination"])
def test_ctrl_c_in_compiled_code_is_no_failure_of_the_run(plan, monkeypatch, at):
    """A signal there comes as a SystemError, "returned a result with an exception set", caused by KeyboardInterrupt."""

    def interrupted(*args):
        raise SystemError("a kernel returned a result with an exception set") from KeyboardInterrupt()

    monkeypatch.setattr("pymoo_gridpath.study.running.execute._warm", set())
    monkeypatch.setattr(f"pymoo_gridpath.study.running.execute.{at}", interrupted)
    task = next(task for task in map(plan.task, plan.runs) if task.budget is not None)
    with pytest.raises(KeyboardInterrupt):
        execute(task)


def test_a_run_that_finds_nothing_legal_is_finished():
    task = one_task(
        dense(random={"size": 40, "p0": 0.6, "seeds": 1}), {"algorithm": "NSGA2", "pop_size": 4}, {"generations": 1}
    )
    record = from_bytes(execute(task))
    assert (record.status, record.n_legal, record.F.shape) == ("finished", 0, (0, 2))
    assert record.history is not None
    assert record.history.best_length.tolist() == [np.inf] and record.history.front(0).shape == (0, 2)


def test_the_record_names_versions_machine_and_time(plan):
    record = from_bytes(execute(plan.task(plan.runs[-1])))
    assert set(record.versions) == {"python", "pymoo_gridpath", "pymoo", "numpy", "scipy", "moocore", "numba"}
    assert record.versions["numpy"] == np.__version__
    assert record.machine["cores"] >= 1 and record.machine["processor"]
    assert record.started.endswith("+00:00") and "T" in record.started


def test_other_seeds_find_other_things():
    tasks = [one_task(dense(), {"algorithm": "NSGA2", "pop_size": 30}, {"generations": 3}, seed) for seed in (1, 2)]
    histories = [from_bytes(execute(task)).history for task in tasks]
    assert histories[0].points.tobytes() != histories[1].points.tobytes()  # pyright: ignore


def test_the_order_of_runs_does_not_matter(plan):
    tasks = [plan.task(run) for run in plan.runs[3:9]]
    forward = [from_bytes(execute(task)) for task in tasks]
    backward = [from_bytes(execute(task)) for task in reversed(tasks)][::-1]
    for a, b in zip(forward, backward, strict=True):
        assert (a.X.tobytes(), a.F.tobytes()) == (b.X.tobytes(), b.F.tobytes())
