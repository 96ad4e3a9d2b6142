"""Compare the speed of two versions of the package: generations, evaluation and exact fronts, alternating in one run.

Give it two folders that hold a version each, such as two git worktrees:

    python benchmarks/before_after.py ../before . --rounds 5

Each round starts a fresh process for either version. They take turns, a few dozen milliseconds each, so that whatever else the
machine does hits both alike. Times are those of the processor. Kernels have been compiled before. With a folder of MovingAI's
maps, ``--maps``, problems and exact fronts of large maps are compared instead, of these and of random ones: what was found has
to be equal, and ``--rounds 1 --turns 5`` takes half an hour.
"""

from __future__ import annotations

import argparse
import copy
import hashlib
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
    from pymoo.optimize import minimize

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

    def run(n_var: int):
        problem = problem_of(n_var + 1, "integer", 2)
        algorithm = make_algorithm("NSGA2", problem, pop_size=500)
        return lambda: lambda: minimize(problem, algorithm, ("n_gen", 100), seed=1)

    def evaluation(coding: str, n_obj: int, n_rows: int):
        problem = problem_of(32, coding, n_obj)
        rows = path_operators(problem)["sampling"](problem, n_rows, random_state=np.random.default_rng(1)).get("X")
        return lambda: lambda: problem.evaluate(rows)

    def front(size: int, n_obj: int, coding: str):
        problem = problem_of(size, coding, n_obj)
        return lambda: lambda: exact_front(problem)

    for n_var in (31, 127):
        yield f"NSGA-II, population 500, {n_var} genes, 100 generations", run(n_var)
    for coding in ("integer", "cells"):
        yield f"generation {coding}", generations(coding)
        for n_obj in (2, 3):
            for n_rows in (100, 1000):
                yield f"evaluation {coding} {n_obj} objectives {n_rows} rows", evaluation(coding, n_obj, n_rows)
        for size, n_obj in ((8, 2), (16, 2), (64, 2), (24, 3)):
            yield f"exact {coding} {size} x {size} {n_obj} objectives", front(size, n_obj, coding)


