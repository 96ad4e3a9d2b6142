"""Obstacles that move in the problems of a study, as its file describes them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from pymoo_gridpath.errors import StudyError
from pymoo_gridpath.study.specification import values
from pymoo_gridpath.study.specification.base import set_fields, set_given
from pymoo_gridpath.study.specification.values import Where

#: The one representation of paths among obstacles that move, and how these are treated.
REPRESENTATION, TREATMENT = "cells", "penalty"

_MOST_MOVERS, _MOST_EPOCHS = 10_000, 10_000
_WAYS = "how many, or for each its cells, one an epoch, such as [[[4, 9], [4, 8]], [[7, 2]]]"


@dataclass(frozen=True, kw_only=True)
class MovingObstacles:
    """The table ``moving`` of a problem: obstacles that move while the search goes on, see `MovingObstaclesProblem`.

    A run ends after the last epoch, whatever the budget of the study.

    Parameters
    ----------
    movers : int or sequence of sequences of (int, int)
        For each moving obstacle its cells (x, y) in epoch 0, 1, and so on; after its last one it stays. Or how many wander at
        random, see `pymoo_gridpath.problems.random_movers`, which takes ``epochs``.
    every : int, default 5
        Generations of an epoch.
    epochs : int, optional
        Different maps there are; by default as many as the longest way has cells.
    seed : int, default 1
        Of the obstacles that wander at random.
    """

    owner: ClassVar[str] = "moving"

    movers: Any
    every: int = 5
    epochs: int | None = None
    seed: int | None = None

    def __post_init__(self):
        set_fields(self, every=values.whole(self.every, ("every",), 1, values.MAX_BUDGET // _MOST_EPOCHS))
        set_given(self, "epochs", check=lambda value, where: values.whole(value, where, 1, _MOST_EPOCHS))
        set_given(self, "seed", check=lambda value, where: values.whole(value, where, 0, values.MAX_SEED))
        given: Any = self.movers.tolist() if isinstance(self.movers, np.ndarray | np.integer) else self.movers
        if isinstance(given, int) and not isinstance(given, bool):
            set_fields(self, movers=values.whole(given, ("movers",), 1, _MOST_MOVERS))
            if self.epochs is None:
                raise StudyError("moving has no epochs, expected how many of them there are for movers at random", ("epochs",))
            return
        set_fields(self, movers=_ways(given))
        if self.seed is not None:
            raise StudyError("seed is for movers at random, and the cells of these are given", ("seed",))

    def ways(self) -> list[list[list[int]]]:
        """Return the cells that are given, in each epoch of each mover."""
        return held(self.movers, self.epochs or max(map(len, self.movers)))


def check_moving(spec: Any) -> None:
    """Refuse what does not go with obstacles that move in a table of a problem."""
    for key, fits, others in (
        ("representation", REPRESENTATION, (None,)),
        ("obstacles", TREATMENT, ()),
        ("axis", "auto", ()),
    ):
        value = getattr(spec, key)
        if value != fits and value not in others:
            raise StudyError(f"{key} is {values.show(value)}, expected {fits!r} where obstacles move", (key,))


def held(ways: Sequence[Any], n_epochs: int) -> list[list[list[int]]]:
    """Return the cells of movers in so many epochs: after its last one each stays."""
    return [np.asarray(way)[np.minimum(np.arange(n_epochs), len(way) - 1)].tolist() for way in ways]


def entry(ways: Sequence[Any], every: int) -> dict[str, Any]:
    """Return obstacles that move in canonical form: their cells in each epoch, and how many generations that is."""
    return {"every": every, "movers": [np.asarray(way).tolist() for way in ways]}


def n_epochs(moving: dict[str, Any]) -> int:
    """Return how many maps there are in canonical form."""
    return len(moving["movers"][0])


def generations(moving: dict[str, Any]) -> int:
    """Return after how many generations a run ends."""
    return moving["every"] * n_epochs(moving)


def check_entry(moving: Any, where: Where) -> None:
    """Refuse what is no canonical form of obstacles that move, as something that was stored may hold."""
    table = values.table(moving, where)
    values.check_keys(table, ("every", "movers"), where, "moving")
    for key in ("every", "movers"):
        if key not in table:
            raise StudyError(f"moving has no {key}, expected every and movers", where)
    try:
        read = MovingObstacles(movers=table["movers"], every=table["every"]) if isinstance(table["movers"], list) else None
    except StudyError as error:
        raise StudyError(error.message, (*where, *error.where)) from None
    if read is None or read.ways() != table["movers"]:
        raise StudyError(f"movers is {values.show(table['movers'])}, expected as many cells of each", (*where, "movers"))


def _ways(given: Any) -> tuple[tuple[tuple[int, int], ...], ...]:
    """Return the cells of each mover."""
    where = ("movers",)
    if not isinstance(given, Sequence) or isinstance(given, str) or not 0 < len(given) <= _MOST_MOVERS:
        raise StudyError(f"movers is {values.show(given)}, expected {_WAYS}", where)
    found = []
    for number, way in enumerate(given):
        way = way.tolist() if isinstance(way, np.ndarray) else way
        if not isinstance(way, Sequence) or isinstance(way, str) or not 0 < len(way) <= _MOST_EPOCHS:
            raise StudyError(f"mover {number} is {values.show(way)}, expected its cells, such as [[4, 9], [4, 8]]", where)
        found.append(tuple(values.cell(cell, where) for cell in way))
    return tuple(found)
