"""The occupancy grid: its errors, cells, metres, regions, inflation and move graph."""

import copy
import heapq
import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pymoo_gridpath.errors import GridError, GridPathWarning, UnreachableError
from pymoo_gridpath.grid import Box, OccupancyGrid, inflation
from pymoo_gridpath.grid.inflation import disc_of


def random_grid(seed, shape=(7, 9), density=0.35, corner_cutting=False):
    occupied = np.random.default_rng(seed).random(shape) < density
    occupied[0, 0] = occupied[-1, -1] = False
    return OccupancyGrid(occupied, corner_cutting=corner_cutting)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"occupied": [0, 1]}, "two-dimensional array of occupied cells, got 1 dimension"),
        ({"occupied": np.zeros((0, 3))}, r"at least one cell, got an array of shape \(0, 3\)"),
        ({"occupied": [[0, 2]]}, "got other values"),
        ({"occupied": [["a", "b"]]}, "expected a two-dimensional array of booleans"),
        ({"occupied": [[math.nan, 0.0]]}, "got other values"),
        ({"occupied": [[0]], "resolution": 0}, "resolution is 0, expected a positive number"),
        ({"occupied": [[0]], "resolution": math.nan}, "resolution is nan"),
        ({"occupied": [[0]], "resolution": "wide"}, "resolution is 'wide'"),
        ({"occupied": [[0]], "origin": (1,)}, "origin is"),
        ({"occupied": [[0]], "origin": (0, math.inf, 0)}, "origin is"),
        ({"occupied": [[0]], "origin": "here"}, "origin is"),
        ({"occupied": [[0]], "origin": (0, 0, 1)}, r"origin is \(0, 0, 1\), in metres, and no resolution is given"),
    ],
)
def test_bad_arguments_are_refused_in_words(arguments, message):
    with pytest.raises(GridError, match=message):
        OccupancyGrid(**arguments)


def test_grid_is_immutable_and_owns_its_array():
    source = np.zeros((3, 4), dtype=bool)
    grid = OccupancyGrid(source)
    source[0, 0] = True
    assert grid.n_occupied == 0
    with pytest.raises(ValueError, match="read-only"):
        grid.occupied[0, 0] = True
    with pytest.raises(AttributeError):
        grid.resolution = 2.0  # pyright: ignore


@pytest.mark.parametrize("clone", [copy.deepcopy, copy.copy, lambda g: pickle.loads(pickle.dumps(g))])
@pytest.mark.parametrize("place", [(0.5, (1, 2, 0.3)), (None, (0, 0))])
def test_copies_are_equal_and_still_immutable(clone, place):
    grid = OccupancyGrid([[0, 1]], *place, True, "a")
    other = clone(grid)
    assert other == grid and hash(other) == hash(grid)
    assert not other.occupied.flags.writeable
    assert other.resolution == place[0] and other != grid.replace(resolution=7.0)
    assert other != grid.replace(name="b") and other != grid.replace(occupied=[[1, 1]])


def test_replace_knows_its_arguments():
    grid = OccupancyGrid([[0, 1]])
    assert grid.replace(resolution=2.0).resolution == 2.0
    with pytest.raises(TypeError, match="no argument 'resolutoin'"):
        grid.replace(resolutoin=2.0)


def test_cells_are_checked_and_the_nearest_free_cell_is_named():
    grid = OccupancyGrid([[1, 1, 0], [1, 1, 1], [0, 1, 1]], name="demo")
    assert grid.check_cell((2, 0)) == (2, 0)
    assert grid.check_cell(np.array([2, 0])) == (2, 0)
    with pytest.raises(
        GridError, match=r"start \(0, 1\) lies on an obstacle of the grid 'demo'; the nearest free cell is \(0, 2\)"
    ):
        grid.check_cell((0, 1), "start")
    with pytest.raises(GridError, match=r"goal \(9, -1\) lies outside .* 3 x 3 cells .* nearest free cell is \(2, 0\)"):
        grid.check_cell((9, -1), "goal")
    for bad in ((1.5, 0), (1,), "ab", None, (math.nan, 0), (math.inf, 0), (1, 2, 3)):
        with pytest.raises(GridError, match="expected a cell"):
            grid.check_cell(bad)
    with pytest.raises(GridError, match="no free cell"):
        OccupancyGrid([[1]]).check_cell((0, 0))


