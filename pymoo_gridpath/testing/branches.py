"""All paths of quadrant selection, each branch walked anew, in plain Python: slow, and independent of what plans."""

from __future__ import annotations

from pymoo_gridpath.grid import Cell, OccupancyGrid
from pymoo_gridpath.testing.enumeration import STEPS, legal_steps
from pymoo_gridpath.testing.reference import octile_length


def enumerate_branches(grid: OccupancyGrid, start: Cell, goal: Cell, strict: bool = False) -> list[list[Cell]]:
    """Return the path of every branch that leads to the goal, without loops; see `QuadrantSelection`.

    Their number doubles with every obstacle in a row. Loops are cut in each stretch from one obstacle to the next, and then in
    the whole.
    """
    return _Walk(grid, goal, strict).paths_from(start)


class _Walk:
    """The rules of the walk, for one goal."""

    def __init__(self, grid: OccupancyGrid, goal: Cell, strict: bool):
        self.grid, self.goal, self.strict = grid, goal, strict

    def paths_from(self, start: Cell) -> list[list[Cell]]:
        """Return the path of every branch."""
        paths: list[list[Cell]] = []
        # Each with the path up to the last obstacle, without that cell, and with what was walked since.
        open_branches: list[tuple[list[Cell], list[Cell]]] = [([], [start])]
        while open_branches:
            before, stretch = open_branches.pop()
            while stretch[-1] != self.goal and self.ahead(stretch[-1]) in self.legal(stretch[-1]):
                stretch.append(_after(stretch[-1], self.ahead(stretch[-1])))
            path, hit = before + _without_loops(stretch), stretch[-1]
            if hit == self.goal:
                paths.append(_without_loops(path))
                continue
            for side in (-1, 1):
                around = self.beside(hit, side) if self.strict else self.around(hit, side)
                if around:
                    open_branches.append((path[:-1], [hit, *around]))
        return paths

    def legal(self, cell: Cell) -> set[int]:
        """Return the headings of the legal steps from a cell."""
        return {m for m, _ in legal_steps(self.grid, cell)}

    def ahead(self, cell: Cell) -> int:
        """Return the heading of the signs of what is left."""
        return STEPS.index((_sign(self.goal[0] - cell[0]), _sign(self.goal[1] - cell[1])))

    def left(self, cell: Cell) -> float:
        """Return the length of the shortest way on an empty grid."""
        return octile_length([cell, self.goal])

    def beside(self, hit: Cell, side: int) -> list[Cell]:
        """Return the cell beside the blocked one, or none if the step there is not legal."""
        m = (self.ahead(hit) + side) % 8
        return [_after(hit, m)] if m in self.legal(hit) else []

    def around(self, hit: Cell, side: int) -> list[Cell]:
        """Return the cells around an obstacle, up to where it is left."""
        way, cell = [], hit
        while cell != self.goal:
            cell = _after(cell, self.ahead(cell))
            way.append(cell)
        cell, m, found = hit, self.ahead(hit) + side, []
        while True:
            while m % 8 not in self.legal(cell):
                m += side
            cell = _after(cell, m % 8)
            found.append(cell)
            if self.left(cell) < self.left(hit) and (cell in way or self.ahead(cell) in self.legal(cell)):
                return found
            beside = [_after(cell, k) for k in self.legal(cell)]
            onto = [other for other in beside if other in way and self.left(other) < self.left(hit)]
            if onto:
                return [*found, min(onto, key=self.left)]
            m -= side * (1 if self.grid.corner_cutting and m % 2 == 0 else 2)


def _sign(value: int) -> int:
    return (value > 0) - (value < 0)


def _after(cell: Cell, m: int) -> Cell:
    return cell[0] + STEPS[m][0], cell[1] + STEPS[m][1]


def _without_loops(path: list[Cell]) -> list[Cell]:
    last = {cell: k for k, cell in enumerate(path)}
    kept, k = [], 0
    while k < len(path):
        kept.append(path[k])
        k = last[path[k]] + 1
    return kept
