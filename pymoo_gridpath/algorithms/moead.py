"""MOEA/D that takes constraints and breaks ties by smoothness."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from moocore import is_nondominated
from pymoo.algorithms.moo.moead import MOEAD, default_decomp
from scipy.spatial.distance import cdist

from pymoo_gridpath import checks
from pymoo_gridpath.algorithms.arguments import check_whole
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.operators.array_population import ArrayPopulation
from pymoo_gridpath.operators.bands import band_of, boxes
from pymoo_gridpath.operators.mating import FirstChildMating, NeighborSelection, mates_on_arrays
from pymoo_gridpath.operators.parameters import number
from pymoo_gridpath.operators.survival import turns_of

#: Decomposed values that differ by no more than this share of 1 + their size are a tie.
TIE = 1e-9
#: How wide the steps are that the smoothness tie-break takes objectives in, as a share of their range, unless told.
BAND = 0.01


class SmoothMOEAD(MOEAD):
    """MOEA/D with constraints, scaled objectives and a smoothness tie-break.

    Objectives count in steps of a `band`, a share of their range. A child takes the place of a neighbour if, in this order,

    1. its constraint violation is smaller;
    2. of equal violations, its decomposed value in the neighbour's direction is smaller;
    3. of equal values, it dominates the neighbour;
    4. where neither dominates the other, its total turn is smaller;
    5. of equal turns on the same steps, it dominates the neighbour by less than a step.

    The fourth step is the smoothness tie-break. Paths on the same steps of length and vulnerability tie in every direction, so
    the smoothest of them is kept. Without a band it acts only between paths of the same objectives, and on a map with obstacles
    there are hardly two such. Paths also tie which differ only in the objective that does not decide a Chebyshev value; there
    dominance goes first lest smoothness cost an objective.

    On a grid few objective vectors exist, and one good child would soon fill all neighbourhoods with copies of itself. Hence a
    child replaces no more than ``n_replace`` neighbours, chosen at random, and none if a neighbour has the same genes.

    Parameters
    ----------
    ref_dirs : numpy.ndarray, shape (n_directions, n_obj)
        Reference directions, two or more; their number is the population size.
    smoothness : bool, default True
        Whether to break ties by ``turn``, which the problem then has to set; where it does not, a warning says so.
    normalize : bool, default True
        Whether to decompose objectives scaled to the range from the ideal point to the nadir point, since length and
        vulnerability have different ranges. The ideal point is the best value of each objective so far among feasible
        individuals (among all, until one is feasible); the nadir point is the worst value among the non-dominated of them,
        estimated anew each generation.
    n_replace : int, default 5
        Most neighbours that a child may replace; pymoo's MOEA/D has no limit.
    batch_size : int, optional
        Children that are made and evaluated at once, see Notes. By default all of a generation; 1 is the textbook's MOEA/D.
    band : float, optional
        The width of the steps that the smoothness tie-break takes objectives in, as a share of their range on the current
        front, or of 1 if they are not scaled: at most 0.5, by default 0.01. Paths may be worse in an objective by as much as a
        step is wide, if they turn less. 0 takes objectives as they are, and so does ``smoothness=False``.
    **kwargs
        As for pymoo's `MOEAD`: ``n_neighbors``, ``decomposition``, ``prob_neighbor_mating``, ``sampling``, ``crossover``,
        ``mutation``, ``repair``, ``output`` and others.

    Raises
    ------
    CapabilityError
        If ref_dirs has fewer than two rows, smoothness or normalize is no truth value, n_replace or batch_size is not positive,
        band is out of its range or given without the tie-break that it is for, or, when the run begins, ref_dirs has another
        number of columns than the problem objectives.

    Notes
    -----
    This is a generational variant of MOEA/D, unless ``batch_size`` is 1: children are made from parents as they were before
    the first child of their batch was, as in pymoo's `ParallelMOEAD`, while in the textbook every child may be a parent of the
    next. Either way they replace neighbours one after another. A generation takes less than a tenth of the time, as operators
    and evaluation work on many rows at once, and final hypervolumes were no worse by paired tests with 2 and 3 objectives, with
    the paper's operators and with path-aware ones; ``benchmarks/fast_generation.py`` repeats them as algorithm MOEAD/1.

    Crossover, mutation and repair are called by their array hook (`FirstChildMating`), or all through pymoo's mating if one of
    them does more than that says, see `mates_on_arrays`.

    Unlike pymoo's own, mating is told the algorithm, so that mutation rates that follow the run do. As there, each mating
    gives one child. Between batches it can be copied and pickled.

    References
    ----------
    Q. Zhang and H. Li, "MOEA/D: a multiobjective evolutionary algorithm based on decomposition", IEEE Transactions on
    Evolutionary Computation 11(6), 2007; section V.F for the scaling. H. Li and Q. Zhang,
    "Multiobjective optimization problems with complicated Pareto sets, MOEA/D and NSGA-II", IEEE Transactions on Evolutionary
    Computation 13(2), 2009, for the limit on replacements. K. Deb, "An efficient constraint handling method for
    genetic algorithms", Computer Methods in Applied Mechanics and Engineering 186, 2000, for the first step.
    """

    # pymoo fills these when the run begins.
    problem: Any
    pop: Any
    mating: Any
    ref_dirs: Any
    neighbors: Any
    random_state: Any

    def __init__(
        self,
        ref_dirs,
        smoothness: bool = True,
        normalize: bool = True,
        n_replace: int = 5,
        batch_size: int | None = None,
        band: float | None = None,
        **kwargs,
    ):
        expected = "two or more reference directions as rows of finite numbers"
        ref_dirs = checks.array("ref_dirs", ref_dirs, expected=expected, finite=True, error=CapabilityError).astype(float)
        if ref_dirs.ndim != 2 or len(ref_dirs) < 2:
            raise CapabilityError(f"MOEA/D needs two or more reference directions as rows, got shape {ref_dirs.shape}")
        given = {"n_replace": n_replace, "batch_size": batch_size, "n_neighbors": kwargs.get("n_neighbors")}
        for name, value in given.items():
            if value is not None:
                check_whole("MOEAD", name, value)
        smoothness = checks.flag("smoothness", smoothness, CapabilityError)
        normalize = checks.flag("normalize", normalize, CapabilityError)
        if band is not None and not smoothness:
            raise CapabilityError(
                f"band is {checks.shown(band)} and smoothness is False, expected no band: ties are not broken"
            )
        super().__init__(ref_dirs=ref_dirs, **kwargs)
        self.smoothness = smoothness
        self.band = band_of(BAND if band is None else band, CapabilityError) if smoothness else 0.0
        self.normalize = normalize
        self.n_replace = n_replace
        self.batch_size = len(ref_dirs) if batch_size is None else batch_size
        self.seen_feasible = False
        # Subproblems, by batches, that are still to have a child in this generation.
        self._batches: list[np.ndarray] = []
        operators = self.mating.crossover, self.mating.mutation, self.mating.repair
        if "mating" not in kwargs and all(map(mates_on_arrays, operators)):
            self.selection = NeighborSelection(number(self.selection.prob))
            self.mating = FirstChildMating(self.selection, *operators)

    def _setup(self, problem, **kwargs):
        if self.ref_dirs.shape[1] != problem.n_obj:
            raise CapabilityError(
                f"the reference directions have {self.ref_dirs.shape[1]} columns, the problem {problem.n_obj} objectives"
            )
        # A neighbourhood includes its own direction.
        self.neighbors = np.argsort(cdist(self.ref_dirs, self.ref_dirs), axis=1, kind="stable")[:, : self.n_neighbors]
        if self.decomposition is None:
            self.decomposition = default_decomp(problem)

    def _initialize_advance(self, infills=None, **kwargs):
        super()._initialize_advance(infills, **kwargs)
        self.pop = self.pop.view(ArrayPopulation)
        self.ideal = np.full(self.problem.n_obj, np.inf)

    def _infill(self):
        # pymoo's own runs a generator, which neither pickles nor copies in the midst of a generation.
        if not self._batches:
            self._begin_generation()
        run = {"random_state": self.random_state, "algorithm": self}
        near, n_parents = self.neighbors[self._batches[0]], self.mating.crossover.n_parents
        parents = self.selection.do(self.problem, self.pop, len(near), n_parents, neighbors=near, **run)
        return self.mating.do(self.problem, self.pop, len(near), parents=parents, n_max_iterations=1, **run)

    def _begin_generation(self) -> None:
        self._read_population()
        self._rescale()
        order = self.random_state.permutation(len(self.pop))
        self._batches = np.array_split(order, math.ceil(len(order) / self.batch_size))

    def _advance(self, infills=None, **kwargs):
        self._replace(self._batches.pop(0), infills)
        # Whether the generation is over, and what pymoo does after each is due.
        return not self._batches

    def _read_population(self) -> None:
        # Arrays beside the population: reading 20 neighbours one attribute at a time costs more than comparing them.
        self._X, self._F, self._cv, self._turn = self._read(self.pop)

    def _read(self, pop) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Return the genes, objectives, constraint violations and turns of individuals; turns are 0 where they do not count."""
        pop = pop.view(ArrayPopulation)
        X, F, cv = pop.get("X", "F", "CV")
        turn = turns_of(pop, "SmoothMOEAD") if self.smoothness else np.zeros(len(pop))
        return X, F.astype(float), cv[:, 0], turn

    def _move_ideal(self, F: np.ndarray, feasible: np.ndarray) -> None:
        if feasible.any():
            F = F[feasible]
            if not self.seen_feasible:
                # What only paths through obstacles reach is no ideal.
                self.ideal, self.seen_feasible = F.min(axis=0), True
        elif self.seen_feasible:
            return
        self.ideal = np.minimum(self.ideal, F.min(axis=0))

    def _rescale(self) -> None:
        feasible = self._cv <= 0.0
        self._move_ideal(self._F, feasible)
        self.span = np.ones(self._F.shape[1])
        if self.normalize:
            F = self._F[feasible] if feasible.any() else self._F
            span = F[is_nondominated(F, keep_weakly=True)].max(axis=0) - self.ideal
            self.span[span > 0] = span[span > 0]

    def _scale(self, F: np.ndarray) -> np.ndarray:
        """Return objectives scaled to the range of the front, in steps of the band."""
        if self.band:
            return boxes(F, self.ideal, self.span, self.band) * self.band
        return (F - self.ideal) / self.span

    def _decompose(self, scaled: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Return the decomposed value of each row of scaled objectives in the direction of the same row of weights."""
        return self.decomposition.do(scaled, weights=weights, _type="one_to_one", ideal_point=np.zeros(scaled.shape[1]))

    def _replace(self, subproblems: np.ndarray, off) -> None:
        """Let children, one after another, take the places of neighbours of their subproblems."""
        X, F, cv, turn = self._read(off)
        self._move_ideal(F, cv <= 0.0)
        scaled, self._scaled = self._scale(F), self._scale(self._F)
        neighborhoods = self.neighbors[subproblems]
        values = self._decompose(self._scaled, self.ref_dirs)
        directions = self.ref_dirs[neighborhoods].reshape(-1, F.shape[1])
        offered = self._decompose(scaled.repeat(neighborhoods.shape[1], axis=0), directions).reshape(neighborhoods.shape)
        beats = self._beats(neighborhoods, offered, values, F[:, None], scaled[:, None], cv[:, None], turn[:, None])
        replaced = np.zeros(len(values), dtype=bool)
        for i, near in enumerate(neighborhoods):
            if replaced[near].any():
                beats[i] = self._beats(near, offered[i], values, F[i], scaled[i], cv[i], turn[i])
            beaten = np.flatnonzero(beats[i])
            if len(beaten) == 0 or (self._X[near] == X[i]).all(axis=1).any():
                continue
            if len(beaten) > self.n_replace:
                beaten = self.random_state.choice(beaten, self.n_replace, replace=False)
            places = near[beaten]
            self.pop[places], values[places], replaced[places] = off[i], offered[i, beaten], True
            self._X[places], self._F[places], self._cv[places], self._turn[places] = X[i], F[i], cv[i], turn[i]
            self._scaled[places] = scaled[i]

    def _beats(self, near, offered, values, F, scaled, cv, turn) -> np.ndarray:
        """Return which of its neighbours a child beats, bool, the shape of ``near``; for many children, add an axis to all.

        Parameters
        ----------
        near : numpy.ndarray of int, shape (n_neighbors,)
        offered : numpy.ndarray, shape (n_neighbors,)
            Decomposed values of the child in the directions of the neighbours.
        values : numpy.ndarray, shape (n_directions,)
            Decomposed value of each member of the population in its own direction.
        F, scaled : numpy.ndarray, shape (n_obj,)
            Objectives as they are, and scaled.
        cv, turn : float
        """
        old, neighbors_cv = values[near], self._cv[near]
        gain, slack = old - offered, TIE * (1.0 + np.abs(old))
        wins, tie = gain > slack, np.abs(gain) <= slack
        if tie.any():
            neighbors_turn = self._turn[near]
            no_worse, no_better = _compare(scaled, self._scaled[near])
            better = (no_worse & ~no_better) | ((no_worse == no_better) & (turn < neighbors_turn))
            if self.band:
                exactly_no_worse, exactly_no_better = _compare(F, self._F[near])
                better |= no_worse & no_better & (turn == neighbors_turn) & exactly_no_worse & ~exactly_no_better
            wins |= tie & better
        return (cv < neighbors_cv) | ((cv == neighbors_cv) & wins)


def _compare(F: np.ndarray, others: np.ndarray) -> tuple[Any, Any]:
    """Return whether F is no worse than others in any objective, and whether it is no better."""
    return (others >= F).all(axis=-1), (others <= F).all(axis=-1)
