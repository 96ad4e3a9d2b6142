"""The eight steps to a neighbouring cell: their directions, what lies between two of them, and what a diagonal one may pass."""

from __future__ import annotations

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
    """What a diagonal step of a grid may pass: the one rule by which paths are searched for, coded, counted and judged.

    Beside a diagonal step lie two cells, which share a side with both of its ends.

    Parameters
    ----------
    crossed : (int, int, int)
        How many cells a diagonal step counts as crossing, besides its ends, where none, one and both of those are occupied. The
        step is legal where it is 0; it is nowhere less for more that are occupied.
    """

    crossed: tuple[int, int, int]

    @property
    def restricts(self) -> bool:
        """Whether there are diagonal steps between free cells that are not legal."""
        return any(self.crossed)

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


# By whether corners may be cut.
_NEIGHBOURHOODS = {False: Neighbourhood((0, 1, 2)), True: Neighbourhood((0, 0, 0))}


def neighbourhood_of(corner_cutting: bool) -> Neighbourhood:
    """Return the rule of a grid on which corners may be cut, or not."""
    return _NEIGHBOURHOODS[corner_cutting]
