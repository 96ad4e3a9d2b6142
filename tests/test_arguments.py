"""Arguments: checked in one place, refused in one sentence, taken in any guise, and never changed."""

from __future__ import annotations

import inspect
import itertools
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid, checks
from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.decision import TradeOffSet, knee_point
from pymoo_gridpath.errors import GridError, GridPathError, MapError
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.maps import load_map, load_shipped, read_scen
from pymoo_gridpath.maps.queries import Query, ends_of
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.operators import BitwiseMutation, path_operators
from pymoo_gridpath.plotting import plot_convergence
from pymoo_gridpath.representations import REPRESENTATIONS, CellSequence, make_representation
from pymoo_gridpath.study.running.store import Store

FUZZ = Path(__file__).resolve().parents[1] / "benchmarks" / "fuzz"

GRID = OccupancyGrid([[0, 0, 0, 0, 0], [0, 1, 1, 0, 0], [0, 0, 0, 0, 0], [0, 0, 1, 0, 0]])
QUERY = {"start": (0, 0), "goal": (4, 3)}
FIELD = np.array([[0, 1, 2, 1, 0], [3, 0, 0, 1, 1], [0, 2, 1, 0, 3], [1, 1, 5, 1, 0]])


class Own(Objective):
    name = label = "own"

    def __init__(self, cost, kind=None):
        self.cost, self.kind = cost, kind

    def field(self, grid):
        return self.cost

    def __call__(self, paths, prepared):
        values = paths.total(prepared.field)
        return values if self.kind is None else values.astype(self.kind)


# -- the checks themselves ----------------------------------------------------------------------------------------------------


class Endless:
    def __repr__(self):
        raise RuntimeError

    def __iter__(self):
        raise RuntimeError


CYCLE: list = []
CYCLE.append(CYCLE)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        pytest.param(10**5000, "a whole number of about 5,001 digits", id="huge"),
        (-(10**400), "a whole number of about 401 digits"),
        (np.float32(0.5), "0.5"),
        (np.array(3), "3"),
        (np.zeros((2, 3), dtype=np.int8), "an array of int8 of shape (2, 3)"),
        ("a\x1b[2Jb\n", r"'a\x1b[2Jb\n'"),
        (Endless(), "an object of the class Endless"),
        ([Endless()] * 9, "[" + "an object of the class Endless, " * 4 + "...]"),
        (CYCLE, "[[[[...]]]]"),
        (int, "the class int"),
        (np.ma.masked, "an object of the class MaskedConstant"),
        (None, "None"),
    ],
)
def test_values_are_shown_short_and_on_one_line(value, text):
    assert checks.shown(value) == text


def test_long_values_are_cut():
    for value in ("x" * 10**6, b"\xff" * 10**6, [["y" * 10**5]] * 50, dict.fromkeys(range(50), "z" * 10**5)):
        assert len(checks.shown(value)) < 200


@pytest.mark.parametrize("value", [2, 2.0, np.int8(2), np.float16(2), np.array(2.0), Fraction(2)])
def test_numbers_of_python_and_numpy_are_numbers(value):
    assert checks.number("n", value) == 2.0
    assert type(checks.number("n", value)) is float


@pytest.mark.parametrize(
    "value", [True, np.True_, "2", b"2", 2j, None, np.nan, np.inf, 10**400, np.ma.masked, [2], np.zeros(1)]
)
def test_other_values_are_none(value):
    with pytest.raises(GridPathError, match=r"^n is .*, expected a finite number$"):
        checks.number("n", value)


def test_whole_numbers_keep_to_their_range():
    assert checks.whole("n", np.uint8(5), 1, 5) == 5
    assert checks.whole("n", np.array(5)) == 5
    for value in (0, 6, 5.0, True, "5", np.nan, 10**400):
        with pytest.raises(GridPathError, match="expected a whole number of at least 1 and at most 5"):
            checks.whole("n", value, 1, 5)


