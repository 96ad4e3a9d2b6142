"""What a path is scored by: each objective maps a batch of paths to an array of N numbers to be minimised."""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.fields import BoxedField, check_costs, check_variance, obstacle_potential
from pymoo_gridpath.grid import Box, OccupancyGrid, check_box
from pymoo_gridpath.paths import TURN_UNIT


class Objective(ABC):
    """A quantity of a path to be minimised.

    Subclass it to add one of your own: set `name` and `label`, and compute from the paths, or from the sum of a field over the
    visited cells if `field` returns one. A field is nowhere negative, and whole numbers, truth values and short
    floats in it count as floats; objectives that have one have an exact front.

    Attributes
    ----------
    name : str
        What tables and files call it.
    label : str
        What an axis of a figure says, with the unit.
    penalty_unit : float
        What a penalty of 1 adds to it: 1, or the objective's own step where it counts in larger ones.
    local : bool
        Whether the cost of a cell depends on its neighbourhood alone, so that `field_in` does not work out the whole field.

    Examples
    --------
    >>> class Mud(Objective):
    ...     name, label = "mud", "Mud on the way"
    ...
    ...     def field(self, grid):
    ...         cost = np.zeros(grid.shape)
    ...         cost[2:5, :4] = 1.5  # rows y, columns x
    ...         return cost
    ...
    ...     def __call__(self, paths, sums):
    ...         return paths.total(sums)
    >>> from pymoo_gridpath import GridPathProblem
    >>> problem = GridPathProblem(OccupancyGrid(np.zeros((8, 8))), (0, 0), (0, 7), "cells", objectives=["length", Mud()])
    >>> problem.pareto_front().round(2).tolist()
    [[7.0, 4.5], [10.9, 3.0], [11.49, 1.5], [12.07, 0.0]]
    """

    name: str
    label: str
    penalty_unit: float = 1.0
    local: bool = False

    def field(self, grid: OccupancyGrid) -> np.ndarray | None:
        """Return the cost of each cell, shape (height, width), if the objective is a sum over visited cells, else None."""
        return None

    def field_in(self, grid: OccupancyGrid, box: Box) -> np.ndarray | None:
        """Return the cost of each cell in a box, shape (height, width) of the box, or None.

        What `field` says of these cells. Override it too where that can be had without the cost of all other cells.
        """
        whole = self.field(grid)
        box = check_box(box, grid)
        return whole if whole is None or box == grid.whole else np.asarray(whole)[box.slices]

    @abstractmethod
    def __call__(self, paths, sums: np.ndarray | BoxedField | None) -> np.ndarray:
        """Score a batch of paths.

        Parameters
        ----------
        paths : ColumnPaths or CellPaths
            N paths.
        sums : numpy.ndarray or None
            What the representation prepared from `field`, for ``paths.total(sums)``; None if that is None.

        Returns
        -------
        numpy.ndarray of float, shape (N,)
        """

    def __repr__(self) -> str:
        settings = ", ".join(f"{key}={value!r}" for key, value in vars(self).items())
        return f"{type(self).__name__}({settings})"


class Length(Objective):
    """Length of the path in cells: straight steps count 1, diagonal ones sqrt(2).

    References
    ----------
    Ahmed and Deb (2013), section 3.1.
    """

    name = "length"
    label = "Path length [cells]"

    def __call__(self, paths, sums=None):
        return paths.length


class Vulnerability(Objective):
    """Sum of the obstacles' potential over the visited cells, start and goal included.

    Parameters
    ----------
    variance : float, default 0.5
        Variance of the bell-shaped potential in squared cells, see `pymoo_gridpath.fields.obstacle_potential`.

    References
    ----------
    Ahmed and Deb (2013), section 3.2.
    """

    name = "vulnerability"
    label = "Path vulnerability"

    def __init__(self, variance: float = 0.5):
        self.variance = check_variance(variance)

    def field(self, grid):
        return obstacle_potential(grid, self.variance)

    @property
    def local(self) -> bool:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Whether the field is that of this class: one made from it may have another."""
        return type(self).field is Vulnerability.field

    def field_in(self, grid, box):
        """Return the potential in a box, from the obstacles in reach."""
        return obstacle_potential(grid, self.variance, box) if self.local else super().field_in(grid, box)

    def __call__(self, paths, sums):
        return paths.total(sums)


class Turn(Objective):
    """Total turn in degrees, the sum of the absolute heading changes; the smoothest path has the least.

    References
    ----------
    Ahmed and Deb (2013), sections 3.3 and 5.6.
    """

    name = "turn"
    label = "Total turn [degrees]"
    penalty_unit = TURN_UNIT

    def __call__(self, paths, sums=None):
        return paths.turn.astype(float)


#: The objectives of the paper by name.
OBJECTIVES: dict[str, type[Objective]] = {cls.name: cls for cls in (Length, Vulnerability, Turn)}


def make_objectives(objectives: Sequence[str | Objective] | str | Objective) -> tuple[Objective, ...]:
    """Return objectives given by name or as objects.

    Parameters
    ----------
    objectives : str, Objective, or sequence of these

    Returns
    -------
    tuple of Objective

    Raises
    ------
    GridPathError
        If there are none, a name is unknown, or two share a name.

    Examples
    --------
    >>> make_objectives(["length", Vulnerability(variance=2.0)])
    (Length(), Vulnerability(variance=2.0))
    """
    if isinstance(objectives, str | Objective):
        objectives = [objectives]
    made = []
    for item in checks.items("objectives", objectives, "names such as 'length', or Objective objects"):
        if isinstance(item, str):
            item = OBJECTIVES[checks.known("objective", item, OBJECTIVES)]()
        elif not isinstance(item, Objective):
            raise GridPathError(f"objective {shown(item)} is neither a name nor an Objective")
        if not isinstance(getattr(item, "name", None), str):
            raise GridPathError(f"the objective {type(item).__name__} has no name, expected a text as its attribute 'name'")
        made.append(item)
    names = [item.name for item in made]
    if not names or len(set(names)) < len(names):
        raise GridPathError(f"objectives are {shown(names)}, expected one or more, each once")
    return tuple(made)


def field_of(objective: Objective, grid: OccupancyGrid, box: Box | None = None) -> np.ndarray | None:
    """Return the field of an objective, or the part in a box, or None if it has none.

    Raises
    ------
    GridPathError
        See `pymoo_gridpath.fields.check_costs`; of an objective that is not local, wherever in the grid.
    """
    box = grid.whole if box is None else box
    if objective.local and box != grid.whole:
        return objective.field_in(grid, box)
    given = objective.field(grid)
    if given is None:
        return None
    return check_costs(f"the field of the objective {shown(objective.name)}", given, grid)[box.slices]


def boxed_field_of(objective: Objective, grid: OccupancyGrid, box: Box) -> np.ndarray | BoxedField | None:
    """Return the field of an objective; if that is more than a box, it is worked out beyond once it is asked for."""
    inside = field_of(objective, grid, box)
    if inside is None or box == grid.whole:
        return inside
    return BoxedField(inside, box, grid.width, functools.partial(_known_field_of, objective, grid))


def _known_field_of(objective: Objective, grid: OccupancyGrid) -> np.ndarray:
    field = field_of(objective, grid)
    assert field is not None
    return field
