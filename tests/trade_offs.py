"""Small problems, and Results as pymoo runs leave them."""

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.population import Population
from pymoo.core.result import Result
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.operators import RankAndSmoothness, SmoothnessTournament, paper_operators
from pymoo_gridpath.problems import random_dense_grid


def make_problem(size=8, seed=5, corner_cutting=True, representation="integer", **options):
    grid = random_dense_grid(size, 0.25, seed).replace(corner_cutting=corner_cutting)
    return GridPathProblem(grid, (0, 0), (size - 1, size - 1), representation, **options)


def draw(problem, n=3000, seed=0):
    return np.random.default_rng(seed).integers(problem.xl, problem.xu + 1, (n, problem.n_var))


def run(problem, seed=1, generations=25, **options):
    algorithm = NSGA2(60, selection=SmoothnessTournament(), survival=RankAndSmoothness(), **paper_operators(problem))
    return minimize(problem, algorithm, ("n_gen", generations), seed=seed, **options)


def result_of(problem, X, opt=True):
    """A Result as a pymoo run leaves it, of given genes."""
    result = Result()
    result.problem = problem
    result.pop = Population.new(X=np.asarray(X))
    result.opt = result.pop if opt else None
    return result
