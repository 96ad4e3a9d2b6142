"""What a search hands over on the way: better and better fronts, with true certificates, kept whenever it ends."""

from __future__ import annotations

import copy
import pickle
import signal

import numpy as np
import pytest
from exact_fronts import Cost, holds, random_grid, whole_costs
from pymoo.optimize import minimize
from pymoo.termination.collection import TerminationCollection
from pymoo.termination.max_gen import MaximumGenerationTermination
from pymoo.termination.max_time import TimeBasedTermination

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import ExactFront, minimize_runs
from pymoo_gridpath.exact import budget, exact_front, steps
from pymoo_gridpath.exact.front import better_fronts
from pymoo_gridpath.exact.nearness import WHOLE
from pymoo_gridpath.exact.steps import handed_over
from pymoo_gridpath.exact.three import _Search as Three
from pymoo_gridpath.exact.two import _Search as Two
from pymoo_gridpath.representations import CellSequence

THREE = ("length", "vulnerability", "turn")


@pytest.fixture
def often(monkeypatch):
    """Have searches hand over whenever they can, and often."""
    monkeypatch.setattr(steps, "_TIMES", 0)
    monkeypatch.setattr(steps, "_GROWTH", 0.0)
    for search in (Two, Three):
        monkeypatch.setattr(search, "pops_at_a_time", 40)


def whole_problem(seed, side=16, **more):
    costs = [Cost(*one) for one in whole_costs((side, side), seed).items()]
    return GridPathProblem(random_grid(side, seed), (0, 0), (side - 1, side - 1), "cells", costs, **more)


@pytest.mark.parametrize("seed", range(5))
def test_what_is_handed_over_is_certified_truly_and_better_and_better(seed, often):
    problem = whole_problem(seed)
    whole = exact_front(problem)
    n_steps = []
    for asked in ({}, {"epsilon": 0.01}, {"share": 0.05}):
        *way, (end, final) = handed_over(better_fronts(problem, **asked))
        assert final and not any(last for _, last in way)
        again = exact_front(problem, **asked)
        np.testing.assert_array_equal(end.X, again.X)
        np.testing.assert_array_equal(end.F, again.F)
        assert (end.certified, end.message) == (again.certified, again.message)
        before = None
        for found in [one for one, _ in way] + [end]:
            assert found.certified is not None and holds(found.certified, found.F, whole.F), asked
            np.testing.assert_array_equal(problem.evaluate(found.X), found.F)
            assert found.success is (found is end) and found.message.startswith(("all", str(len(found.F))))
            if before is not None and not asked:
                assert found.certified.epsilon <= before.epsilon and found.certified.share <= before.share
            before = found.certified
        n_steps.append(len(way))
    assert n_steps[0] > 3 and len(whole.F) > 3


def test_what_does_not_fit_or_may_be_hidden_has_no_certificate(often):
    costs = [Cost(*one) for one in whole_costs((24, 24), 2).items()]
    grid = OccupancyGrid(np.zeros((24, 24)))
    short = GridPathProblem(grid, (0, 0), (23, 23), CellSequence(grid, (0, 0), (23, 23), max_cells=27), costs)
    way = [found for found, _ in handed_over(better_fronts(short))]
    assert len(way) > 3 and way[-1].complete
    assert all(found.certified is None for found in way[2:-1]) and all(found.X.shape[1] == short.n_var for found in way)
    limited = GridPathProblem(random_grid(14, 1), (0, 0), (13, 13), "cells", obstacles="limit", potential_limit=9.0)
    way = [found for found, _ in handed_over(better_fronts(limited))]
    assert len(way) > 2 and way[-1].certified == WHOLE
    for found in way[:-1]:
        assert found.certified is None and (limited.evaluate(found.X, return_values_of=["G"]) <= 0).all()


def test_of_three_objectives_it_is_a_part_of_the_front(often):
    problem = GridPathProblem(random_grid(12, 3, 0.1), (0, 0), (11, 11), "cells", THREE)
    way = [found for found, _ in handed_over(better_fronts(problem))]
    points = {tuple(point) for point in way[-1].F}
    assert [len(found.F) for found in way] == sorted(len(found.F) for found in way) and len(way) > 3
    assert all({tuple(point) for point in found.F} <= points and found.certified is None for found in way[:-1])


def test_small_searches_hand_over_the_front_alone():
    for objectives in (("length",), ("length", "vulnerability"), THREE):
        problem = GridPathProblem(random_grid(12, 3, 0.1), (0, 0), (11, 11), "cells", objectives)
        assert len(list(handed_over(better_fronts(problem)))) == 1


def raising(error, after):
    """Return a callback that keeps what it sees and raises, or calls, something in an iteration."""
    seen = []

    def callback(algorithm):
        seen.append((algorithm.found, algorithm.opt.get("F").copy()))
        if len(seen) == after:
            if isinstance(error, type):
                raise error
            error(algorithm)

    return seen, callback


def test_a_keyboard_interrupt_in_a_callback_leaves_the_front_so_far(often):
    problem = whole_problem(1)
    whole = minimize(problem, ExactFront())
    for after in (1, 3):
        seen, callback = raising(KeyboardInterrupt, after)
        result = minimize(problem, ExactFront(), callback=callback)
        found, F = seen[-1]
        assert len(seen) == after and np.array_equal(F, found.F) and np.array_equal(result.F, F)
        assert result.success is False and result.certified == found.certified and holds(result.certified, F, whole.F)
        assert result.message == f"ended early, stopped by Ctrl-C; {len(F)} paths found, {result.certified}"
        assert result.algorithm.evaluator.n_eval == sum(len(F) for _, F in seen)
        assert not result.algorithm.has_next() and result.algorithm.found.message == result.message
    # Other errors are not caught, nor is Ctrl-C where someone goes on step by step, as studies do.
    with pytest.raises(ZeroDivisionError):
        minimize(problem, ExactFront(), callback=raising(ZeroDivisionError, 1)[1])
    algorithm = ExactFront().setup(problem, callback=raising(KeyboardInterrupt, 2)[1])
    algorithm.next()
    with pytest.raises(KeyboardInterrupt):
        algorithm.next()