def test_texts_are_of_letters_that_a_file_can_hold(tmp_path):
    half = "a\ud800"
    with pytest.raises(GridPathError, match=r"title is .*, expected a text"):
        checks.text("title", half)
    with pytest.raises(GridPathError, match=r"key is .*, expected the key of a run"):
        Store(tmp_path).write(half, b"")
    with pytest.raises(MapError, match="no such shipped map") as refused:
        load_shipped("long " * 50_000)
    assert len(str(refused.value)) < 300


def test_of_too_many_items_none_is_looked_at():
    endless = (1 / 0 for _ in range(1))
    with pytest.raises(GridPathError, match="expected two"):
        checks.items("pair", endless, "two", most=2)
    with pytest.raises(GridPathError, match="expected two"):
        checks.items("pair", [1, 2, 3], "two", most=2)
    assert checks.items("pair", {1: 2, 3: 4}.keys(), "two", most=2) == [1, 3]


def test_names_of_any_length_are_cut_wherever_they_are_said(tmp_path, recwarn):
    long, path, scen = "long " * 2000, tmp_path / "a.yaml", tmp_path / "a.scen"
    grid = OccupancyGrid(np.zeros((3, 3)), name=long, resolution=1.0)
    problem = GridPathProblem(grid, (0, 0), (2, 2))
    scen.write_text("version 1\n0\ta.map\t5\t5\t0\t0\t1\t1\t1.41421\n")
    path.write_text("image: a.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.6\nfree_thresh: 0.1\n")
    for wrong in (
        lambda: load_map(path, **{long: 1}),
        lambda: make_algorithm("exact", problem, **{long: 1}),
        lambda: make_algorithm(make_algorithm("nsga2", problem), problem, **{long: 1}),
        lambda: read_scen(scen, grid),
        lambda: ends_of(grid, Query(), None, None),
        lambda: plot_convergence([], color=Endless()),
    ):
        with pytest.raises(GridPathError) as caught:
            wrong()
        assert len(str(caught.value)) < 600
    grid.inflate(0.1)
    assert [len(str(item.message)) < 600 for item in recwarn] == [True]


def test_empty_lists_have_the_type_that_was_asked_for():
    for kinds, kind in (("b", "b"), ("biu", "i"), ("biuf", "f")):
        assert checks.array("a", np.empty((0, 2)), (None, 2), kinds, expected="some").dtype.kind == kind
    assert BitwiseMutation().flip(np.empty((0, 3)), 0.5, np.random.default_rng(1)).shape == (0, 3)


def test_flags_are_truth_values():
    assert [checks.flag("f", value) for value in (True, np.False_, np.array(True))] == [True, False, True]
    for value in (1, 0, "True", None, np.ones(2, dtype=bool)):
        with pytest.raises(GridPathError, match="expected True or False"):
            checks.flag("f", value)


def test_masked_values_are_refused_and_arrays_without_a_mask_taken():
    array = np.ma.masked_array([1.0, -9999.0], mask=[False, True])
    with pytest.raises(GridPathError, match="a holds masked values, expected two numbers"):
        checks.array("a", array, (2,), expected="two numbers")
    assert checks.array("a", np.ma.masked_array([1.0, 2.0]), (2,), expected="two numbers").tolist() == [1.0, 2.0]


# -- costs of cells -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("representation", ["integer", "cells"])
@pytest.mark.parametrize(("cell", "place"), [((3, 2), "free"), ((1, 1), "occupied")])
def test_a_negative_cost_is_refused_with_its_cell(representation, cell, place):
    cost = FIELD.astype(float)
    cost[cell[1], cell[0]] = -9999.0
    said = rf"the field of the objective 'own' is -9999 in the {place} cell \({cell[0]}, {cell[1]}\), expected zero or more"
    with pytest.raises(GridPathError, match=said):
        GridPathProblem(GRID, **QUERY, representation=representation, objectives=["length", Own(cost)])


