"""Terrains and routes against shortest paths of scipy."""

import gc
import weakref
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from queries import SPIRAL, queries
from scipy import sparse
from scipy.sparse import csgraph

from pymoo_gridpath.fields import obstacle_potential
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.representations import make_representation
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.route import NOWHERE, block_noise, find_route, last_reached, least_rest, make_work, unwind, work_for
from pymoo_gridpath.search.shortest import UNREACHABLE
from pymoo_gridpath.search.terrain import LARGEST_COST, make_terrain, plain_terrain, steps_through

EVERYWHERE = 10**6


def terrain_of(query, name, n_fields=1):
    grid, start, goal, axis, rng = query
    moves = make_representation(name, grid, start, goal, "auto" if name == "cells" else axis).moves
    fields = [rng.random(grid.shape) * 10 ** rng.uniform(-3, 3) for _ in range(n_fields)]
    return make_terrain(moves, moves.index(start), moves.index(goal), fields)


def graph_of(terrain, weight, noise=(0, 0, 0), box=None):
    """The terrain's steps and what they cost, built step by step."""
    n, width = len(terrain.legal), terrain.width
    tails, heads, costs = [], [], []
    for cell in range(n):
        for m in range(8):
            if terrain.legal[cell] >> m & 1:
                other = int(cell + terrain.offsets[m])
                x, y = other % width, other // width
                if box and not (box[0] <= x <= box[1] and box[2] <= y <= box[3]):
                    continue
                cost = int(weight[0]) * (terrain.diagonal if m % 2 else terrain.straight)
                cost += sum(int(w) * int(c) for w, c in zip(weight[1:], terrain.fields[other], strict=True))
                if noise[0]:
                    cost += (cost * noise[0] >> 10) * int(block_noise(x >> noise[1], y >> noise[1], noise[2])) >> 10
                tails.append(cell)
                heads.append(other)
                costs.append(cost)
    ends = np.array([tails, heads], dtype=np.int32)  # what csgraph takes before scipy 1.15
    return sparse.csr_array((np.array(costs, dtype=float), tuple(ends)), shape=(n, n))


def cost_of(graph, cells):
    return sum(graph[a, b] for a, b in pairwise(cells))


@settings(max_examples=50)
@given(queries(), st.sampled_from(["cells", "integer"]), st.integers(0, 2))
def test_bounds_are_shortest_paths_from_the_start_and_to_the_goal(query, name, n_fields):
    terrain = terrain_of(query, name, n_fields)
    assert terrain.n_terms == n_fields + 1 and terrain.useful[[terrain.start, terrain.goal]].all()
    assert max(terrain.diagonal, terrain.fields.max(initial=0)) <= LARGEST_COST + 1
    for k, weight in enumerate(np.eye(n_fields + 1, dtype=int)):
        graph = graph_of(terrain, weight)
        graph.data += 1e-6  # scipy takes a step that costs nothing for none
        for column, costs in (
            (2 * k, csgraph.dijkstra(graph.T, indices=terrain.goal)),
            (2 * k + 1, csgraph.dijkstra(graph, indices=terrain.start)),
        ):
            found = terrain.bounds[terrain.useful, column]
            assert found == pytest.approx(costs[terrain.useful], abs=0.01)
            assert (terrain.bounds[~terrain.useful, column] == UNREACHABLE).all()


def test_a_terrain_leaves_out_dead_ends_of_monotone_paths():
    occupied = np.zeros((3, 5), dtype=bool)
    occupied[1, 3] = occupied[2, 3] = occupied[1, 4] = True
    moves = make_representation("integer", SPIRAL.replace(occupied=occupied), (0, 0), (4, 0)).moves
    terrain = plain_terrain(moves, 0, 4)
    assert plain_terrain(moves, 0, 4) is terrain
    assert np.flatnonzero(~terrain.useful).tolist() == [8, 9, 13, 14]
    # From the right of the wall nothing leads back to it.
    assert terrain.legal[3] >> 2 & 1 == 0


