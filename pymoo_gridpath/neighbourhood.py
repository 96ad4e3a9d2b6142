"""The eight steps to a neighbouring cell: their directions, and what lies between two of them."""

from __future__ import annotations

import numpy as np

#: Degrees of one unit of turning; headings on an eight-connected grid are multiples of it.
TURN_UNIT = 45

#: The step (dx, dy) of each heading, counter-clockwise from the right in steps of 45 degrees; odd ones are diagonal.
HEADINGS = np.array([(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)])

#: The heading of a step (dx, dy) at [dy + 1, dx + 1].
HEADING_OF = np.full((3, 3), -1)
HEADING_OF[HEADINGS[:, 1] + 1, HEADINGS[:, 0] + 1] = np.arange(8)

#: Whether each heading is diagonal.
DIAGONAL = np.arange(8) % 2 == 1


def turn_units() -> np.ndarray:
    """Return the turn between headings in units of 45 degrees, int, shape (9, 8); row 8 is for a path that just starts."""
    apart = np.abs(np.arange(8)[:, None] - np.arange(8)[None, :])
    return np.concatenate([np.minimum(apart, 8 - apart), np.zeros((1, 8), dtype=int)])
