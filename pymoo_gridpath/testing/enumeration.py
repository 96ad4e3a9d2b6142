"""All legal paths of a small grid, and fronts of what they score, in plain Python; and random queries."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from pymoo_gridpath.grid import Cell, OccupancyGrid

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
