"""Waypoints against distances from all obstacles, one by one, at many points of a line; their points, headings and files."""

from __future__ import annotations

import csv
import math
from itertools import pairwise

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.errors import GridError, GridPathError
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.nearest import Nearest
from pymoo_gridpath.search.sight import visible
from pymoo_gridpath.search.smoother import Smoother
from pymoo_gridpath.search.waypoints import Waypoints
from pymoo_gridpath.testing.enumeration import RULES
from pymoo_gridpath.testing.reference import walk


def distances(occupied, points):
    """From every point to every square, the least of each."""
    ys, xs = np.nonzero(occupied)
    if not len(xs):
        return np.full(len(points), np.inf)
    beyond = np.maximum(np.abs(points[:, None] - np.stack([xs, ys], axis=1)) - 0.5, 0)
    return np.hypot(beyond[..., 0], beyond[..., 1]).min(axis=1)


def along(points, shares):
    """The points at some shares of the length of a line."""
    length = np.concatenate([[0], np.cumsum([math.dist(a, b) for a, b in pairwise(points)])])
    return np.stack([np.interp(shares * length[-1], length, np.array(points)[:, k]) for k in (0, 1)], axis=1)


def to_spare(grid, stretch, tolerance, shares):
    """By how much the line between the ends of a stretch is clearer than promised, at some shares of it."""
    occupied = grid.original.occupied
    if not occupied.any():
        return np.full(len(shares), np.inf)
    line = along([stretch[0], stretch[-1]], shares)
    path = distances(occupied, along(stretch, shares))
    # As clear as the path but for the tolerance, and wide enough for the robot if the path is.
    return distances(occupied, line) - np.maximum(path - tolerance, np.minimum(path, grid.growth) - 1 / 32)


@st.composite
def walks(draw):
    """A grid, a path on it that was not made to be short, and the cells that there were before obstacles grew."""
    shape = draw(st.integers(2, 14)), draw(st.integers(2, 14))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    grid = OccupancyGrid(rng.random(shape) < draw(st.sampled_from([0.02, 0.1, 0.25])), **draw(st.sampled_from(RULES)))
    grid = grid.grow(draw(st.sampled_from([0.0, 0.0, 0.6, 1.2, 1.5])))
    free = np.argwhere(~grid.occupied)[:, ::-1].tolist()
    if len(free) < 2:
        return grid, [tuple(free[0])] if free else None
    start, goal = (tuple(free[k]) for k in rng.choice(len(free), 2, replace=False))
    return grid, walk(grid, start, goal, rng)


@settings(max_examples=150, deadline=None)
@given(walks(), st.sampled_from([0.0, 0.1, 0.5, 2.0]))
def test_a_line_is_as_clear_as_the_path_was_there(grid_and_path, tolerance):
    grid, path = grid_and_path
    if path is None:
        return
    smoother, cells = Smoother(grid, path[0]), np.array(path)
    places = smoother.places(cells, tolerance)
    made = smoother.waypoints(cells, tolerance)
    assert np.array_equal(made.cells, cells[places]) and places[0] == 0 and places[-1] == len(cells) - 1
    assert made.length <= made.before.length + 1e-9
    moves = Moves(grid)
    shares = np.linspace(0, 1, 203)
    for i, j in pairwise(places):
        assert visible(moves, *(np.array([moves.index(cells[k])]) for k in (i, j))).all()
        assert (to_spare(grid, cells[i : j + 1], tolerance, shares) > -1e-9).all()
        # And no cell further on would have done, by more than what a test of points may lose.
        for k in range(j + 1, len(cells)):
            seen = visible(moves, *(np.array([moves.index(cells[at])]) for at in (i, k)))[0]
            lost = 1 / 64 + 2 * math.sqrt(2) * (k - i) / len(shares)
            assert not seen or to_spare(grid, cells[i : k + 1], tolerance, shares).min() < lost


def test_lines_of_sight_alone_would_come_nearer():
    """Without the promise the detour is gone, so that the test above can fail."""
    occupied = np.zeros((9, 15), dtype=bool)
    occupied[0, 5:10] = True
    detour = [*((x, 1 + x) for x in range(6)), *((x, 6) for x in range(6, 9)), *((x, 15 - x) for x in range(9, 15))]
    smoother = Smoother(OccupancyGrid(occupied), (0, 1))
    kept, cut = (smoother.waypoints(np.array(detour), tolerance) for tolerance in (None, math.inf))
    assert len(cut) == 2 and cut.clearance.least == 0.5
    assert len(kept) > 3 and kept.clearance.least > 3 and kept.length < kept.before.length
    shares = np.linspace(0, 1, 99)
    assert to_spare(OccupancyGrid(occupied), np.array(detour), 0.5, shares).min() < -3


