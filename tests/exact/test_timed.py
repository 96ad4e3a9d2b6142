"""Fronts among obstacles of known motion: equal to full enumeration, by rules written down a second time here."""

from __future__ import annotations

import numpy as np
import pytest

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.exact import Budget
from pymoo_gridpath.exact.timed import exact_timed_front
from pymoo_gridpath.paths.trajectories import Trajectories
from pymoo_gridpath.testing.timed import enumerated, wander


@pytest.mark.parametrize("corner_cutting", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_the_front_is_that_of_an_enumeration(seed, corner_cutting):
    rng = np.random.default_rng(seed)
    occupied = np.zeros((4, 4), dtype=bool)
    occupied[1, 2] = seed > 0
    ways = [wander(rng, 4, 5) for _ in range(1 + seed)]
    found = exact_timed_front(OccupancyGrid(occupied, corner_cutting=corner_cutting), (0, 0), (3, 3), Trajectories(ways), 6)
    expected = enumerated(occupied, corner_cutting, (0, 0), (3, 3), ways, 6)
    np.testing.assert_allclose(found.F, np.reshape(expected, (-1, 3)), rtol=0, atol=1e-12)


def test_nobody_exchanges_cells_or_crosses():
    lane = OccupancyGrid(np.zeros((1, 4)))
    swap = Trajectories([[(3, 0), (2, 0), (1, 0), (0, 0)]])
    found = exact_timed_front(lane, (0, 0), (3, 0), swap, 9)
    assert len(found.F) == 0 and found.complete and "no legal path" in found.message
    square = OccupancyGrid(np.zeros((2, 2)), corner_cutting=True)
    crossing = Trajectories([[(1, 0), (0, 1)]], after="gone")
    assert exact_timed_front(square, (0, 0), (1, 1), crossing, 5).F[:, 0].min() == 2
    following = Trajectories([[(0, 1), (1, 0)]], after="gone")
    assert exact_timed_front(square, (0, 0), (1, 1), following, 5).F[:, 0].min() == 2


def test_a_bound_is_no_proof():
    lane = OccupancyGrid(np.zeros((1, 5)))
    standing = Trajectories([[(2, 0)]])
    found = exact_timed_front(lane, (0, 0), (4, 0), standing, 8)
    assert not found.complete and found.message == "gave up at the horizon, tick 8: no path arrives by then"
    gone = exact_timed_front(lane, (0, 0), (4, 0), Trajectories([[(2, 0)]], after="gone"), 8)
    assert gone.complete and gone.F[0, :2].tolist() == [4.0, 4.0]
    early = exact_timed_front(lane, (0, 0), (4, 0), standing, 8, budget=Budget(max_labels=3))
    assert not early.complete and early.message.startswith("gave up, the budget of 3 labels")


def test_states_of_obstacles():
    numpys = Trajectories([{np.int64(1): (0, 0), np.int32(2): (1, 1)}], before="absent", after="gone")
    assert numpys.cells(3)[:, 0].tolist() == [[-9, -9], [0, 0], [1, 1], [-9, -9]]
    assert Trajectories([{1: (0, 0), 2: (1, 1)}]).cells(3)[:, 0].tolist() == [[0, 0], [0, 0], [1, 1], [1, 1]]
    for wrong, message in (
        ([{0: (0, 0), 2: (1, 1)}], "no state at tick 1"),
        ([{1.5: (0, 0)}], "a tick of mover 0 is 1.5"),
        ([{0: (0, 0), 1: (2, 0)}], "at most one cell a tick"),
        ([[]], "no state"),
        ([[(0.5, 0)]], "whole numbers"),
    ):
        with pytest.raises(GridPathError, match=message):
            Trajectories(wrong)
