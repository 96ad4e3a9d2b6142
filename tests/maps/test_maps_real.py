"""Real maps, from a folder that is not part of the repository."""

from __future__ import annotations

import numpy as np
import pytest
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.decision import TradeOffSet
from pymoo_gridpath.maps import load_map, read_movingai, read_scen


@pytest.mark.parametrize(
    ("name", "entries", "tried"),
    [
        ("arena", 160, 160),
        ("lak304d", 773, 773),
        ("random-64-64-20", 220, 220),
        ("warehouse-10-20-10-2-1", 450, 450),
        ("random512-10-0", 1670, 167),
    ],
)
def test_shortest_paths_are_as_long_as_the_benchmark_says(shared_data, name, entries, tried):
    path = shared_data / "movingai" / f"{name}.map"
    grid = read_movingai(path)
    queries = read_scen(f"{path}.scen", grid)
    assert len(queries) == entries
    chosen = [queries[k] for k in np.linspace(0, entries - 1, tried).astype(int)]
    found = []
    for query in chosen:
        lengths = grid.shortest_lengths(query.start, limit=query.optimal_length + 1)
        found.append(lengths[query.goal[1], query.goal[0]])
    np.testing.assert_allclose(found, [query.optimal_length for query in chosen], rtol=0, atol=1e-3)


def test_a_map_read_upside_down_would_be_noticed(shared_data):
    path = shared_data / "movingai" / "random-64-64-20.map"
    grid = read_movingai(path)
    upside_down = grid.replace(occupied=grid.occupied[::-1])
    wrong = 0
    for query in read_scen(f"{path}.scen", grid):
        reached = upside_down.is_free(query.start) and upside_down.shortest_lengths(query.start)[query.goal[1], query.goal[0]]
        wrong += abs(reached - query.optimal_length) > 1e-3
    assert wrong > 100


@pytest.mark.parametrize("name", ["arena", "random512-10-0"])
def test_cells_are_the_letters_of_the_file(shared_data, name):
    path = shared_data / "movingai" / f"{name}.map"
    rows = path.read_text().split("\n")[4:]
    grid = load_map(path)
    assert grid.n_occupied == sum(row.count(letter) for row in rows for letter in "@T")
    for x, y in [(0, 0), (7, 3), (20, 30), (grid.width - 1, grid.height - 1)]:
        assert grid.is_free((x, y)) == (rows[grid.height - 1 - y][x] == ".")


@pytest.mark.parametrize(
    ("name", "width", "height", "origin", "occupied_thresh", "free_thresh"),
    [("depot", 604, 307, (0, 0, 0), 0.65, 0.25), ("tb3_sandbox", 384, 384, (-10, -10, 0), 0.65, 0.196)],
)
def test_ros_maps(shared_data, name, width, height, origin, occupied_thresh, free_thresh):
    data = (shared_data / "ros" / f"{name}.pgm").read_bytes()
    shade = np.frombuffer(data[-width * height :], np.uint8).reshape(height, width)[::-1].astype(int)
    dark = 255 - shade >= 255 * occupied_thresh
    light = 255 - shade <= 255 * free_thresh
    path = shared_data / "ros" / f"{name}.yaml"
    strict, lax = load_map(path), load_map(path, unknown="free")
    assert (strict.width, strict.height, strict.resolution, strict.origin) == (width, height, 0.05, origin)
    assert np.array_equal(strict.occupied, ~light) and np.array_equal(lax.occupied, dark)
    assert 0 < lax.n_occupied < 0.2 * lax.occupied.size


def test_the_default_coding_finds_the_shortest_path_through_the_depot(shared_data):
    grid = load_map(shared_data / "ros" / "depot.yaml").inflate(0.3)
    problem = GridPathProblem(grid, (50, 62), (560, 260))
    result = minimize(problem, make_algorithm("NSGA-II", problem, pop_size=40), ("n_gen", 3), seed=1)
    found = TradeOffSet.from_results(result)
    assert found.shortest.length == pytest.approx(592.0, abs=0.05)
    assert found.shortest.length == pytest.approx(found.least_length) and found.advice == ""
