"""What a run on a path problem prints with ``verbose=True``."""

from __future__ import annotations

from typing import Any

import numpy as np
from pymoo.util.display.column import Column
from pymoo.util.display.output import Output

from pymoo_gridpath import checks
from pymoo_gridpath.problems.members import Members
from pymoo_gridpath.quality import ReferenceFront


class PathOutput(Output):
    """A line a generation: evaluations, legal paths of the population, the least length among them, distance to the front.

    `make_algorithm` and every `Planner` give each algorithm one of its own; ``output=`` takes another. The columns:

    - ``n_gen``, ``n_eval``: generations and evaluations so far.
    - ``legal``: members of the population that are legal paths.
    - ``length``: the least length of these, where length is an objective; a dash where there is none.
    - ``igd+``: the mean distance by which the points of the exact front are missed, IGD+, in objectives that are scaled by the
      range of the front (those without a range count in their own unit); 0 for a run that has them all. It is shown where
      ``problem.pareto_front()`` knows the front, or finds it in the time that it takes by default.

    Parameters
    ----------
    distance : bool, default True
        Whether to show the distance to the front.

    Raises
    ------
    GridPathError
        If distance is no truth value.

    References
    ----------
    H. Ishibuchi, H. Masuda, Y. Tanigaki and Y. Nojima, "Modified distance calculation in generational distance and inverted
    generational distance", EMO 2015.
    """

    def __init__(self, distance: bool = True):
        super().__init__()
        self.distance = checks.flag("distance", distance)
        self.legal = Column("legal", width=6)
        self.length = Column("length", width=11)
        self.igd_plus = Column("igd+", width=9)
        self._front: np.ndarray | None = None
        self._measure: ReferenceFront | None = None

    def initialize(self, algorithm: Any) -> None:
        problem = algorithm.problem
        self.columns.append(self.legal)
        if "length" in problem.objective_names:
            self.columns.append(self.length)
        if self.distance and self._reference(problem) is not None:
            self.columns.append(self.igd_plus)

    def update(self, algorithm: Any) -> None:
        super().update(algorithm)
        members = Members(algorithm)
        F = members.F
        self.legal.set(len(F))
        if self.length in self.columns:
            self.length.set(f"{members.least('length'):.3f}" if len(F) else None)
        if self.igd_plus in self.columns:
            reference = self._reference(algorithm.problem)
            self.igd_plus.set(f"{reference.igd_plus(F):.6f}" if len(F) and reference is not None else None)

    def _reference(self, problem) -> ReferenceFront | None:
        """Return the front of a problem, which is another one where its map has changed."""
        # The problem keeps it.
        front = problem.pareto_front()
        if front is not self._front:
            self._front, self._measure = front, None if front is None or not len(front) else ReferenceFront(front)
        return self._measure


class FrontOutput(Output):
    """A line for each front that `ExactFront` hands over: its points, and how near to the exact one it is proven to be.

    The columns:

    - ``n_gen``, ``n_eval``: fronts and evaluations so far.
    - ``points``: paths of the front.
    - ``certified``: how near it is proven to come to the exact one, see `Certificate`; a dash where nothing is proven.
    - ``labels``: the most labels that the search has had at a time.
    - ``seconds``: of the search so far.
    """

    def __init__(self):
        super().__init__()
        self.points, self.certified = Column("points", width=6), Column("certified", width=14)
        self.labels, self.seconds = Column("labels", width=11), Column("seconds", width=8)
        self.columns += [self.points, self.certified, self.labels, self.seconds]

    def update(self, algorithm: Any) -> None:
        super().update(algorithm)
        found = algorithm.found
        self.points.set(len(found.F))
        self.certified.set(None if found.certified is None else found.certified.short)
        self.labels.set(f"{found.n_labels:,}")
        self.seconds.set(f"{found.seconds:.2f}")