@settings(max_examples=80, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_clearance_is_that_of_the_whole_line(seed):
    rng = np.random.default_rng(seed)
    occupied = rng.random(rng.integers(1, 12, 2)) < rng.choice([0.0, 0.05, 0.3])
    points = rng.uniform(-0.5, np.array(occupied.shape[::-1]) - 0.5, (rng.integers(1, 4), 2)).round(rng.integers(0, 3))
    nearest = Nearest(occupied)
    found = distances(occupied, points)
    np.testing.assert_allclose(nearest.distances(points), found, rtol=1e-12, atol=1e-12)
    line = along(points, np.linspace(0, 1, 4001)) if len(points) > 1 and np.ptp(points, axis=0).any() else points[:1]
    dense = distances(occupied, line)
    if not occupied.any():
        assert nearest.least(points) == nearest.mean(points) == math.inf
        return
    assert dense.min() - 0.01 <= nearest.least(points) <= dense.min() + 1e-9
    assert nearest.mean(points) == pytest.approx(dense.mean(), abs=0.02)


def test_a_slanted_corridor_has_no_stairs_left():
    """Where the safest path goes up step by step, the line does not."""
    x, y = np.meshgrid(np.arange(90), np.arange(50))
    grid = OccupancyGrid(np.abs(y - 5 - 0.42 * x) > 5, 0.05)
    path = np.array([(k, round(5 + 0.42 * k)) for k in range(90)])
    made = Smoother(grid, (0, 5)).waypoints(path)
    assert made.before.turn > 2000 and made.turn <= 45


def test_a_robot_is_measured_from_its_side():
    occupied = np.zeros((9, 30), dtype=bool)
    occupied[0] = True
    grid = OccupancyGrid(occupied, 0.1).inflate(0.2)
    made = Smoother(grid, (2, 5)).waypoints(np.array([(x, 5) for x in range(2, 20)]))
    assert made.clearance_m == pytest.approx((0.45 - 0.2,) * 2) and made.clearance == pytest.approx((2.5,) * 2)
    assert len(made) == 2 and str(made) == (
        "points 18 to 2, length 1.70 to 1.70 m, turn 0 to 0 degrees, least clearance 0.250 to 0.250 m, mean 0.250 to 0.250 m"
    )


def test_points_between_leave_the_line_and_its_corners():
    grid = OccupancyGrid(np.zeros((30, 30)), 0.1, (1.0, 2.0, 0.5))
    corners = Waypoints(grid, np.array([(0, 0), (10, 0), (13, 4), (13, 4), (29, 29)]))
    for spacing in (0.05, 0.25, 0.3, 7.0):
        made = corners.resampled(spacing)
        assert made.length == pytest.approx(corners.length) and made.turn == pytest.approx(corners.turn)
        legs = np.hypot(*np.diff(made.points, axis=0).T)
        assert legs.max() <= spacing + 1e-9
        assert {tuple(cell) for cell in corners.cells.tolist()} <= {tuple(cell) for cell in made.cells.tolist()}
        # No more than are needed.
        assert len(made) == 1 + sum(
            max(math.ceil(0.1 * math.dist(a, b) / spacing - 1e-9), 1) for a, b in pairwise(corners.cells)
        )
    assert np.array_equal(corners.resampled(7.0).points, corners.points)
    for wrong in (0.0, -1.0, math.nan, math.inf, "0.2", 1e-9):
        with pytest.raises(GridPathError, match="spacing"):
            corners.resampled(wrong)


def test_headings_are_those_of_metres():
    grid = OccupancyGrid(np.zeros((9, 9)), 0.5, (0.0, 0.0, math.radians(30)))
    made = Waypoints(grid, np.array([(0, 0), (4, 0), (4, 4), (4, 4), (0, 4)]))
    assert np.degrees(made.yaw) == pytest.approx([30, 120, 120, -150, -150])
    assert made.turn == pytest.approx(180)
    waits = Waypoints(grid, np.array([(1, 1), (1, 1), (1, 2)]))
    assert np.degrees(waits.yaw) == pytest.approx([120] * 3)
    assert Waypoints(grid, np.array([(3, 3)])).yaw.tolist() == [0.0]


@pytest.fixture
def line():
    grid = OccupancyGrid(np.zeros((40, 40)), 1e-6, (-1.5, 2e-7, 0.3))
    return Waypoints(grid, np.array([(0, 0), (3, 0), (9, 8), (30, 8)]))


def test_the_plain_file(line, tmp_path):
    with open(line.to_csv(tmp_path / "line.csv"), newline="") as file:
        rows = list(csv.DictReader(file))
    assert [[float(row["x"]), float(row["y"])] for row in rows] == line.points.tolist()
    assert [float(row["yaw"]) for row in rows] == line.yaw.tolist()


@pytest.mark.parametrize("store", [Stores.ROS2_HUMBLE, Stores.LATEST])
def test_a_library_of_ros_takes_the_path(line, tmp_path, store):
    """Not only the words are right: the message is made, written as bytes and read again."""
    types = get_typestore(store).types
    text = line.to_nav_path(tmp_path / "line.yaml", "m\u00e4p").read_text(encoding="utf-8")
    assert "&" not in text and "!" not in text
    found = yaml.safe_load(text)

    def header(value):
        return types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](**value["stamp"]), value["frame_id"])

    def pose(value):
        point = types["geometry_msgs/msg/Point"](**value["position"])
        return types["geometry_msgs/msg/Pose"](point, types["geometry_msgs/msg/Quaternion"](**value["orientation"]))

    stamped = types["geometry_msgs/msg/PoseStamped"]
    poses = [stamped(header(one["header"]), pose(one["pose"])) for one in found["poses"]]
    message = types["nav_msgs/msg/Path"](header(found["header"]), poses)
    typestore = get_typestore(store)
    again = typestore.deserialize_cdr(typestore.serialize_cdr(message, "nav_msgs/msg/Path"), "nav_msgs/msg/Path")
    assert again.header.frame_id == "m\u00e4p" and len(again.poses) == len(line)
    for one, (x, y), yaw in zip(again.poses, line.points, line.yaw, strict=True):
        turned = one.pose.orientation
        assert (one.pose.position.x, one.pose.position.y, one.pose.position.z) == (x, y, 0.0)
        assert (turned.x, turned.y) == (0.0, 0.0) and math.hypot(turned.z, turned.w) == pytest.approx(1)
        assert 2 * math.atan2(turned.z, turned.w) == pytest.approx(yaw)
        assert (one.header.frame_id, one.header.stamp.sec, one.header.stamp.nanosec) == ("m\u00e4p", 0, 0)


