"""The suite for representations: all codings pass it, one with two methods of its own too, and faults do not."""

import functools
import inspect
import itertools

import numpy as np
import pytest

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.neighbourhood import HEADING_OF, HEADINGS
from pymoo_gridpath.paths import CellPaths, Paths, SequencePaths, Sequences
from pymoo_gridpath.problems import GridPathProblem
from pymoo_gridpath.registry import register
from pymoo_gridpath.representations import (
    REPRESENTATIONS,
    AbsoluteRepresentation,
    BinaryRepresentation,
    CellSequence,
    IntegerRepresentation,
    MixedRepresentation,
    Representation,
    make_representation,
)
from pymoo_gridpath.testing import MapFormatSuite, OperatorSuite, PlannerSuite, RepresentationSuite


class Headings(Representation):
    """The headings of the steps, and 8 to stay; a row that does not lead to the goal jumps there at its end."""

    name = "headings"

    def __init__(self, grid, start, goal):
        super().__init__(grid, start, goal)
        self.n_var = self.max_cells = 2 * (np.ptp(self.moves.cells(np.arange(self.moves.n_cells)), axis=0).sum() + 12)
        self.xl, self.xu = np.zeros(self.n_var, dtype=int), np.full(self.n_var, 8)

    def decode(self, X):
        steps = np.vstack([HEADINGS, [[0, 0]]])[self.genes(X)]
        cells = np.clip(self.start + np.cumsum(steps, axis=1), 0, [self.grid.width - 1, self.grid.height - 1])
        start, goal = (np.broadcast_to(cell, (len(cells), 1, 2)) for cell in (self.start, self.goal))
        x, y = np.moveaxis(np.concatenate([start, cells, goal], axis=1), 2, 0)
        return CellPaths(self.grid, y * self.grid.width + x)

    def from_sequences(self, sequences):
        cells = self.moves.cells(sequences.cells)
        X = np.full((len(sequences.lengths), self.n_var), 8)
        for row, (first, end) in zip(X, itertools.pairwise(sequences.offsets), strict=True):
            dx, dy = np.diff(cells[first:end], axis=0).T
            row[: len(dx)] = HEADING_OF[dy + 1, dx + 1]
        return X


class RealHeadings(Headings):
    """The same as real numbers, of which decoding takes the nearest."""

    name, vtype = "real headings", float

    def genes(self, X):
        return np.rint(super().genes(X)).astype(int)

    def repair(self, X, random_state):
        return Representation.genes(self, X)

    def from_sequences(self, sequences):
        return super().from_sequences(sequences).astype(float)


@pytest.mark.parametrize(
    "cls",
    [
        IntegerRepresentation,
        BinaryRepresentation,
        MixedRepresentation,
        AbsoluteRepresentation,
        CellSequence,
        pytest.param(functools.partial(CellSequence, backtracking=False), id="CellSequence without backtracking"),
        Headings,
        RealHeadings,
    ],
)
class TestRepresentations(RepresentationSuite):
    @pytest.fixture(autouse=True)
    def _class(self, cls):
        self.cls = cls

    def make(self, grid, start, goal):
        return self.cls(grid, start, goal)


@pytest.mark.parametrize(
    ("call", "method"),
    [
        (lambda: RepresentationSuite().make(OccupancyGrid([[0, 0]]), (0, 0), (1, 0)), r"make\(self, grid, start, goal\)"),
        (lambda: PlannerSuite().make(), r"make\(self\) that returns a new planner"),
        (lambda: OperatorSuite().make(), r"make\(self\) that returns a new operator"),
        (lambda: MapFormatSuite().write(*"ab"), r"write\(self, path, grid\)"),
        (lambda: MapFormatSuite().write_query(*"abc"), r"write_query\(self, path, grid, query\)"),
    ],
)
def test_a_suite_without_what_it_needs_says_so(call, method):
    with pytest.raises(NotImplementedError, match=f"the suite needs a method {method}"):
        call()


# -- faults that the suite finds --------------------------------------------------------------------------------------------


def edited(paths, change):
    """Return the paths after a function has changed each list of cells."""
    lists = [change(list(part)) for part in np.split(paths.sequences.cells, paths.sequences.offsets[1:-1])]
    return SequencePaths(paths.grid, Sequences(np.concatenate(lists), np.cumsum([0, *map(len, lists)])))


class ForgetsTheGoal(Headings):
    """Legal on its way, and taken for legal wherever it ends."""

    def decode(self, X):
        return edited(super().decode(X), lambda cells: cells[:-1])


