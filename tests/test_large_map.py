"""A large map of which little can be reached is planned on as the little part alone."""

from __future__ import annotations

import numpy as np
import pytest
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.decision import TradeOffSet
from pymoo_gridpath.errors import GridError, GridPathError
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.fields import clearance, obstacle_potential
from pymoo_gridpath.grid import Box
from pymoo_gridpath.objectives import Objective, Vulnerability
from pymoo_gridpath.operators import path_operators
from pymoo_gridpath.paths import CellPaths
from pymoo_gridpath.plotting import plot_paths

SIZE, X0, Y0 = 400, 230, 90
N = 50
START, GOAL = (13, 14), (34, 36)


def room() -> np.ndarray:
    """Return a room of 28 x 28 cells with obstacles in it, and walls around it so thick that it feels nothing beyond."""
    occupied = np.random.default_rng(4).random((28, 28)) < 0.12
    occupied[1:5, 1:5] = occupied[23:27, 21:25] = False
    return np.pad(occupied, 11, constant_values=True)


def pair(corner_cutting: bool = False) -> tuple[OccupancyGrid, OccupancyGrid]:
    """Return the room, and a map of 400 x 400 cells that holds it, two other rooms and nothing else that is free."""
    small = OccupancyGrid(room(), resolution=0.05, origin=(1.0, 2.0, 0.3), corner_cutting=corner_cutting)
    occupied = np.ones((SIZE, SIZE), dtype=bool)
    occupied[Y0 : Y0 + N, X0 : X0 + N] = small.occupied
    occupied[5:9, 5:30] = occupied[350:380, 20:60] = False
    cos, sin = np.cos(0.3), np.sin(0.3)
    corner = 1.0 - 0.05 * (cos * X0 - sin * Y0), 2.0 - 0.05 * (sin * X0 + cos * Y0), 0.3
    return small, OccupancyGrid(occupied, resolution=0.05, origin=corner, corner_cutting=corner_cutting)


def moved(cell) -> tuple[int, int]:
    return cell[0] + X0, cell[1] + Y0


def cells_of(problem, X) -> list[np.ndarray]:
    paths = problem.decode(X)
    return [paths.cells(k) for k in range(len(X))]


class Safe(Vulnerability):
    """A class made from the vulnerability, with another field and name."""

    name = "safe"

    def field(self, grid):
        return 2.0 * obstacle_potential(grid, 1.0)


class Mud(Objective):
    """A cost that depends on where a cell lies in the room, wherever that lies."""

    name, label = "mud", "Mud"

    def field(self, grid):
        y, x = np.indices(grid.shape)
        return (((x - X0 * (grid.width > N)) * 7 + (y - Y0 * (grid.width > N)) * 3) % 5).astype(float)


@pytest.mark.parametrize("corner_cutting", [False, True])
@pytest.mark.parametrize("representation", ["cells", "integer", "absolute"])
@pytest.mark.parametrize(
    "objectives", [["length", "vulnerability"], ["length", "vulnerability", "turn"], ["length", Safe(), Mud()], ["turn"]]
)
def test_exact_fronts_and_paths_are_those_of_the_room_alone(representation, objectives, corner_cutting):
    small, large = pair(corner_cutting)
    one = GridPathProblem(small, START, GOAL, representation, objectives)
    other = GridPathProblem(large, moved(START), moved(GOAL), representation, objectives)
    assert other.representation.moves.n_cells <= 30 * 30
    assert other.n_var == one.n_var
    a, b = exact_front(one), exact_front(other)
    assert a.complete and b.complete and len(a.F) >= 1
    np.testing.assert_array_equal(a.F, b.F)
    for near, far in zip(cells_of(one, a.X), cells_of(other, b.X), strict=True):
        np.testing.assert_array_equal(near + moved((0, 0)), far)
    # What a score says is what the whole grid says.
    np.testing.assert_array_equal(other.evaluate(b.X).reshape(-1, other.n_obj), b.F)


def test_genes_are_cells_of_the_whole_grid_and_broken_rows_are_scored_by_it():
    _, large = pair()
    problem = GridPathProblem(large, moved(START), moved(GOAL), "cells")
    X = np.random.default_rng(1).integers(problem.xl, problem.xu + 1, (20, problem.n_var))
    assert problem.xu.max() == SIZE * SIZE - 1
    paths = CellPaths(large, problem.representation.genes(X))
    plain = np.column_stack([paths.length, paths.total(obstacle_potential(large).ravel())])
    np.testing.assert_array_equal(problem.evaluate(X), plain + 2.0 * paths.interfering_cells[:, None])
    repaired = problem.representation.repair(X, np.random.default_rng(1))
    assert (problem.decode(repaired).interfering_cells == 0).all()
    np.testing.assert_array_equal(problem.representation.encode(problem.decode(X[:3])), problem.representation.genes(X[:3]))