def test_a_racing_line(tmp_path):
    grid = OccupancyGrid(np.zeros((40, 40)), 0.1, (0.0, 0.0, -0.3))
    angles = np.linspace(0, 1.5, 31)
    circle = Waypoints(grid, 5 + 20 * np.stack([np.cos(angles), np.sin(angles)], axis=1))
    file = circle.to_f1tenth(tmp_path / "line.csv", speed=2.5)
    assert file.read_text().splitlines()[2] == "# s_m; x_m; y_m; psi_rad; kappa_radpm; vx_mps; ax_mps2"
    # Both ways in which readers do it.
    rows = np.loadtxt(file, delimiter=";", skiprows=3)
    np.testing.assert_array_equal(rows, np.loadtxt(file, delimiter=";"))
    s, x, y, psi, kappa, v, a = rows.T
    np.testing.assert_array_equal(np.stack([x, y], axis=1), circle.points)
    assert s[0] == 0 and s[-1] == pytest.approx(2.0 * 1.5, rel=1e-3) and s[-1] == pytest.approx(circle.length_m)
    np.testing.assert_allclose(np.exp(1j * psi), np.exp(1j * circle.yaw))
    assert psi.min() >= 0 and psi.max() < 2 * math.pi
    assert kappa[1:-1] == pytest.approx(0.5) and (kappa[[0, -1]] == 0).all()
    assert (v == 2.5).all() and (a == 0).all()
    back = Waypoints(grid, circle.cells[::-1]).to_f1tenth(tmp_path / "back.csv")
    assert np.loadtxt(back, delimiter=";")[1:-1, 4] == pytest.approx(-0.5)
    with pytest.raises(GridPathError, match="speed is -1, expected metres per second"):
        circle.to_f1tenth(tmp_path / "line.csv", speed=-1)


@pytest.mark.parametrize("tolerance", [-0.1, math.nan, "0.1", True])
def test_tolerances_that_are_none(tolerance):
    with pytest.raises(GridPathError, match=r"tolerance is .*expected a number of metres, zero or more"):
        Smoother(OccupancyGrid(np.zeros((3, 3)), 0.5), (0, 0)).waypoints(np.array([(0, 0), (1, 0)]), tolerance)


def test_paths_in_time_keep_their_cells():
    cells = np.array([(0, 0), (0, 0), (1, 1), (2, 1), (2, 1), (3, 1)])
    smoother = Smoother(OccupancyGrid(np.zeros((3, 5))), (0, 0), timed=True)
    made = smoother.waypoints(cells)
    assert np.array_equal(made.cells, cells) and made.length == made.before.length
    for given_ in ({"tolerance": 1.0}, {"spacing": 0.5}):
        with pytest.raises(GridPathError, match="is not for a path in time"):
            smoother.waypoints(cells, **given_)


def test_a_map_in_cells_has_cells(tmp_path):
    grid = OccupancyGrid(np.eye(12)[::-1] * (np.arange(12) > 6), None).grow(1.5)
    made = Smoother(grid, (0, 0)).waypoints(np.array([*((x, 0) for x in range(5)), *((4, y) for y in range(1, 4))]), 1.0, 0.75)
    assert made.points[0].tolist() == [0.0, 0.0] and made.points[-1].tolist() == [4.0, 3.0]
    assert np.hypot(*np.diff(made.points, axis=0).T).max() <= 0.75
    assert made.length_m is None and made.clearance_m is None and "cells, turn" in str(made)
    assert made.to_csv(tmp_path / "line.csv").read_text().startswith("x,y,yaw\n0.0,0.0,0.")
    for write in (made.to_nav_path, made.to_f1tenth):
        with pytest.raises(GridError, match="metres"):
            write(tmp_path / "line")
