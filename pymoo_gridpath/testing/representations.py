"""The tests that every representation passes."""

from __future__ import annotations

import itertools
import pickle
from typing import Any

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize

from pymoo_gridpath.errors import GridPathError, UnreachableError
from pymoo_gridpath.grid import Cell, OccupancyGrid
from pymoo_gridpath.neighbourhood import HEADINGS
from pymoo_gridpath.operators import default_operators, path_operators
from pymoo_gridpath.paths import Paths, Sequences
from pymoo_gridpath.paths.sequences import check_sequences
from pymoo_gridpath.problems import GridPathProblem
from pymoo_gridpath.representations import Representation
from pymoo_gridpath.representations.base import check_representation
from pymoo_gridpath.testing import reference

# Rows of random genes a test.
_ROWS = 24

Query = tuple[OccupancyGrid, Cell, Cell]


def _room_in_the_dark() -> OccupancyGrid:
    """Return a room in a grid so large that searches work on a box around it."""
    occupied = np.ones((260, 270))
    occupied[100:106, 200:209] = 0
    occupied[103, 203] = 1
    return OccupancyGrid(occupied)


def _dense(seed: int, **steps: Any) -> OccupancyGrid:
    """Return a grid with many obstacles, and a free bottom row and right column."""
    occupied = np.random.default_rng(seed).random((6, 9)) < 0.35
    occupied[0], occupied[:, -1] = False, False
    return OccupancyGrid(occupied, **steps)


_QUERIES: dict[str, Query] = {
    "square": (OccupancyGrid(np.zeros((6, 6)), corner_cutting=True), (0, 0), (5, 5)),
    "wide, from the right": (OccupancyGrid(np.zeros((4, 9))), (8, 2), (0, 1)),
    "tall, downwards": (OccupancyGrid(np.zeros((9, 3))), (1, 8), (2, 0)),
    "one row": (OccupancyGrid(np.zeros((1, 5))), (4, 0), (1, 0)),
    "one column": (OccupancyGrid(np.zeros((5, 1)), corner_cutting=True), (0, 0), (0, 4)),
    "dense": (_dense(1), (0, 0), (8, 5)),
    "dense, corners cut": (_dense(1, corner_cutting=True), (0, 0), (8, 5)),
    "dense, corners cut on one side": (_dense(1, corner_cutting="one side"), (0, 0), (8, 5)),
    "dense, four moves": (_dense(1, moves=4), (0, 0), (8, 5)),
    "dense, back": (_dense(2), (8, 5), (0, 0)),
    "a room in the dark": (_room_in_the_dark(), (200, 100), (208, 105)),
}