class ForgetsTheBox(Headings):
    def from_sequences(self, sequences):
        cells = np.stack([sequences.cells % self.grid.width, sequences.cells // self.grid.width], axis=1)
        X = np.full((len(sequences.lengths), self.n_var), 8)
        for row, (first, end) in zip(X, itertools.pairwise(sequences.offsets), strict=True):
            dx, dy = np.clip(np.diff(cells[first:end], axis=0), -1, 1).T
            row[: len(dx)] = HEADING_OF[dy + 1, dx + 1]
        return X


class LosesDiagonals(Headings):
    """Goes straight, and longer, where a diagonal was given."""

    def from_sequences(self, sequences):
        lists = np.split(sequences.cells, sequences.offsets[1:-1])
        found = []
        for cells in lists:
            x, y = self.moves.cells(cells).T
            path = [cells[0]]
            for k in range(1, len(cells)):
                if x[k] != x[k - 1] and y[k] != y[k - 1]:
                    path.append(self.moves.index((x[k], y[k - 1])))
                path.append(cells[k])
            found.append(np.array(path))
        return super().from_sequences(Sequences(np.concatenate(found or [np.zeros(0, int)]), np.cumsum([0, *map(len, found)])))


class WrongType(Headings):
    def from_sequences(self, sequences):
        return super().from_sequences(sequences).astype(float)


class OutOfBounds(Headings):
    def from_sequences(self, sequences):
        X = super().from_sequences(sequences)
        X[:, -1] = 9
        return X


class WritesIntoRows(Headings):
    def decode(self, X):
        if isinstance(X, np.ndarray) and X.dtype.kind == "i" and X.flags.writeable:
            X[:, -1] = 8
        return super().decode(X)


class Draws(Headings):
    def decode(self, X):
        X = self.genes(X)
        X[:, 0] = np.random.default_rng().integers(0, 9, len(X))
        return super().decode(X)


class Truncates(Headings):
    def genes(self, X):
        return super().genes(np.floor(np.asarray(X, dtype=float)))


class SharesItsQuery(Headings):
    """Keeps the start of the last one made for all objects."""

    shared = (0, 0)

    def __init__(self, grid, start, goal):
        super().__init__(grid, start, goal)
        SharesItsQuery.shared = start

    def decode(self, X):
        start, self.start = self.start, self.shared
        try:
            return super().decode(X)
        finally:
            self.start = start


class ForgetsCorners(CellPaths):
    @property
    def interfering_cells(self):
        return SequencePaths(self.grid.replace(corner_cutting=True), self.sequences).interfering_cells


class CutsCorners(Headings):
    def decode(self, X):
        return ForgetsCorners(self.grid, super().decode(X).rows)


class TurnsLess(CellPaths):
    @property
    def turn(self):
        return np.maximum(super().turn - 45, 0)


class WrongTurn(Headings):
    def decode(self, X):
        return TurnsLess(self.grid, super().decode(X).rows)


class LeavesOutTheStart(CellPaths):
    def total(self, field):
        return super().total(field) - field[self.rows[:, 0]]


class WrongTotal(Headings):
    def decode(self, X):
        return LeavesOutTheStart(self.grid, super().decode(X).rows)


class BreaksLegalRows(Headings):
    def repair(self, X, random_state):
        X = super().repair(X, random_state)
        X[:, 0] = random_state.integers(0, 8, len(X))
        return X


class CannotBeCopied(Headings):
    def __reduce__(self):
        return type(self), (self.grid, self.goal, self.start)


FAULTS = {
    ForgetsTheGoal: "test_paths_without_interfering_cells_are_legal",
    ForgetsTheBox: "test_sequences_come_back_from_their_rows",
    LosesDiagonals: "test_sequences_come_back_from_their_rows",
    WrongType: "test_rows_of_sequences_are_genes",
    OutOfBounds: "test_rows_of_sequences_are_genes",
    WritesIntoRows: "test_decoding_is_repeatable_and_leaves_the_rows",
    Draws: "test_decoding_is_repeatable_and_leaves_the_rows",
    Truncates: "test_genes_of_other_types_are_rounded_and_brought_within_the_bounds",
    SharesItsQuery: "test_one_object_does_not_disturb_another",
    CutsCorners: "test_measures_are_those_of_the_reference",
    WrongTurn: "test_measures_are_those_of_the_reference",
    WrongTotal: "test_measures_are_those_of_the_reference",
    BreaksLegalRows: "test_repair_returns_new_rows_and_keeps_legal_paths",
    CannotBeCopied: "test_copies_decode_alike",
}


def failures(cls, test):
    """Return on which queries of the suite a test fails for a class."""

    class Suite(RepresentationSuite):
        def make(self, grid, start, goal):
            return cls(grid, start, goal)

    suite, failed = Suite(), []
    for query in suite.queries():
        try:
            getattr(suite, test)(suite._made(query))
        except (Exception, pytest.fail.Exception) as error:
            failed.append(f"{query}: {error}")
    return failed


@pytest.mark.parametrize("cls", FAULTS)
def test_the_suite_finds_a_fault(cls):
    assert failures(cls, FAULTS[cls]), f"{cls.__name__} passed {FAULTS[cls]}"
    # For it is the fault that it finds.
    assert not failures(Headings, FAULTS[cls])


# -- a class of one's own, wherever a representation is taken -----------------------------------------------------------------


@pytest.fixture
def registered():
    register(Headings)
    yield Headings
    REPRESENTATIONS._known.pop("headings"), REPRESENTATIONS._names.pop("headings")


def test_a_registered_class_is_known_by_name(registered):
    grid = OccupancyGrid(np.zeros((5, 6)))
    query = grid, (0, 0), (5, 4)
    assert "headings" in REPRESENTATIONS and "headings" in list(REPRESENTATIONS)
    for given in ("headings", Headings, Headings(*query)):
        assert type(GridPathProblem(*query, representation=given).representation) is Headings
    with pytest.raises(GridPathError, match="there is no representation 'heading'; did you mean 'headings'"):
        make_representation("heading", *query)
    with pytest.raises(GridPathError, match="headings representation advance along none; expected 'auto'"):
        GridPathProblem(*query, representation="headings", axis="x")
    with pytest.raises(GridPathError, match="representation is the class Paths, expected a class derived from Representation"):
        GridPathProblem(*query, representation=Paths)


def test_fields_of_objectives_go_to_whoever_wants_them():
    """Once to the cells by name alone."""

    class Wants(Headings):
        wants_fields = True

        def __init__(self, grid, start, goal, fields=(), spare=1.0):
            super().__init__(grid, start, goal)
            self.given, self.spare = [np.asarray(field) for field in fields], spare

    grid = OccupancyGrid(np.eye(5)[::-1] * [0, 0, 1, 0, 0])
    for objectives, n_fields, spare in (("length", 0, 1.0), (["vulnerability"], 1, 1.0), (["vulnerability", "turn"], 1, 2.0)):
        coding = GridPathProblem(grid, (0, 0), (4, 4), Wants, objectives).representation
        assert (len(coding.given), coding.spare) == (n_fields, spare)
        assert all(field.shape == grid.shape for field in coding.given)
    larger = type("Larger", (CellSequence,), {"name": "larger"})
    sizes = [GridPathProblem(grid, (0, 0), (4, 4), cls, ["vulnerability", "turn"]).n_var for cls in (CellSequence, larger)]
    assert sizes[0] == sizes[1] == GridPathProblem(grid, (0, 0), (4, 4), "cells", ["vulnerability", "turn"]).n_var


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"n_var": 3}, "xl and xu of the representation Half have the shapes .* expected a bound for each of its 3 genes"),
        ({"vtype": str}, "vtype of the representation Half is the class str, expected int, bool or float"),
    ],
)
def test_an_unfinished_representation_is_refused_in_a_sentence(changes, said):
    class Half(Headings):
        def __init__(self, grid, start, goal):
            super().__init__(grid, start, goal)
            vars(self).update(changes)

    class Empty(Headings):
        def __init__(self, grid, start, goal):
            Representation.__init__(self, grid, start, goal)

    query = OccupancyGrid(np.zeros((3, 3))), (0, 0), (2, 2)
    with pytest.raises(GridPathError, match=said):
        GridPathProblem(*query, representation=Half)
    with pytest.raises(
        GridPathError, match="the representation Empty does not have 'n_var'; expected its class or constructor"
    ):
        GridPathProblem(*query, representation=Empty)


