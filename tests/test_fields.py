"""Potential and clearance against sums and distances taken cell by cell."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pymoo_gridpath.errors import GridError
from pymoo_gridpath.fields import QUANTUM, clearance, obstacle_potential
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.testing import reference


def random_grid(seed, density=0.3):
    rng = np.random.default_rng(seed)
    return OccupancyGrid(rng.random(rng.integers(1, 12, size=2)) < density)


@given(st.integers(0, 10**6), st.floats(0.05, 20))
def test_potential_is_the_sum_of_bells(seed, variance):
    grid = random_grid(seed)
    assert np.abs(obstacle_potential(grid, variance) - reference.potential(grid, variance)).max() <= 0.51 * QUANTUM


def test_potential_of_one_obstacle_by_hand():
    grid = OccupancyGrid([[0, 0, 0], [0, 1, 0], [0, 0, 0]])
    e1, e2 = math.exp(-1), math.exp(-2)
    expected = [[e2, e1, e2], [e1, 1, e1], [e2, e1, e2]]
    assert obstacle_potential(grid) == pytest.approx(np.array(expected), abs=1e-9)


@given(st.integers(0, 10**6))
def test_sums_of_potentials_carry_no_rounding_noise(seed):
    field = obstacle_potential(random_grid(seed)).ravel()
    shuffled = np.random.default_rng(seed).permutation(field)
    assert sum(field.tolist()) == sum(shuffled.tolist())


@given(st.integers(0, 10**6))
def test_clearance_is_the_distance_to_the_nearest_obstacle(seed):
    grid = random_grid(seed)
    ys, xs = np.nonzero(grid.occupied)
    field = clearance(grid)
    for y in range(grid.height):
        for x in range(grid.width):
            expected = min((math.dist((x, y), cell) for cell in zip(xs, ys, strict=True)), default=math.inf)
            assert field[y, x] == pytest.approx(expected)


@pytest.mark.parametrize("variance", [0, -1, math.nan, math.inf])
def test_variance_is_checked(variance):
    with pytest.raises(GridError, match="variance"):
        obstacle_potential(random_grid(0), variance)