def test_terms_have_comparable_ranges():
    rng = np.random.default_rng(0)
    grid = SPIRAL.replace(occupied=rng.random((40, 40)) < 0.2)
    moves = Moves(grid)
    cells = np.flatnonzero(grid.regions == grid.regions[20, 20])
    ends = int(cells[0]), int(cells[-1])
    field = rng.random(grid.shape)
    small, large = (make_terrain(moves, *ends, [scale * field]) for scale in (1e-3, 1e3))
    assert small.straight == pytest.approx(large.straight, rel=1e-5)
    assert small.fields == pytest.approx(large.fields, rel=1e-5, abs=2)


def banded(dear):
    """A field of random costs with a band of dear cells up to one gap at the top, and its terrain."""
    field = np.random.default_rng(0).random((40, 40))
    field[:36, 18:20] = dear
    moves = Moves(SPIRAL.replace(occupied=np.zeros((40, 40))))
    return field, make_terrain(moves, 0, 39, [field])


def test_prohibitive_costs_leave_the_others_their_range():
    field, terrain = banded(1e12)
    ordinary = field.ravel() < 1
    assert len(np.unique(terrain.fields[ordinary, 0])) > 1400
    # A dear cell still costs no less than the whole cheapest path, but not much more.
    dear = terrain.fields[~ordinary, 0]
    assert np.ptp(dear) == 0 and terrain.bounds[0, 2] <= dear[0] < 1.5 * terrain.bounds[0, 2]
    with np.errstate(divide="ignore"):
        ratio = terrain.fields[ordinary, 0] / field.ravel()[ordinary]
    assert ratio == pytest.approx(ratio.mean(), rel=0.01)
    for other in (1e6, 1e20, np.inf, np.nan):
        assert banded(other)[1].fields == pytest.approx(terrain.fields, rel=1e-5, abs=2)


def test_steep_fields_are_no_prohibitions():
    occupied = np.zeros((30, 50), dtype=bool)
    occupied[15, 25] = True
    grid = SPIRAL.replace(occupied=occupied)
    field = obstacle_potential(grid)
    terrain = make_terrain(Moves(grid), 15 * 50, 15 * 50 + 49, [field])
    dearest = terrain.fields[14 * 50 + 25, 0]
    assert terrain.fields[14 * 50 + 24, 0] == pytest.approx(np.exp(-1) * dearest, rel=1e-3)


def test_negative_costs_are_raised_by_the_least_of_the_cells_that_paths_visit():
    occupied = np.zeros((5, 7), dtype=bool)
    occupied[:, 5] = True
    moves = Moves(SPIRAL.replace(occupied=occupied))
    field = np.random.default_rng(1).random((5, 7))
    below = field - 3.0
    below[:, 5:] = -99.0, np.inf
    below[2, 2] = -3.0
    field[2, 2] = 0.0
    for shifted in (below, np.where(occupied, np.nan, below)):
        terrain, same = (make_terrain(moves, 0, 4, [values]) for values in (shifted, field))
        useful = terrain.useful
        assert terrain.fields[useful, 0].min() == 0
        assert terrain.fields[useful] == pytest.approx(same.fields[useful], rel=1e-6, abs=2)


@settings(max_examples=30)
@given(queries(), st.sampled_from(["cells", "integer"]))
def test_fewest_steps_through_cells(query, name):
    grid, start, goal, axis, _ = query
    moves = make_representation(name, grid, start, goal, "auto" if name == "cells" else axis).moves
    terrain = plain_terrain(moves, moves.index(start), moves.index(goal))
    graph = graph_of(terrain, [1])
    graph.data[:] = 1.0
    there, back = (csgraph.dijkstra(g, indices=i) for g, i in ((graph, terrain.start), (graph.T, terrain.goal)))
    steps = steps_through(moves, terrain.start, terrain.goal)
    assert np.array_equal(steps[terrain.useful], (there + back)[terrain.useful])
    assert (steps[~terrain.useful] >= UNREACHABLE).all()