@pytest.mark.parametrize("unusual", [np.inf, -np.inf, np.nan])
def test_costs_that_are_not_finite_stand_in_occupied_cells_alone(unusual):
    cost = FIELD.astype(float)
    cost[1, 1] = unusual
    F = GridPathProblem(GRID, **QUERY, objectives=["length", Own(cost)]).pareto_front()
    np.testing.assert_array_equal(F, GridPathProblem(GRID, **QUERY, objectives=["length", Own(FIELD)]).pareto_front())
    cost[2, 2] = unusual
    with pytest.raises(GridPathError, match=rf"is {unusual:g} in the free cell \(2, 2\), expected a finite number"):
        GridPathProblem(GRID, **QUERY, objectives=["length", Own(cost)])


def test_masked_costs_are_refused():
    with pytest.raises(GridPathError, match="the field of the objective 'own' holds masked values"):
        GridPathProblem(GRID, **QUERY, objectives=[Own(np.ma.masked_equal(FIELD, 5))])


@pytest.mark.parametrize("kind", [bool, np.int8, np.uint8, np.int64, np.uint64, np.float16, np.float32])
@pytest.mark.parametrize("representation", ["integer", "cells"])
def test_costs_of_any_type_give_what_floats_give(representation, kind):
    cost = FIELD.astype(kind)

    def front(field, **options):
        problem = GridPathProblem(GRID, **QUERY, representation=representation, objectives=[Own(field)], **options)
        operators = path_operators(problem)
        result = minimize(problem, NSGA2(pop_size=6, **operators), ("n_gen", 2), seed=1)
        X = np.random.default_rng(1).integers(problem.xl, problem.xu + 1, (20, problem.n_var))
        return problem.pareto_front(), result.F, problem.evaluate(X, return_values_of=["F"])

    for given_, plain in zip(front(cost), front(cost.astype(float)), strict=True):
        np.testing.assert_array_equal(given_, plain)
        assert given_.dtype == float


@pytest.mark.parametrize("kind", [int, bool, np.float16, np.uint64])
def test_values_of_an_objective_may_be_of_any_type_of_number(kind):
    problem = GridPathProblem(GRID, **QUERY, representation="integer", objectives=[Own(np.full(GRID.shape, 0.125), kind)])
    X = np.zeros((3, problem.n_var), dtype=int)
    paths = problem.decode(X)
    expected = (0.125 * np.array([len(paths.cells(k)) for k in range(3)])).astype(kind) + 2.0 * paths.interfering_cells
    assert problem.evaluate(X)[:, 0].tolist() == expected.tolist()


def test_an_objective_that_returns_nan_is_named():
    class Broken(Own):
        def __call__(self, paths, prepared):
            return np.full(len(paths), np.nan)

    problem = GridPathProblem(GRID, **QUERY, representation="integer", objectives=["length", Broken(FIELD)])
    with pytest.raises(GridPathError, match="the objective 'own' returned NaN for path 0, expected a number"):
        problem.evaluate(np.zeros((2, problem.n_var), dtype=int))


