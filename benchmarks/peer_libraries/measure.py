"""Peers measured beside one another, alternating in one process, in processor time."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from peer_libraries.agreement import Judged, judge, measured_rule
from peer_libraries.paths import Cell, PathPeer
from peer_libraries.searches import SearchPeer

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.grid import CornerCutting
from pymoo_gridpath.maps import load_map, read_scen
from pymoo_gridpath.problems import GridPathProblem
from pymoo_gridpath.quality import hypervolume_ratio
from pymoo_gridpath.search.moves import Moves


def say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def split(peers: Sequence[Any]) -> tuple[list[Any], dict[str, str]]:
    """Return the peers that are there, and why the others are not, by package."""
    reasons = {peer.package: peer.missing() for peer in peers}
    return [peer for peer in peers if reasons[peer.package] is None], {name: why for name, why in reasons.items() if why}


def seconds_of(call: Callable[[], Any]) -> tuple[float, Any]:
    begin = time.process_time()
    found = call()
    return time.process_time() - begin, found


# -- shortest paths -----------------------------------------------------------------------------------------------------------


class Case(NamedTuple):
    """A map, and queries (start, goal, published length), NaN where none is published."""

    name: str
    grid: OccupancyGrid
    queries: list[tuple[Cell, Cell, float]]


def cases_of(folder: Path, names: Sequence[str], n_queries: int) -> list[Case]:
    """Return maps with so many of their queries, evenly from the shortest to the longest."""
    cases = []
    for name in names:
        path = folder / f"{name}.map"
        grid = load_map(path)
        queries = read_scen(f"{path}.scen", grid)
        # The first ones are of a step or two.
        chosen = np.linspace(len(queries) - 1, 0, n_queries, endpoint=False).round().astype(int)[::-1]
        queries = [(queries[k].start, queries[k].goal, queries[k].optimal_length) for k in chosen.tolist()]
        cases.append(Case(name, grid, queries))
    return cases


def dense_case(n_queries: int) -> Case:
    """Return a seeded map with a third of its cells occupied, where ways that differ cost nearly the same."""
    rng = np.random.default_rng(1)
    grid = OccupancyGrid(rng.random((64, 64)) < 1 / 3)
    # Queries within the largest region, in which all corner rules find paths.
    inside = np.argwhere(grid.regions == np.argmax(np.bincount(grid.regions[~grid.occupied])))
    ends = inside[rng.choice(len(inside), (n_queries, 2), replace=False)][:, :, ::-1].tolist()
    return Case("dense", grid, [(tuple(start), tuple(goal), np.nan) for start, goal in ends])


class PathRow(NamedTuple):
    """What a peer did: the rule that it followed, set-up by case, and seconds and judgement of each query by case."""

    peer: PathPeer
    rule: CornerCutting
    set_up: dict[str, float]
    seconds: dict[str, list[float]]
    judged: dict[str, list[Judged]]

    @property
    def all_judged(self) -> np.ndarray:
        """Return judgements of all queries, a row each."""
        return np.array([one for rows in self.judged.values() for one in rows], dtype=float)


def measure_paths(peers: Sequence[PathPeer], cases: Sequence[Case], repeats: int) -> tuple[list[PathRow], dict[str, str]]:
    """Return a row for each peer, and why others failed, by label. A query takes the least time of its repeats."""
    rows, failed = [], {}
    for peer in peers:
        # Imports and compiling come with it.
        try:
            rows.append(PathRow(peer, measured_rule(peer), {}, {}, {}))
        except Exception as error:
            failed[peer.label] = f"{type(error).__name__}: {error}"
    for case in cases:
        moves = {}
        for row in rows:
            grid = case.grid.replace(corner_cutting=row.peer.rule)
            moves[row.peer.rule] = Moves(grid)
            row.set_up[case.name], _ = seconds_of(lambda row=row, grid=grid: row.peer.set_up(grid))
            row.seconds[case.name], row.judged[case.name] = [], []
        for k, (start, goal, published) in enumerate(case.queries):
            for row in rows:
                tries = [seconds_of(partial(row.peer.query, start, goal)) for _ in range(repeats)]
                row.seconds[case.name].append(min(seconds for seconds, _ in tries))
                row.judged[case.name].append(judge(row.peer, moves[row.peer.rule], tries[0][1], start, goal, published))
            say(f"{case.name}: query {k + 1} of {len(case.queries)}")
    return rows, failed


# -- searches -----------------------------------------------------------------------------------------------------------------


class SearchRow(NamedTuple):
    """Seconds, hypervolume ratio and share of legal paths of each run of a peer."""

    peer: SearchPeer
    runs: list[tuple[float, float, float]]


def measure_searches(
    peers: Sequence[SearchPeer], problem: GridPathProblem, pop_size: int, n_gen: int, n_seeds: int, patience: float
) -> list[SearchRow]:
    """Return a row for each peer; one that took longer than ``patience`` seconds has no further run."""
    # Imports and compiling; that of the evaluation comes with the first.
    for peer in peers:
        peer.run(problem, 8, 2, 0)
    front = problem.pareto_front(max_seconds=120.0)
    rows = [SearchRow(peer, []) for peer in peers]
    for seed in range(1, n_seeds + 1):
        for row in rows:
            if any(seconds > patience for seconds, *_ in row.runs):
                continue
            seconds, X = seconds_of(lambda row=row, seed=seed: row.peer.run(problem, pop_size, n_gen, seed))
            found: Any = problem.evaluate(X, return_as_dictionary=True)
            legal = np.ravel(found["interfering_cells"]) == 0
            row.runs.append((seconds, hypervolume_ratio(found["F"][legal], front), float(legal.mean())))
            say(f"{problem.n_var} genes, seed {seed}, {row.peer.label}: {seconds:.1f} s")
    return rows
