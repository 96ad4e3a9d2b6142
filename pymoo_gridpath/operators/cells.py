"""The operators of the variable-length genetic algorithm: a path is the list of its cells, and may cross obstacles."""

from __future__ import annotations

import numpy as np
from pymoo.core.crossover import Crossover
from pymoo.core.mutation import Mutation
from pymoo.core.sampling import Sampling

from pymoo_gridpath import checks
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.operators.parameters import CROSSOVER_RATE, in_range, number, one_or_two
from pymoo_gridpath.operators.path_terrain import terrain_of
from pymoo_gridpath.paths.sequences import Sequences
from pymoo_gridpath.registry import OPERATORS
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.representations.base import representation_of
from pymoo_gridpath.search.cell_rows import change_cells, cross_at_shared_cells, walks
from pymoo_gridpath.search.sequences import mend

# How often a walk that comes to a dead end starts anew, before it becomes a shortest path.
TRIES = 20


@OPERATORS.register
class GreedySampling(Sampling):
    """Walk from the start, each step to a free neighbour near the goal: the nearest, most often.

    The nearest neighbour that was not visited before is taken with probability 1/2, the second nearest with 1/4, and so on; of
    neighbours as near, the first by heading is the nearer. A walk that comes to a dead end, or has more cells than a row,
    starts anew; after 20 of these it becomes a shortest path. All paths are legal.

    For problems with ``representation="cells"``.

    Parameters
    ----------
    greedy : bool, default False
        Whether to take the nearest neighbour always and whatever it holds, which is the printed rule. Nothing is random in
        it: all paths are the same, and cross what obstacles are in the way.

    References
    ----------
    The variable-length genetic algorithm, see `variable_length_ga`, sections 5.1 and 5.2.
    """

    # Its rows are paths, if across obstacles.
    knows_paths = True

    def __init__(self, greedy: bool = False):
        super().__init__()
        self.greedy = checks.flag("greedy", greedy)

    def _do(self, problem, n_samples, *args, random_state=None, **kwargs):
        assert random_state is not None
        coding, terrain = cells_of(problem, "GreedySampling"), terrain_of(problem)
        if self.greedy:
            return np.tile(_straight_row(coding), (n_samples, 1))
        X = np.empty((n_samples, coding.n_var), dtype=np.int64)
        left = np.arange(n_samples)
        for _ in range(TRIES):
            paths = walks(terrain, random_state.random((len(left), coding.max_cells)))
            done = paths.lengths > 0
            X[left[done]] = coding.from_sequences(paths.take(done))
            left = left[~done]
            if not len(left):
                break
        none = Sequences(np.empty(0, dtype=np.int64), np.zeros(len(left) + 1, dtype=np.int64))
        X[left] = coding.from_sequences(mend(none, coding.moves, terrain.start, terrain.goal, coding.max_cells))
        return X


@OPERATORS.register
class SharedCellCrossover(Crossover):
    """Join the head of one path and the tail of another at a cell that both visit, and the other way round.

    The cell is any that both visit between their ends, drawn at random. Loops are cut. Parents without such a cell, and those
    of which a child would not fit into a row, are copied. Legal parents have legal children.

    For problems with ``representation="cells"``.

    Parameters
    ----------
    prob : float, default 0.9
        Probability of a mating to cross at all.
    n_offsprings : {1, 2}, default 2
        Children of each mating; algorithms that use one, such as C-TAEA, need 1.

    References
    ----------
    The variable-length genetic algorithm, see `variable_length_ga`, section 5.6, which joins halves wherever they are cut;
    `SinglePointCrossover` does that.
    """

    knows_paths = True

    def __init__(self, prob: float = CROSSOVER_RATE, n_offsprings: int = 2, **kwargs):
        super().__init__(2, one_or_two(n_offsprings), prob=in_range("prob", prob, 0, 1), **kwargs)

    def _do(self, problem, X, *args, random_state=None, **kwargs):
        assert random_state is not None
        coding = cells_of(problem, "SharedCellCrossover")
        moves, genes = coding.moves, coding.genes(X.reshape(-1, X.shape[2]))
        rows, goal = moves.from_grid(genes).reshape(X.shape), moves.index(coding.goal)
        children = cross_at_shared_cells(rows, goal, moves.n_cells, random_state.random(X.shape[1]))
        return moves.to_grid(children[: self.n_offsprings])


@OPERATORS.register
class CellMutation(Mutation):
    """Change single cells of a path, or regrow its tail.

    Each cell between the ends changes with probability ``prob_var``. It becomes another cell beside both of its neighbours in
    the path, which may be an obstacle; or the path goes on from there by a new walk, as `GreedySampling` walks. Loops are cut.

    For problems with ``representation="cells"``.

    Parameters
    ----------
    prob_var : float, default 0.02
        Probability of each cell to change.
    regrow : float, default 0.5
        Share of the changes that are new walks.
    anywhere : bool, default False
        Whether a cell becomes any cell of the grid instead, which is the printed rule read literally. Hardly any such path
        holds together.
    prob : float, default 1.0
        Probability of an individual to be mutated at all.

    References
    ----------
    The variable-length genetic algorithm, see `variable_length_ga`, section 5.7.
    """

    def __init__(self, prob_var: float = 0.02, regrow: float = 0.5, anywhere: bool = False, prob: float = 1.0, **kwargs):
        super().__init__(prob=in_range("prob", prob, 0, 1), prob_var=in_range("prob_var", prob_var, 0, 1), **kwargs)
        self.regrow = in_range("regrow", regrow, 0, 1)
        self.anywhere = checks.flag("anywhere", anywhere)

    def _do(self, problem, X, *args, random_state=None, **kwargs):
        assert random_state is not None
        coding, rate = cells_of(problem, "CellMutation"), number(self.prob_var)
        X = coding.genes(X)
        if self.anywhere:
            # What is left after the last cell that is not the goal is no cell of the path.
            n_cells = X.shape[1] - np.argmax(X[:, ::-1] != X[:, -1:], axis=1)
            gene = np.arange(X.shape[1])
            chosen = (random_state.random(X.shape) < rate) & (gene > 0) & (gene < n_cells[:, None])
            return np.where(chosen, random_state.integers(0, problem.grid.occupied.size, X.shape), X)
        rows = coding.moves.from_grid(X)
        draws = random_state.random((4, *X.shape))
        return coding.moves.to_grid(change_cells(terrain_of(problem), rows, rate, number(self.regrow), draws))


def cells_of(problem, owner: str) -> CellSequence:
    """Return the representation of a problem if it is one of cells.

    Raises
    ------
    CapabilityError
        If it is another one.
    """
    representation = representation_of(problem)
    if not isinstance(representation, CellSequence):
        raise CapabilityError(
            f"{owner} is for lists of cells, and the problem has the {representation.name} representation; give it "
            f"representation='cells'"
        )
    return representation


def _straight_row(coding: CellSequence) -> np.ndarray:
    """Return the genes of the path that steps to the neighbour nearest to the goal, whatever it holds."""
    # The step that lessens what is left in x and in y leads nearest, as long as there is both.
    (x, y), (gx, gy) = coding.start, coding.goal
    k = np.arange(coding.n_var)
    xs = x + np.sign(gx - x) * np.minimum(k, abs(gx - x))
    ys = y + np.sign(gy - y) * np.minimum(k, abs(gy - y))
    return ys * coding.grid.width + xs
