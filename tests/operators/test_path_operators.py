"""Path-aware operators: what they make is legal, new, and the same again, in every representation and algorithm."""

import json
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.problem import Problem
from pymoo.optimize import minimize
from queries import SPIRAL, queries, random_genes

from pymoo_gridpath.algorithms import CAPABILITIES, make_algorithm
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.operators import (
    PathMutation,
    PathRepair,
    ReachableSampling,
    ScalarizedSampling,
    SpliceCrossover,
    default_operators,
    paper_operators,
    path_operators,
    path_sampling,
)
from pymoo_gridpath.operators.path_mutation import EXPANSIONS_PER_STEP, WAYS
from pymoo_gridpath.operators.path_terrain import random_weights, terrain_of
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.problems import GridPathProblem, random_dense_grid
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.search.moves import Moves
from pymoo_gridpath.search.sequences import mend

NAMES = ["integer", "binary", "mixed", "absolute", "cells"]


class Dark(Objective):
    """How much of a path lies to the left, in cells that cost the less the farther right they are."""

    name = label = "dark"

    def field(self, grid):
        return np.tile(float(grid.width) - np.arange(grid.width), (grid.height, 1))


class Odd(Objective):
    """An objective that does not add up."""

    name = label = "odd"

    def __call__(self, paths, prepared):
        return paths.turn % 2


def corner_to_corner(name="cells", size=16, p0=0.3, seed=0, objectives=("length", "vulnerability"), **options):
    grid = random_dense_grid(size, p0, seed)
    return GridPathProblem(grid, (0, 0), (size - 1, size - 1), name, objectives, **options)


def is_legal(problem, X):
    return (problem.decode(X).interfering_cells == 0).all()


def rows(X):
    return set(map(tuple, X.tolist()))


# -- sampling -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("sampling", [ReachableSampling, ScalarizedSampling])
@pytest.mark.parametrize("name", ["integer", "cells"])
def test_samples_are_legal_however_dense_the_grid(name, sampling):
    for p0 in np.arange(1, 11) / 10:
        for size in (8, 20):
            problem = corner_to_corner(name, size, p0, seed=round(10 * p0))
            X = sampling().do(problem, 30, random_state=np.random.default_rng(1)).get("X")
            assert X.shape == (30, problem.n_var) and X.dtype == np.dtype(problem.vtype)
            assert (problem.xl <= X).all() and (problem.xu >= X).all()
            assert is_legal(problem, X)


@pytest.mark.parametrize("name", ["integer", "cells"])
def test_the_only_corridor_of_a_large_grid_is_found_at_once(name):
    problem = corner_to_corner(name, 128, 1.0)
    for sampling in (ReachableSampling(), ScalarizedSampling()):
        assert is_legal(problem, sampling.do(problem, 20, random_state=np.random.default_rng(0)).get("X"))


@pytest.mark.parametrize("name", NAMES)
def test_random_samples_differ_and_reach_all_over(name):
    problem = corner_to_corner(name, 20, 0.1)
    X = ReachableSampling().do(problem, 200, random_state=np.random.default_rng(0)).get("X")
    assert len(rows(X)) > 190
    visited = np.unique(problem.representation.to_sequences(X).cells)
    assert len(visited) > 0.8 * terrain_of(problem).useful.sum()
    straight = ReachableSampling(roughness=0, detour=0).do(problem, 50, random_state=np.random.default_rng(0)).get("X")
    assert problem.decode(straight).length.mean() < 0.95 * problem.decode(X).length.mean()


def test_scalarised_samples_contain_the_best_of_each_objective_and_no_duplicates():
    problem = corner_to_corner("cells", 24, 0.2)
    front = problem.pareto_front(max_seconds=60)
    X = ScalarizedSampling().do(problem, 40, random_state=np.random.default_rng(0)).get("X")
    F = problem.score(problem.decode(X))
    for best in (front[front[:, 0].argmin()], front[front[:, 1].argmin()]):
        assert np.abs(F - best).max(axis=1).min() < 0.01
    assert len(rows(X)) > 35
    plain = ScalarizedSampling(noise=0).do(problem, 40, random_state=np.random.default_rng(0)).get("X")
    assert 3 < len(rows(plain)) < 30
    # Each is the best for its weights, so none dominates another.
    G = problem.score(problem.decode(plain))
    assert not ((G[:, None] < G[None] - 1e-6).all(axis=2)).any()


