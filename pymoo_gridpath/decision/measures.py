"""Measures of decoded paths, whether or not the problem minimises them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from pymoo_gridpath.fields import BoxedField, obstacle_potential
from pymoo_gridpath.objectives import Risk, Vulnerability, boxed_field_of, prepared
from pymoo_gridpath.problems.members import are_legal
from pymoo_gridpath.representations.base import representation_of
from pymoo_gridpath.search.path_clearance import least_distances

# Metres are given to a nanometre: what lies below is the rounding of numbers.
_DECIMALS = 9


def risk_of(problem) -> Risk | None:
    """Return the objective by which a problem says how safe paths are, None if it has none."""
    return next((objective for objective in problem.objectives if isinstance(objective, Risk)), None)


class PathMeasures:
    """The vulnerability and the legality of paths of a problem.

    Parameters
    ----------
    problem : GridPathProblem
        If it minimises a vulnerability, an objective of that name, it is the one used; else the default.

    Raises
    ------
    GridPathError
        If the problem does not decode paths.

    Attributes
    ----------
    field : numpy.ndarray, shape (height, width) of the representation's box
        The potential whose sum the problem minimises as its risk, or else whose sum is the vulnerability; the default one if
        that is no such sum.
    """

    def __init__(self, problem):
        representation_of(problem)
        given = [objective for objective in problem.objectives if objective.name == Vulnerability.name]
        self.problem = problem
        self._objective = given[0] if given else Vulnerability().on(problem.grid)
        box = problem.representation.box
        field = boxed_field_of(self._objective, problem.grid, box)
        self._prepared = prepared(self._objective, problem.representation, field)
        if (risk := risk_of(problem)) is not None and risk is not self._objective:
            field = boxed_field_of(risk, problem.grid, box)
        inside = field.inside if isinstance(field, BoxedField) else field
        self.field = obstacle_potential(problem.grid, box=box) if inside is None else inside

    def vulnerability(self, paths) -> np.ndarray:
        """Return the vulnerability of N paths, shape (N,)."""
        return self._objective(paths, self._prepared)

    def legal(self, paths) -> np.ndarray:
        """Return which of N paths cross no occupied cell and keep the potential limit if the problem has one, shape (N,)."""
        limited = self.problem.potential_limit is not None
        over = self.problem.over_limit(self.vulnerability(paths)) if limited else None
        return are_legal(paths.interfering_cells, over)

    def clearance_m(self, cells: Sequence[np.ndarray]) -> np.ndarray:
        """Return the room between a robot on its way and the obstacles of a map in metres, as they were before they grew.

        Parameters
        ----------
        cells : sequence of numpy.ndarray of int, each of shape (n_cells, 2)
            Cells (x, y) of N paths.

        Returns
        -------
        numpy.ndarray of float, shape (N,)
            Metres, see `PathRecord`.
        """
        grid, box = self.problem.grid, self.problem.representation.box
        # What keeps the robot from a cell is no further away than it is wide.
        reach = math.ceil(grid.growth) + 2
        away = least_distances(grid.original.occupied, cells, box.grown(reach, grid.shape))
        metres = away * grid.check_resolution("a clearance in metres")
        return np.round(metres - grid.robot_radius, _DECIMALS) + 0.0
