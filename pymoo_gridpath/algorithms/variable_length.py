"""The genetic algorithm with chromosomes of variable length, repaired where its paper contradicts itself, and as printed."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from pymoo.algorithms.soo.nonconvex.ga import GA
from pymoo.core.termination import Termination
from pymoo.termination.max_gen import MaximumGenerationTermination
from pymoo.util.optimum import filter_optimum

from pymoo_gridpath import checks
from pymoo_gridpath.algorithms.capabilities import Capability
from pymoo_gridpath.algorithms.factory import make_algorithm
from pymoo_gridpath.algorithms.paper import Setup
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.objectives import Length, Objective
from pymoo_gridpath.operators.cells import cells_of
from pymoo_gridpath.operators.sets import PRINTED, printed_operators, printed_rules
from pymoo_gridpath.planners import PathOutput
from pymoo_gridpath.problems import GridPathProblem
from pymoo_gridpath.problems.members import are_legal
from pymoo_gridpath.registry import ALGORITHMS
from pymoo_gridpath.representations import CellSequence

#: The rules of the paper that `variable_length_ga` can take as they are printed.
PRINTED_RULES = ("distances", *PRINTED)


class PrintedLength(Objective):
    """The length of a path with the printed distances: straight steps count 1, diagonal ones 0.414."""

    name = "printed length"
    label = "Path length, diagonal steps 0.414"

    def moves(self, grid):
        return 1.0, 0.414


@ALGORITHMS.register
class VariableLengthGA(GA):
    """The variable-length genetic algorithm: pymoo's, with operators of its own, whose Result holds legal paths or none.

    "variable_length_ga" by name, for problems of one objective with ``representation="cells"``; `variable_length_ga` makes
    that of the paper. ``result.success`` and ``result.message`` say whether a legal path was found.

    Parameters
    ----------
    pop_size : int, default 50
    printed : collection of {"start", "roulette", "variation"}, default ()
        Which rules to take as they are printed, see `variable_length_ga`.
    output, evaluator, callback, termination, seed : optional
        As of all algorithms of pymoo.

    Raises
    ------
    GridPathError
        If an argument is of another kind or out of its range.
    CapabilityError
        When the run begins, if the problem has another representation.
    """

    name = "variable_length_ga"
    capability = Capability(
        name, __name__, min_objectives=1, max_objectives=1, takes_operators=False, repair=False, unpacks=False
    )

    # All of its arguments: what makes the children is its own.
    def __init__(
        self,
        pop_size: int = 50,
        printed: Collection[str] = (),
        output: Any = None,
        evaluator: Any = None,
        callback: Any = None,
        termination: Any = None,
        seed: int | None = None,
    ):
        pop_size = checks.whole("pop_size", pop_size, 1)
        self.printed = [rule for rule in PRINTED if rule in printed_rules(printed, PRINTED)]
        others = {"evaluator": evaluator, "callback": callback, "termination": termination, "seed": seed}
        output = PathOutput() if output is None else output
        super().__init__(pop_size=pop_size, output=output, **printed_operators(self.printed), **others)

    def _setup(self, problem, **kwargs):
        cells_of(problem, self.name)
        super()._setup(problem, **kwargs)

    def _set_optimum(self):
        # A penalty would let pymoo prefer a path across obstacles.
        pop: Any = self.pop
        legal = self._are_legal(pop)
        self.opt = filter_optimum(pop[legal] if legal.any() else pop, least_infeasible=True)

    def result(self):
        result: Any = super().result()
        if result.opt is not None and not self._are_legal(result.opt).all():
            result.opt = result.X = result.F = result.CV = result.G = result.H = None
        result.success = result.opt is not None
        result.message = "found a legal path" if result.success else "found no legal path, only such across obstacles"
        return result

    @staticmethod
    def _are_legal(pop) -> np.ndarray:
        return are_legal(pop.get("interfering_cells"), pop.get("CV")[:, 0])


def variable_length_ga(
    grid: OccupancyGrid,
    start: Sequence[int],
    goal: Sequence[int],
    pop_size: int = 50,
    n_gen: int = 50,
    printed: Collection[str] = (),
    termination: Termination | None = None,
    max_cells: int | None = None,
) -> Setup:
    """Return a run of the variable-length genetic algorithm for the shortest path, ready for pymoo.

    ``minimize(*variable_length_ga(grid, start, goal), seed=1)``. A path is the list of its cells. `GreedySampling` makes the
    first population; `RouletteSelection` draws parents, `SharedCellCrossover` crosses them with probability 0.9,
    `CellMutation` changes each cell with probability 0.02, and `ElitistSurvival` keeps the best string. The fitness is the
    length and 300 for each obstacle that is met, which pymoo sees as a constraint: it returns a legal path or none, and
    ``result.success`` and ``result.message`` say which.

    Parameters
    ----------
    grid : OccupancyGrid
    start, goal : (int, int)
        Cells (x, y).
    pop_size, n_gen : int, default 50
        Members and generations. The paper gives neither, but for 50 generations to the optimum in its conclusion.
    printed : collection of {"distances", "start", "roulette", "variation"}, default ()
        Which rules to take as they are printed; all are `PRINTED_RULES`.

        - "distances": a diagonal step counts 0.414, so that zigzags are shorter than straight lines.
        - "start": every first path steps to the neighbour nearest to the goal, whatever it holds, so that all are the same.
        - "roulette": weights are the fitness, which is to be small, so that the worst are drawn most.
        - "variation": halves are joined wherever they are cut, and a changed cell is any cell, so that paths are torn.
    termination : pymoo termination, optional
        In place of ``n_gen``.
    max_cells : int, optional
        The most cells that a path can visit, see `CellSequence`.

    Returns
    -------
    Setup
        ``(problem, algorithm, termination)``.

    Raises
    ------
    GridPathError
        If an argument is of another kind or out of its range, or the query cannot be solved.

    Notes
    -----
    The formula of the fitness is lost in the paper's scan. Here it is the sum of distances and damping coefficients, 300 for an
    obstacle; -0.9 for the target is the same for all paths and left out. Steps that are not legal, such as cut corners where
    the grid forbids it, count as obstacles.

    References
    ----------
    "Navigation strategy using a genetic algorithm", with static and moving obstacles and chromosomes of variable length,
    sections 5.1 to 5.7.

    Examples
    --------
    >>> import numpy as np
    >>> from pymoo.optimize import minimize
    >>> grid = OccupancyGrid(np.zeros((10, 10)), corner_cutting=True)
    >>> result = minimize(*variable_length_ga(grid, (0, 0), (9, 9)), seed=1)
    >>> result.F.round(2).tolist(), result.message
    ([12.73], 'found a legal path')
    """
    for name, value in (("pop_size", pop_size), ("n_gen", n_gen)):
        checks.whole(name, value, 1)
    checks.instance("termination", termination, Termination, " of pymoo", optional=True)
    rules = printed_rules(printed, PRINTED_RULES)
    objective = PrintedLength() if "distances" in rules else Length()
    coding = CellSequence(grid, start, goal, max_cells)
    problem = GridPathProblem(grid, start, goal, coding, [objective], "constraint")
    algorithm = make_algorithm(VariableLengthGA, problem, pop_size, printed=rules - {"distances"})
    return Setup(problem, algorithm, termination or MaximumGenerationTermination(n_gen))
