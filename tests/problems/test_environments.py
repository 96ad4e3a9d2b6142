"""The stand-ins for the six environments of Rajchandar et al.: what their paper and the names say of them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import ndimage

from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.errors import GridError
from pymoo_gridpath.problems import SMALL_ENVIRONMENTS, small_environment


@pytest.mark.parametrize("name", SMALL_ENVIRONMENTS)
def test_environments_have_the_size_of_the_paper_and_a_path(name):
    for corner_cutting in (True, False):
        grid, start, goal = small_environment(name, corner_cutting)
        assert grid.shape == (10, 10) and grid.name == name and grid.corner_cutting == corner_cutting
        assert GridPathProblem(grid, start, goal, "cells").pareto_front() is not None
    # Without diagonal steps all is still joined.
    labels, _ = ndimage.label(~grid.occupied)
    assert labels[start[1], start[0]] == labels[goal[1], goal[0]] > 0


def test_environments_are_what_their_names_say():
    narrow = small_environment("narrow way")[0].occupied
    assert narrow.sum() == 9 and narrow.any(axis=0).sum() == 1
    # Each wall of the zigzag leaves a gap of two cells, on the right and the left in turn, from top to bottom.
    gaps = [np.flatnonzero(~row).tolist() for row in small_environment("zigzag")[0].occupied[::-1] if row.any()]
    assert gaps == [[8, 9], [0, 1], [8, 9], [0, 1]]
    # The spiral winds round its goal more than once: the way is over three times the map.
    assert small_environment("spiral")[0].shortest_length((0, 9), (3, 4)) == 50.0


def test_an_unknown_environment_is_refused_with_the_nearest():
    with pytest.raises(GridError, match=r"no environment 'zig-zag'; did you mean 'zigzag'"):
        small_environment("zig-zag")