@given(st.integers(0, 10**6), st.integers(-5, 14), st.integers(-5, 12))
def test_nearest_free_cell_is_nearest(seed, x, y):
    grid = random_grid(seed)
    near = grid.nearest_free((x, y))
    free = [(a, b) for b in range(grid.height) for a in range(grid.width) if not grid.occupied[b, a]]
    assert near in free
    assert math.dist(near, (x, y)) == min(math.dist(cell, (x, y)) for cell in free)


def test_queries_need_a_path():
    grid = OccupancyGrid([[0, 1, 0], [0, 1, 0]])
    with pytest.raises(UnreachableError, match=r"goal \(2, 1\) cannot be reached from start \(0, 0\)"):
        grid.check_query((0, 0), (2, 1))
    with pytest.raises(GridError, match="same cell"):
        grid.check_query((0, 0), (0, 0))


def test_metres_and_back():
    grid = OccupancyGrid(np.zeros((4, 6)), resolution=0.5, origin=(10.0, 20.0))
    assert grid.to_metres((0, 0)).tolist() == [10.25, 20.25]
    turned = OccupancyGrid(np.zeros((4, 6)), resolution=0.5, origin=(10.0, 20.0, math.pi / 2))
    # A quarter turn to the left: the map's x axis points along the world's y axis.
    assert turned.to_metres((2, 0)) == pytest.approx([10.0 - 0.25, 20.0 + 1.25])
    cells = np.array([[0, 0], [5, 3], [2, 1]])
    for g in (grid, turned, grid.replace(origin=(1, 2, 0.7))):
        assert g.to_cells(g.to_metres(cells)).tolist() == cells.tolist()


def plain_dijkstra(grid, start):
    """Shortest lengths by a heap and the rules in words."""
    best, heap = {start: 0.0}, [(0.0, start)]
    while heap:
        d, (x, y) = heapq.heappop(heap)
        if d > best[x, y]:
            continue
        for dx in (-1, 0, 1):
            for dy in (-1, 0, 1):
                cell = (x + dx, y + dy)
                if (dx, dy) == (0, 0) or not grid.is_free(cell):
                    continue
                if dx and dy and not grid.corner_cutting and not (grid.is_free((x + dx, y)) and grid.is_free((x, y + dy))):
                    continue
                new = d + math.hypot(dx, dy)
                if new < best.get(cell, math.inf) - 1e-12:
                    best[cell] = new
                    heapq.heappush(heap, (new, cell))
    return best


@given(st.integers(0, 10**6), st.booleans())
def test_shortest_lengths_and_regions_agree_with_a_plain_search(seed, corner_cutting):
    grid = random_grid(seed, corner_cutting=corner_cutting)
    expected = plain_dijkstra(grid, (0, 0))
    lengths = grid.shortest_lengths((0, 0))
    for y in range(grid.height):
        for x in range(grid.width):
            assert lengths[y, x] == pytest.approx(expected.get((x, y), math.inf))
            if grid.is_free((x, y)):
                assert grid.shortest_length((0, 0), (x, y)) == lengths[y, x]
            reached = grid.regions[y, x] == grid.regions[0, 0] and not grid.occupied[y, x]
            assert reached == ((x, y) in expected)


@pytest.mark.filterwarnings("ignore:the robot radius")
@given(st.integers(0, 10**6), st.floats(0, 4), st.sampled_from([0.5, 1.0, 2.0]))
def test_inflation_occupies_what_a_disc_would_touch(seed, radius, resolution):
    grid = random_grid(seed, density=0.1).replace(resolution=resolution)
    inflated = grid.inflate(radius)
    ys, xs = np.nonzero(grid.occupied)
    for y in range(grid.height):
        for x in range(grid.width):
            # Distance from the centre to the nearest point of each occupied square, in metres.
            gaps = np.hypot(np.maximum(abs(xs - x) - 0.5, 0), np.maximum(abs(ys - y) - 0.5, 0)) * resolution
            if len(gaps) and abs(gaps.min() - radius) < 1e-6:
                continue
            touched = bool(len(gaps)) and gaps.min() < radius
            assert inflated.occupied[y, x] == (grid.occupied[y, x] or touched)
    assert inflated.resolution == grid.resolution and inflated.name == grid.name


