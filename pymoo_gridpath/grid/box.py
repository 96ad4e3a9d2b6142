"""Parts of a grid."""

from __future__ import annotations

from typing import NamedTuple


class Box(NamedTuple):
    """A rectangle of cells, from (x0, y0) on and up to (x1, y1), which are not in it."""

    x0: int
    y0: int
    x1: int
    y1: int

    @property
    def slices(self) -> tuple[slice, slice]:
        """What takes the part out of an array over the grid."""
        return slice(self.y0, self.y1), slice(self.x0, self.x1)

    @property
    def shape(self) -> tuple[int, int]:
        """Height and width."""
        return self.y1 - self.y0, self.x1 - self.x0

    def within(self, part: Box) -> Box:
        """Return where the box lies in another that holds it."""
        return Box(self.x0 - part.x0, self.y0 - part.y0, self.x1 - part.x0, self.y1 - part.y0)

    def grown(self, margin: int, shape: tuple[int, int]) -> Box:
        """Return the box with so many more cells on each side, as far as an array of that shape goes."""
        height, width = shape
        return Box(
            max(self.x0 - margin, 0), max(self.y0 - margin, 0), min(self.x1 + margin, width), min(self.y1 + margin, height)
        )
