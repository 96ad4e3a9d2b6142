"""NSGA-II of other libraries on a problem of whole numbers, with rows evaluated all at once where a library lets one.

All have simulated binary crossover (rate 0.9, index 10) and polynomial mutation (rate 1 / n, index 20), the paper's, as far as
they have them for whole numbers. None knows what a gene means: ours alone brings genes back that lead off the grid.
"""

from __future__ import annotations

import math
import random
from abc import ABC, abstractmethod
from importlib import import_module
from typing import Any

import numpy as np
from peer_libraries.base import Peer
from pymoo.optimize import minimize
from throughput import stock_nsga2

from pymoo_gridpath.algorithms import make_algorithm

RATE, ETA_CROSSOVER, ETA_MUTATION = 0.9, 10.0, 20.0


class SearchPeer(Peer, ABC):
    """An NSGA-II for whole numbers within bounds.

    Attributes
    ----------
    batch : str
        How rows are evaluated all at once.
    numbers : str
        How whole numbers are treated.
    """

    batch = numbers = ""

    @abstractmethod
    def run(self, problem: Any, pop_size: int, n_gen: int, seed: int) -> np.ndarray:
        """Return the genes of the last population, shape (N, n_var), after so many evaluations of a `GridPathProblem`."""


def bounds(problem: Any) -> tuple[list[int], list[int]]:
    """Return the least and the largest value of each gene."""
    return problem.xl.astype(int).tolist(), problem.xu.astype(int).tolist()


class Ours(SearchPeer):
    label = "pymoo_gridpath, `ahmed_deb_2013`"
    batch, numbers = "yes", "discrete SBX and mutation, edge fixing"

    def run(self, problem, pop_size, n_gen, seed):
        result: Any = minimize(problem, make_algorithm("NSGA2", problem, pop_size), ("n_gen", n_gen), seed=seed)
        return result.pop.get("X")


class StockPymoo(SearchPeer):
    package = module = "pymoo"
    label = "pymoo, `NSGA2`"
    batch, numbers = "yes", "SBX and PM, rounded by its repair"

    def run(self, problem, pop_size, n_gen, seed):
        result: Any = minimize(problem, stock_nsga2(pop_size), ("n_gen", n_gen), seed=seed)
        return result.pop.get("X")


class Pygmo(SearchPeer):
    package = module = "pygmo"
    licence = "MPL-2.0"
    label = "pygmo, `nsga2`"
    batch, numbers = "`batch_fitness`, `member_bfe`", "its own, by `get_nix`"

    def run(self, problem, pop_size, n_gen, seed):
        pg: Any = import_module(self.module)

        class Rows:
            def get_bounds(self):
                return bounds(problem)

            def get_nobj(self):
                return problem.n_obj

            def get_nix(self):
                return problem.n_var

            def fitness(self, x):
                return self.batch_fitness(x)

            def batch_fitness(self, rows):
                return problem.evaluate(np.reshape(rows, (-1, problem.n_var))).ravel()

            def __deepcopy__(self, memo):
                # It asks for copies; the problem does not change.
                return self

        all_at_once = pg.bfe(pg.member_bfe())
        own = pg.nsga2(n_gen - 1, RATE, ETA_CROSSOVER, 1 / problem.n_var, ETA_MUTATION, seed=seed)
        own.set_bfe(all_at_once)
        population = pg.population(pg.problem(Rows()), pop_size, b=all_at_once, seed=seed)
        return pg.algorithm(own).evolve(population).get_x()


class Deap(SearchPeer):
    package = module = "deap"
    licence = "LGPL-3.0"
    label = "DEAP, `selNSGA2`"
    batch, numbers = "`map` over the population", "bounded SBX and PM, rounded"

    def run(self, problem, pop_size, n_gen, seed):
        base, tools = (import_module(f"deap.{name}") for name in ("base", "tools"))
        random.seed(seed)
        low, high = bounds(problem)

        class Fitness(base.Fitness):
            weights = (-1.0,) * problem.n_obj

        class Individual(list):
            def __init__(self, genes):
                super().__init__(genes)
                self.fitness = Fitness()

        def evaluate(individuals: list) -> None:
            for one, values in zip(individuals, problem.evaluate(np.array(individuals)).tolist(), strict=True):
                one.fitness.values = tuple(values)

        population = [Individual(random.randint(a, b) for a, b in zip(low, high, strict=True)) for _ in range(pop_size)]
        evaluate(population)
        # For the crowding distances that its tournament asks for.
        population = tools.selNSGA2(population, pop_size)
        for _ in range(n_gen - 1):
            children = [Individual(one) for one in tools.selTournamentDCD(population, pop_size)]
            for one, two in zip(children[::2], children[1::2], strict=True):
                if random.random() <= RATE:
                    tools.cxSimulatedBinaryBounded(one, two, ETA_CROSSOVER, low, high)
                for child in (one, two):
                    tools.mutPolynomialBounded(child, ETA_MUTATION, low, high, 1 / problem.n_var)
                    child[:] = [round(gene) for gene in child]
            evaluate(children)
            population = tools.selNSGA2(population + children, pop_size)
        return np.array(population)