@settings(max_examples=60)
@given(queries(), st.sampled_from(["cells", "integer"]), st.booleans())
def test_routes_are_cheapest(query, name, noisy):
    terrain, rng = terrain_of(query, name), query[-1]
    work = make_work(terrain)
    useful = np.flatnonzero(terrain.useful)
    for _ in range(10):
        weight = rng.integers(1, 1025, 2)
        noise = np.array([rng.integers(1, 8000), rng.integers(0, 4), rng.integers(0, 2**31)]) * noisy
        source, target = (int(cell) for cell in rng.choice(useful, 2))
        margin = int(rng.choice([0, 1, EVERYWHERE]))
        (sx, sy), (tx, ty) = (divmod(cell, terrain.width)[::-1] for cell in (source, target))
        box = min(sx, tx) - margin, max(sx, tx) + margin, min(sy, ty) - margin, max(sy, ty) + margin
        graph = graph_of(terrain, weight, [int(v) for v in noise], box)
        least = csgraph.dijkstra(graph, indices=source)[target]
        found = find_route(terrain, work, source, target, weight, noise, margin, EVERYWHERE)
        assert found == np.isfinite(least)
        if found:
            path, n = unwind(terrain, work, source, target, np.array([source]), 1)
            assert path[0] == source and path[n - 1] == target
            assert cost_of(graph, path[:n].tolist()) == least


def test_a_search_for_all_cells_finds_cheapest_routes_to_all():
    rng = np.random.default_rng(5)
    terrain = terrain_of((SPIRAL.replace(occupied=np.zeros((7, 9))), (0, 0), (8, 6), "auto", rng), "cells")
    work, weight, noise = make_work(terrain), np.array([300, 700]), np.array([4000, 1, 77])
    find_route(terrain, work, terrain.start, NOWHERE, weight, noise, EVERYWHERE, EVERYWHERE)
    graph = graph_of(terrain, weight, noise.tolist())
    assert np.array_equal(work.cost, csgraph.dijkstra(graph, indices=terrain.start))


@settings(max_examples=30)
@given(queries(), st.sampled_from(["cells", "integer"]))
def test_the_bound_of_the_rest_is_consistent(query, name):
    terrain, rng = terrain_of(query, name, 2), query[-1]
    weight = rng.integers(1, 1025, 3)
    target = int(rng.choice(np.flatnonzero(terrain.useful)))

    def rest(cell):
        (x, y), (tx, ty) = (divmod(c, terrain.width)[::-1] for c in (cell, target))
        return least_rest(terrain, weight, cell, target, abs(tx - x), abs(ty - y))

    graph = graph_of(terrain, weight).tocoo()
    assert rest(target) == 0
    for a, b, cost in zip(graph.row, graph.col, graph.data, strict=True):
        assert rest(int(a)) <= cost + rest(int(b))


def test_searches_give_up_at_their_limit_and_at_walls():
    moves = Moves(SPIRAL.replace(occupied=np.zeros((20, 20))))
    terrain = plain_terrain(moves, 0, 399)
    work, weight, none = make_work(terrain), np.array([1024]), np.zeros(3, dtype=np.int64)
    assert find_route(terrain, work, 0, 399, weight, none, EVERYWHERE, 30)
    assert not find_route(terrain, work, 0, 399, weight, none, EVERYWHERE, 10)
    wall = np.zeros((5, 5))
    wall[:4, 2] = 1
    terrain = plain_terrain(Moves(SPIRAL.replace(occupied=wall)), 0, 4)
    assert not find_route(terrain, work, 0, 4, weight, none, 3, EVERYWHERE)
    assert find_route(terrain, work, 0, 4, weight, none, 4, EVERYWHERE)
    assert not find_route(terrain, work, 0, 7, weight, none, 4, EVERYWHERE), "an occupied cell"


