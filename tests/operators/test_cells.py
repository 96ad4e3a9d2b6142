"""The operators of the variable-length genetic algorithm beside slow references, and roulette and elitism by hand."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymoo.core.population import Population
from queries import SPIRAL, queries

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.neighbourhood import HEADINGS
from pymoo_gridpath.operators import CellMutation, ElitistSurvival, GreedySampling, RouletteSelection, SharedCellCrossover
from pymoo_gridpath.operators.path_terrain import terrain_of
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.search.cell_rows import change_cells, cross_at_shared_cells, walks
from pymoo_gridpath.testing.reference import is_legal


def problem_of(query, max_cells=None):
    grid, start, goal = query[:3]
    return GridPathProblem(grid, start, goal, CellSequence(grid, start, goal, max_cells), ["length"])


def cells(problem, row):
    """The cells (x, y) of a row, whatever it holds, none following itself."""
    path = [divmod(int(cell), problem.grid.width)[::-1] for cell in row]
    return [path[0], *(other for cell, other in pairwise(path) if cell != other)]


def without_loops(path):
    kept, k = [], 0
    while k < len(path):
        kept.append(path[k])
        k = len(path) - path[::-1].index(path[k])
    return kept


def neighbours(grid, cell, by_legal_steps):
    """The cells around one: those on the grid, or those that a legal step leads to."""
    around = [(cell[0] + int(dx), cell[1] + int(dy)) for dx, dy in HEADINGS]
    inside = [(x, y) for x, y in around if 0 <= x < grid.width and 0 <= y < grid.height]
    return [other for other in inside if not by_legal_steps or is_legal([cell, other], grid, cell, other)]


def walk(problem, path, draws):
    """The walk on from a path, one draw a cell; None if it comes to a dead end or is too long."""
    path = list(path)
    useful = terrain_of(problem).useful
    while path[-1] != problem.goal:
        free = [cell for cell in neighbours(problem.grid, path[-1], True) if cell not in path]
        free = [cell for cell in free if useful[problem.representation.moves.index(cell)]]
        if not free or len(path) == len(draws):
            return None
        free.sort(key=lambda cell: math.dist(cell, problem.goal))
        draw = draws[len(path)]
        # The k-th is taken from 2**-k to twice that.
        rank = math.ceil(-math.log2(draw)) - 1 if draw > 0 else len(free)
        path.append(free[min(rank, len(free) - 1)])
    return path


def rows_of(problem, rng, n=12):
    """Random walks, some of them changed to what is no legal path."""
    X = GreedySampling().do(problem, n, random_state=rng).get("X")
    X[: n // 2] = CellMutation(prob_var=0.4).do(problem, Population.new("X", X[: n // 2]), random_state=rng).get("X")
    return X


# -- sampling -------------------------------------------------------------------------------------------------------------


@settings(max_examples=60, deadline=None)
@given(queries(density=0.25))
def test_walks_are_those_of_the_reference(query):
    problem = problem_of(query)
    draws = query[-1].random((6, problem.n_var))
    moves = problem.representation.moves
    found = walks(terrain_of(problem), draws)
    for i in range(6):
        path = moves.cells(found.cells[found.offsets[i] : found.offsets[i + 1]]).tolist()
        expected = walk(problem, [problem.start], draws[i])
        assert [tuple(cell) for cell in path] == (expected or [])


@settings(max_examples=40, deadline=None)
@given(queries(density=0.3), st.integers(1, 20))
def test_first_populations_are_legal_and_fit(query, n):
    problem = problem_of(query)
    X = GreedySampling().do(problem, n, random_state=query[-1]).get("X")
    assert X.shape == (n, problem.n_var)
    for row in X:
        path = cells(problem, row)
        assert is_legal(path, *query[:3]) and len(set(path)) == len(path)


def test_the_second_nearest_is_taken_half_as_often_as_the_nearest():
    problem = problem_of((OccupancyGrid(np.zeros((9, 9)), corner_cutting=True), (4, 4), (8, 5)))
    X = GreedySampling().do(problem, 20_000, random_state=np.random.default_rng(1)).get("X")
    taken, counts = np.unique(X[:, 1], return_counts=True)
    # By distance to the goal, 8 right and 5 up of the corner; all eight are free.
    order = sorted(neighbours(problem.grid, (4, 4), True), key=lambda cell: math.dist(cell, (8, 5)))
    shares = dict(zip(taken.tolist(), counts / len(X), strict=True))
    assert [round(shares[y * 9 + x], 2) for x, y in order[:5]] == pytest.approx([0.5, 0.25, 0.12, 0.06, 0.03], abs=0.011)


def test_dead_ends_become_shortest_paths():
    """Walks into a pocket that have to come out again are too long; through a spiral there is one way alone."""
    pocket = np.zeros((7, 9), dtype=bool)
    pocket[1:6, 6], pocket[1, 2:6], pocket[5, 2:6] = True, True, True
    problem = problem_of((OccupancyGrid(pocket), (1, 3), (8, 3)), max_cells=13)
    X = GreedySampling().do(problem, 30, random_state=np.random.default_rng(2)).get("X")
    lengths = [len(cells(problem, row)) for row in X]
    assert max(lengths) <= 13 and all(is_legal(cells(problem, row), problem.grid, (1, 3), (8, 3)) for row in X)
    only = problem_of((SPIRAL, (0, 0), (0, 2)))
    assert len(np.unique(GreedySampling().do(only, 5, random_state=np.random.default_rng(1)).get("X"), axis=0)) == 1


@pytest.mark.parametrize(("start", "goal"), [((0, 0), (7, 3)), ((7, 6), (2, 0)), ((3, 5), (3, 0)), ((6, 1), (0, 4))])
def test_the_printed_start_steps_to_the_nearest_neighbour_whatever_it_holds(start, goal):
    rng = np.random.default_rng(4)
    occupied = rng.random((7, 8)) < 0.2
    occupied[[start[1], goal[1]], [start[0], goal[0]]] = False
    problem = problem_of((OccupancyGrid(occupied, corner_cutting=True), start, goal))
    X = GreedySampling(greedy=True).do(problem, 4, random_state=rng).get("X")
    assert (X[0] == X).all()
    path = [start]
    while path[-1] != goal:
        path.append(min(neighbours(problem.grid, path[-1], False), key=lambda cell: math.dist(cell, goal)))
    assert cells(problem, X[0]) == path


# -- crossover ------------------------------------------------------------------------------------------------------------


@settings(max_examples=60, deadline=None)
@given(queries(density=0.2))
def test_children_join_a_head_and_a_tail_at_a_shared_cell(query):
    problem, rng = problem_of(query), query[-1]
    X = rows_of(problem, rng).reshape(2, -1, problem.n_var)
    before, moves = X.copy(), problem.representation.moves
    rows = moves.from_grid(X)
    # All numbers that choose another cell where there are up to 64 of them.
    found = [set() for _ in range(X.shape[1])]
    for draw in np.arange(64) / 64:
        children = moves.to_grid(
            cross_at_shared_cells(rows, moves.index(problem.goal), moves.n_cells, np.full(X.shape[1], draw))
        )
        for i, pair in enumerate(np.swapaxes(children, 0, 1)):
            found[i].add(tuple(tuple(cells(problem, row)) for row in pair))
    assert np.array_equal(X, before)
    for i in range(X.shape[1]):
        a, b = cells(problem, X[0, i]), cells(problem, X[1, i])
        joins = {
            tuple(
                tuple(child if len(child) <= problem.n_var else parent)
                for child, parent in ((without_loops(a[:k] + b[j:]), a), (without_loops(b[:j] + a[k:]), b))
            )
            for k in range(1, len(a) - 1)
            for j in range(1, len(b) - 1)
            if a[k] == b[j]
        }
        assert found[i] == joins if joins else found[i] == {(tuple(a), tuple(b))}


def test_legal_parents_have_legal_children():
    problem = problem_of((SPIRAL.replace(occupied=np.zeros((8, 8))), (0, 0), (7, 7)))
    rng = np.random.default_rng(3)
    pop = GreedySampling().do(problem, 60, random_state=rng)
    children = SharedCellCrossover(prob=1.0).do(problem, pop, np.arange(60).reshape(-1, 2), random_state=rng).get("X")
    assert (problem.decode(children).interfering_cells == 0).all()
    assert len(np.unique(np.vstack([children, pop.get("X")]), axis=0)) > len(np.unique(pop.get("X"), axis=0))


def test_children_that_do_not_fit_are_their_parents():
    # On a grid of 9 x 3, from 0 to 8; both visit cell 13, one as its fifth and the other as its ninth.
    late = [0, 9, 18, 19, 20, 21, 22, 14, 13, 5, 6, 7, 8]
    soon = [0, 1, 2, 3, 13, 23, 24, 25, 26, 17, 16, 7, 8]
    crossed = cross_at_shared_cells(np.array([[late], [soon]]), 8, 27, np.zeros(1))
    # The head of one and the tail of the other are 17 cells, and what is left of the other two nine.
    assert crossed[0, 0].tolist() == late
    assert crossed[1, 0].tolist() == [0, 1, 2, 3, 13, 5, 6, 7, 8, 8, 8, 8, 8]


# -- mutation -------------------------------------------------------------------------------------------------------------


@settings(max_examples=40, deadline=None)
@given(queries(density=0.2), st.booleans())
def test_a_change_is_one_of_those_that_there_are(query, regrow):
    problem, rng = problem_of(query), query[-1]
    X, moves = rows_of(problem, rng, 6), problem.representation.moves
    row = X[int(rng.integers(6))]
    path = cells(problem, row)
    if len(path) < 3:
        return
    k = int(rng.integers(1, len(path) - 1))
    draws = np.full((4, 64, problem.n_var), 0.5)
    draws[0, :, k] = 0.0
    draws[1] = 0.0 if regrow else 1.0
    draws[2] = (np.arange(64) / 64)[:, None]
    draws[3] = rng.random((64, problem.n_var))
    rows = moves.from_grid(np.tile(row, (64, 1)))
    changed = moves.to_grid(change_cells(terrain_of(problem), rows, 0.1, 0.5, draws))
    found = [cells(problem, one) for one in changed]
    if regrow:
        on = [walk(problem, path[: k + 1], draws[3, i]) for i in range(64)]
        assert found == [path if one is None else without_loops(one) for one in on]
    else:
        beside = set(neighbours(problem.grid, path[k - 1], False)) & set(neighbours(problem.grid, path[k + 1], False))
        beside = {
            cell for cell in beside - {path[k]} if moves.from_grid(np.array([cell[1] * problem.grid.width + cell[0]]))[0] >= 0
        }
        expected = {tuple(without_loops([*path[:k], cell, *path[k + 1 :]])) for cell in beside} or {tuple(path)}
        assert set(map(tuple, found)) == expected


def test_each_cell_changes_at_its_rate():
    problem = problem_of((OccupancyGrid(np.zeros((6, 40)), corner_cutting=True), (0, 2), (39, 2)))
    X = np.tile(GreedySampling(greedy=True).do(problem, 1, random_state=np.random.default_rng(1)).get("X"), (4000, 1))
    still = CellMutation(prob_var=0.0).do(problem, Population.new("X", X.copy()), random_state=np.random.default_rng(1))
    assert np.array_equal(still.get("X"), X)
    mutation = CellMutation(prob_var=0.02, regrow=0.0)
    changed = mutation.do(problem, Population.new("X", X.copy()), random_state=np.random.default_rng(1)).get("X")
    # Each of the 38 cells between the ends.
    assert (changed != X).sum() / (4000 * 38) == pytest.approx(0.02, rel=0.05)
    torn = CellMutation(prob_var=0.02, anywhere=True)
    changed = torn.do(problem, Population.new("X", X.copy()), random_state=np.random.default_rng(1)).get("X")
    assert (changed != X).sum() / (4000 * 38) == pytest.approx(0.02 * 239 / 240, rel=0.05)
    assert (changed[:, [0]] == X[:, [0]]).all() and (changed[:, 39:] == X[:, 39:]).all()


def test_obstacles_may_be_entered_and_are_never_taken_for_legal():
    problem = problem_of((OccupancyGrid(np.pad(np.ones((1, 5)), 1), corner_cutting=True), (0, 0), (6, 0)))
    X = np.tile(GreedySampling(greedy=True).do(problem, 1, random_state=np.random.default_rng(1)).get("X"), (50, 1))
    changed = CellMutation(prob_var=0.5, regrow=0.0).do(problem, Population.new("X", X), random_state=np.random.default_rng(1))
    crossed = problem.decode(changed.get("X")).interfering_cells
    legal = [is_legal(cells(problem, row), problem.grid, (0, 0), (6, 0)) for row in changed.get("X")]
    assert ((crossed == 0) == legal).all() and not all(legal)


# -- selection and survival -------------------------------------------------------------------------------------------------


def evaluated(F, born, CV=None):
    pop = Population.new("X", np.arange(len(F))[:, None])
    pop.set(
        "F",
        np.array(F, dtype=float)[:, None],
        "n_gen",
        born,
        "CV",
        np.zeros((len(F), 1)) if CV is None else np.array(CV)[:, None],
    )
    return pop


@pytest.mark.parametrize(
    ("literal", "weights"),
    [(False, [1 / 10, 1 / 20, 1 / 310, 1 / 610]), (True, [9, 19, 309, 609])],
)
def test_the_wheel_has_slices_by_fitness(literal, weights):
    pop = evaluated([9, 19, 9, 9], [1] * 4, [0.0, 0.0, 1.0, 2.0])
    drawn = RouletteSelection(literal).do(None, pop, 30_000, 2, to_pop=False, random_state=np.random.default_rng(1))
    assert drawn.shape == (30_000, 2)
    shares = np.bincount(drawn.ravel(), minlength=4) / drawn.size
    assert shares == pytest.approx(np.array(weights) / sum(weights), abs=0.006)


def test_the_wheel_turns_where_fitness_is_nought_or_less():
    rng = np.random.default_rng(1)
    for F in ([0.0, 0.0], [-5.0, -5.0], [-5.0, -1.0]):
        for literal in (False, True):
            drawn = RouletteSelection(literal).do(None, evaluated(F, [1, 1]), 200, 2, to_pop=False, random_state=rng)
            assert set(np.unique(drawn)) <= {0, 1} and (len(np.unique(drawn)) == 2 or (literal and F[0] != F[1]))


@pytest.mark.parametrize(
    ("F", "born", "n_survive", "survivors"),
    [
        # The best parent is better than all children and takes the place of the worst.
        ([5, 7, 9, 8, 6], [1, 1, 2, 2, 2], 3, [0, 3, 4]),
        # A child is as good, or better.
        ([5, 7, 9, 8, 5], [1, 1, 2, 2, 2], 3, [2, 3, 4]),
        ([5, 7, 9, 8, 4], [1, 1, 2, 2, 2], 3, [2, 3, 4]),
        # Parents may be of any generation before.
        ([7, 3, 9, 8], [4, 2, 5, 5], 2, [1, 3]),
        # Too few children, and too many.
        ([7, 3, 9], [1, 1, 2], 2, [2, 1]),
        ([1, 7, 3, 9], [1, 2, 2, 2], 2, [0, 2]),
        # Nobody says when they were made.
        ([4, 2, 3], [None] * 3, 3, [0, 1, 2]),
    ],
)
def test_children_replace_parents_but_the_best(F, born, n_survive, survivors):
    pop = ElitistSurvival().do(None, evaluated(F, born), n_survive=n_survive)
    assert sorted(pop.get("X")[:, 0].tolist()) == sorted(survivors)


def test_obstacles_count_in_survival():
    pop = ElitistSurvival().do(None, evaluated([20, 5, 9], [1, 2, 2], [0.0, 1.0, 1.0]), n_survive=2)
    assert sorted(pop.get("X")[:, 0].tolist()) == [0, 1]


# -- what they refuse -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("operator", [GreedySampling(), SharedCellCrossover(), CellMutation()])
def test_other_codings_are_refused(operator):
    problem = GridPathProblem(OccupancyGrid(np.zeros((5, 5)), corner_cutting=True), (0, 0), (4, 4), "integer")
    said = rf"^{type(operator).__name__} is for lists of cells, .* integer representation; give it representation='cells'$"
    with pytest.raises(CapabilityError, match=said):
        operator._do(problem, 3, random_state=np.random.default_rng(1))


def test_several_objectives_are_refused():
    pop = evaluated([1, 2], [1, 1])
    pop.set("F", np.ones((2, 2)))
    for operator, arguments in ((RouletteSelection(), (1, 2)), (ElitistSurvival(), ())):
        with pytest.raises(CapabilityError, match=f"^{type(operator).__name__} is for one objective, the problem has 2$"):
            operator._do(None, pop, *arguments, random_state=np.random.default_rng(1))


@pytest.mark.parametrize(
    "make",
    [
        lambda: GreedySampling(greedy=1),
        lambda: SharedCellCrossover(prob=2),
        lambda: SharedCellCrossover(n_offsprings=3),
        lambda: CellMutation(prob_var=-0.1),
        lambda: CellMutation(regrow=1.5),
        lambda: CellMutation(anywhere="yes"),
        lambda: RouletteSelection(literal=0),
        lambda: RouletteSelection(damping=-1),
        lambda: ElitistSurvival(damping="much"),
    ],
)
def test_wrong_arguments_are_refused(make):
    with pytest.raises(GridPathError, match="expected"):
        make()
