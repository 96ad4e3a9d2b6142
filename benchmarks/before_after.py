"""Compare the speed of two versions of the package: generations, evaluation and exact fronts, alternating in one run.

Give it two folders that hold a version each, such as two git worktrees:

    python benchmarks/before_after.py ../before . --rounds 5

Each round starts a fresh process for either version. They take turns, a few dozen milliseconds each, so that whatever else the
machine does hits both alike. Times are those of the processor. Kernels have been compiled before.
"""

from __future__ import annotations

import argparse
import copy
import json
import os
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

SIDES = ("before", "after")

# Seconds of the processor that a turn takes at least.
_TURN = 0.03

# Generations that are timed together: the first ones are alike in both versions, since results are.
_GENERATIONS = 3


def workloads() -> Iterator[tuple[str, Callable[[], Callable[[], object]]]]:
    """Yield what is timed: its name, and a function that makes it ready and returns what to time, once each."""
    # The version that the environment names.
    from pymoo_gridpath import GridPathProblem
    from pymoo_gridpath.algorithms import make_algorithm
    from pymoo_gridpath.exact import exact_front
    from pymoo_gridpath.objectives import Vulnerability
    from pymoo_gridpath.operators import path_operators
    from pymoo_gridpath.problems import random_dense_grid

    # The paper's.
    objectives = "length", Vulnerability(0.5), "turn"

    def problem_of(size: int, coding: str, n_obj: int):
        grid = random_dense_grid(size, 0.1, 1)
        return GridPathProblem(grid, (0, 0), (size - 1, size - 1), coding, objectives=objectives[:n_obj])

    def generations(coding: str):
        problem = problem_of(32, coding, 2)
        algorithm = make_algorithm("NSGA2", problem, pop_size=200)
        algorithm.setup(problem, termination=("n_gen", 1000), seed=1)
        algorithm.next()

        def ready():
            mine = copy.deepcopy(algorithm)
            return lambda: [mine.next() for _ in range(_GENERATIONS)]

        return ready

    def evaluation(coding: str, n_obj: int, n_rows: int):
        problem = problem_of(32, coding, n_obj)
        rows = path_operators(problem)["sampling"](problem, n_rows, random_state=np.random.default_rng(1)).get("X")
        return lambda: lambda: problem.evaluate(rows)

    def front(size: int, n_obj: int, coding: str):
        problem = problem_of(size, coding, n_obj)
        return lambda: lambda: exact_front(problem)

    for coding in ("integer", "cells"):
        yield f"generation {coding}", generations(coding)
        for n_obj in (2, 3):
            for n_rows in (100, 1000):
                yield f"evaluation {coding} {n_obj} objectives {n_rows} rows", evaluation(coding, n_obj, n_rows)
        for size, n_obj in ((8, 2), (16, 2), (64, 2), (24, 3)):
            yield f"exact {coding} {size} x {size} {n_obj} objectives", front(size, n_obj, coding)


def serve() -> None:
    """Take turns in the version that the environment names: a number of a workload comes in, the times of a turn go out."""
    warnings.simplefilter("ignore")
    import pymoo_gridpath

    known = dict(workloads())
    for ready in known.values():
        ready()()
    print(json.dumps([str(Path(pymoo_gridpath.__file__).parent.parent), *known]), flush=True)
    for line in sys.stdin:
        ready = list(known.values())[int(line)]
        times: list[float] = []
        while len(times) < 2 or sum(times) < _TURN:
            run = ready()
            begin = time.process_time()
            run()
            times.append(time.process_time() - begin)
        print(json.dumps(times), flush=True)


class Version:
    """A fresh process of one version."""

    def __init__(self, folder: Path):
        environment = os.environ | {"PYTHONPATH": str(folder.resolve())}
        command = [sys.executable, __file__, "--serve"]
        self.process = subprocess.Popen(command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        where, *self.names = self._answer()
        assert Path(where) == folder.resolve(), f"{folder} holds no version of the package: it comes from {where}"

    def _answer(self):
        assert self.process.stdout is not None
        return json.loads(self.process.stdout.readline())

    def turn(self, number: int) -> list[float]:
        """Return the times of a turn, in seconds."""
        assert self.process.stdin is not None
        print(number, file=self.process.stdin, flush=True)
        return self._answer()

    def end(self) -> None:
        self.process.communicate()


def main() -> None:
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("before", type=Path, nargs="?", help="a folder with the package in it")
    parser.add_argument("after", type=Path, nargs="?", help="another one")
    parser.add_argument("--rounds", type=int, default=4, help="how many fresh processes of each version")
    parser.add_argument("--turns", type=int, default=6, help="how many turns each has at each workload")
    parser.add_argument("--only", default="", help="workloads with this in their name alone")
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.serve:
        return serve()
    if arguments.after is None:
        parser.error("two folders are needed")

    times: dict[str, dict[str, list[float]]] = {}
    for number in range(arguments.rounds):
        versions = {side: Version(getattr(arguments, side)) for side in SIDES}
        for k, name in enumerate(versions["after"].names):
            if arguments.only not in name:
                continue
            mine = times.setdefault(name, {side: [] for side in SIDES})
            for turn in range(arguments.turns):
                # Who comes second may find warm caches, or a slow clock.
                for side in SIDES if (number + turn) % 2 == 0 else reversed(SIDES):
                    mine[side] += versions[side].turn(k)
        for version in versions.values():
            version.end()

    print(f"{'milliseconds of processor time':45}{'before':>9}{'after':>9}{'median':>9}{'least':>8}")
    for name, sides in times.items():
        before, after = (np.array(sides[side]) for side in SIDES)
        middle = np.median(before), np.median(after)
        least = before.min(), after.min()
        print(
            f"{name:45}{1e3 * middle[0]:>9.3f}{1e3 * middle[1]:>9.3f}{middle[1] / middle[0]:>9.3f}{least[1] / least[0]:>8.3f}"
        )


if __name__ == "__main__":
    main()
