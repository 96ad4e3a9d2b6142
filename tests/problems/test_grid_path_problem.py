"""GridPathProblem: objectives, the three ways to treat obstacles, and the promises made to pymoo."""

import copy
import pickle

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize
from queries import SPIRAL

from pymoo_gridpath.errors import GridPathError, UnreachableError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.objectives import Length, Objective, Vulnerability
from pymoo_gridpath.operators import RandomSampling, paper_operators
from pymoo_gridpath.problems import GridPathProblem, random_dense_grid
from pymoo_gridpath.problems import grid_path as module
from pymoo_gridpath.representations import CellSequence, make_representation
from pymoo_gridpath.testing import reference
from pymoo_gridpath.testing.global_state import global_state

GRID = random_dense_grid(12, 0.3, 4)
START, GOAL = (0, 0), (11, 11)


def genes(problem, n=50, seed=0):
    rng = np.random.default_rng(seed)
    X = rng.integers(problem.xl, problem.xu, size=(n, problem.n_var), endpoint=True).astype(problem.vtype)
    return problem.representation.repair(X, rng)


def plain(problem, X):
    """Length, vulnerability, turn and interfering cells of every path, by definition."""
    paths = problem.decode(X)
    rows = []
    for i in range(len(X)):
        cells = paths.cells(i).tolist()
        rows.append(
            [
                reference.length(cells),
                reference.vulnerability(cells, problem.grid),
                reference.turn(cells),
                reference.interfering_cells(cells, problem.grid),
            ]
        )
    return np.array(rows)


@pytest.mark.parametrize("representation", ["integer", "binary", "mixed", "absolute"])
def test_penalty_adds_to_every_objective(representation):
    problem = GridPathProblem(GRID, START, GOAL, representation, ("length", "vulnerability", "turn"), penalty=100.0)
    X = genes(problem)
    out = problem.evaluate(X, return_as_dictionary=True)
    expected = plain(problem, X)
    assert out["F"] == pytest.approx(expected[:, :3] + [100.0, 100.0, 4500.0] * expected[:, 3:], abs=1e-6)
    assert out["turn"] == pytest.approx(expected[:, 2]) and out["interfering_cells"] == pytest.approx(expected[:, 3])
    assert problem.n_constr == 0 and (expected[:, 3] > 0).any()


def test_constraint_is_the_number_of_interfering_cells():
    problem = GridPathProblem(GRID, START, GOAL, obstacles="constraint")
    X = genes(problem)
    F, G = problem.evaluate(X)
    expected = plain(problem, X)
    assert pytest.approx(expected[:, :2], abs=1e-6) == F and G[:, 0] == pytest.approx(expected[:, 3])


def test_limit_is_the_papers_equation_1():
    problem = GridPathProblem(GRID, START, GOAL, obstacles="limit", potential_limit=5.0)
    X = genes(problem)
    F, G = problem.evaluate(X)
    expected = plain(problem, X)
    potential = expected[:, 1] + GRID.occupied.size * expected[:, 3]
    assert pytest.approx(np.column_stack([expected[:, 0], potential]), abs=1e-6) == F
    assert G[:, 0] == pytest.approx(potential - 5.0, abs=1e-6)
    assert (expected[G[:, 0] <= 0, 3] == 0).all()


def test_evaluation_in_parts_equals_evaluation_at_once(monkeypatch):
    problem = GridPathProblem(GRID, START, GOAL)
    X = genes(problem, 101)
    whole = problem.evaluate(X)
    monkeypatch.setattr(module, "PART_SIZE", 40)
    assert np.array_equal(problem.evaluate(X), whole)
    assert np.array_equal(np.vstack([problem.evaluate(x) for x in X]), whole)


class Cells(Objective):
    """The number of visited cells, as an objective of a user's own."""

    name, label = "cells", "Cells visited"

    def field(self, grid):
        return np.ones(grid.shape)


class Own(Objective):
    """An objective with any field and any values."""

    name = label = "own"

    def __init__(self, field, values=None):
        self.values, self.cost = values, field

    def field(self, grid):
        return self.cost

    def __call__(self, paths, prepared):
        return super().__call__(paths, prepared) if self.values is None else self.values