def test_ctrl_c_before_anything_is_found_leaves_nothing(monkeypatch):
    def interrupted(*given):
        raise KeyboardInterrupt

    monkeypatch.setattr("pymoo_gridpath.exact.front.parts_of", interrupted)
    result = minimize(whole_problem(1), ExactFront())
    assert (result.X, result.success, result.certified) == (None, False, None)
    assert result.message == "ended early, stopped by Ctrl-C; 0 paths found" and len(result.pop) == 0


@pytest.fixture
def heard():
    """Python hears Ctrl-C, though it does not where a shell has started the tests in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield signal.default_int_handler
    signal.signal(signal.SIGINT, before)


def test_ctrl_c_ends_a_search_with_all_that_it_has_found(often, heard, capsys):
    problem = whole_problem(1)
    whole = minimize(problem, ExactFront())
    before = heard
    seen, callback = raising(lambda algorithm: signal.raise_signal(signal.SIGINT), 2)
    result = minimize(problem, ExactFront(), callback=callback)
    assert "keeping what was found" in capsys.readouterr().err and signal.getsignal(signal.SIGINT) is before
    assert result.success is False and result.message.startswith("ended early, stopped by Ctrl-C; ") and len(seen) == 3
    assert result.certified.epsilon <= seen[1][0].certified.epsilon and holds(result.certified, result.F, whole.F)
    # Who insists is heard.
    with pytest.raises(KeyboardInterrupt):
        minimize(problem, ExactFront(), callback=lambda algorithm: signal.raise_signal(signal.SIGINT))
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.parametrize("given", ["budget", "termination", "one of several"])
def test_a_time_leaves_the_front_so_far(given, often, monkeypatch):
    problem, now = whole_problem(1), [0.0]
    whole = exact_front(problem)
    monkeypatch.setattr(budget, "working_seconds", lambda: now[0])
    seen, callback = raising(lambda algorithm: now.__setitem__(0, 100.0), 3)
    both = TerminationCollection(MaximumGenerationTermination(1), TimeBasedTermination(60))
    termination = {"budget": None, "termination": ("time", 60), "one of several": both}[given]
    algorithm = ExactFront(max_seconds=60 if given == "budget" else None)
    result = minimize(problem, algorithm, termination, callback=callback)
    assert result.success is False and len(seen) == 4 and holds(result.certified, result.F, whole.F)
    assert result.message.startswith("ended early, the time budget of 60 s is used up; ")
    assert result.certified.epsilon <= seen[2][0].certified.epsilon and len(result.F) >= len(seen[2][1])


def test_numbers_of_generations_do_not_end_it_and_a_termination_that_is_told_to_does(often):
    problem = whole_problem(2)
    whole = minimize(problem, ExactFront(), ("n_gen", 1))
    assert whole.success is True and whole.algorithm.n_gen > 3
    seen, callback = raising(lambda algorithm: algorithm.termination.terminate(), 2)
    result = minimize(problem, ExactFront(), callback=callback)
    assert len(seen) == 3 and result.message.startswith("ended early, stopped by its termination; ")
    assert holds(result.certified, result.F, whole.F)
    (observed,) = minimize_runs(problem, ExactFront(), n_runs=1, observe=lambda run, algorithm: algorithm.n_gen > 2)
    assert observed.success is False and holds(observed.certified, observed.F, whole.F)


def test_copies_begin_anew_and_what_has_run_pickles(often):
    problem = whole_problem(3)
    whole = minimize(problem, ExactFront(), save_history=True)
    fronts = [one.found for one in whole.history]
    assert len(fronts) > 3 and fronts[-1].complete and not fronts[0].complete
    assert len(pickle.loads(pickle.dumps(whole)).history) == len(fronts)
    algorithm = ExactFront().setup(problem)
    for _ in range(2):
        algorithm.next()
    for one in (copy.deepcopy(algorithm), pickle.loads(pickle.dumps(algorithm)), algorithm):
        np.testing.assert_array_equal(one.opt.get("F"), fronts[1].F)
        while one.has_next():
            one.next()
        np.testing.assert_array_equal(one.opt.get("X"), whole.X)
        assert one.result().certified == WHOLE


def test_each_front_is_a_line(often, capsys):
    problem = whole_problem(1)
    seen = []
    minimize(problem, ExactFront(), verbose=True, callback=lambda algorithm: seen.append(algorithm.found))
    lines = [[cell.strip() for cell in line.split("|")] for line in capsys.readouterr().out.splitlines() if "|" in line]
    assert lines[0] == ["n_gen", "n_eval", "points", "certified", "labels", "seconds"] and len(lines) == len(seen) + 1
    for line, found in zip(lines[1:], seen, strict=True):
        assert line[2:] == [str(len(found.F)), found.certified.short, f"{found.n_labels:,}", f"{found.seconds:.2f}"]
    assert lines[-1][3] == "0 %" and lines[1][3].endswith(("%", "of range"))
