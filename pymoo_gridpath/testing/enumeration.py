"""All legal paths of a small grid, and fronts of what they score, in plain Python; and random queries."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from pymoo_gridpath.grid import Cell, OccupancyGrid
from pymoo_gridpath.objectives import Objective

#: The step (dx, dy) of each heading.
STEPS = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]

#: The rules for steps that a grid may have, as arguments: those for corners, and no diagonal steps.
CORNER_RULES: tuple[dict[str, Any], ...] = tuple({"corner_cutting": rule} for rule in (False, True, "one side"))
RULES: tuple[dict[str, Any], ...] = (*CORNER_RULES, {"moves": 4})


class EnumeratedPath(NamedTuple):
    """A path: its cells (x, y), its straight and diagonal steps, and its total turn in units of 45 degrees."""

    cells: tuple[Cell, ...]
    straight: int
    diagonal: int
    turn: int


def random_query(
    rng: np.random.Generator, least: int, most: int, density: float = 0.5, rules: Sequence[Mapping[str, Any]] = RULES
) -> tuple[OccupancyGrid, Cell, Cell]:
    """Return a random grid, of any of some rules for steps, and a query on it that has a path.

    Parameters
    ----------
    rng : numpy.random.Generator
    least, most : int
        Cells a side.
    density : float
        The largest share of occupied cells; it is drawn as well.
    rules : sequence of mapping
        Arguments of a grid, such as one of `RULES`; by default any of these.
    """
    while True:
        occupied = rng.random(rng.integers(least, most + 1, 2)) < rng.uniform(0, density)
        query = query_on(OccupancyGrid(occupied, **rules[int(rng.integers(len(rules)))]), rng)
        if query is not None:
            return query


def query_on(grid: OccupancyGrid, rng: np.random.Generator, apart: float = 0.0) -> tuple[OccupancyGrid, Cell, Cell] | None:
    """Return a grid and a random query on it, or None if two cells were drawn that no path joins, or there are none.

    In x or in y they must be at least the share ``apart`` of the larger side away from one another.
    """
    free = np.argwhere(~grid.occupied)
    if len(free) < 2:
        return None
    (ya, xa), (yb, xb) = free[rng.choice(len(free), 2, replace=False)].tolist()
    far = max(abs(xa - xb), abs(ya - yb)) >= apart * max(grid.shape)
    return (grid, (xa, ya), (xb, yb)) if far and grid.regions[ya, xa] == grid.regions[yb, xb] else None


def legal_steps(grid: OccupancyGrid, cell: Cell, headings: Iterable[int] = range(8)) -> Iterator[tuple[int, Cell]]:
    """Yield the heading and the end of each legal step from a cell."""
    x, y = cell
    for m in headings:
        dx, dy = STEPS[m]
        beside = [grid.is_free((x + dx, y)), grid.is_free((x, y + dy))]
        rule = {True: True, False: all(beside), "one side": any(beside)}
        diagonal = grid.moves == 8 and rule[grid.corner_cutting]
        if grid.is_free((x + dx, y + dy)) and (dx == 0 or dy == 0 or diagonal):
            yield m, (x + dx, y + dy)


def steps_of(grid: OccupancyGrid, headings: Iterable[int] = range(8)) -> dict[Cell, list[tuple[int, Cell]]]:
    """Return the heading and the end of each legal step from every free cell."""
    headings = list(headings)
    free = [(x, y) for y, x in np.ndindex(grid.shape) if grid.is_free((x, y))]
    return {cell: list(legal_steps(grid, cell, headings)) for cell in free}


def turn_between(before: int | None, after: int) -> int:
    """Return the turn between two headings in units of 45 degrees; nothing is before the first step."""
    apart = 0 if before is None else abs(after - before)
    return min(apart, 8 - apart)


def enumerate_paths(grid: OccupancyGrid, start: Cell, goal: Cell, headings: Iterable[int] = range(8)) -> list[EnumeratedPath]:
    """Return every legal path without a loop. Grids of more than 14 free cells take long."""
    steps = steps_of(grid, headings)
    turns = {before: [turn_between(before, m) for m in range(8)] for before in (None, *range(8))}
    found: list[EnumeratedPath] = []
    cells, visited = [start], {start}

    def walk(straight, diagonal, turn, heading):
        if cells[-1] == goal:
            found.append(EnumeratedPath(tuple(cells), straight, diagonal, turn))
            return
        for m, after in steps[cells[-1]]:
            if after not in visited:
                cells.append(after)
                visited.add(after)
                walk(straight + 1 - m % 2, diagonal + m % 2, turn + turns[heading][m], m)
                visited.remove(cells.pop())

    walk(0, 0, 0, None)
    return found


def non_dominated(rows: Iterable[tuple[float, ...]]) -> np.ndarray:
    """Return the rows that no other dominates, each once and in ascending order, shape (N, k)."""
    front: list[tuple[float, ...]] = []
    # In ascending order no row is dominated by a later one.
    for row in sorted(set(rows)):
        if not any(all(a <= b for a, b in zip(better, row, strict=True)) for better in front):
            front.append(row)
    return np.array(front, dtype=float)


def label_front(
    grid: OccupancyGrid, start: Cell, goal: Cell, objectives: Sequence[Objective], headings: Iterable[int] = range(8)
) -> np.ndarray:
    """Return the front of all paths, label by label in lexicographic order (Martins, 1984), shape (N, n_obj), ascending.

    Objectives add up costs that they name, or go by the worst cell of a path. Costs that differ by rounding alone count as the
    same. Some hundred cells take a second.
    """
    steps, turning = steps_of(grid, headings), any(one.turn_cost for one in objectives)
    costs = [_cost_of(one, grid) for one in objectives]
    first = tuple(cost(None, None, start) for cost in costs)
    # Of each cell, with the heading where it matters, the labels from which paths go on.
    settled: dict[Any, list[tuple[float, ...]]] = {}
    count = itertools.count()
    queue: list[Any] = [(first, next(count), start, None)]
    while queue:
        label, _, cell, heading = heapq.heappop(queue)
        kept = settled.setdefault((cell, heading if turning and cell != goal else None), [])
        if _is_behind(label, kept):
            continue
        kept.append(label)
        if cell != goal:
            for m, after in steps[cell]:
                further = tuple(cost(label[k], (heading, m), after) for k, cost in enumerate(costs))
                if not _is_behind(further, settled.get((after, m if turning and after != goal else None), ())):
                    heapq.heappush(queue, (further, next(count), after, m))
    found = sorted(settled.get((goal, None), []))
    # Rounding may have put what is worse first.
    front = [row for k, row in enumerate(found) if not _is_behind(row, found[k + 1 :])]
    return np.array(front, dtype=float).reshape(-1, len(objectives))


def _cost_of(objective: Objective, grid: OccupancyGrid):
    """Return what a step adds to the cost of a path: from its cost so far, the headings before and of the step, and its end."""
    field, moves = objective.field(grid), objective.moves(grid)
    costs = None if field is None else np.asarray(field, dtype=float).tolist()
    of_moves: Any = None if moves is None else np.asarray(moves, dtype=float).tolist()
    by_cell = np.ndim(moves) == 3 if moves is not None else False

    def cost(before, headings, cell):
        x, y = cell
        entered = 0.0 if costs is None else costs[y][x]
        if objective.bottleneck:
            entered = -entered if objective.maximise else entered
            return entered if before is None else max(before, entered)
        if headings is None:
            return entered
        _, m = headings
        if of_moves is not None:
            entered += of_moves[m][y][x] if by_cell else of_moves[m % 2]
        return before + entered + objective.turn_cost * turn_between(*headings)

    return cost


def _is_behind(label: tuple[float, ...], others: Iterable[tuple[float, ...]]) -> bool:
    """Whether one of some labels is nowhere worse, but for rounding."""
    return any(all(a <= b + 1e-9 * (1.0 + abs(b)) for a, b in zip(other, label, strict=True)) for other in others)