@pytest.mark.parametrize("representation", ["integer", "cells"])
@pytest.mark.parametrize(
    ("field", "what"),
    [
        (np.zeros((6, 8)), r"an array of float64 of shape \(6, 8\)"),
        (np.zeros(48), r"an array of float64 of shape \(48,\)"),
        (3.0, "3.0"),
        (np.zeros((8, 6), dtype=complex), "an array of complex128"),
        ([["a"] * 6] * 8, "an array of <U1"),
        ([[1], [1, 2]], r"\[\[1\], \[1, 2\]\]"),
    ],
)
def test_fields_of_the_wrong_kind_are_refused(representation, field, what):
    grid = OccupancyGrid(np.zeros((8, 6)), corner_cutting=True)
    with pytest.raises(GridPathError, match=rf"the field of the objective 'own' is {what}.*, expected numbers of shape"):
        GridPathProblem(grid, (0, 0), (5, 7), representation, objectives=["length", Own(field)])
    lists = GridPathProblem(grid, (0, 0), (5, 7), representation, objectives=["length", Own([[1] * 6] * 8)])
    assert lists.pareto_front()[0, 1] == 8


def test_values_of_the_wrong_shape_are_refused():
    grid = OccupancyGrid(np.zeros((8, 8)), corner_cutting=True)
    problem = GridPathProblem(grid, (0, 0), (7, 7), objectives=["length", Own(None, values=np.zeros(2))])
    with pytest.raises(GridPathError, match=r"'own' returned values of shape \(2,\) for 3 paths"):
        problem.evaluate(np.zeros((3, 7), dtype=int))


def test_an_objective_without_a_name_is_refused():
    class Nameless(Own):
        name = None

    with pytest.raises(GridPathError, match="the objective Nameless has no name"):
        GridPathProblem(OccupancyGrid(np.zeros((8, 8))), (0, 0), (7, 7), objectives=["length", Nameless(None)])


def test_objectives_of_ones_own():
    problem = GridPathProblem(GRID, START, GOAL, objectives=[Cells(), Length(), Vulnerability(2.0)], obstacles="constraint")
    X = genes(problem)
    paths = problem.decode(X)
    F = problem.score(paths)
    assert F[:, 0].tolist() == [len(paths.cells(i)) for i in range(len(X))]
    assert F[0, 2] == pytest.approx(reference.vulnerability(paths.cells(0).tolist(), GRID, variance=2.0), abs=1e-6)


@pytest.mark.parametrize("corner_cutting", [True, False])
@pytest.mark.parametrize(
    "options",
    [{"obstacles": "penalty"}, {"obstacles": "constraint"}, {"obstacles": "limit", "potential_limit": 5.0}],
)
def test_the_same_paths_have_the_same_values_in_cells(options, corner_cutting):
    grid = GRID if corner_cutting else OccupancyGrid(np.random.default_rng(2).random((12, 12)) < 0.15, corner_cutting=False)
    integer = GridPathProblem(grid, START, GOAL, "integer", ("length", "vulnerability", "turn", Cells()), **options)
    coding = CellSequence(grid, START, GOAL, max_cells=grid.occupied.size)
    cells = GridPathProblem(grid, START, GOAL, coding, integer.objectives, **options)
    X = genes(integer)
    expected = integer.evaluate(X, return_as_dictionary=True)
    found = cells.evaluate(coding.encode(integer.decode(X)), return_as_dictionary=True)
    assert (expected["interfering_cells"] > 0).any()
    for key in expected:
        assert np.array_equal(found[key], expected[key]), key


def test_rows_that_are_no_paths_are_never_legal():
    problem = GridPathProblem(GRID, START, GOAL, "cells", ("length", "vulnerability", "turn"), penalty=100.0)
    X = RandomSampling()._do(problem, 30, random_state=np.random.default_rng(0))
    out = problem.evaluate(X, return_as_dictionary=True)
    field = reference.potential(GRID)
    for row, F, interfering in zip(X, out["F"], out["interfering_cells"], strict=True):
        cells = reference.visited(row, GRID.width)
        assert interfering == reference.broken_cells(cells, GRID) > 0
        plain = [reference.octile_length(cells), sum(field[y, x] for x, y in cells), reference.sign_turn(cells)]
        assert pytest.approx(plain + np.array([100.0, 100.0, 4500.0]) * interfering, abs=1e-6) == F