def map_workloads(folder: Path) -> Iterator[tuple[str, Callable[[], Callable[[], object]]]]:
    """Yield the same for large maps. The paper's objectives are named: another default is no other front."""
    from pymoo_gridpath import GridPathProblem, OccupancyGrid
    from pymoo_gridpath.exact import exact_front
    from pymoo_gridpath.maps import load_map, read_scen
    from pymoo_gridpath.objectives import Turn, Vulnerability

    paper = ["length", Vulnerability(variance=0.5)]

    def problem(grid, ends, objectives):
        start, goal = ends
        return GridPathProblem(grid, start, goal, "cells", objectives)

    def fronts(grid, queries, objectives):
        def ready():
            problems = [problem(grid, ends, objectives) for ends in queries]
            return lambda: [exact_front(one) for one in problems]

        return ready

    def whole(grid, queries, objectives):
        return lambda: lambda: [exact_front(problem(grid, ends, objectives)) for ends in queries]

    def making(side):
        occupied = np.random.default_rng(1).random((side, side)) < 0.2
        occupied[0] = occupied[:, -1] = False
        ends = (0, 0), (side - 1, side - 1)
        return lambda: (lambda grid: lambda: problem(grid, ends, paper))(OccupancyGrid(occupied))

    maps = {path.stem: load_map(path) for path in sorted(folder.glob("*.map"))}
    queries = {
        name: [(query.start, query.goal) for query in read_scen(folder / f"{name}.map.scen") if query.start != query.goal]
        for name in maps
    }
    lak, wide = "lak304d", "random512-10-0"
    some = queries[lak][:: len(queries[lak]) // 50][:50]
    yield "one objective, problem and front, lak304d", whole(maps[lak], some, paper[:1])
    for side in (512, 1024, 2048):
        yield f"problem in cells, {side} x {side}", making(side)
    half = {name: some[len(some) // 2] for name, some in queries.items()}
    longest = {name: some[-1] for name, some in queries.items()}
    for name in maps:
        some = queries[lak][::10] if name == lak else [half[name]] if name == wide else [longest[name]]
        yield f"exact, {name}", fronts(maps[name], some, paper)
    for name, occupied in drawn_maps().items():
        grid = OccupancyGrid(occupied)
        yield f"exact, {name}", fronts(grid, [part_way(grid, 0.1 if name == "maze of 8" else 0.5)], paper)
    yield f"exact, {wide}, longest", fronts(maps[wide], [longest[wide]], paper)
    for name in (lak, "random-64-64-20"):
        yield f"exact, three objectives, {name}", fronts(maps[name], [half[name]], [*paper, Turn()])


def drawn_maps(side: int = 512, seed: int = 7) -> dict[str, np.ndarray]:
    """Return maps of random cells, of rooms, and of mazes of narrow and of wide corridors, from a seed."""
    draw = np.random.default_rng(seed)
    rooms = np.zeros((side, side), dtype=bool)
    rooms[32::33] = rooms[:, 32::33] = True
    for y in range(0, side, 33):
        for x in range(0, side, 33):
            # A door to the right, and one up.
            along = int(draw.integers(1, 31))
            rooms[min(y + along, side - 1), x + 32 : x + 33] = False
            rooms[y + 32 : y + 33, min(x + along, side - 1)] = False
    found = {"random 40 %": draw.random((side, side)) < 0.4, "rooms of 32": rooms}
    for corridor in (1, 8):
        found[f"maze of {corridor}"] = maze(side // (corridor + 1), corridor, draw)
    return found


def maze(n: int, corridor: int, draw: np.random.Generator) -> np.ndarray:
    """Return a maze of n x n crossings, without loops, by a walk that turns back where it can go no further."""
    pitch = corridor + 1
    occupied = np.ones((n * pitch + 1, n * pitch + 1), dtype=bool)
    seen, stack = np.zeros((n, n), dtype=bool), [(0, 0)]
    seen[0, 0] = True
    occupied[1:pitch, 1:pitch] = False
    while stack:
        y, x = stack[-1]
        ways = [(y + dy, x + dx) for dy, dx in ((0, 1), (1, 0), (0, -1), (-1, 0))]
        ways = [(v, u) for v, u in ways if 0 <= v < n and 0 <= u < n and not seen[v, u]]
        if not ways:
            stack.pop()
            continue
        v, u = ways[int(draw.integers(len(ways)))]
        seen[v, u] = True
        occupied[min(y, v) * pitch + 1 : max(y, v) * pitch + pitch, min(x, u) * pitch + 1 : max(x, u) * pitch + pitch] = False
        stack.append((v, u))
    return occupied


def part_way(grid, share):
    """Return a cell at a corner of the largest region, and one that is a share as far from it as the farthest."""
    regions = grid.regions
    y, x = np.nonzero(regions == np.bincount(regions[regions > 0]).argmax())
    k = np.argmin(x + y)
    start = int(x[k]), int(y[k])
    length = grid.shortest_lengths(start)[y, x]
    k = np.argmin(np.abs(length - share * length.max()))
    return start, (int(x[k]), int(y[k]))


def serve(maps: Path | None) -> None:
    """Take turns in the version that the environment names: a number of a workload comes in, the times of a turn go out."""
    warnings.simplefilter("ignore")
    import pymoo_gridpath

    known = dict(workloads() if maps is None else map_workloads(maps))
    for ready in known.values() if maps is None else ():
        ready()()
    print(json.dumps([str(Path(pymoo_gridpath.__file__).parent.parent), *known]), flush=True)
    for line in sys.stdin:
        ready = list(known.values())[int(line)]
        times: list[float] = []
        made: object = None
        while len(times) < (2 if maps is None else 1) or sum(times) < _TURN:
            run = ready()
            begin = time.process_time()
            made = run()
            times.append(time.process_time() - begin)
        print(json.dumps([times, digest(made)]), flush=True)


def digest(made: object) -> str:
    """Return what tells fronts and their paths from others."""
    fronts = [one for one in (made if isinstance(made, list) else [made]) if hasattr(one, "F")]
    return hashlib.sha256(b"".join(one.X.tobytes() + one.F.tobytes() for one in fronts)).hexdigest()  # pyright: ignore


class Version:
    """A fresh process of one version, which serves turns at what a script lists."""

    def __init__(self, folder: Path, script: str, *options: str):
        environment = os.environ | {"PYTHONPATH": str(folder.resolve())}
        command = [sys.executable, script, "--serve", *options]
        self.process = subprocess.Popen(command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        where, *self.names = self._answer()
        assert Path(where) == folder.resolve(), f"{folder} holds no version of the package: it comes from {where}"

    def _answer(self):
        assert self.process.stdout is not None
        return json.loads(self.process.stdout.readline())

    def turn(self, number: int) -> tuple:
        """Return the times of a turn, in seconds, and what was found, here as a digest."""
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
    parser.add_argument("--maps", type=Path, help="a folder with maps of MovingAI: compare large maps")
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.serve:
        return serve(arguments.maps)
    if arguments.after is None:
        parser.error("two folders are needed")

    times: dict[str, dict[str, list[float]]] = {}
    different: set[str] = set()
    for number in range(arguments.rounds):
        options = [] if arguments.maps is None else ["--maps", str(arguments.maps)]
        versions = {side: Version(getattr(arguments, side), __file__, *options) for side in SIDES}
        for k, name in enumerate(versions["after"].names):
            if arguments.only not in name:
                continue
            mine = times.setdefault(name, {side: [] for side in SIDES})
            if arguments.maps is not None:
                print(name, file=sys.stderr, flush=True)
            for turn in range(arguments.turns):
                # Who comes second may find warm caches, or a slow clock.
                found = {}
                for side in SIDES if (number + turn) % 2 == 0 else reversed(SIDES):
                    seconds, found[side] = versions[side].turn(k)
                    mine[side] += seconds
                    if arguments.maps is not None:
                        print(f"  {side}: {1e3 * np.median(seconds):.0f} ms", file=sys.stderr, flush=True)
                different |= {name} if found["before"] != found["after"] else set()
        for version in versions.values():
            version.end()

    print(f"{'milliseconds of processor time':45}{'before':>9}{'after':>9}{'median':>9}{'least':>8}")
    for name, sides in times.items():
        before, after = (np.array(sides[side]) for side in SIDES)
        middle = np.median(before), np.median(after)
        least = before.min(), after.min()
        print(
            f"{name:45}{1e3 * middle[0]:>9.3f}{1e3 * middle[1]:>9.3f}{middle[1] / middle[0]:>9.3f}{least[1] / least[0]:>8.3f}"
            f"{'  other results' if name in different else ''}"
        )


if __name__ == "__main__":
    main()
