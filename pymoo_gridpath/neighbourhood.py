"""The steps to a neighbouring cell: their directions and lengths, what lies between two of them, and which a grid allows."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

#: Degrees of one unit of turning; headings on an eight-connected grid are multiples of it.
TURN_UNIT = 45

#: The step (dx, dy) of each heading, counter-clockwise from the right in steps of 45 degrees; odd ones are diagonal.
HEADINGS = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])

#: The heading of a step (dx, dy) at [dy + 1, dx + 1].
HEADING_OF = np.full((3, 3), -1)
HEADING_OF[HEADINGS[:, 1] + 1, HEADINGS[:, 0] + 1] = np.arange(8)

#: The heading that leads back along each heading.
OPPOSITE = (np.arange(8) + 4) % 8

#: Whether each heading is diagonal.
DIAGONAL = np.arange(8) % 2 == 1

#: The length of a diagonal step, and of the step along each heading, in cells.
SQRT2 = math.sqrt(2.0)
LENGTHS = np.where(DIAGONAL, SQRT2, 1.0)


def turns_between(before: np.ndarray, after: np.ndarray, out: np.ndarray | None = None) -> np.ndarray:
    """Return the turn from headings to others, elementwise, in units of 45 degrees; written to ``out`` if it is given."""
    apart = np.abs(after - before)
    return np.minimum(apart, 8 - apart, out=out)


def turn_units() -> np.ndarray:
    """Return the turn between headings in units of 45 degrees, int, shape (9, 8); row 8 is for a path that just starts."""
    turns = turns_between(np.arange(8)[:, None], np.arange(8)[None, :])
    return np.concatenate([turns, np.zeros((1, 8), dtype=int)])


@dataclass(frozen=True)
class Neighbourhood:
    """The steps of a grid: the one rule by which paths are searched for, coded, counted and judged.

    Beside a diagonal step lie two cells, which share a side with both of its ends.

    Parameters
    ----------
    diagonal : bool
        Whether there are diagonal steps at all. Where there are none, a path that goes from a cell to one that touches it at a
        corner leaves out a cell.
    crossed : (int, int, int)
        How many cells a diagonal step crosses besides its ends, where none, one and both of those beside it are occupied. The
        step is legal where it is 0; it is nowhere less for more that are occupied.
    """

    diagonal: bool
    crossed: tuple[int, int, int]

    @property
    def restricts(self) -> bool:
        """Whether there are diagonal steps between free cells that are not legal."""
        return any(self.crossed)

    @property
    def rounds(self) -> bool:
        """Whether a diagonal step may pass one occupied cell."""
        return self.crossed[1] == 0

    @property
    def squeezes(self) -> bool:
        """Whether a diagonal step may pass between two occupied cells, and so join what straight steps do not."""
        return self.crossed[2] == 0

    def may_pass(self, free: np.ndarray, free_too: np.ndarray) -> np.ndarray:
        """Return which diagonal steps are legal, by whether each of the cells beside them is free, bool, both of one shape."""
        # Without counting, which takes ten times as long.
        none, one, both = (n == 0 for n in self.crossed)
        if both:
            return np.ones_like(free)
        if one:
            return free | free_too
        return free & free_too if none else np.zeros_like(free)

    def crossings(self, occupied: np.ndarray, occupied_too: np.ndarray) -> np.ndarray:
        """Return `crossed` for diagonal steps, by whether each of the cells beside them is occupied, bool; int8."""
        return np.array(self.crossed, dtype=np.int8).take(occupied.view(np.int8) + occupied_too.view(np.int8))


#: What a grid may say of corners: they are cut, kept, or passed where at most one of the cells beside a step is occupied.
ONE_SIDE = "one side"
CORNERS = {True: (0, 0, 0), False: (0, 1, 2), ONE_SIDE: (0, 0, 2)}

#: How many steps there may be from a cell.
MOVES = (4, 8)

#: What they are called.
_WORDS = {
    True: "corners may be cut",
    False: "corners may not be cut",
    ONE_SIDE: "corners may be cut on one side",
}


def steps_in_words(moves: int, corner_cutting: bool | str) -> str:
    """Return what is said of the steps of a grid."""
    return _WORDS[corner_cutting] if moves == 8 else "no diagonal steps"


def neighbourhood_of(moves: int, corner_cutting: bool | str) -> Neighbourhood:
    """Return the steps of a grid; without diagonal ones it does not matter how corners are passed."""
    return Neighbourhood(moves == 8, CORNERS[corner_cutting] if moves == 8 else (1, 1, 1))