@pytest.mark.parametrize("representation", ["cells", "integer"])
def test_searches_find_legal_paths_of_the_whole_grid(representation):
    _, large = pair()
    problem = GridPathProblem(large, moved(START), moved(GOAL), representation)
    algorithm = make_algorithm("NSGA2", problem, pop_size=20, **path_operators(problem))
    trade_off = TradeOffSet.from_results(minimize(problem, algorithm, ("n_gen", 10), seed=1))
    assert trade_off.feasible
    whole = clearance(large)
    for record in trade_off:
        assert tuple(record.cells[0]) == moved(START) and tuple(record.cells[-1]) == moved(GOAL)
        assert not large.occupied[record.cells[:, 1], record.cells[:, 0]].any()
        assert record.clearance == whole[record.cells[:, 1], record.cells[:, 0]].min()


def test_the_figure_shows_the_room_at_its_place():
    _, large = pair()
    problem = GridPathProblem(large, moved(START), moved(GOAL), "cells")
    trade_off = TradeOffSet.from_genes(problem, exact_front(problem).X)
    ax = plot_paths(trade_off, units="cells")
    box = problem.representation.box
    assert (ax.get_xlim(), ax.get_ylim()) == ((box.x0 - 0.5, box.x1 - 0.5), (box.y0 - 0.5, box.y1 - 0.5))
    assert ax.get_images()[0].get_array().shape[:2] == box.shape
    np.testing.assert_array_equal(ax.lines[0].get_xydata()[0], moved(START))
    metres = plot_paths(trade_off, units="m")
    low, high = metres.get_xlim()
    x = large.to_metres(trade_off[0].cells)[:, 0]
    assert low < x.min() and x.max() < high < x.max() + 3.0


@pytest.mark.parametrize("corner_cutting", [False, True])
def test_what_is_worked_out_in_a_box_is_what_the_whole_has(corner_cutting):
    _, large = pair(corner_cutting)
    box = large.box_of(moved(START))
    assert box != large.whole
    for variance in (0.05, 0.5, 30.0):
        np.testing.assert_array_equal(obstacle_potential(large, variance, box), obstacle_potential(large, variance)[box.slices])
    reachable = large.regions == large.regions[moved(START)[::-1]]
    np.testing.assert_array_equal(clearance(large.crop(box))[reachable[box.slices]], clearance(large)[reachable])
    lengths = large.shortest_lengths(moved(START))
    assert np.isfinite(lengths[reachable]).all() and np.isinf(lengths[~reachable]).all()
    assert large.shortest_length(moved(START), moved(GOAL)) == lengths[moved(GOAL)[::-1]]
    assert large.shortest_length(moved(START), (10, 6)) == np.inf
    assert large._lengths_in(box, moved(START)).shape == box.shape
    part = large.crop(box)
    np.testing.assert_allclose(part.to_metres((2, 3)), large.to_metres((2 + box.x0, 3 + box.y0)))


@pytest.mark.parametrize("radius", [0.03, 0.06, 0.11])
def test_obstacles_grow_as_on_the_whole_grid(radius):
    small, large = pair()
    grown = large.inflate(radius)
    # A grid with a free corner at each end is grown as a whole.
    spread = large.occupied.copy()
    spread[0, 0] = spread[-1, -1] = False
    whole = OccupancyGrid(spread, resolution=0.05).inflate(radius).occupied
    np.testing.assert_array_equal(grown.occupied, whole)
    np.testing.assert_array_equal(grown.occupied[Y0 : Y0 + N, X0 : X0 + N], small.inflate(radius).occupied)


def test_grids_that_can_be_reached_are_worked_on_whole():
    open_grid = OccupancyGrid(np.zeros((300, 300)))
    assert open_grid.box_of((0, 0)) == open_grid.whole and open_grid.crop(open_grid.whole) is open_grid
    small, _ = pair()
    assert small.box_of(START) == small.whole


@pytest.mark.parametrize("box", [(0, 0, 0, 5), (0, 0, 401, 5), (-1, 0, 3, 5), (0, 0, 3), (0, 0, 3, 2.5), "all"])
def test_boxes_that_are_no_cells_of_the_grid_are_refused(box):
    _, large = pair()
    for use in (large.crop, lambda box: obstacle_potential(large, box=box), lambda box: Mud().field_in(large, box)):
        with pytest.raises(GridPathError, match=r"box is .*, expected a Box of cells of the grid of 400 x 400"):
            use(box)
    with pytest.raises(GridError, match=r"start \(400, 0\) lies outside the grid"):
        large.box_of((400, 0))
    assert large.crop(Box(0, 0, 3, 5)).shape == (5, 3)
