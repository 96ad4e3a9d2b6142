"""Path planning on a grid as a pymoo problem."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Sequence
from numbers import Real
from typing import Literal

import numpy as np
from pymoo.core.problem import Problem

from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.exact import Budget, ExactResult, exact_front
from pymoo_gridpath.fields import BoxedField
from pymoo_gridpath.frame import Axis
from pymoo_gridpath.grid import Box, OccupancyGrid
from pymoo_gridpath.objectives import Objective, Turn, make_objectives
from pymoo_gridpath.representations import CellSequence, Representation, make_representation

Obstacles = Literal["penalty", "constraint", "limit"]
# Chosen by measurement on the shipped maps and random grids, see the parameter.
DEFAULT_PENALTY = 2.0

# How long pareto_front() may take, since pymoo asks for it unbidden.
PARETO_SECONDS = 60.0

# Sums of the same costs in another order differ by no more than this share of themselves.
_ROUNDING = 1e-12

# Genes that are evaluated at a time.
PART_SIZE = 12000

OBSTACLES: tuple[Obstacles, ...] = ("penalty", "constraint", "limit")


class GridPathProblem(Problem):
    """Paths from a start to a goal on an occupancy grid, to be minimised in length, vulnerability, turn or other objectives.

    Parameters
    ----------
    grid : OccupancyGrid
    start, goal : (int, int)
        Free cells (x, y).
    representation : {"integer", "binary", "mixed", "absolute", "cells"} or Representation, default "integer"
        How a path is coded as decision variables. The first four are those of the paper, for paths that never turn back;
        "cells" codes every path, see `CellSequence`, and needs operators of its own.
    objectives : sequence of str or Objective, default ("length", "vulnerability")
        What is minimised, in this order; names are "length", "vulnerability" and "turn".
    obstacles : {"penalty", "constraint", "limit"}, default "penalty"
        How paths are kept off obstacles.

        - "penalty": every interfering cell adds ``penalty`` to every objective, and 45 times as many degrees to the turn. pymoo
          sees no constraint.
        - "constraint": ``G`` is the number of interfering cells, which must be zero.
        - "limit": the paper's eq. (1). An occupied cell has the extremely high potential ``penalty``, which adds to the
          vulnerability, and ``G`` keeps the vulnerability at or below ``potential_limit``.
    penalty : float, optional
        What an interfering cell costs. By default 2 with ``obstacles="penalty"``, and the number of cells of the grid with
        "limit", higher than any potential limit worth setting. A small penalty keeps the search diverse, since a path across an
        obstacle may still be non-dominated by its length; a large one makes the number of obstacles decide almost alone, and
        searches end in the first corridor they find. With too small a penalty, paths across obstacles crowd the legal ones
        out; at 1 this happens on floors with thick walls.
    potential_limit : float, optional
        P0, with ``obstacles="limit"`` only, and needed there. Choose it below ``penalty``, so that no path with an
        interfering cell keeps it.
    axis : {"auto", "x", "y"}, default "auto"
        The axis along which monotone paths advance.

    Raises
    ------
    GridPathError
        If an argument is unknown or out of its range, or the query cannot be solved: start or goal outside the grid or on an
        obstacle, goal unreachable, no path that the representation can code.

    Attributes
    ----------
    n_var, n_obj, n_ieq_constr, xl, xu, vtype
        As in pymoo.

    Notes
    -----
    ``pareto_front()`` and ``pareto_set()`` return the exact front of the legal paths, without penalties, and a path for each
    point (see `exact_front`; the first call computes both). They return None if an objective does not add up along a path,
    that is, if it is neither length nor turn and has no field; if there are more than three objectives; or, with a warning,
    if ``max_seconds`` (60 by default) do not suffice. pymoo asks for the front of its own accord where it prints progress
    (``verbose=True``), to show how far a run is from it.

    Besides ``F`` (N, n_obj) and ``G`` (N, 1), an evaluation sets the attributes ``turn`` (degrees) and
    ``interfering_cells`` of each individual: ``pop.get("turn")``. It draws no random number.

    References
    ----------
    F. Ahmed and K. Deb, "Multi-objective optimal path planning using elitist non-dominated sorting genetic algorithms",
    Soft Computing 17(7), 2013, sections 2 to 4.

    Examples
    --------
    >>> import numpy as np
    >>> from pymoo_gridpath import GridPathProblem, OccupancyGrid
    >>> grid = OccupancyGrid(np.zeros((8, 8)), corner_cutting=True)
    >>> problem = GridPathProblem(grid, (0, 0), (7, 7))
    >>> problem.n_var, problem.n_obj, problem.n_ieq_constr
    (7, 2, 0)
    >>> problem.evaluate(np.array([[0, 1, 1, 1, 1, 1, 1]])).round(3).tolist()
    [[9.899, 0.0]]
    """

    def __init__(
        self,
        grid: OccupancyGrid,
        start: Sequence[int],
        goal: Sequence[int],
        representation: str | Representation = "integer",
        objectives: Sequence[str | Objective] = ("length", "vulnerability"),
        obstacles: Obstacles = "penalty",
        penalty: float | None = None,
        potential_limit: float | None = None,
        axis: Axis = "auto",
    ):
        if not isinstance(grid, OccupancyGrid):
            raise GridPathError(f"grid is of the class {type(grid).__name__}, expected an OccupancyGrid; load_map reads one")
        self.grid = grid
        self.start, self.goal = grid.check_query(start, goal)
        self.objectives = make_objectives(objectives)
        if obstacles == "constraint" and penalty is not None:
            raise GridPathError("penalty is for obstacles='penalty' and 'limit', not for obstacles='constraint'")
        self.obstacles = obstacles
        given = self._default_penalty() if penalty is None else penalty
        if not (isinstance(given, Real) and 0 < given < np.inf):
            raise GridPathError(f"penalty is {given!r}, expected a positive number")
        self.penalty = float(given)
        self.potential_limit = potential_limit
        self._check_obstacles()
        box = grid.box_of(self.start)
        fields = [_field(objective, grid, box) for objective in self.objectives]
        if isinstance(representation, str) and representation == CellSequence.name and axis == "auto":
            # Room for the safest paths in the fields of these objectives, and for what else they may bring about.
            costs = [field for field in fields if field is not None]
            spare = 2.0 if len(costs) > 1 or any(isinstance(objective, Turn) for objective in self.objectives) else 1.0
            representation = CellSequence(grid, self.start, self.goal, fields=costs, spare=spare)
        if isinstance(representation, str):
            representation = make_representation(representation, grid, self.start, self.goal, axis)
        else:
            self._check_representation(representation, axis)
        self.representation = representation
        self._front: ExactResult | None = None
        self._sums = [None if field is None else representation.prepare(field) for field in fields]
        super().__init__(
            n_var=representation.n_var,
            n_obj=len(self.objectives),
            n_ieq_constr=0 if obstacles == "penalty" else 1,
            xl=representation.xl,
            xu=representation.xu,
            vtype=representation.vtype,
        )

    def _check_obstacles(self) -> None:
        if self.obstacles not in OBSTACLES:
            raise GridPathError(f"obstacles is {self.obstacles!r}, expected one of {', '.join(OBSTACLES)}")
        if self.obstacles != "limit":
            if self.potential_limit is not None:
                raise GridPathError(f"potential_limit is for obstacles='limit', not for obstacles={self.obstacles!r}")
        elif "vulnerability" not in self.objective_names:
            raise GridPathError(
                f"obstacles='limit' limits the vulnerability, which is not among the objectives {self.objective_names}"
            )
        elif not (isinstance(self.potential_limit, Real) and self.potential_limit > 0):
            raise GridPathError(
                f"potential_limit is {self.potential_limit!r}, expected a positive number with obstacles='limit'"
            )

    def _check_representation(self, representation: Representation, axis: Axis) -> None:
        if not isinstance(representation, Representation):
            raise GridPathError(f"representation is {representation!r}, expected a name such as 'integer', or a Representation")
        if (representation.grid, representation.start, representation.goal) != (self.grid, self.start, self.goal):
            raise GridPathError(
                f"the {representation.name} representation was made for another grid, start or goal than the problem has"
            )
        if axis != "auto":
            raise GridPathError(f"axis={axis!r} is for a representation by name; give it to the representation instead")

    def _default_penalty(self) -> float:
        return self.grid.occupied.size if self.obstacles == "limit" else DEFAULT_PENALTY

    @property
    def objective_names(self) -> list[str]:
        """Names of the objectives in the order of the columns of F."""
        return [objective.name for objective in self.objectives]

    # -- the exact front ----------------------------------------------------------------------------------------------

    def pareto_front(self, *args, **kwargs):
        """Return the exact front, shape (N, n_obj), or None, see Notes; ``max_seconds`` (default 60) may be given."""
        return self._unless_none("pareto_front", *args, **kwargs)

    def pareto_set(self, *args, **kwargs):
        """Return a path for each point of the exact front, shape (N, n_var), or None, as `pareto_front`."""
        return self._unless_none("pareto_set", *args, **kwargs)

    def _unless_none(self, name: str, *args, **kwargs):
        found = getattr(super(), name)(*args, **kwargs)
        if found is None:
            # pymoo would keep that, however much more time the next call gives.
            self.__dict__["cache"].pop(name, None)
        return found

    def _calc_pareto_front(self, max_seconds: float = PARETO_SECONDS):
        found = self._exact(max_seconds)
        return None if found is None else found.F

    def _calc_pareto_set(self, max_seconds: float = PARETO_SECONDS):
        found = self._exact(max_seconds)
        return None if found is None else found.X

    def _exact(self, max_seconds: float) -> ExactResult | None:
        """Return the exact front, kept for the next call, or None if there is none or the time is too short."""
        if self._front is None:
            budget = Budget(max_seconds=max_seconds)
            try:
                found = exact_front(self, budget)
            except CapabilityError:
                return None
            except GridPathError as error:
                warnings.warn(f"no Pareto front: {error}", stacklevel=7)
                return None
            if not found.complete:
                warnings.warn(
                    f"no Pareto front: the search {found.message} (max_seconds={max_seconds:g})",
                    stacklevel=7,
                )
                return None
            self._front = found
        return self._front

    # -- measures -----------------------------------------------------------------------------------------------------

    def decode(self, X: np.ndarray):
        """Return the paths that the rows of X code, see `ColumnPaths` and `CellPaths`."""
        return self.representation.decode(X)

    def score(self, paths) -> np.ndarray:
        """Return the plain objectives of paths, without any penalty, shape (N, n_obj)."""
        F = [f(paths, sums) for f, sums in zip(self.objectives, self._sums, strict=True)]
        for objective, values in zip(self.objectives, F, strict=True):
            if np.shape(values) != (len(paths),):
                raise GridPathError(
                    f"the objective {objective.name!r} returned values of shape {np.shape(values)} for {len(paths)} paths, "
                    f"expected one a path"
                )
        return np.column_stack(F)

    def over_limit(self, vulnerability: np.ndarray) -> np.ndarray:
        """Return by how much vulnerabilities exceed the potential limit; 0 for sums that rounding alone sets apart from it."""
        assert self.potential_limit is not None
        over = np.asarray(vulnerability - self.potential_limit, dtype=float)
        over[np.abs(over) <= _ROUNDING * self.potential_limit] = 0.0
        return over

    def _evaluate(self, x, out, *args, **kwargs):
        # In parts small enough for their temporary arrays to stay in the processor's cache: about twice as fast.
        n_parts = min(max(1, round(len(x) * self.n_var / PART_SIZE)), max(1, len(x)))
        parts = [self._measure(part) for part in np.array_split(x, n_parts)]
        F, turn, interfering = (np.concatenate(values) for values in zip(*parts, strict=True))
        if self.obstacles == "penalty":
            F += np.outer(self.penalty * interfering, [objective.penalty_unit for objective in self.objectives])
        elif self.obstacles == "constraint":
            out["G"] = interfering[:, None].astype(float)
        else:
            k = self.objective_names.index("vulnerability")
            F[:, k] += self.penalty * interfering
            out["G"] = self.over_limit(F[:, [k]])
        out["F"] = F
        out["turn"] = turn
        out["interfering_cells"] = interfering

    def _measure(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        paths = self.decode(X)
        return self.score(paths), paths.turn, paths.interfering_cells


def _field(objective: Objective, grid: OccupancyGrid, box: Box) -> np.ndarray | BoxedField | None:
    """Return the field of an objective, that of a local one in a box only."""
    if not objective.local or box == grid.whole:
        return _checked(objective, grid)
    return BoxedField(objective.field_in(grid, box), box, grid.width, functools.partial(objective.field, grid))


def _checked(objective: Objective, grid: OccupancyGrid) -> np.ndarray | None:
    """Return the field of an objective, zero in occupied cells if it is not finite there, or None if it has none."""
    given = objective.field(grid)
    if given is None:
        return None
    try:
        field = np.asarray(given)
    except ValueError:  # rows of different lengths
        field = np.asarray(None)
    if field.shape != grid.shape or field.dtype.kind not in "biuf":
        what = f"{field.dtype} of shape {field.shape}" if field.dtype.kind != "O" else type(given).__name__
        raise GridPathError(
            f"the field of the objective {objective.name!r} is {what}, expected numbers of shape {grid.shape}, the (height, "
            f"width) of the grid"
        )
    if np.isfinite(field).all():
        return field
    if not np.isfinite(field[~grid.occupied]).all():
        y, x = np.argwhere(~np.isfinite(field) & ~grid.occupied)[0]
        raise GridPathError(
            f"the field of the objective {objective.name!r} is {field[y, x]:g} in the free cell ({x}, {y}), expected a finite "
            f"number; mark cells that no path may enter as occupied"
        )
    return np.where(np.isfinite(field), field, 0.0)