NEED_METRES = {
    "to_metres": lambda grid: grid.to_metres((0, 0)),
    "to_cells": lambda grid: grid.to_cells((0.5, 0.5)),
    "inflate": lambda grid: grid.inflate(0.3),
    "radius_in_cells": lambda grid: grid.radius_in_cells(0.3),
    "check_resolution": lambda grid: grid.check_resolution("a test"),
}


@pytest.mark.parametrize("call", NEED_METRES.values(), ids=NEED_METRES)
def test_a_map_in_cells_has_no_metres(call):
    grid = OccupancyGrid(np.zeros((4, 6)), name="field")
    said = "^the grid 'field' is in cells, and .* needs their size; expected a map that states its resolution, or one given in"
    with pytest.raises(GridError, match=said):
        call(grid)
    call(grid.replace(resolution=0.25))


def test_a_map_in_cells_stays_one():
    grid = OccupancyGrid(np.eye(6), name="field")
    stated = grid.replace(resolution=0.5, origin=(1, 2))
    for made in (grid, grid.crop(Box(1, 1, 4, 3)), grid.downsample(2), grid.grow(1.0), grid.inflate(0.0)):
        assert made.resolution is None and made.origin == (0.0, 0.0, 0.0)
    assert "m," not in repr(grid) and "of 0.5 m" in repr(stated)
    assert (grid.digest, grid.radius_in_cells(0)) == (stated.digest, 0.0)
    assert OccupancyGrid.from_occupancy([[0, 100]]).resolution is None


@pytest.mark.parametrize("radius", [0.6, 1.0, 3.7, 9.4])
def test_both_ways_to_grow_obstacles_agree(radius):
    for seed in range(5):
        occupied, disc = random_grid(seed, (6, 31), 0.05).occupied, disc_of(radius, 31)
        np.testing.assert_array_equal(inflation._by_rows(occupied, disc), inflation._by_convolution(occupied, disc))


def test_a_radius_in_cells():
    assert OccupancyGrid([[0] * 9], resolution=0.25).radius_in_cells(1.5) == 6.0
    assert OccupancyGrid([[0] * 9], resolution=1e-300).radius_in_cells(1e300) == 10.0, "as much as covers all"
    with pytest.raises(GridError, match="robot radius is -1, expected"):
        OccupancyGrid([[0, 0]]).radius_in_cells(-1)


@pytest.mark.parametrize("radius", [-0.1, math.nan, math.inf])
def test_inflation_refuses_bad_radii(radius):
    with pytest.raises(GridError, match="robot radius"):
        random_grid(0).inflate(radius)


@pytest.mark.parametrize(("radius", "grows"), [(0, True), (0.01, False), (0.25, False), (0.26, True)])
def test_a_radius_without_effect_is_said(radius, grows, recwarn):
    grid = OccupancyGrid([[0, 1, 0]], resolution=0.5, name="hall")
    assert (grid.inflate(radius).n_occupied == 3) == (grows and radius > 0)
    said = [str(item.message) for item in recwarn if item.category is GridPathWarning]
    assert len(said) == (not grows)
    assert all(f"{radius:g} m is at most half a cell of 'hall', 0.5 m wide" in text for text in said)


