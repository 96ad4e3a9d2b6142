"""How a grid shows itself, in a notebook and in words."""

from __future__ import annotations

import numpy as np

from pymoo_gridpath import pictures
from pymoo_gridpath.errors import counted, visible
from pymoo_gridpath.grid.grown import GrownCells
from pymoo_gridpath.neighbourhood import steps_in_words
from pymoo_gridpath.pictures import Scene


def scene_of(grid: GrownCells) -> Scene:
    """Return the cells of a grid as they are drawn."""
    return Scene(grid.occupied, grid.unknown, grown=grid.grown_cells)


def unknown_of(grid: GrownCells) -> str | None:
    """Return in words how many cells of a map are unknown and what they count as; None if its kind knows none."""
    if grid.unknown is None:
        return None
    n = int(np.count_nonzero(grid.unknown))
    meaning = ("occupied" if (grid.occupied | ~grid.unknown).all() else "free") if n else ""
    return counted(n, "cell") + (f", {n / grid.unknown.size:.1%}, taken as {meaning}" if n else "")


def size_of(grid) -> str:
    """Return in words how many cells an `OccupancyGrid` has, and of what size."""
    return f"{grid.width} x {grid.height} cells" + ("" if grid.resolution is None else f" of {grid.resolution:g} m")


def html_of(grid) -> str:
    """Return an `OccupancyGrid` as a picture beside what it is."""
    n, unknown = grid.n_occupied, unknown_of(grid)
    rows = {
        "cells": size_of(grid).replace(" cells", ""),
        "occupied": f"{n} ({n / grid.occupied.size:.0%})",
        **({} if grid.original is grid else {"of these grown": f"{n - grid.original.n_occupied}"}),
        **({} if unknown is None else {"unknown": unknown}),
        "steps": steps_in_words(grid.moves, grid.corner_cutting),
    }
    return pictures.page(pictures.png(scene_of(grid)), visible(grid.name), rows, "map, occupied cells dark")