# -- single arguments ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("wrong", [None, "maze.yaml", np.zeros((3, 3)), 3, OccupancyGrid])
def test_a_grid_of_another_class_is_refused_wherever_one_is_taken(wrong):
    from pymoo_gridpath.algorithms import ahmed_deb_2013
    from pymoo_gridpath.fields import clearance, obstacle_potential
    from pymoo_gridpath.paths.frame import MonotoneFrame
    from pymoo_gridpath.plotting import plot_map

    takers = [clearance, obstacle_potential, plot_map]
    takers += [lambda grid, f=f: f(grid, (0, 0), (2, 2)) for f in (GridPathProblem, MonotoneFrame, ahmed_deb_2013)]
    takers += [lambda grid, f=f: f(grid, (0, 0), (2, 2)) for f in REPRESENTATIONS.values()]
    for take in takers:
        with pytest.raises(GridPathError, match=r"^grid is .*, expected an OccupancyGrid; load_map reads one$"):
            take(wrong)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"resolution": 10**400}, "resolution is a whole number of about 401 digits, expected a positive number"),
        ({"resolution": True}, "resolution is True"),
        ({"origin": 3}, r"origin is 3, expected \(x, y\) or"),
        ({"origin": itertools.count()}, "origin is an object of the class count"),
        ({"origin": (0, None)}, r"origin is \(0, None\)"),
        ({"corner_cutting": 1}, "corner_cutting is 1, expected True, False or 'one side'"),
        ({"name": None}, "name is None, expected a text"),
        ({"occupied": [[0, 1], [0]]}, "occupied is .*, expected a two-dimensional array"),
        ({"occupied": np.ma.masked_array([[0, 1]], mask=[[0, 1]])}, "occupied holds masked values"),
        ({"occupied": np.array([[0, 1]], dtype=complex)}, "occupied is an array of complex128"),
    ],
)
def test_arguments_of_grids_are_refused_in_a_sentence(arguments, said):
    with pytest.raises(GridError, match=said):
        OccupancyGrid(**{"occupied": [[0]], "resolution": 0.5, **arguments})


def test_numpys_scalars_are_taken():
    grid = OccupancyGrid(np.zeros((3, 3)), np.float32(0.5), np.array([1, 2]), np.True_, np.str_("n"))
    assert (grid.resolution, grid.origin, grid.corner_cutting, grid.name) == (0.5, (1.0, 2.0, 0.0), True, "n")
    problem = GridPathProblem(grid, np.array([0, 0], dtype=np.int8), (np.uint8(2), np.int64(2)), penalty=np.float32(3))
    assert (problem.start, problem.goal, problem.penalty) == ((0, 0), (2, 2), 3.0)
    assert CellSequence(grid, (0, 0), (2, 2), max_cells=np.int16(9)).n_var == 9


@pytest.mark.parametrize("wrong", [10**9, 10**400, -1, 2.5, "9", True, np.nan])
def test_rows_of_more_genes_than_memory_are_refused(wrong):
    with pytest.raises(GridPathError, match=r"max_cells is .*, expected a whole number of at least"):
        CellSequence(GRID, **QUERY, max_cells=wrong)


def test_bits_are_no_cells():
    """Rows of truth values once led from cell 0, whatever the start was."""
    coding = CellSequence(GRID, (4, 3), (0, 0))
    paths = coding.decode(np.ones((1, coding.n_var), dtype=bool))
    assert paths.cells(0)[0].tolist() == [4, 3] and paths.cells(0)[-1].tolist() == [0, 0]


def test_sizes_of_random_grids_are_bounded():
    from pymoo_gridpath.problems import random_dense_grid

    for size, p0, seed in ((10**9, 0.2, 1), (8.0, 0.2, 1), (8, np.nan, 1), (8, "0.2", 1), (8, 0.2, None), (8, 0.2, -1)):
        with pytest.raises(GridError, match=r"^(size|p0|random_state) is .*, expected "):
            random_dense_grid(size, p0, seed)


# -- arrays in any guise ------------------------------------------------------------------------------------------------------


def guises(array):
    """Return views and copies of an array that lie otherwise in memory, or may not be written into."""
    backwards = (slice(None, None, -1),) * array.ndim
    wide = np.zeros((*array.shape[:-1], 3 * array.shape[-1]), dtype=array.dtype)
    wide[..., 1::3] = array
    frozen = array.copy()
    frozen.flags.writeable = False
    return {
        "columns": np.asfortranarray(array),
        "flipped": array[backwards].copy()[backwards],
        "strided": wide[..., 1::3],
        "read-only": frozen,
        "transposed": np.ascontiguousarray(array.T).T,
        "other bytes": array.astype(array.dtype.newbyteorder()),
        "matrix": array.view(np.matrix) if array.ndim == 2 else array,
    }


