"""What a grid knows of its obstacles before they grew, and what a footprint keeps clear of."""

import copy
import math
import pickle
import warnings

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pymoo_gridpath.errors import GridError, GridPathWarning
from pymoo_gridpath.grid import Box, OccupancyGrid
from pymoo_gridpath.problems import MovingObstaclesProblem

UNGROWN = OccupancyGrid(
    np.array([[0, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 0, 0]]),
    resolution=0.5,
    origin=(1.0, -2.0, 0.3),
    name="hall",
    unknown=np.array([[1, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, 0, 0, 0]]),
)
GROWN = UNGROWN.inflate(0.4)
SQUARE = [(0.3, 0.2), (-0.3, 0.2), (-0.3, -0.2), (0.3, -0.2)]


def test_a_grid_that_did_not_grow_is_its_own_original():
    for grid in (UNGROWN, UNGROWN.inflate(0.0), UNGROWN.replace(name="b"), pickle.loads(pickle.dumps(UNGROWN))):
        assert grid.original is grid and grid.robot_radius == 0.0 and grid.footprint is None


@pytest.mark.parametrize("clone", [lambda grid: grid, copy.copy, copy.deepcopy, lambda grid: pickle.loads(pickle.dumps(grid))])
def test_the_original_is_kept(clone):
    grid = clone(GROWN)
    assert grid.original == UNGROWN and grid.n_occupied == 9 and grid.original.n_occupied == 1
    assert grid.robot_radius == 0.4 and grid.footprint is None
    assert (grid.original.unknown == UNGROWN.unknown).all() and not grid.original.occupied.flags.writeable


def test_what_grew_is_planned_on_and_known_by_its_own_cells():
    plain = UNGROWN.replace(occupied=GROWN.occupied)
    assert plain == GROWN and hash(GROWN) == hash(plain) and GROWN.digest == plain.digest != UNGROWN.digest
    assert plain.original is plain and plain.robot_radius == 0.0


def test_growing_twice_adds_up_and_leads_back_to_the_first():
    twice = GROWN.inflate(0.3)
    assert twice.original is UNGROWN and twice.robot_radius == pytest.approx(0.7)
    assert (twice.occupied >= GROWN.occupied).all() and twice.n_occupied > GROWN.n_occupied
    assert GROWN.grow(0.6).robot_radius == pytest.approx(0.4 + 0.6 * 0.5)
    again = UNGROWN.inflate(footprint=SQUARE).inflate(0.3)
    assert again.footprint is None and again.robot_radius == pytest.approx(math.hypot(0.3, 0.2) + 0.3)


def test_a_radius_that_grows_nothing_is_still_the_robots():
    with pytest.warns(GridPathWarning, match="no obstacle grows"):
        small = UNGROWN.inflate(0.1)
    assert small.original is UNGROWN and small.robot_radius == 0.1 and small.n_occupied == 1


def test_parts_and_larger_cells_have_their_own_original():
    part = GROWN.crop(Box(1, 1, 4, 4))
    assert part.original == UNGROWN.crop(Box(1, 1, 4, 4)) and part.robot_radius == 0.4
    assert part.original.to_metres((0, 0)) == pytest.approx(UNGROWN.to_metres((1, 1)))
    coarse = GROWN.downsample(2)
    assert coarse.original == UNGROWN.downsample(2) and coarse.robot_radius == 0.4 and coarse.resolution == 1.0


def test_replacing_changes_the_original_likewise():
    changes = {"name": "b", "origin": (0, 0, 1.0), "corner_cutting": True, "moves": 4}
    assert GROWN.replace(**changes).original == UNGROWN.replace(**changes)
    unseen = GROWN.replace(unknown=None)
    assert unseen.unknown is None and unseen.original.unknown is not None
    # The same cells of another size: what grew by one cell did so still.
    finer = UNGROWN.inflate(footprint=SQUARE).replace(resolution=0.25)
    assert finer.robot_radius == pytest.approx(math.hypot(0.15, 0.1)) and finer.original.resolution == 0.25
    assert np.allclose(finer.footprint, np.array(SQUARE) / 2)


def test_obstacles_that_move_stand_on_the_original_too():
    problem = MovingObstaclesProblem(GROWN, [[(4, 3), (4, 2)]], (0, 0), (4, 0))
    for still, cell in zip(problem.stills, [(4, 3), (4, 2)], strict=True):
        assert not still.grid.original.is_free(cell) and still.grid.original.n_occupied == 2
        assert still.grid.robot_radius == 0.4