class RepresentationSuite:
    """Tests of a representation, to be inherited by a class whose name begins with ``Test``.

    Set `make`. Queries that it refuses with an UnreachableError are skipped, but for those on grids without obstacles, which
    every representation can code.

    Examples
    --------
    >>> from pymoo_gridpath.representations import CellSequence
    >>> class TestCellSequence(RepresentationSuite):
    ...     def make(self, grid, start, goal):
    ...         return CellSequence(grid, start, goal)
    """

    def make(self, grid: OccupancyGrid, start: Cell, goal: Cell) -> Representation:
        """Return the representation under test for a query."""
        raise NotImplementedError("the suite needs a method make(self, grid, start, goal) that returns the representation")

    @pytest.fixture(params=_QUERIES)
    def coding(self, request) -> Representation:
        """The representation for each of the queries."""
        return self._made(request.param)

    def _made(self, query: str) -> Representation:
        grid, start, goal = _QUERIES[query]
        try:
            return self.make(grid, start, goal)
        except UnreachableError as error:
            if query.startswith("dense"):
                pytest.skip(str(error))
            raise

    @staticmethod
    def queries() -> list[str]:
        """Return the names of the queries that the tests are run on."""
        return list(_QUERIES)

    # -- what it says of itself ---------------------------------------------------------------------------------------

    def test_it_is_complete(self, coding):
        assert isinstance(coding, Representation)
        check_representation(coding)
        assert isinstance(coding.name, str) and coding.name
        assert (np.asarray(coding.xl) <= np.asarray(coding.xu)).all()
        assert coding.n_var > 0 and (coding.max_cells is None or coding.max_cells > 1)

    @pytest.mark.parametrize("query", _QUERIES)
    def test_it_is_of_the_query(self, query):
        coding = self._made(query)
        assert (coding.grid, coding.start, coding.goal) == _QUERIES[query]

    def test_moves_are_legal_steps(self, coding):
        moves, grid = coding.moves, coding.grid
        assert moves.box == coding.box
        for index in np.flatnonzero(moves.legal):
            x, y = moves.cells(index)
            for m in np.flatnonzero(moves.legal[index] >> np.arange(8) & 1):
                step = [(x, y), (x + HEADINGS[m][0], y + HEADINGS[m][1])]
                assert all(grid.contains(cell) for cell in step) and reference.broken_cells(step, grid) == 0

    # -- decode -------------------------------------------------------------------------------------------------------------

    def test_rows_decode_to_paths(self, coding):
        paths = coding.decode(random_rows(coding))
        assert isinstance(paths, Paths), "decode returned no Paths"
        assert len(paths) == _ROWS and paths.grid == coding.grid
        cells, offsets = check_sequences(paths.sequences, coding.grid.occupied.size)
        assert len(offsets) == _ROWS + 1 and (np.diff(offsets) > 0).all(), "a path visits no cell"
        follows = np.setdiff1d(np.arange(1, len(cells)), offsets)
        assert (cells[follows] != cells[follows - 1]).all(), "a cell follows itself"
        none = coding.decode(random_rows(coding)[:0])
        assert len(none) == 0 and none.length.shape == none.turn.shape == none.interfering_cells.shape == (0,)

    def test_decoding_is_repeatable_and_leaves_the_rows(self, coding):
        X = random_rows(coding)
        before = X.copy()
        first, again = coding.decode(X).sequences, coding.decode(X).sequences
        assert np.array_equal(X, before) and X.dtype == before.dtype, "decode changed the rows"
        assert _same(first, again), "the same rows decoded to other paths"
        X.flags.writeable = False
        assert _same(first, coding.decode(X).sequences)
        backwards = coding.decode(X[::-1])
        for i in range(_ROWS):
            alone = coding.decode(X[[i]]).cells(0)
            assert np.array_equal(alone, backwards.cells(_ROWS - 1 - i)), "a path depends on the rows beside its own"

    def test_paths_without_interfering_cells_are_legal(self, coding):
        X = np.concatenate([random_rows(coding), self._legal_rows(coding)])
        paths = coding.decode(X)
        for i, interfering in enumerate(paths.interfering_cells):
            legal = reference.is_legal(_cells(paths, i), coding.grid, coding.start, coding.goal)
            assert legal == (interfering == 0), f"row {i} has {interfering} interfering cells: {_cells(paths, i)}"

    def test_measures_are_those_of_the_reference(self, coding):
        X = np.concatenate([random_rows(coding), self._legal_rows(coding)])
        paths, grid = coding.decode(X), coding.grid
        # Sums of these are exact in any order.
        field = np.random.default_rng(3).integers(0, 64, grid.shape) / 8
        total = paths.total(coding.prepare(field))
        for name in ("length", "turn", "interfering_cells", "n_straight", "n_diagonal"):
            assert getattr(paths, name).shape == (len(X),), name
        assert total.shape == (len(X),)
        for i in range(len(X)):
            cells = _cells(paths, i)
            long, short = zip(*(reference.distances(a, b) for a, b in itertools.pairwise(cells)), strict=True)
            assert paths.n_diagonal[i] == sum(short) and paths.n_straight[i] == sum(long) - sum(short)
            assert paths.length[i] == pytest.approx(reference.octile_length(cells), abs=1e-9)
            assert paths.turn[i] == reference.sign_turn(cells)
            assert paths.interfering_cells[i] == reference.broken_cells(cells, grid) + _forbidden_steps(cells, coding)
            assert total[i] == reference.total(cells, field)
        for chosen in (slice(1, None, 2), np.arange(len(X)) % 3 == 0, np.array([2, 0, 2, -1])):
            part = paths[chosen]
            assert np.array_equal(part.length, paths.length[chosen]) and np.array_equal(part.turn, paths.turn[chosen])
            assert np.array_equal(part.total(coding.prepare(field)), total[chosen])

    def test_genes_of_other_types_are_rounded_and_brought_within_the_bounds(self, coding):
        X = random_rows(coding)
        given = coding.decode(X).sequences
        assert _same(given, coding.decode(X.astype(object)).sequences)
        if coding.vtype is not float:
            noise = np.random.default_rng(4).uniform(-0.45, 0.45, X.shape)
            assert _same(given, coding.decode(X + noise).sequences), "real numbers do not decode as the nearest genes"
        ends = np.stack([coding.xl, coding.xu]).astype(float)
        beyond = ends + np.array([[-3.0], [3.0]])
        assert _same(coding.decode(ends).sequences, coding.decode(beyond).sequences), "genes beyond the bounds are not clipped"
        for wrong in (np.zeros((1, coding.n_var + 1)), np.full((1, coding.n_var), np.nan)):
            with pytest.raises(GridPathError):
                coding.decode(wrong)

    # -- there and back -------------------------------------------------------------------------------------------------

    def _legal(self, coding) -> Sequences:
        """Return legal paths that fit, by a search over cells, some of them by way of others than the shortest."""
        rng, moves = np.random.default_rng(5), coding.moves
        inside = np.flatnonzero(moves.legal)
        taken = [m for m in range(8) if (moves.legal >> m & 1).any()]
        allowed = {tuple(HEADINGS[m].tolist()) for m in taken}
        found = []
        for _ in range(8):
            via = tuple(moves.cells(rng.choice(inside)).tolist())
            for stops in ([coding.start, coding.goal], [coding.start, via, coding.goal]):
                parts: list[Any] = [
                    reference.walk(coding.grid, a, b, rng, allowed.__contains__) for a, b in itertools.pairwise(stops)
                ]
                if all(parts):
                    found.append(np.array([parts[0][0], *(cell for part in parts for cell in part[1:])]))
        assert found, "no legal path leads along the moves of the representation"
        cells = [np.array([moves.index(cell) for cell in path]) for path in found]
        sequences = Sequences(np.concatenate(cells), np.cumsum([0, *map(len, cells)]))
        fits = coding.fits(sequences)
        assert fits.shape == (len(found),) and fits.dtype == bool
        shortest = sequences.lengths == sequences.lengths.min()
        assert fits[shortest].all(), "a shortest path does not fit"
        return sequences.take(fits)

    def _legal_rows(self, coding) -> np.ndarray:
        return coding.from_sequences(self._legal(coding))

    def test_rows_of_sequences_are_genes(self, coding):
        sequences = self._legal(coding)
        before = Sequences(*(values.copy() for values in sequences))
        X = coding.from_sequences(sequences)
        assert _same(sequences, before), "from_sequences changed its argument"
        assert X.shape == (len(sequences.lengths), coding.n_var)
        assert X.dtype == np.dtype(coding.vtype), f"genes are {X.dtype}, expected {coding.vtype.__name__}"
        assert (coding.xl <= X).all() and (coding.xu >= X).all(), "genes are out of their bounds"
        assert coding.from_sequences(sequences.take(np.zeros(0, dtype=int))).shape == (0, coding.n_var)

    def test_sequences_come_back_from_their_rows(self, coding):
        sequences = self._legal(coding)
        X = coding.from_sequences(sequences)
        paths = coding.decode(X)
        for i, (first, end) in enumerate(itertools.pairwise(sequences.offsets)):
            given = [tuple(cell) for cell in coding.moves.cells(sequences.cells[first:end]).tolist()]
            cells = _cells(paths, i)
            assert reference.is_legal(cells, coding.grid, coding.start, coding.goal), f"{given} came back as {cells}"
            assert reference.octile_length(cells) <= reference.octile_length(given) + 1e-9, "a path came back longer"
            assert set(cells) <= set(given), "a path came back with other cells"
        again = coding.to_sequences(X)
        assert np.array_equal(coding.moves.to_grid(again.cells), paths.sequences.cells)
        assert np.array_equal(coding.from_sequences(again), X), "one path has two rows"
        assert np.array_equal(coding.encode(paths), X), "encode returned other rows than from_sequences"
        assert _same(coding.decode(coding.encode(paths)).sequences, paths.sequences)

    def test_paths_of_another_grid_are_refused(self, coding):
        paths = coding.decode(self._legal_rows(coding))
        grid, start, goal = coding.grid, coding.start, coding.goal
        other = grid.replace(corner_cutting=not grid.corner_cutting)
        try:
            stranger = self.make(other, start, goal)
        except UnreachableError as error:
            pytest.skip(str(error))
        with pytest.raises(GridPathError):
            stranger.encode(paths)

    def test_one_object_does_not_disturb_another(self, coding):
        X = random_rows(coding)
        before = coding.decode(X).sequences
        for grid, start, goal in list(_QUERIES.values())[:3]:
            other = self.make(grid, start, goal)
            other.decode(random_rows(other))
        assert _same(coding.decode(X).sequences, before), "another object of the class changed what rows code"

    # -- repair and copies --------------------------------------------------------------------------------------------------

    def test_repair_returns_new_rows_and_keeps_legal_paths(self, coding):
        legal = self._legal_rows(coding)
        X = np.concatenate([random_rows(coding), legal]).astype(coding.vtype)
        before = X.copy()
        repaired = coding.repair(X, np.random.default_rng(6))
        assert np.array_equal(X, before) and not np.shares_memory(repaired, X), "repair changed its argument"
        assert repaired.shape == X.shape and repaired.dtype == np.dtype(coding.vtype)
        assert (repaired >= coding.xl).all() and (repaired <= coding.xu).all()
        assert np.array_equal(repaired, coding.repair(X, np.random.default_rng(6))), (
            "repair draws other numbers than it is given"
        )
        assert np.array_equal(repaired[_ROWS:], legal), "repair changed a legal path"

    def test_copies_decode_alike(self, coding):
        X = random_rows(coding)
        copied = pickle.loads(pickle.dumps(coding))
        assert _same(copied.decode(X).sequences, coding.decode(X).sequences)
        assert (copied.grid, copied.start, copied.goal) == (coding.grid, coding.start, coding.goal)

    # -- in a search ----------------------------------------------------------------------------------------------------

    @pytest.mark.parametrize("operators", [default_operators, path_operators])
    def test_searches_find_legal_paths(self, coding, operators):
        problem = GridPathProblem(coding.grid, coding.start, coding.goal, coding, ["length", "vulnerability", "turn"])
        F = []
        for _ in range(2):
            search: Any = NSGA2(pop_size=12, **operators(problem))
            # Where there are but few paths, new ones are looked for a hundred times otherwise.
            search.mating.n_max_iterations = 5
            result: Any = minimize(problem, search, ("n_gen", 3), seed=1)
            F.append(result.F)
        assert np.array_equal(*F), "the same seed gave another result"
        paths = problem.decode(result.X)
        if operators is path_operators:
            assert (result.pop.get("interfering_cells") == 0).all(), "path operators made an illegal path"
        legal = np.flatnonzero(paths.interfering_cells == 0)
        # The paper's operators know nothing of obstacles.
        if not (operators is default_operators and coding.paper and coding.grid.n_occupied):
            assert len(legal), "no legal path was found"
        for i in legal.tolist():
            cells = _cells(paths, i)
            assert reference.is_legal(cells, coding.grid, coding.start, coding.goal)
            assert result.F[i, 0] == pytest.approx(reference.octile_length(cells)) and result.F[i, 2] == reference.turn(cells)

    def test_exact_fronts_have_rows(self, coding):
        problem = GridPathProblem(coding.grid, coding.start, coding.goal, coding)
        X: Any = problem.pareto_set(max_seconds=None)
        F: Any = problem.pareto_front(max_seconds=None)
        assert X is not None and len(X) == len(F) > 0
        assert np.array_equal(np.asarray(problem.evaluate(X)), F)