@settings(max_examples=40)
@given(queries(), st.sampled_from(["cells", "integer"]), st.booleans())
def test_a_search_that_is_given_up_knows_how_far_along_a_path_it_has_come(query, name, noisy):
    terrain, rng = terrain_of(query, name), query[-1]
    work, weight = make_work(terrain), rng.integers(1, 1025, 2)
    noise = np.array([rng.integers(1, 8000), rng.integers(0, 4), rng.integers(0, 2**31)]) * noisy
    # A path to be changed: the cheapest for other weights.
    assert find_route(terrain, work, terrain.start, terrain.goal, np.array([1, 1024]), 0 * noise, EVERYWHERE, EVERYWHERE)
    path, n = unwind(terrain, work, terrain.start, terrain.goal, np.array([terrain.start]), 1)
    least = csgraph.dijkstra(graph_of(terrain, weight, [int(v) for v in noise]), indices=terrain.start)
    reached = []
    for limit in range(terrain.useful.sum()):
        if find_route(terrain, work, terrain.start, terrain.goal, weight, noise, EVERYWHERE, limit):
            break
        reached.append(last_reached(terrain, work, path, 0, n - 1, weight))
        assert 0 <= reached[-1] < n - 1
        if reached[-1]:
            cell = int(path[reached[-1]])
            found, m = unwind(terrain, work, terrain.start, cell, np.array([terrain.start]), 1)
            assert found[m - 1] == cell and work.cost[cell] == least[cell]
    # The longer it goes on, the farther it comes.
    assert reached == sorted(reached) and (not reached or reached[0] == 0)


def test_a_route_that_is_barred_by_the_margin_leads_as_far_as_the_wall_lets_it():
    wall = np.zeros((5, 5))
    wall[:4, 2] = 1
    terrain = plain_terrain(Moves(SPIRAL.replace(occupied=wall)), 0, 4)
    work, weight, none = make_work(terrain), np.array([1024]), np.zeros(3, dtype=np.int64)
    path = np.array([0, 6, 11, 16, 22, 18, 13, 8, 4])
    assert not find_route(terrain, work, 0, 4, weight, none, 3, EVERYWHERE)
    assert last_reached(terrain, work, path, 0, 8, weight) == 3


def test_noise_is_even():
    x, y = np.meshgrid(np.arange(60), np.arange(60))
    for seed in (0, 1, 2**31 - 1):
        values = np.array([block_noise(a, b, seed) for a, b in zip(x.ravel().tolist(), y.ravel().tolist(), strict=True)])
        assert values.min() >= 0 and values.max() <= 1023
        assert values.mean() == pytest.approx(511.5, abs=25)
        assert values.std() == pytest.approx(1024 / 12**0.5, rel=0.05)
        grid = values.reshape(60, 60)
        for neighbour in (grid[1:, :-1], grid[:-1, 1:]):
            assert abs(np.corrcoef(grid[:-1, :-1].ravel(), neighbour.ravel())[0, 1]) < 0.06


def test_working_arrays_are_lent_to_one_at_a_time_and_go_with_their_terrain():
    grid = OccupancyGrid(np.zeros((4, 5)))
    terrain = make_terrain(Moves(grid), 0, 19)
    with work_for(terrain) as work, work_for(terrain) as other:
        assert work is not other and len(work.cost) == len(other.cost) == 20
        firsts = work, other
    with work_for(terrain) as work:
        assert any(work is first for first in firsts)
    with pytest.raises(ZeroDivisionError), work_for(terrain) as broken:
        raise ZeroDivisionError
    with work_for(terrain) as work, work_for(terrain) as other:
        assert work is not broken and other is not broken
    gone = weakref.ref(work.cost)
    del terrain, work, other, firsts, broken
    gc.collect()
    assert gone() is None
