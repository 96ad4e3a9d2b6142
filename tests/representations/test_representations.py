"""Properties of the monotone codings on any start, goal, grid and corner rule."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from queries import queries, random_genes

from pymoo_gridpath.errors import GridError, GridPathError, UnreachableError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.objectives import Vulnerability
from pymoo_gridpath.paths.frame import MonotoneFrame
from pymoo_gridpath.representations import make_representation
from pymoo_gridpath.testing import reference
from pymoo_gridpath.testing.enumeration import RULES

NAMES = ["absolute", "binary", "integer", "mixed", "sugihara-smith"]


@given(queries(), st.sampled_from(NAMES))
def test_every_row_decodes_to_a_monotone_path_from_start_to_goal(query, name):
    grid, start, goal, axis, rng = query
    coding = make_representation(name, grid, start, goal, axis)
    paths = coding.decode(random_genes(coding, rng))
    along = 0 if coding.frame.axis == "x" else 1
    for i in range(len(paths)):
        cells = paths.cells(i).tolist()
        assert tuple(cells[0]) == start and tuple(cells[-1]) == goal
        assert reference.is_connected(cells)
        assert all(grid.contains(cell) for cell in cells)
        steps = np.diff([cell[along] for cell in cells]) * np.sign(goal[along] - start[along])
        assert (steps >= 0).all()


@given(queries(density=0.4), st.sampled_from(NAMES))
def test_measures_equal_those_of_the_cells(query, name):
    grid, start, goal, axis, rng = query
    coding = make_representation(name, grid, start, goal, axis)
    paths = coding.decode(random_genes(coding, rng))
    objective = Vulnerability()
    vulnerability = objective(paths, objective.prepare(coding, grid))
    for i in range(len(paths)):
        cells = paths.cells(i).tolist()
        assert paths.length[i] == pytest.approx(reference.length(cells), abs=1e-9)
        assert paths.turn[i] == reference.turn(cells)
        assert paths.interfering_cells[i] == reference.interfering_cells(cells, grid)
        assert vulnerability[i] == pytest.approx(reference.vulnerability(cells, grid), abs=1e-6)
        assert paths.n_straight[i] + paths.n_diagonal[i] == len(cells) - 1


@pytest.mark.parametrize("size", [11, 12, 60, 200])
@pytest.mark.parametrize("steps", RULES, ids=str)
def test_crossed_cells_are_counted_on_grids_of_any_size(size, steps):
    rng = np.random.default_rng(size)
    occupied = rng.random((size, size)) < 0.4
    occupied[0] = occupied[:, -1] = False
    grid = OccupancyGrid(occupied, **steps)
    coding = make_representation("absolute", grid, (0, 0), (size - 1, size - 1), "auto")
    paths = coding.decode(random_genes(coding, rng, 5))
    expected = [reference.interfering_cells(paths.cells(i).tolist(), grid) for i in range(len(paths))]
    assert paths.interfering_cells.tolist() == expected


@given(queries(), st.sampled_from(NAMES))
def test_encode_is_the_inverse_of_decode_on_repaired_genes(query, name):
    grid, start, goal, axis, rng = query
    coding = make_representation(name, grid, start, goal, axis)
    X = coding.repair(random_genes(coding, rng), rng)
    paths = coding.decode(X)
    again = coding.encode(paths)
    if name in ("integer", "absolute"):
        assert np.array_equal(again, X)
    decoded = coding.decode(again)
    assert np.array_equal(decoded.enter, paths.enter) and np.array_equal(decoded.leave, paths.leave)


@given(queries(), st.sampled_from(NAMES))
def test_repair_keeps_paths_on_the_grid_and_is_idempotent(query, name):
    grid, start, goal, axis, rng = query
    coding = make_representation(name, grid, start, goal, axis)
    X = random_genes(coding, rng)
    before = X.copy()
    repaired = coding.repair(X, rng)
    assert np.array_equal(X, before), "the argument was changed"
    assert repaired.dtype == np.dtype(coding.vtype)
    assert (repaired >= coding.xl).all() and (repaired <= coding.xu).all()
    rows = coding.frame.start_row + np.cumsum(coding.row_moves(repaired), axis=1)
    assert (rows >= 0).all() and (rows < coding.frame.n_rows).all()
    assert np.array_equal(coding.repair(repaired, rng), repaired)
    inside = (coding.frame.start_row + np.cumsum(coding.row_moves(X), axis=1) >= 0).all(axis=1)
    inside &= (coding.frame.start_row + np.cumsum(coding.row_moves(X), axis=1) < coding.frame.n_rows).all(axis=1)
    assert np.array_equal(repaired[inside], X[inside])


@pytest.mark.parametrize("name", ["integer", "mixed", "binary", "sugihara-smith"])
@pytest.mark.parametrize("up", [True, False])
def test_edge_fixing_draws_rows_by_the_linear_distribution(name, up):
    """From row r towards the edge, row j is drawn with a probability proportional to |j - r| (section 2.1)."""
    size, row = 8, 3
    grid = OccupancyGrid(np.zeros((size, size)), corner_cutting=True)
    coding = make_representation(name, grid, (0, 0), (size - 1, size - 1))
    n = 60_000
    moves = np.zeros((n, size - 1), dtype=int)
    moves[:, 0] = row
    if name == "integer":
        X = moves.copy()
        X[:, 1] = 7 if up else -7
    elif name == "mixed":
        X = np.zeros((n, coding.n_var), dtype=int)
        X[:, coding.n_bits], X[:, coding.n_bits + 1], X[:, 0] = row, 8, up
    else:
        # A climb of 7 after a horizontal step.
        X = np.zeros((n, coding.n_var), dtype=bool)
        X[:, :3] = [0, 1, 1]
        X[:, 3:8] = [up, not up, 1, 1, 1]
        X[:, 8::5] = True  # further steps horizontal: 10
    fixed = coding.row_moves(coding.repair(X, np.random.default_rng(1)))
    drawn = row + fixed[:, 1]
    room = np.arange(row + 1, size) if up else np.arange(row)
    expected = np.abs(room - row) / np.abs(room - row).sum()
    counts = np.array([(drawn == r).sum() for r in room])
    assert counts.sum() == n, "a row outside the room was drawn"
    assert counts / n == pytest.approx(expected, abs=0.01)


def test_vehicle_at_the_edge_stays_in_its_row():
    grid = OccupancyGrid(np.zeros((4, 4)), corner_cutting=True)
    coding = make_representation("integer", grid, (0, 0), (3, 3))
    assert coding.repair(np.array([[3, 2, 0]]), np.random.default_rng(0)).tolist() == [[3, 0, 0]]


@pytest.mark.parametrize("name", ["integer", "absolute", "mixed"])
def test_corner_rule_turns_a_cutting_diagonal_into_a_horizontal_step(name):
    occupied = np.zeros((3, 3))
    occupied[1, 0] = 1  # above the start
    for corner_cutting, expected in ((True, [[0, 0], [1, 1], [2, 2]]), (False, [[0, 0], [1, 0], [1, 1], [2, 2]])):
        grid = OccupancyGrid(occupied, corner_cutting=corner_cutting)
        coding = make_representation(name, grid, (0, 0), (2, 2))
        straight = make_representation("integer", grid, (0, 0), (2, 2)).decode(np.array([[0, 1]]))
        path = coding.decode(coding.encode(straight))
        assert path.cells(0).tolist() == expected
        assert path.interfering_cells[0] == 0


def all_legal_monotone_paths(grid, frame):
    """Whether any legal path exists, by search over cells of the frame (no turning back along columns)."""
    stack, seen = [(0, frame.start_row)], set()
    while stack:
        c, r = stack.pop()
        if (c, r) in seen:
            continue
        seen.add((c, r))
        for dc, dr in ((0, 1), (0, -1), (1, -1), (1, 0), (1, 1)):
            a, b = c + dc, r + dr
            if not (0 <= a < frame.n_columns and 0 <= b < frame.n_rows) or frame.occupied[a, b]:
                continue
            if dc and dr and not grid.corner_cutting and (frame.occupied[c, b] or frame.occupied[a, r]):
                continue
            stack.append((a, b))
    return (frame.n_columns - 1, frame.goal_row) in seen


@given(st.integers(0, 2**32 - 1), st.booleans(), st.sampled_from(["x", "y"]))
def test_frame_admits_a_path_exactly_if_a_search_finds_one(seed, corner_cutting, axis):
    rng = np.random.default_rng(seed)
    occupied = rng.random((6, 7)) < 0.35
    occupied[0, 0] = occupied[5, 6] = False
    grid = OccupancyGrid(occupied, corner_cutting=corner_cutting)
    frame = MonotoneFrame.__new__(MonotoneFrame)
    frame.grid, frame.start, frame.goal = grid, (0, 0), (6, 5)
    frame._lay_out(axis)
    assert frame.admits_path() == all_legal_monotone_paths(grid, frame)


def test_refusals_say_why():
    wall = np.zeros((5, 5))
    wall[:4, 1], wall[1:, 3] = 1, 1  # an S that every path along x can follow, and none along y
    grid = OccupancyGrid(wall)
    assert MonotoneFrame(grid, (0, 0), (4, 4), "auto").axis == "x"
    with pytest.raises(UnreachableError, match=r"monotone along y: .*representation='cells', which can code every path"):
        MonotoneFrame(grid, (0, 0), (4, 4), "y")
    with pytest.raises(GridError, match="same x"):
        MonotoneFrame(grid, (0, 0), (0, 4), "x")
    with pytest.raises(GridError, match="expected 'auto', 'x' or 'y'"):
        MonotoneFrame(grid, (0, 0), (4, 4), "z")
    with pytest.raises(GridPathError, match="did you mean 'integer'"):
        make_representation("intger", grid, (0, 0), (4, 4))
    coding = make_representation("integer", grid, (0, 0), (4, 4))
    with pytest.raises(GridPathError, match="expected 4 genes"):
        coding.decode(np.zeros((1, 9), dtype=int))


@given(queries())
def test_frame_maps_cells_there_and_back(query):
    grid, start, goal, axis, rng = query
    frame = MonotoneFrame(grid, start, goal, axis)
    columns = rng.integers(0, frame.n_columns, 10)
    rows = rng.integers(0, frame.n_rows, 10)
    cells = frame.to_cells(columns, rows)
    back = frame.from_cells(cells)
    assert np.array_equal(back[0], columns) and np.array_equal(back[1], rows)
    assert [bool(grid.occupied[y, x]) for x, y in cells] == frame.occupied[columns, rows].tolist()