def test_a_map_inflated_elsewhere_is_told_its_original():
    given_ = OccupancyGrid(GROWN.occupied, 0.5, (1.0, -2.0, 0.3)).grown_from(UNGROWN, 0.4)
    assert given_.original is UNGROWN and given_.robot_radius == 0.4
    assert given_.grown_from(GROWN, 0.9).original is UNGROWN
    for original, radius, message in [
        (UNGROWN.occupied, 0.1, "original is an array"),
        (UNGROWN, -1.0, "robot_radius is -1.0, expected metres, zero or more"),
        (UNGROWN.replace(resolution=1.0), 0.1, r"the original grid has the resolution 1.0, expected that of the grid, 0.5"),
        (UNGROWN.crop(Box(0, 0, 2, 2)), 0.1, "the original grid has the shape"),
        (
            UNGROWN.replace(occupied=np.ones((4, 5))),
            0.1,
            r"\(0, 0\) is occupied on the original grid and free on the grown one",
        ),
    ]:
        with pytest.raises(GridError, match=message):
            given_.grown_from(original, radius)


# -- footprints -----------------------------------------------------------------------------------------------------------


def overlaps(corners, square):
    """Whether the triangles about the first of a polygon's corners, which is convex, overlap a square: separating axes."""
    edges = np.roll(corners, -1, axis=0) - corners
    for nx, ny in [*np.stack([-edges[:, 1], edges[:, 0]], axis=1), (1.0, 0.0), (0.0, 1.0)]:
        mine, other = corners @ (nx, ny), square @ (nx, ny)
        if mine.max() <= other.min() + 1e-9 or other.max() <= mine.min() + 1e-9:
            return False
    return True


@given(
    st.integers(0, 2**32 - 1),
    st.lists(st.tuples(st.floats(0.05, 1.2), st.floats(0.0, 1.0)), min_size=3, max_size=5),
    st.sampled_from([0.2, 0.5]),
)
def test_no_heading_of_a_footprint_touches_an_obstacle(seed, spokes, resolution):
    """Around the origin, corners in the order of their angles; each triangle with the origin is convex."""
    rng = np.random.default_rng(seed)
    angles = 2 * math.pi * (np.arange(len(spokes)) + [0.8 * share for _, share in spokes]) / len(spokes)
    corners = np.array([radius for radius, _ in spokes])[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    occupied = np.zeros((9, 9), dtype=bool)
    occupied[tuple(rng.integers(0, 9, (2, 3)))] = True
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", GridPathWarning)
        grown = OccupancyGrid(occupied, resolution).inflate(footprint=corners)
    squares = [resolution * (np.array([(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)])) for y, x in np.argwhere(occupied)]
    free = np.argwhere(~grown.occupied)
    for y, x in free[rng.permutation(len(free))[:4]]:
        centre = resolution * (np.array([x, y]) + 0.5)
        for heading in rng.uniform(0, 2 * math.pi, 6):
            turn = np.array([[math.cos(heading), math.sin(heading)], [-math.sin(heading), math.cos(heading)]])
            turned = corners @ turn + centre
            for k in range(len(turned)):
                triangle = np.array([centre, turned[k], turned[(k + 1) % len(turned)]])
                assert not any(overlaps(triangle, square) for square in squares)
    # And no tighter than the farthest corner asks for.
    assert grown.robot_radius == pytest.approx(np.hypot(*corners.T).max())
    assert (grown.occupied == OccupancyGrid(occupied, resolution).grow(grown.robot_radius / resolution).occupied).all()


@pytest.mark.parametrize(
    "footprint", [[], [(0, 0), (1, 0)], [(1, 1)] * 3, [(0, 0), (1, math.nan), (1, 1)], "square", 3, [(0, 0, 0)] * 3, None]
)
def test_what_is_no_footprint_is_refused(footprint):
    if footprint is None:
        with pytest.raises(GridError, match=r"there are a radius of 0.2 and a footprint, expected one of them"):
            UNGROWN.inflate(0.2, SQUARE)
        return
    with pytest.raises(GridError, match=r"footprint .*expected the corners \(x, y\) of the robot in metres, three or more"):
        UNGROWN.inflate(footprint=footprint)