def test_a_path_that_turns_back_is_found_in_cells():
    problem = GridPathProblem(SPIRAL, (0, 0), (2, 2), "cells")
    repaired = problem.representation.repair(np.zeros((1, problem.n_var), dtype=int), np.random.default_rng(0))
    assert problem.evaluate(repaired)[0, 0] == 16.0
    result = minimize(problem, NSGA2(pop_size=10), ("n_gen", 3), seed=1)
    assert np.isfinite(result.F).all()


def test_rows_longer_than_a_part_are_evaluated(monkeypatch):
    problem = GridPathProblem(GRID, START, GOAL, "cells")
    X = RandomSampling()._do(problem, 5, random_state=np.random.default_rng(0))
    whole = problem.evaluate(X)
    monkeypatch.setattr(module, "PART_SIZE", problem.n_var // 3)
    assert np.array_equal(problem.evaluate(X), whole)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"representation": "cells", "axis": "x"}, "axis is 'x', but paths of the cells representation advance along none"),
        ({"objectives": ("lenght",)}, "no objective 'lenght'; did you mean 'length'"),
        ({"objectives": ()}, "expected one or more"),
        ({"objectives": ("length", "length")}, "each once"),
        ({"objectives": (3,)}, "neither a name nor an Objective"),
        ({"objectives": None}, "objectives is None, expected names such as 'length', or Objective objects"),
        ({"representation": "real"}, "no representation 'real'"),
        (
            {"representation": 3},
            "representation is 3, expected a name such as 'integer', a class derived from Representation, or an object of one",
        ),
        (
            {"representation": np.zeros(2)},
            r"representation is an array of float64 of shape \(2,\), expected a name such as 'integer'",
        ),
        ({"grid": "office"}, "grid is 'office', expected an OccupancyGrid; load_map reads one"),
        ({"obstacles": "wall"}, "obstacles is 'wall', expected one of penalty, constraint, limit"),
        ({"penalty": -1}, "penalty is -1, expected a positive number"),
        ({"penalty": "high"}, "penalty is 'high', expected a positive number"),
        ({"penalty": np.nan}, "penalty is nan, expected a positive number"),
        ({"penalty": np.inf}, "penalty is inf, expected a positive number"),
        ({"obstacles": "limit"}, "potential_limit is None, expected a positive number"),
        ({"obstacles": "limit", "potential_limit": "low"}, "potential_limit is 'low', expected a positive number"),
        ({"obstacles": "constraint", "penalty": 5.0}, "penalty is for obstacles='penalty' and 'limit'"),
        ({"potential_limit": 3.0}, "potential_limit is for obstacles='limit'"),
        ({"obstacles": "limit", "potential_limit": 1.0, "objectives": ("length",)}, "limits the vulnerability"),
        ({"start": (-1, 0)}, r"start \(-1, 0\) lies outside"),
        ({"goal": START}, "same cell"),
    ],
)
def test_bad_arguments_are_refused_in_words(options, message):
    with pytest.raises(GridPathError, match=message):
        GridPathProblem(**({"grid": GRID, "start": START, "goal": GOAL} | options))


def test_representation_of_another_query_is_refused():
    coding = make_representation("integer", GRID, START, GOAL)
    assert GridPathProblem(GRID, START, GOAL, coding).representation is coding
    with pytest.raises(GridPathError, match="another grid, start or goal"):
        GridPathProblem(GRID, GOAL, START, coding)
    with pytest.raises(GridPathError, match="give it to the representation"):
        GridPathProblem(GRID, START, GOAL, coding, axis="y")


def test_genes_that_are_no_numbers_are_refused():
    problem = GridPathProblem(GRID, START, GOAL)
    with pytest.raises(GridPathError, match="no finite numbers"):
        problem.evaluate(np.full((2, problem.n_var), np.nan))


