"""Measure what more processes save: exact fronts of many problems, and runs of NSGA-II, here and on a pool.

Each is carried out in this process, on a pool that is started for it, and on one that has worked before, in turns. Rows show
the medians of wall time and their ratios to that of this process; 1 over the number of processes is the least that there can
be on an idle machine, and the load average, before and after, says how idle this one was. The last column is the processor
time of a new pool and of this process with it, over that of this process alone: what is lost in starting and sending, whatever
else the machine does. What is found has to be the same to the bit.

    python benchmarks/scaling.py --processes 2

takes about a minute on an idle machine.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import resource
import time
from collections.abc import Callable
from concurrent.futures import Executor, ProcessPoolExecutor

# One thread for each process: those of the linear algebra would take what others are to have.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import make_algorithm, minimize_runs
from pymoo_gridpath.exact import exact_fronts
from pymoo_gridpath.objectives import Vulnerability

# The paper's.
OBJECTIVES = ["length", Vulnerability(variance=0.5)]


def problem_of(side: int, seed: int) -> GridPathProblem:
    """Return a query from corner to corner of random cells, a fifth of them occupied."""
    occupied = np.random.default_rng(seed).random((side, side)) < 0.2
    # The bottom row and the right column lead to the goal.
    occupied[0] = occupied[:, -1] = False
    return GridPathProblem(OccupancyGrid(occupied), (0, 0), (side - 1, side - 1), "cells", OBJECTIVES)


def workloads() -> dict[str, Callable[[Executor | None], list]]:
    """Return what is timed, by name: functions of an executor, or of None for this process."""
    problems = [problem_of(256, seed) for seed in range(12)]
    small = problem_of(64, 1)
    algorithm = make_algorithm("NSGA2", small, pop_size=100)
    return {
        f"exact fronts of {len(problems)} problems, 256 x 256": lambda executor: exact_fronts(problems, executor=executor),
        "8 runs of NSGA-II, 64 x 64, 10,000 evaluations": lambda executor: minimize_runs(
            small, algorithm, ("n_eval", 10_000), 8, executor=executor
        ),
    }


def processor_seconds() -> float:
    """Return the processor time of this process and of those that it has started and that have ended."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def values(results: list) -> list[bytes]:
    """Return the bits of fronts and their paths."""
    return [np.ascontiguousarray(array).tobytes() for result in results for array in (result.X, result.F)]


def main() -> None:
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("--processes", type=int, default=os.cpu_count(), help="of the pool (default: the machine's processors)")
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--start-method", choices=multiprocessing.get_all_start_methods(), help="how processes are started")
    arguments = parser.parse_args()
    context = multiprocessing.get_context(arguments.start_method)

    def pool() -> ProcessPoolExecutor:
        return ProcessPoolExecutor(arguments.processes, mp_context=context)

    print(f"{arguments.processes} processes, {context.get_start_method()}, on {os.cpu_count()} processors")
    print("load averages before:", *(f"{load:.2f}" for load in os.getloadavg()))
    print(f"{'seconds of wall time':50}{'here':>8}{'new pool':>10}{'ratio':>7}{'kept pool':>11}{'ratio':>7}{'processor':>11}")
    with pool() as kept:
        for name, work in workloads().items():
            # Compiles here and there.
            expected = values(work(None))
            work(kept)
            seconds, used = [], []
            for _ in range(arguments.turns):
                clock, spent = [time.perf_counter()], [processor_seconds()]
                found = [work(None)]
                clock.append(time.perf_counter())
                spent.append(processor_seconds())
                with pool() as new:
                    found.append(work(new))
                clock.append(time.perf_counter())
                spent.append(processor_seconds())
                found.append(work(kept))
                clock.append(time.perf_counter())
                seconds.append(np.diff(clock))
                used.append(np.diff(spent))
                assert all(values(one) == expected for one in found), f"{name}: other results"
            alone, fresh, ready = np.median(seconds, axis=0)
            lost = float(np.median([after / before for before, after in used]))
            print(
                f"{name:50}{alone:>8.2f}{fresh:>10.2f}{fresh / alone:>7.2f}{ready:>11.2f}{ready / alone:>7.2f}{lost:>11.2f}",
                flush=True,
            )
    print("load averages after:", *(f"{load:.2f}" for load in os.getloadavg()))


if __name__ == "__main__":
    # Processes that are started anew read this file again.
    main()
