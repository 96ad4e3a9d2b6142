"""Whether something is a batch of decoded paths."""

from __future__ import annotations

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.paths.cell import CellPaths
from pymoo_gridpath.paths.column import ColumnPaths


def check_paths(paths):
    """Return a batch of decoded paths if it is one; what a representation of one's own decodes to needs the same measures."""
    measures = ("length", "turn", "interfering_cells", "total", "cells")
    if isinstance(paths, ColumnPaths | CellPaths) or all(hasattr(paths, name) for name in ("__len__", *measures)):
        return paths
    raise GridPathError(f"paths is {checks.shown(paths)}, expected paths as decode returns them")
