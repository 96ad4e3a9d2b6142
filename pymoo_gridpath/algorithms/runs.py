"""Several runs of one algorithm from different initial populations."""

from __future__ import annotations

import copy
import functools
from collections.abc import Callable
from concurrent.futures import Executor

from pymoo.core.algorithm import Algorithm
from pymoo.core.callback import Callback
from pymoo.core.problem import Problem
from pymoo.core.result import Result
from pymoo.core.termination import Termination
from pymoo.termination import get_termination

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.parallel import carried_out, check_executor
from pymoo_gridpath.problems import GridPathProblem

_MOST_RUNS = 100_000


def minimize_runs(
    problem,
    algorithm: Algorithm,
    termination: Termination | tuple | None = None,
    n_runs: int = 10,
    seed: int = 1,
    callback: Callback | None = None,
    observe: Callable[[int, Algorithm], bool | None] | None = None,
    executor: Executor | None = None,
) -> list[Result]:
    """Run an algorithm several times and return all Results, for `TradeOffSet.from_results` to merge into one front.

    Run k is ``pymoo.optimize.minimize(problem, algorithm, termination, seed=seed + k)``, bit for bit; where obstacles move,
    each begins with the first epoch.

    Parameters
    ----------
    problem : GridPathProblem
    algorithm : pymoo.core.algorithm.Algorithm
        Not changed: every run has a copy.
    termination : pymoo termination, optional
        As for `pymoo.optimize.minimize`.
    n_runs : int, default 10
        The paper's number.
    seed : int, default 1
        Seed of the first run.
    callback : pymoo.core.callback.Callback, optional
        Every run has a copy of its own, at ``result.algorithm.callback``.
    observe : callable, optional
        Called as ``observe(k, algorithm)`` after every generation of run k. If it returns True, the runs end there, and
        what was found is returned. Not with an executor, whose runs are elsewhere.
    executor : concurrent.futures.Executor, optional
        What carries the runs out, each on a copy of the problem, such as a ``ProcessPoolExecutor``; this process by default. It
        is left open. Other processes need an algorithm, problem and callback that can be pickled; `CAPABILITIES` says which
        of pymoo's algorithms can. Results are the same, and of the given problem.

    Returns
    -------
    list of pymoo.core.result.Result
        One of each run, fewer if ``observe`` ended them.

    Raises
    ------
    GridPathError
        If an argument is of another kind or out of its range; ``n_runs`` is 1 to 100,000. If the executor has broken down, or a
        run cannot be sent to another process.

    References
    ----------
    Ahmed and Deb (2013), section 5: ten runs, whose fronts are merged.
    """
    checks.instance("problem", problem, Problem)
    checks.instance("algorithm", algorithm, Algorithm)
    _check_termination(termination)
    n_runs = checks.whole("n_runs", n_runs, 1, _MOST_RUNS)
    seed = checks.whole("seed", seed, 0)
    checks.instance("callback", callback, Callback, optional=True)
    checks.function("observe", observe, "a function of the number of the run and the algorithm", 2, optional=True)
    check_executor(executor)
    if executor is not None:
        if observe is not None:
            raise GridPathError("observe is called after every generation in this process, expected none with an executor")
        tasks = [(problem, algorithm, termination, seed + k, callback) for k in range(n_runs)]
        results = list(carried_out(executor, "run", _run_elsewhere, tasks))
        for result in results:
            result.problem = result.algorithm.problem = problem
        return results
    results = []
    for k in range(n_runs):
        result, stopped = _run(problem, algorithm, termination, seed + k, callback, observe and functools.partial(observe, k))
        results.append(result)
        if stopped:
            break
    return results


def _run(problem, algorithm, termination, seed, callback, observe=None) -> tuple[Result, bool]:
    """Return the result of one run, and whether it was stopped."""
    run = copy.deepcopy(algorithm)
    if isinstance(problem, GridPathProblem):
        problem.restart()
    options: dict = {} if callback is None else {"callback": copy.deepcopy(callback)}
    if termination is not None:
        options["termination"] = copy.deepcopy(termination)
    run.setup(problem, seed=seed, **options)
    stopped = False
    while run.has_next() and not stopped:
        run.next()
        stopped = bool(observe and observe(run))
    result = run.result()
    result.algorithm = run
    return result, stopped


def _run_elsewhere(problem, algorithm, termination, seed, callback) -> Result:
    """Return the result of one run on a copy of the problem, since threads share it and obstacles may move."""
    result, _ = _run(copy.deepcopy(problem), algorithm, termination, seed, callback)
    # Whoever asked for it has the problem.
    result.problem = result.algorithm.problem = None  # pyright: ignore
    return result


def _check_termination(termination) -> None:
    """Refuse what pymoo cannot make a termination of."""
    if termination is None or isinstance(termination, Termination):
        return
    expected = "a pymoo termination or a tuple such as ('n_gen', 100)"
    if not isinstance(termination, tuple) or not termination:
        raise GridPathError(f"termination is {checks.shown(termination)}, expected {expected}")
    name, *arguments = termination
    if not isinstance(name, str):
        raise GridPathError(f"termination is {checks.shown(termination)}, expected {expected}")
    if name.startswith("n_"):
        if len(arguments) != 1:
            raise GridPathError(f"termination is {checks.shown(termination)}, expected {expected}")
        checks.number(
            f"the number of the termination {checks.shown(name)}", arguments[0], 0.0, infinite=True, expected="zero or more"
        )
    try:
        get_termination(name, *arguments)
    except Exception:  # pymoo raises bare ones
        raise GridPathError(f"termination is {checks.shown(termination)}, expected {expected}") from None