def frozen(array):
    array = np.array(array)
    array.flags.writeable = False
    return array


@settings(max_examples=20)
@given(st.integers(0, 10**6), st.booleans())
def test_grids_are_the_same_in_any_guise(seed, corner_cutting):
    rng = np.random.default_rng(seed)
    occupied = frozen(rng.random((5, 7)) < 0.3)
    plain = OccupancyGrid(occupied, corner_cutting=corner_cutting)
    for name, view in guises(occupied).items():
        grid = OccupancyGrid(view, corner_cutting=corner_cutting)
        assert grid == plain and hash(grid) == hash(plain), name
        assert grid.occupied.flags.c_contiguous
        np.testing.assert_array_equal(grid.move_graph().toarray(), plain.move_graph().toarray())
        np.testing.assert_array_equal(grid.regions, plain.regions)


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_rows_are_decoded_repaired_and_scored_alike_in_any_guise(name):
    problem = GridPathProblem(GRID, **QUERY, representation=name, objectives=["length", "vulnerability", "turn"])
    coding = problem.representation
    X = frozen(np.random.default_rng(2).integers(problem.xl, problem.xu + 1, (12, problem.n_var)).astype(coding.vtype))
    paths = problem.decode(X)
    F, repaired = problem.evaluate(X), coding.repair(X, np.random.default_rng(3))
    legal = repaired[problem.decode(repaired).interfering_cells == 0]
    best = TradeOffSet.from_genes(problem, repaired).F if len(legal) else None
    for guise, view in guises(X).items():
        np.testing.assert_array_equal(problem.evaluate(view), F, err_msg=guise)
        np.testing.assert_array_equal(problem.decode(view).interfering_cells, paths.interfering_cells, err_msg=guise)
        np.testing.assert_array_equal(coding.repair(view, np.random.default_rng(3)), repaired, err_msg=guise)
        np.testing.assert_array_equal(
            coding.from_sequences(coding.to_sequences(coding.repair(view, np.random.default_rng(3)))),
            coding.from_sequences(coding.to_sequences(repaired)),
            err_msg=guise,
        )
    if best is not None:
        for guise, view in guises(repaired).items():
            np.testing.assert_array_equal(TradeOffSet.from_genes(problem, view).F, best, err_msg=guise)


@settings(max_examples=20)
@given(st.integers(0, 10**6), st.sampled_from(["integer", "cells"]))
def test_costs_give_the_same_fronts_in_any_guise(seed, representation):
    cost = frozen(np.random.default_rng(seed).integers(0, 9, GRID.shape) / 4)

    def front(field):
        problem = GridPathProblem(GRID, **QUERY, representation=representation, objectives=["length", Own(field)])
        found = exact_front(problem)
        return np.column_stack([found.F, problem.evaluate(found.X)])

    plain = front(cost)
    for guise, view in guises(cost).items():
        np.testing.assert_array_equal(front(view), plain, err_msg=guise)


@pytest.mark.parametrize("name", REPRESENTATIONS)
def test_prepared_fields_add_up_alike_in_any_guise(name):
    coding = make_representation(name, GRID, **QUERY)
    cost = frozen(FIELD / 8)
    X = np.random.default_rng(2).integers(coding.xl, coding.xu + 1, (9, coding.n_var))
    paths = coding.decode(X)
    plain = paths.total(coding.prepare(cost))
    assert plain.tolist() == [sum(cost[y, x] for x, y in paths.cells(k)) for k in range(9)]
    for guise, view in guises(cost).items():
        np.testing.assert_array_equal(paths.total(coding.prepare(view)), plain, err_msg=guise)
    for guise, view in guises(coding.prepare(cost)).items():
        if guise != "matrix":
            np.testing.assert_array_equal(paths.total(view), plain, err_msg=guise)