def test_genes_beyond_their_bounds_count_as_the_bounds():
    problem = GridPathProblem(GRID, START, GOAL)
    X = np.full((1, problem.n_var), 99)
    assert np.array_equal(problem.evaluate(X), problem.evaluate(np.full((1, problem.n_var), 11)))


def test_unreachable_goal_is_refused():
    with pytest.raises(UnreachableError, match="cannot be reached"):
        GridPathProblem(OccupancyGrid([[0, 1, 0]]), (0, 0), (2, 0))


def test_stock_nsga2_just_works_on_real_genes():
    result = minimize(GridPathProblem(GRID, START, GOAL), NSGA2(pop_size=20), ("n_gen", 5), seed=1)
    assert result.F.shape[1] == 2 and np.isfinite(result.F).all()


@pytest.mark.parametrize("clone", [copy.deepcopy, lambda p: pickle.loads(pickle.dumps(p))])
@pytest.mark.parametrize("representation", ["mixed", "cells"])
def test_copies_evaluate_the_same(clone, representation):
    problem = GridPathProblem(GRID, START, GOAL, representation, obstacles="constraint")
    X = genes(problem)
    assert all(np.array_equal(a, b) for a, b in zip(problem.evaluate(X), clone(problem).evaluate(X), strict=True))


def test_evaluation_leaves_its_arguments_and_the_global_random_state_alone():
    problem = GridPathProblem(GRID, START, GOAL)
    X = genes(problem)
    before, state = X.copy(), global_state()
    first = problem.evaluate(X)
    assert np.array_equal(X, before) and np.array_equal(problem.evaluate(X), first)
    assert global_state() == state


def test_ties_carry_no_float_noise():
    """Different paths over cells of equal worth have exactly equal objectives."""
    grid = OccupancyGrid(np.zeros((9, 9)), corner_cutting=True)
    problem = GridPathProblem(grid, START, (8, 8), objectives=("length",))
    rng = np.random.default_rng(0)
    rows = np.stack([rng.permutation([0] * 3 + [1] * 2 + [3] * 2) for _ in range(200)])
    X = np.column_stack([np.zeros(200, dtype=int), rows])
    assert len(np.unique(problem.evaluate(X))) == 1


@pytest.mark.parametrize("size", [8, 16])
@pytest.mark.parametrize("p0", [0.0, 0.4, 1.0])
def test_random_dense_grids_hold_a_path_and_the_density(size, p0):
    for seed in range(20):
        grid = random_dense_grid(size, p0, seed)
        assert grid == random_dense_grid(size, p0, seed)
        problem = GridPathProblem(grid, (0, 0), (size - 1, size - 1))  # raises where no monotone path exists
        assert problem.representation.frame.admits_path()
    cells = size**2 - np.mean([random_dense_grid(size, 1.0, s).n_occupied for s in range(100)])
    # Cells of the free path: one a column and the further cells of its climbs.
    assert 1.3 * size < cells < 1.7 * size
    share = np.mean([random_dense_grid(size, p0, s).n_occupied for s in range(100)]) / (size**2 - cells)
    assert share == pytest.approx(p0, abs=0.02)


@pytest.mark.parametrize(("size", "p0"), [(1, 0.5), (8, -0.1), (8, 1.1)])
def test_scenarios_check_their_arguments(size, p0):
    with pytest.raises(GridPathError, match="expected"):
        random_dense_grid(size, p0, 0)


def test_operators_fit_any_pymoo_algorithm():
    problem = GridPathProblem(GRID, START, GOAL)
    result = minimize(problem, NSGA2(pop_size=40, **paper_operators(problem)), ("n_gen", 30), seed=1)
    assert result.pop.get("X").dtype.kind == "i"
    assert (result.pop.get("interfering_cells") == 0).any()


def test_the_papers_operators_are_refused_for_cells():
    with pytest.raises(GridPathError, match=r"no operators for the cells representation.*path_operators"):
        paper_operators(GridPathProblem(GRID, START, GOAL, "cells"))
