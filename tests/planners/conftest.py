"""Random queries that have a path, paths in plain Python, and what is tested only where it lies beside the repository."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pymoo_gridpath import OccupancyGrid

SHARED = Path(__file__).resolve().parents[3] / "shared"


@pytest.fixture(scope="session")
def companions() -> Path:
    """The folder of golden counts, which is not part of the repository."""
    if not (SHARED / "companions").is_dir():
        pytest.skip("golden counts are tested only where the folder ../shared/companions lies beside the repository")
    return SHARED / "companions"


@pytest.fixture
def solvable_query():
    """Return a random grid and a query on it that has a path."""

    def draw(rng: np.random.Generator, least: int, most: int, density: float = 0.5):
        while True:
            occupied = rng.random(rng.integers(least, most + 1, 2)) < rng.uniform(0, density)
            grid = OccupancyGrid(occupied, corner_cutting=bool(rng.integers(2)))
            free = np.argwhere(~grid.occupied)
            if len(free) < 2:
                continue
            (ya, xa), (yb, xb) = free[rng.choice(len(free), 2, replace=False)].tolist()
            if grid.regions[ya, xa] == grid.regions[yb, xb]:
                return grid, (xa, ya), (xb, yb)

    return draw