class Jmetal(SearchPeer):
    package, module, licence = "jmetalpy", "jmetal", "MIT"
    label = "jMetalPy, `NSGAII`"
    batch, numbers = "an `Evaluator` of one's own", "`IntegerSBXCrossover`, `IntegerPolynomialMutation`"

    def run(self, problem, pop_size, n_gen, seed):
        random.seed(seed)
        parts: Any = {
            name: import_module(f"jmetal.{name}")
            for name in (
                "algorithm.multiobjective.nsgaii",
                "core.problem",
                "operator.crossover",
                "operator.mutation",
                "util.evaluator",
                "util.termination_criterion",
            )
        }

        class Rows(parts["core.problem"].IntegerProblem):
            def __init__(self):
                super().__init__()
                self.lower_bound, self.upper_bound = bounds(problem)

            def number_of_objectives(self):
                return problem.n_obj

            def number_of_constraints(self):
                return 0

            def name(self):
                return "grid path"

            def evaluate(self, solution):
                AllAtOnce().evaluate([solution], self)
                return solution

        class AllAtOnce(parts["util.evaluator"].Evaluator):
            def evaluate(self, solution_list, problem):
                F = evaluate(np.array([one.variables for one in solution_list]))
                for one, values in zip(solution_list, F.tolist(), strict=True):
                    one.objectives = values
                return solution_list

        evaluate = problem.evaluate
        algorithm = parts["algorithm.multiobjective.nsgaii"].NSGAII(
            problem=Rows(),
            population_size=pop_size,
            offspring_population_size=pop_size,
            mutation=parts["operator.mutation"].IntegerPolynomialMutation(1 / problem.n_var, ETA_MUTATION),
            crossover=parts["operator.crossover"].IntegerSBXCrossover(RATE, ETA_CROSSOVER),
            termination_criterion=parts["util.termination_criterion"].StoppingByEvaluations(pop_size * n_gen),
            population_evaluator=AllAtOnce(),
        )
        algorithm.run()
        return np.array([one.variables for one in algorithm.result()])


class Platypus(SearchPeer):
    package, module, licence = "platypus-opt", "platypus", "GPL-3.0"
    label = "Platypus, `NSGAII`, `Real`"
    batch, numbers = "an `Evaluator` of one's own", "SBX and PM, rounded when evaluated"

    def types(self, platypus: Any, problem: Any) -> list:
        return [platypus.Real(a, b) for a, b in zip(*bounds(problem), strict=True)]

    def variator(self, platypus: Any, problem: Any) -> Any:
        return platypus.GAOperator(platypus.SBX(RATE, ETA_CROSSOVER), platypus.PM(1 / problem.n_var, ETA_MUTATION))

    def genes(self, solutions: list) -> np.ndarray:
        """Return the genes of solutions, in which they are coded."""
        types = solutions[0].problem.types
        rows = [[kind.decode(gene) for kind, gene in zip(types, one.variables, strict=True)] for one in solutions]
        return np.rint(np.array(rows)).astype(int)

    def run(self, problem, pop_size, n_gen, seed):
        platypus: Any = import_module(self.module)
        random.seed(seed)
        genes = self.genes

        class AllAtOnce(platypus.Evaluator):
            def evaluate_all(self, jobs, **kwargs):
                F = problem.evaluate(genes([job.solution for job in jobs])) if jobs else []
                for job, values in zip(jobs, F, strict=True):
                    job.solution.objectives[:] = values.tolist()
                    job.solution.constraint_violation, job.solution.feasible, job.solution.evaluated = 0.0, True, True
                return jobs

        rows = platypus.Problem(problem.n_var, problem.n_obj)
        rows.types[:] = self.types(platypus, problem)
        variator = self.variator(platypus, problem)
        algorithm = platypus.NSGAII(rows, population_size=pop_size, variator=variator, evaluator=AllAtOnce())
        algorithm.run(pop_size * n_gen)
        return genes(algorithm.population)


class PlatypusInteger(Platypus):
    label = "Platypus, `NSGAII`, `Integer`"
    numbers = "Gray bits, half-uniform crossover, flips"

    def types(self, platypus, problem):
        return [platypus.Integer(a, b) for a, b in zip(*bounds(problem), strict=True)]

    def variator(self, platypus, problem):
        n_bits = sum(math.floor(math.log2(span)) + 1 for span in (problem.xu - problem.xl))
        return platypus.GAOperator(platypus.HUX(RATE), platypus.BitFlip(1 / n_bits))


def search_peers() -> list[SearchPeer]:
    """Make every row of the table, ours first."""
    return [Ours(), StockPymoo(), Pygmo(), Deap(), Jmetal(), Platypus(), PlatypusInteger()]
