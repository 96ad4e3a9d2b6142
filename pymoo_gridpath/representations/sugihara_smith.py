"""The coding of Sugihara and Smith: a diagonal step, or a horizontal one and a climb."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.paths import ColumnPaths
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.representations.binary import BinaryRepresentation


class SugiharaSmithRepresentation(BinaryRepresentation):
    """The bits of `BinaryRepresentation`, but that the climb after a diagonal step is ignored.

    A path that climbs on in a column which it entered diagonally does not have a code: it has to step horizontally and climb
    one more. So there are legal paths, and points of fronts, that it cannot say (``codes_all`` is False), and paths are longer
    than in the other codings. It is what the codings of Ahmed and Deb improve on. In the last column, paths join the goal
    whatever the step into it. On a grid without diagonal steps all are horizontal, and every path that advances has a code.

    See `MonotoneRepresentation` for the parameters.

    References
    ----------
    K. Sugihara and J. Smith (1999), as Ahmed and Deb (2013) describe it in section 2.1.

    Examples
    --------
    One step diagonally up, whatever its climb says; then a horizontal step and a climb of two:

    >>> from pymoo_gridpath.grid import OccupancyGrid
    >>> coding = SugiharaSmithRepresentation(OccupancyGrid(np.zeros((4, 4)), corner_cutting=True), (0, 0), (3, 3))
    >>> bits = "00 11-11 10-10 10"
    >>> path = coding.decode(np.array([[bit == "1" for bit in bits if bit in "01"]]))
    >>> path.cells(0).tolist()
    [[0, 0], [1, 1], [2, 1], [2, 2], [2, 3], [3, 3]]
    >>> "".join(str(int(bit)) for bit in coding.encode(path)[0])
    '001100101010'
    """

    name = "sugihara-smith"
    codes_all = False

    def _split(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        start, direction, climb = super()._split(X)
        return start, direction, np.where(_diagonal(direction[:, :-1]), 0, climb)

    def fits(self, sequences: Sequences) -> np.ndarray:
        """Return which paths have a code, bool, shape (N,): those that nowhere climb on after a diagonal step.

        Where they go back along a column, or along the axis, see `from_sequences`.
        """
        return self._coded(self._column_paths(sequences))

    def encode(self, paths: ColumnPaths) -> np.ndarray:
        """Return the bits of paths, bool, shape (N, n_var).

        The inverse of `decode` but for its redundancies: those of `BinaryRepresentation.encode`, and the climb after a diagonal
        step, which is 0.

        Raises
        ------
        GridPathError
            If a path climbs on after a diagonal step into another column than the last.
        """
        coded = self._coded(self._own(paths))
        if not coded.all():
            raise GridPathError(
                f"path {int(np.flatnonzero(~coded)[0])} climbs on after a diagonal step, which the {self.name} representation "
                f"cannot code; expected paths that `fits` takes"
            )
        return super().encode(paths)

    def _coded(self, paths: ColumnPaths) -> np.ndarray:
        """Return which paths have a code, bool, shape (N,)."""
        step = (paths.enter[:, 1:] - paths.leave[:, :-1])[:, :-1]
        gain = np.diff(paths.leave[:, :-1], axis=1)
        return np.asarray((step * gain <= 1).all(axis=1))


def _diagonal(direction: np.ndarray) -> np.ndarray:
    """Return whether direction bits (0 to 3) are those of a diagonal step."""
    return (direction == 3) | (direction == 0)
