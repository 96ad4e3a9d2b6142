"""What a path is held against: the corner rule that its peer is said to have, our optimum, and MovingAI's published length."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from peer_libraries.paths import Cell, PathPeer

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.grid import CornerCutting
from pymoo_gridpath.neighbourhood import DIAGONAL as IS_DIAGONAL
from pymoo_gridpath.neighbourhood import HEADING_OF, ONE_SIDE, SQRT2
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.shortest import Backward

# One straight step in whole numbers, which order lengths of paths correctly.
_ONE = 2**32

# Published lengths have six significant digits.
PUBLISHED = 1e-3

# Sums in another order.
_ROUNDING = 1e-9


def optimum(moves: Moves, start: Cell, goal: Cell, diagonal: float = SQRT2) -> float:
    """Return the least cost of a path by our own search, where a straight step costs 1; ``inf`` if there is no path."""
    step = np.tile(np.where(IS_DIAGONAL, round(diagonal * _ONE), _ONE), (9, 1)).astype(np.int64)
    nothing = np.zeros((2, moves.n_cells), dtype=np.int64)
    search = Backward(moves, np.stack([step, 0 * step]), nothing, moves.index(goal))
    search.run(until=moves.index(start))
    k = moves.index(start)
    return search.cost[0, k] / _ONE if search.ahead[k] >= 0 or k == moves.index(goal) else np.inf


class Counts(NamedTuple):
    """Steps of a path, and whether all of them are legal."""

    straight: int
    diagonal: int
    legal: bool

    def cost(self, diagonal: float = SQRT2) -> float:
        return self.straight + self.diagonal * diagonal


def counts(moves: Moves, path: np.ndarray, start: Cell, goal: Cell) -> Counts:
    """Return what the steps of a path are by the corner rule of some moves; it is illegal, too, if it joins other cells."""
    steps = np.diff(path, axis=0)
    legal = bool(len(path)) and tuple(path[0]) == tuple(start) and tuple(path[-1]) == tuple(goal)
    legal = legal and bool((np.abs(steps).max(axis=1, initial=0) == 1).all())
    if legal:
        headings = HEADING_OF[steps[:, 1] + 1, steps[:, 0] + 1]
        legal = bool((moves.legal[path[:-1, 1] * moves.width + path[:-1, 0]] >> headings & 1).all())
    diagonal = int((np.abs(steps).sum(axis=1) == 2).sum())
    return Counts(len(steps) - diagonal, diagonal, legal)


class Judged(NamedTuple):
    """A path beside our optima."""

    legal: bool
    # By the peer's own cost of a diagonal, and by the true one, under its rule.
    optimal: bool
    shortest: bool
    # Over the shortest under its rule, and over the published length, in per cent; NaN without a path or a published length.
    excess: float
    over_published: float


def judge(peer: PathPeer, moves: Moves, path: np.ndarray, start: Cell, goal: Cell, published: float) -> Judged:
    """Return how a path does; without one it is illegal and nothing else."""
    found = counts(moves, path, start, goal)
    if not found.legal:
        return Judged(False, False, False, np.nan, np.nan)
    own, length = optimum(moves, start, goal, peer.diagonal), optimum(moves, start, goal)
    excess = found.cost() / length - 1 if length else 0.0
    return Judged(
        True,
        found.cost(peer.diagonal) <= own * (1 + _ROUNDING),
        excess <= _ROUNDING,
        100 * excess,
        0.0 if abs(found.cost() - published) <= PUBLISHED else 100 * (found.cost() / published - 1),
    )


def measured_rule(peer: PathPeer) -> CornerCutting:
    """Return the corner rule that a peer follows on maps of four cells, walled in: True, False or "one side".

    Raises
    ------
    ValueError
        If it follows none of them.
    """
    passes = []
    for blocked in ((), ((2, 1),), ((2, 1), (1, 2))):
        occupied = np.pad(np.zeros((2, 2), dtype=bool), 1, constant_values=True)
        for x, y in blocked:
            occupied[y, x] = True
        peer.set_up(OccupancyGrid(occupied, corner_cutting=peer.rule))
        passes.append(len(peer.query((1, 1), (2, 2))) == 2)
    rules: dict[tuple[bool, ...], CornerCutting] = {
        (True, False, False): False,
        (True, True, False): ONE_SIDE,
        (True, True, True): True,
    }
    if tuple(passes) not in rules:
        raise ValueError(f"{peer.label} passes none, one, two corners: {passes}, expected a known rule")
    return rules[tuple(passes)]
