"""The integer coding: one whole number a column."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.paths import ColumnPaths
from pymoo_gridpath.paths.frame import Axis
from pymoo_gridpath.representations.monotone import MonotoneRepresentation


class IntegerRepresentation(MonotoneRepresentation):
    """Each gene is the number of rows gained by one move; the coding that the paper found best.

    Gene 0 is the climb in the start column. Gene k, from 1 to n_columns - 2, is the step into column k: 0 is horizontal, a
    positive y is a diagonal step up and then y - 1 cells straight up, a negative y the same downwards. The step into
    the last column is not coded: it goes towards the goal's row, diagonally unless it is there, and then straight to the goal.

    Genes lie in [-(n_rows - 1), n_rows - 1]; gene 0 keeps to what its column has room for, which is [0, n - 1] in the paper's
    corner-to-corner case.

    See `MonotoneRepresentation` for the parameters.

    References
    ----------
    Ahmed and Deb (2013), section 2.3.

    Examples
    --------
    Path 1 of the paper's Fig. 2:

    >>> import numpy as np
    >>> from pymoo_gridpath.grid import OccupancyGrid
    >>> grid = OccupancyGrid(np.zeros((8, 8)), corner_cutting=True)
    >>> coding = IntegerRepresentation(grid, (0, 0), (7, 7))
    >>> path = coding.decode(np.array([[0, 3, 1, 0, -2, -1, 0]]))
    >>> path.cells(0)[:5].tolist()
    [[0, 0], [1, 1], [1, 2], [1, 3], [2, 4]]
    >>> coding.encode(path).tolist()
    [[0, 3, 1, 0, -2, -1, 0]]
    """

    name = "integer"

    def __init__(self, grid: OccupancyGrid, start: Sequence[int], goal: Sequence[int], axis: Axis = "auto"):
        super().__init__(grid, start, goal, axis)
        frame = self.frame
        self.n_var = self._n_moves
        self.xl = np.full(self.n_var, -(frame.n_rows - 1))
        self.xu = np.full(self.n_var, frame.n_rows - 1)
        self.xl[0] = -frame.start_row
        self.xu[0] = frame.n_rows - 1 - frame.start_row

    def row_moves(self, X: np.ndarray) -> np.ndarray:
        return self.genes(X)

    def encode(self, paths: ColumnPaths) -> np.ndarray:
        """Return the genes of paths, the inverse of `decode`, int, shape (N, n_var).

        A path that steps horizontally and then climbs has no code of its own, for the diagonal step dominates it
        (section 2.3). It gets the genes of the path that leaves every column at the same row, which is no longer and
        crosses no other cell.
        """
        return np.diff(self._own(paths).leave[:, :-1], axis=1, prepend=self.frame.start_row)

    def _rewrite(self, X, moves, fixed):
        return fixed