@settings(max_examples=20)
@given(st.integers(0, 10**6))
def test_knees_and_hypervolumes_are_the_same_in_any_guise(seed):
    from pymoo_gridpath.convergence import ConvergenceRecorder

    F = frozen(np.random.default_rng(seed).random((9, 2)))
    recorder = ConvergenceRecorder()
    recorder.evaluations, recorder.fronts = [1], [F]
    plain = recorder.hypervolume((1.0, 1.0))
    for guise, view in guises(F).items():
        assert knee_point(view) == knee_point(F), guise
        recorder.fronts = [view]
        np.testing.assert_array_equal(recorder.hypervolume(view.max(axis=0) * 0 + 1.0 if guise != "matrix" else (1, 1)), plain)


def test_cells_and_points_are_the_same_in_any_guise():
    cells = frozen(np.random.default_rng(0).integers(0, 5, (6, 2)))
    grid = GRID.replace(resolution=0.3, origin=(1.0, -2.0, 0.7))
    points = frozen(grid.to_metres(cells))
    for view, other in zip(guises(cells).values(), guises(points).values(), strict=True):
        np.testing.assert_array_equal(grid.to_metres(view), points)
        np.testing.assert_array_equal(grid.to_cells(other), cells)


def test_figures_are_the_same_in_any_guise():
    from matplotlib import pyplot as plt

    from pymoo_gridpath.plotting import plot_map

    cost = frozen(FIELD / 8)

    def picture(field):
        ax = plot_map(GRID, field)
        ax.figure.canvas.draw()
        pixels = np.asarray(ax.figure.canvas.buffer_rgba()).copy()
        plt.close("all")
        return pixels

    plain = picture(cost)
    for guise, view in guises(cost).items():
        np.testing.assert_array_equal(picture(view), plain, err_msg=guise)


# -- everything that is public ------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def fuzzer():
    if not FUZZ.is_dir():
        pytest.skip("the benchmarks are not beside the tests")
    if not hasattr(__import__("os"), "fork"):
        pytest.skip("the harness of the fuzzers forks its workers")
    sys.path.insert(0, str(FUZZ))
    try:
        import arguments
        import harness
        from calls import public_names

        yield arguments, harness, public_names
    finally:
        sys.path.remove(str(FUZZ))


def test_every_public_name_has_a_call_in_the_fuzzer(fuzzer):
    arguments, _, public_names = fuzzer
    assert public_names() - set(arguments.known_names()) == set()


# What only tells others of something, and is read by nobody who would have to check it.
DESCRIPTIONS = {"Capability", "ExactResult", "Outcome", "RunRecord"}


def flags_of(function, arguments) -> list[str]:
    """Return the arguments of a call that are True or False by their annotation."""
    parameters = inspect.signature(function).parameters.values()
    return [p.name for p in parameters if p.name in arguments and p.annotation in ("bool", "bool | None", bool)]


def test_flags_of_all_public_names_are_truth_values(fuzzer, tmp_path, monkeypatch):
    arguments, _, _ = fuzzer
    monkeypatch.chdir(tmp_path)
    seen = 0
    for name, (function, valid) in arguments.calls(arguments.World(tmp_path)).items():
        for flag in flags_of(function, valid) if name not in DESCRIPTIONS else ():
            for wrong in ("no", 2, np.ones(2, dtype=bool)):
                seen += 1
                with pytest.raises(GridPathError, match="expected "):
                    function(**{**valid, flag: wrong})
    assert seen >= 90


def test_wrong_arguments_are_refused_in_a_sentence_and_guises_give_the_same(fuzzer):
    arguments, harness, _ = fuzzer
    outcomes = list(harness.fuzz(arguments.make, range(10**6, 10**6 + 420), 1, arguments.SENTENCES))
    assert [outcome for outcome in outcomes if outcome.fault] == []
    assert len(outcomes) == 420