@pytest.mark.parametrize(
    ("objectives", "n_terms"),
    [
        (("length",), 1),
        (("turn",), 1),
        (("vulnerability", "turn"), 2),
        (("length", "vulnerability", Dark()), 3),
        (("length", Odd()), 1),
    ],
)
def test_objectives_that_do_not_add_up_are_left_out_of_the_weights(objectives, n_terms):
    problem = corner_to_corner("cells", 12, 0.2, objectives=objectives)
    assert terrain_of(problem).n_terms == n_terms
    weights = random_weights(problem, 50, np.random.default_rng(0))
    assert weights.shape == (50, n_terms) and weights.min() >= 1
    for sampling in (ReachableSampling(), ScalarizedSampling()):
        for n in (1, 2, 17):
            X = sampling.do(problem, n, random_state=np.random.default_rng(1)).get("X")
            assert len(X) == n and is_legal(problem, X)


def test_random_samples_differ_however_tight_the_room():
    grid = random_dense_grid(40, 0.1, 0)
    least = len(mend(Sequences(np.zeros(0, dtype=np.int64), np.zeros(2, dtype=np.int64)), Moves(grid), 0, 1599).cells)
    for room, n_distinct in ((0, 50), (2, 90), (10, 98)):
        coding = CellSequence(grid, (0, 0), (39, 39), max_cells=least + room)
        problem = GridPathProblem(grid, (0, 0), (39, 39), coding)
        X = ReachableSampling().do(problem, 100, random_state=np.random.default_rng(0)).get("X")
        assert is_legal(problem, X) and len(rows(X)) >= n_distinct


def test_scalarised_searches_are_few(monkeypatch):
    searched = []
    cheapest_paths = path_sampling.cheapest_paths

    def counted(terrain, moves, weights, *args):
        searched.append(len(weights))
        return cheapest_paths(terrain, moves, weights, *args)

    monkeypatch.setattr(path_sampling, "cheapest_paths", counted)
    problem = corner_to_corner("cells", 24, 0.1, objectives=("length",))
    ScalarizedSampling(noise=0).do(problem, 30, random_state=np.random.default_rng(0))
    assert searched == [1], "all weights are the same"
    searched.clear()
    monkeypatch.setattr(path_sampling, "SEARCH_CELLS", 0)
    for name in ("cells", "integer"):
        problem = corner_to_corner(name, 24, 0.1)
        X = ScalarizedSampling().do(problem, 100, random_state=np.random.default_rng(0)).get("X")
        assert is_legal(problem, X) and len(rows(X)) > 60
    assert sum(searched) == 2 * path_sampling.LEAST_SEARCHES


# -- crossover, mutation, repair ----------------------------------------------------------------------------------------


@settings(max_examples=40)
@given(queries(density=0.25), st.sampled_from(NAMES))
def test_children_are_legal_whatever_the_parents(query, name):
    grid, start, goal, axis, rng = query
    problem = GridPathProblem(grid, start, goal, name, axis="auto" if name == "cells" else axis)
    made = path_operators(problem)
    good = made["sampling"]._do(problem, 12, random_state=rng)
    bad = problem.representation.repair(random_genes(problem.representation, rng, 12), rng)
    for X in (good, bad):
        before = X.copy()
        for n_offsprings in (1, 2):
            crossover = SpliceCrossover(n_offsprings=n_offsprings)
            children = crossover._do(problem, X.reshape(2, 6, -1), random_state=rng)
            assert children.shape == (n_offsprings, 6, problem.n_var) and children.dtype == X.dtype
            assert is_legal(problem, children.reshape(-1, problem.n_var))
        mutated = made["mutation"]._do(problem, X, random_state=rng)
        assert mutated.shape == X.shape and mutated.dtype == X.dtype and is_legal(problem, mutated)
        repaired = made["repair"]._do(problem, X, random_state=rng)
        assert repaired.dtype == np.dtype(problem.vtype) and is_legal(problem, repaired)
        assert np.array_equal(X, before)
    assert np.array_equal(made["repair"]._do(problem, good, random_state=rng), good)


@pytest.mark.parametrize("name", NAMES)
def test_repair_takes_real_genes(name):
    problem = corner_to_corner(name)
    rng = np.random.default_rng(0)
    X = rng.uniform(problem.xl - 1.0, problem.xu + 1.0, (30, problem.n_var))
    repaired = PathRepair()._do(problem, X, random_state=rng)
    assert repaired.dtype == np.dtype(problem.vtype) and is_legal(problem, repaired)


@pytest.mark.parametrize("name", NAMES)
def test_most_children_are_new(name):
    problem = corner_to_corner(name, 32, 0.2)
    rng = np.random.default_rng(0)
    X = ReachableSampling()._do(problem, 100, random_state=rng)
    children = SpliceCrossover()._do(problem, X.reshape(2, 50, -1), random_state=rng).reshape(100, -1)
    assert len(rows(children) - rows(X)) > 70
    mutated = PathMutation()._do(problem, X, random_state=rng)
    assert len(rows(mutated) - rows(X)) > 40