def random_rows(coding: Representation) -> np.ndarray:
    """Return rows of random genes, uniform within their bounds, shape (24, n_var), dtype `vtype`."""
    rng = np.random.default_rng(2)
    if coding.vtype is float:
        return rng.uniform(coding.xl, coding.xu, (_ROWS, coding.n_var))
    return rng.integers(coding.xl, coding.xu, (_ROWS, coding.n_var), endpoint=True).astype(coding.vtype)


def _forbidden_steps(cells: list[Cell], coding: Representation) -> int:
    """Return how many steps lead away from the goal along x or y, where none may."""
    if coding.backtracking:
        return 0
    (x, y), (goal_x, goal_y) = coding.start, coding.goal
    ahead = {(dx, dy) for dx in (0, np.sign(goal_x - x)) for dy in (0, np.sign(goal_y - y))}
    return sum((np.sign(b[0] - a[0]), np.sign(b[1] - a[1])) not in ahead for a, b in itertools.pairwise(cells))


def _cells(paths: Paths, index: int) -> list[tuple[int, int]]:
    """Return the cells (x, y) of a path, from its sequence, and see that `Paths.cells` says the same."""
    cells, offsets = paths.sequences
    found = reference.visited(cells[offsets[index] : offsets[index + 1]], paths.grid.width)
    assert found == [tuple(cell) for cell in paths.cells(index).tolist()]
    return found


def _same(a: Sequences, b: Sequences) -> bool:
    return np.array_equal(a.cells, b.cells) and np.array_equal(a.offsets, b.offsets)