# -- paths given by sequences -------------------------------------------------------------------------------------------------


def test_pauses_count_once_and_empty_paths_are_refused():
    grid = OccupancyGrid(np.zeros((2, 3)))
    paths = SequencePaths(grid, Sequences(np.array([0, 0, 1, 1, 1, 2, 2]), np.array([0, 3, 4, 7])))
    assert [paths.cells(k).tolist() for k in range(3)] == [[[0, 0], [1, 0]], [[1, 0]], [[1, 0], [2, 0]]]
    assert paths.length.tolist() == [1.0, 0.0, 1.0]
    with pytest.raises(GridPathError, match="a path of the sequences visits no cell, expected at least one"):
        SequencePaths(grid, Sequences(np.array([0]), np.array([0, 0, 1])))
    with pytest.raises(GridPathError, match="sequences hold other numbers"):
        SequencePaths(grid, Sequences(np.array([6]), np.array([0, 1])))


def test_what_is_no_paths_is_refused():
    problem = GridPathProblem(OccupancyGrid(np.zeros((3, 3))), (0, 0), (2, 2))
    with pytest.raises(GridPathError, match=r"paths is .*, expected a Paths, as decode returns them"):
        problem.score(np.zeros((2, 3)))
    assert inspect.isabstract(Paths) and checks.instance("paths", problem.decode(problem.xl), Paths)