@pytest.mark.parametrize("way", list(WAYS))
def test_each_way_of_mutation_does_what_it_says(way):
    problem = corner_to_corner("cells", 24, 0.1)
    rng = np.random.default_rng(1)
    X = ReachableSampling()._do(problem, 200, random_state=rng)
    mutated = PathMutation({way: 1.0})._do(problem, X, random_state=rng)
    changed = (mutated != X).any(axis=1)
    assert 20 < changed.sum() < 200 and is_legal(problem, mutated)
    (length, potential), (length_, potential_) = (problem.score(problem.decode(Y)[changed]).T for Y in (X, mutated))
    turn, turn_ = (problem.decode(Y)[changed].turn for Y in (X, mutated))
    if way == "shortcut":
        assert (length_ <= length + 1e-9).all() and length_.mean() < length.mean()
    elif way == "straighten":
        assert turn_.mean() < turn.mean()
    elif way == "weighted":
        assert length_.mean() < length.mean() and potential_.mean() < potential.mean()


def test_fewer_expansions_change_shorter_stretches():
    problem = corner_to_corner("cells", 48, 0.1)
    X = ReachableSampling()._do(problem, 200, random_state=np.random.default_rng(2))
    paths = problem.decode(X)
    shares = []
    for most in (1, 4 * EXPANSIONS_PER_STEP, 20 * EXPANSIONS_PER_STEP):
        mutation = PathMutation({"shortcut": 1.0}, max_expansions=most)
        changes = mutation._draw(problem, paths.sequences.lengths, np.random.default_rng(3))
        assert (changes.end - changes.begin).max() == max(most // EXPANSIONS_PER_STEP, 1)
        mutated = mutation._do(problem, X, random_state=np.random.default_rng(3))
        assert is_legal(problem, mutated) and (problem.decode(mutated).length <= paths.length + 1e-9).all()
        shares.append((mutated != X).any(axis=1).mean())
    assert shares == sorted(shares) and shares[0] == 0 and shares[-1] > 0.3


def test_children_that_are_legal_already_are_not_repaired():
    class Counted(PathRepair):
        n = 0

        def _do(self, problem, X, **kwargs):
            Counted.n += 1
            return super()._do(problem, X, **kwargs)

    class Own(PathMutation):
        def _do(self, problem, X, *args, **kwargs):
            return super()._do(problem, X, *args, **kwargs)

    problem = corner_to_corner("cells", 16, 0.2)
    found, counts = [], []
    for mutation in (PathMutation(), Own(), PathMutation(prob=0.5)):
        Counted.n = 0
        made = path_operators(problem) | {"mutation": mutation, "repair": Counted()}
        algorithm = make_algorithm("NSGA2", problem, 12, operators=made)
        found.append(minimize(problem, algorithm, ("n_gen", 5), seed=1).pop.get("X"))
        counts.append(Counted.n)
    # The first generation always is; and what another class or half of the parents hand on may be anything.
    assert counts[0] == 1 and min(counts[1:]) >= 5
    assert np.array_equal(found[0], found[1])


def test_room_is_kept_to():
    grid = SPIRAL.replace(occupied=np.zeros((12, 12)))
    problem = GridPathProblem(grid, (0, 0), (11, 11), CellSequence(grid, (0, 0), (11, 11), max_cells=13))
    result = minimize(problem, NSGA2(pop_size=20, **path_operators(problem, "random")), ("n_gen", 10), seed=1)
    assert (result.pop.get("interfering_cells") == 0).all()


def test_a_spiral_is_solved_by_cells():
    problem = GridPathProblem(SPIRAL, (0, 0), (0, 2), "cells")
    result = minimize(problem, NSGA2(pop_size=10, **default_operators(problem)), ("n_gen", 3), seed=1)
    assert result.F.shape == (1, 2)


# -- as pymoo's operators -----------------------------------------------------------------------------------------------


def test_arguments_out_of_range_are_refused():
    problem = corner_to_corner()
    for make, message in [
        (lambda: SpliceCrossover(prob=2), "prob is 2"),
        (lambda: SpliceCrossover(n_offsprings=3), "n_offsprings is 3"),
        (lambda: SpliceCrossover(reach=-1), "reach is -1"),
        (lambda: PathMutation({"wander": 1}), "no way 'wander' to mutate a path, expected weighted, random"),
        (lambda: PathMutation({"shift": 0}), "one or more are positive"),
        (lambda: PathMutation(max_expansions=0), "max_expansions is 0"),
        (lambda: ReachableSampling(roughness=9), "roughness is 9"),
        (lambda: ScalarizedSampling(noise=None), "noise is None, expected a number from 0 to 4"),
        (lambda: SpliceCrossover(reach="a"), "reach is 'a', expected a whole number from 0 to 64"),
        (lambda: SpliceCrossover(reach=2.5), "reach is 2.5, expected a whole number"),
        (lambda: PathMutation(ways="shift"), "ways is 'shift', expected a mapping"),
        (lambda: PathMutation(ways={"shift": "a"}), "shift is 'a', expected a number"),
        (lambda: ScalarizedSampling(noise=-1), "noise is -1"),
        (lambda: path_operators(problem, "best"), "sampling is 'best', expected one of scalarized, random"),
        (lambda: path_operators(Problem(n_var=2)), "of the class Problem, expected a path problem"),
        (lambda: paper_operators(Problem(n_var=2)), "of the class Problem, expected a path problem"),
        (lambda: default_operators(Problem(n_var=2)), "of the class Problem, expected a path problem"),
    ]:
        with pytest.raises(GridPathError, match=message):
            make()


def test_defaults_follow_the_representation():
    assert isinstance(default_operators(corner_to_corner("cells"))["mutation"], PathMutation)
    for name in NAMES[:-1]:
        assert not isinstance(default_operators(corner_to_corner(name))["mutation"], PathMutation)


def test_nothing_is_kept_on_problems_and_operators():
    problem = corner_to_corner("cells")
    made = path_operators(problem)
    before = sorted(vars(problem))
    minimize(problem, NSGA2(pop_size=10, **made), ("n_gen", 3), seed=1)
    assert sorted(vars(problem)) == before
    assert pickle.loads(pickle.dumps(made)).keys() == made.keys()


ROWS = [
    row
    for row in CAPABILITIES.values()
    if row.takes_operators and not row.unfit and not row.needs.startswith(("ref_points", "auto"))
]


@pytest.mark.parametrize("row", [pytest.param(row, id=row.name) for row in ROWS])
@pytest.mark.parametrize("name", ["integer", "cells"])
def test_algorithms_take_path_operators(row, name):
    if row.extra and row.extra not in sys.modules:
        pytest.importorskip({"scikit-learn": "sklearn"}.get(row.extra, row.extra))
    objectives = ("length", "vulnerability", "turn")[: max(row.min_objectives, min(2, row.max_objectives or 2))]
    # OmniOptimizer draws on and on until it has as many different paths as it wants, and a single corridor has few.
    for p0 in (0.3,) if row.name == "OmniOptimizer" else (0.3, 1.0):
        problem = corner_to_corner(name, 12, p0, objectives=objectives)
        made = path_operators(problem, "random")

        def solve(problem=problem, made=made):
            algorithm = make_algorithm(row.name, problem, 12, operators=made)
            return minimize(problem, algorithm, ("n_gen", 4), seed=3, callback=Feasible())

        result = solve()
        assert all(result.algorithm.callback.legal)
        if row.reproducible and p0 == 0.3:
            assert np.array_equal(result.pop.get("X"), solve().pop.get("X"))


class Feasible:
    """Note in each generation whether all paths are legal."""

    def __init__(self):
        self.legal = []

    def __call__(self, algorithm):
        self.legal.append((algorithm.pop.get("interfering_cells") == 0).all())


# -- compiled and plain -------------------------------------------------------------------------------------------------

SCRIPT = """
import hashlib, json
import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize
from pymoo_gridpath.operators import PathRepair, path_operators
from pymoo_gridpath.problems import GridPathProblem, random_dense_grid

digests = []
for name in ("integer", "cells"):
    for sampling in ("scalarized", "random"):
        problem = GridPathProblem(random_dense_grid(12, 0.2, 1), (0, 0), (11, 11), name)
        result = minimize(problem, NSGA2(pop_size=12, **path_operators(problem, sampling)), ("n_gen", 4), seed=5)
        digests.append(hashlib.md5(np.ascontiguousarray(result.pop.get("X")).tobytes()).hexdigest())
    rng = np.random.default_rng(0)
    X = rng.integers(problem.xl, problem.xu + 1, (10, problem.n_var))
    digests.append(hashlib.md5(PathRepair()._do(problem, X, random_state=rng).tobytes()).hexdigest())
print(json.dumps(digests))
"""


def test_kernels_give_the_same_bits_compiled_and_plain():
    def run(**environment):
        done = subprocess.run([sys.executable, "-c", SCRIPT], env=os.environ | environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    assert run(NUMBA_DISABLE_JIT="1") == run()


def test_grids_of_a_single_row_have_a_single_path():
    problem = GridPathProblem(OccupancyGrid(np.zeros((1, 4))), (0, 0), (3, 0), "cells")
    rng = np.random.default_rng(0)
    X = ReachableSampling()._do(problem, 6, random_state=rng)
    assert X.tolist() == [[0, 1, 2, 3]] * 6 and problem.n_var == 4
    assert PathMutation()._do(problem, X, random_state=rng).tolist() == X.tolist()
    assert SpliceCrossover()._do(problem, X.reshape(2, 3, -1), random_state=rng).reshape(6, -1).tolist() == X.tolist()