def test_read_only_cells_are_shared_and_all_others_copied():
    cells = np.array([[False, True, False], [False, False, True]])
    grid = OccupancyGrid(cells, unknown=cells)
    cells[0, 0] = True
    assert not grid.occupied[0, 0] and not grid.unknown[0, 0]
    kept = cells.copy()
    kept.flags.writeable = False
    assert OccupancyGrid(kept).occupied is kept and OccupancyGrid(kept, unknown=kept).unknown is kept
    for changed in (grid.replace(name="b"), grid.grow(1.0), grid.replace(occupied=kept)):
        assert changed.unknown is grid.unknown
    assert grid.replace(corner_cutting=True).occupied is grid.occupied
    # Whoever made the array behind a view may write into it, and numbers are no booleans.
    view, turned = cells[:], np.asfortranarray(cells)
    numbers = cells.astype(int)
    for other in (view, turned, numbers):
        other.flags.writeable = False
        own = OccupancyGrid(other).occupied
        assert own is not other and not np.shares_memory(own, other) and own.flags.c_contiguous
        np.testing.assert_array_equal(own, cells)


def test_unknown_cells_stay_with_the_grid_and_make_no_other_grid():
    unknown = np.array([[False, True, True], [False, False, False]])
    grid = OccupancyGrid([[0, 1, 0], [0, 0, 0]], unknown=unknown)
    plain = OccupancyGrid([[0, 1, 0], [0, 0, 0]])
    unknown[:] = True
    expected = [[False, True, True], [False, False, False]]
    for copied in (grid, grid.grow(1), grid.replace(name="b"), pickle.loads(pickle.dumps(grid)), copy.deepcopy(grid)):
        assert copied.unknown.tolist() == expected and not copied.unknown.flags.writeable
    assert plain.unknown is None and plain.grow(1).unknown is None and pickle.loads(pickle.dumps(plain)).unknown is None
    assert grid == plain and hash(grid) == hash(plain)
    assert grid.replace(occupied=[[0, 1]]).unknown is None
    with pytest.raises(GridError, match=r"unknown has the shape \(1, 2\), expected that of the grid, \(2, 3\)"):
        grid.replace(unknown=[[0, 1]])


WALLED = [  # rows from the bottom; the wall in the middle parts the map, and the ends of it are pockets
    [0, 0, 0, 1, 0, 0],
    [0, 0, 1, 1, 0, 1],
    [0, 0, 0, 1, 0, 0],
    [1, 0, 0, 1, 1, 0],
]


@pytest.mark.parametrize(
    ("start", "goal", "message"),
    [
        # (2, 2) is nearer or as near, but on the other side of the wall.
        (
            (3, 2),
            (5, 0),
            r"start \(3, 2\) lies on an obstacle .*; the nearest free cell that a path joins with \(5, 0\) is \(4, 2\)",
        ),
        ((3, 2), (0, 0), r"the nearest free cell that a path joins with \(0, 0\) is \(2, 2\)"),
        ((0, 0), (4, 3), r"goal \(4, 3\) .*; the nearest free cell that a path joins with \(0, 0\) is \(2, 3\)"),
        ((0, 0), (9, 0), r"goal \(9, 0\) lies outside .*; the nearest free cell that a path joins with \(0, 0\) is \(2, 0\)"),
        # If neither end will do, the nearest of all is as good.
        ((3, 2), (3, 0), r"start \(3, 2\) lies on an obstacle .*; the nearest free cell is \(2, 2\)"),
    ],
)
def test_the_hint_for_an_occupied_end_is_joined_with_the_other(start, goal, message):
    with pytest.raises(GridError, match=message):
        OccupancyGrid(WALLED).check_query(start, goal)


def test_an_end_that_is_walled_in_has_no_hint():
    grid = OccupancyGrid([[0, 1, 0], [1, 1, 0]])
    with pytest.raises(GridError, match=r"goal \(1, 0\) .*; there is no free cell that a path joins with \(0, 0\)"):
        grid.check_query((0, 0), (1, 0))
    assert grid.nearest_free((1, 0), joined_with=(2, 0)) == (2, 1)


def test_the_move_graph_has_indices_that_every_scipy_takes():
    """csgraph takes 32 bits alone before scipy 1.15."""
    graph = OccupancyGrid(np.zeros((3, 4))).move_graph()
    assert (graph.indices.dtype, graph.indptr.dtype) == (np.int32, np.int32)
