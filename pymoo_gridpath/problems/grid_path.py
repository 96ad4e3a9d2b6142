"""Path planning on a grid as a pymoo problem."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Literal, Self

import numpy as np
from pymoo.core.problem import Problem

from pymoo_gridpath import checks, pictures
from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import CapabilityError, GridError, GridPathError, GridPathWarning, counted, visible
from pymoo_gridpath.exact import Budget, ExactResult, exact_front
from pymoo_gridpath.exact.nearness import Allowance
from pymoo_gridpath.fields import BoxedField
from pymoo_gridpath.grid import Box, Cell, OccupancyGrid, check_grid
from pymoo_gridpath.grid.picture import scene_of
from pymoo_gridpath.maps.queries import query_in_metres
from pymoo_gridpath.objectives import (
    MoveCosts,
    Objective,
    avoiding_costs,
    boxed_field_of,
    field_of,
    make_objectives,
    prepared,
    visiting_costs,
)
from pymoo_gridpath.paths import Paths, check_paths
from pymoo_gridpath.paths.frame import Axis, check_axis
from pymoo_gridpath.representations import Representation, default_representation, make_representation
from pymoo_gridpath.representations.base import check_representation
from pymoo_gridpath.search import Moves

Obstacles = Literal["penalty", "constraint", "limit"]
# Chosen by measurement on the shipped maps and random grids, see the parameter.
DEFAULT_PENALTY = 2.0

# How long pareto_front() may take unless told, since pymoo asks for it unbidden.
PARETO_SECONDS = 2.0

# Sums of the same costs in another order differ by no more than this share of themselves.
_ROUNDING = 1e-12

# Genes that are evaluated at a time.
PART_SIZE = 100_000

OBSTACLES: tuple[Obstacles, ...] = ("penalty", "constraint", "limit")


def default_penalty(obstacles: Obstacles, n_cells: int) -> float | None:
    """Return what an interfering cell costs by default on a grid of so many cells; None where nothing is added."""
    if obstacles == "constraint":
        return None
    return float(n_cells) if obstacles == "limit" else DEFAULT_PENALTY


class GridPathProblem(Problem):
    """Paths from a start to a goal on an occupancy grid, to be minimised in length, vulnerability, turn or other objectives.

    Parameters
    ----------
    grid : OccupancyGrid
    start, goal : (int, int)
        Free cells (x, y).
    representation : str, type or Representation, optional
        How a path is coded as decision variables: one of `REPRESENTATIONS` by name, a class of your own, or an object made for
        the same query. "cells" codes every path, see `CellSequence`, and needs `path_operators`; "integer", "binary", "mixed"
        and "absolute" are those of the paper, for paths that never turn back along an axis, of which "sugihara-smith" codes
        some. The default is "cells", and
        "integer" where corners may be cut, which is the world of the paper, or an ``axis`` is given, see
        `default_representation`.
    objectives : sequence of str or Objective, default ("length", "vulnerability")
        What is minimised, in this order; names are "length", "vulnerability", "turn", "inflation", and "clearance", the least
        clearance of a path, of which ``F`` holds the negative. The vulnerability is in metres on a map that states its
        resolution, and the paper's on a map in cells, see `Vulnerability`.
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
    that is, if it is neither length nor turn and has no field, nor goes by the worst cell; if there are more than three that
    add up; or, with a warning,
    if ``max_seconds`` do not suffice: 2 by default, of wall time and without compiling, because pymoo asks for the front of its
    own accord where it prints progress (``verbose=True``). Large maps and three objectives need more. What did not suffice once
    is not tried again; only a call with more seconds is a new attempt. With ``epsilon`` or ``share``, and only then, they may
    return paths that are certified to be that near to the front, see `exact_front`, and raise where nothing can be certified.

    Besides ``F`` (N, n_obj) and ``G`` (N, 1), an evaluation sets the attributes ``turn`` (degrees) and
    ``interfering_cells`` of each individual: ``pop.get("turn")``. It draws no random number.

    Algorithms need operators that fit: `path_operators`, `paper_operators`, or all that `make_algorithm` builds. Those that
    pymoo's algorithms have by default are for real numbers and find no legal path on most maps. The first evaluation of genes
    that are no whole numbers, or of a generation of such operators without a legal path, warns of that, once a problem.

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

    # Whether obstacles move while a path is on its way, which its representation has to know.
    timed = False

    def __init__(
        self,
        grid: OccupancyGrid,
        start: Sequence[int],
        goal: Sequence[int],
        representation: str | type[Representation] | Representation | None = None,
        objectives: Sequence[str | Objective] = ("length", "vulnerability"),
        obstacles: Obstacles = "penalty",
        penalty: float | None = None,
        potential_limit: float | None = None,
        axis: Axis = "auto",
    ):
        self.grid = check_grid(grid)
        self.start, self.goal = self._check_ends(start, goal)
        self.objectives = tuple(objective.on(grid) for objective in make_objectives(objectives))
        checks.one_of("obstacles", obstacles, OBSTACLES)
        if obstacles == "constraint" and penalty is not None:
            raise GridPathError("penalty is for obstacles='penalty' and 'limit', not for obstacles='constraint'")
        self.obstacles = obstacles
        given = default_penalty(obstacles, grid.occupied.size) or DEFAULT_PENALTY if penalty is None else penalty
        self.penalty = checks.number("penalty", given, 0.0, above=True, expected="a positive number")
        self.potential_limit = self._check_limit(potential_limit)
        check_axis(axis)
        box = grid.box_of(self.start)
        fields = [boxed_field_of(objective, grid, box) for objective in self.objectives]
        if representation is None:
            representation = default_representation(grid.corner_cutting, axis)
        if getattr(representation, "timed", False) and not self.timed:
            raise GridPathError(
                f"paths of the {shown(getattr(representation, 'name', ''))} representation are paths in time, expected a "
                f"TimedPathProblem for them"
            )
        if isinstance(representation, str | type):
            costs = [
                _row_costs(objective, grid, box, self.start, self.goal, field)
                for objective, field in zip(self.objectives, fields, strict=True)
            ]
            turning = any(objective.turn_cost for objective in self.objectives)
            known = [cost for cost in costs if cost is not None]
            representation = make_representation(representation, grid, self.start, self.goal, axis, known, turning)
        else:
            self._check_representation(representation, axis)
        self.representation: Representation = check_representation(representation)
        self._front: ExactResult | None = None
        # With how many seconds there was none, and why.
        self._no_front: tuple[float, str] | None = None
        self._fronts_near: dict[Allowance, ExactResult] = {}
        self._warned_of_operators = False
        self._prepared = [
            prepared(objective, representation, field) for objective, field in zip(self.objectives, fields, strict=True)
        ]
        super().__init__(
            n_var=representation.n_var,
            n_obj=len(self.objectives),
            n_ieq_constr=0 if obstacles == "penalty" else 1,
            xl=representation.xl,
            xu=representation.xu,
            vtype=representation.vtype,
            # Among them the algorithm.
            requires_kwargs=True,
        )

    @classmethod
    def from_metres(
        cls, grid: OccupancyGrid, start: Sequence[float], goal: Sequence[float], goal_tolerance: float = 0.0, **options
    ) -> Self:
        """Return the problem of paths between two points in metres.

        Parameters
        ----------
        grid : OccupancyGrid
        start, goal : (float, float)
            Points (x, y) in the frame of the map, with its origin and yaw; the cells that hold them are planned between.
        goal_tolerance : float, default 0.0
            Where no path leads to the goal, the nearest cell that can be reached is the goal instead, if its centre is at most
            so many metres from the point.
        **options
            What else the constructor takes.

        Raises
        ------
        GridPathError
            If a point lies outside the map, on an obstacle, or nearer to one than the robot can be, no path leads to the goal,
            or both lie in the same cell, all in metres; and as the constructor.

        Examples
        --------
        >>> import numpy as np
        >>> grid = OccupancyGrid(np.zeros((8, 8)), resolution=0.5, origin=(-2.0, -2.0, 0.0))
        >>> problem = GridPathProblem.from_metres(grid, (-1.8, -1.8), (1.2, 0.3), objectives=["length"])
        >>> problem.start, problem.goal
        ((0, 0), (6, 4))
        """
        ends = query_in_metres(check_grid(grid), start, goal, goal_tolerance)
        if ends[0] == ends[1]:
            raise GridError(
                f"start {shown(tuple(start))} m and goal {shown(tuple(goal))} m lie in the same cell, expected two different "
                f"ones"
            )
        return cls(grid, start=ends[0], goal=ends[1], **options)

    def _check_ends(self, start: Sequence[int], goal: Sequence[int]) -> tuple[Cell, Cell]:
        return self.grid.check_query(start, goal)

    def _check_limit(self, potential_limit: float | None) -> float | None:
        if self.obstacles != "limit":
            if potential_limit is not None:
                raise GridPathError(f"potential_limit is for obstacles='limit', not for obstacles={self.obstacles!r}")
            return None
        if "vulnerability" not in self.objective_names:
            raise GridPathError(
                f"obstacles='limit' limits the vulnerability, which is not among the objectives {shown(self.objective_names)}"
            )
        expected = "a positive number with obstacles='limit'"
        return checks.number("potential_limit", potential_limit, 0.0, above=True, infinite=True, expected=expected)

    def _check_representation(self, representation: Representation, axis: Axis) -> None:
        if not isinstance(representation, Representation):
            raise GridPathError(
                f"representation is {shown(representation)}, expected a name such as 'integer', a class derived from "
                f"Representation, or an object of one"
            )
        if (representation.grid, representation.start, representation.goal) != (self.grid, self.start, self.goal):
            raise GridPathError(
                f"the {representation.name} representation was made for another grid, start or goal than the problem has"
            )
        if axis != "auto":
            raise GridPathError(f"axis={axis!r} is for a representation by name; give it to the representation instead")

    @property
    def objective_names(self) -> list[str]:
        """Names of the objectives in the order of the columns of F."""
        return [objective.name for objective in self.objectives]

    # -- in a notebook ------------------------------------------------------------------------------------------------

    def _repr_png_(self) -> bytes:
        grid = self.grid
        scene = scene_of(grid)._replace(start=self.start, goal=self.goal)
        return pictures.png(scene.cropped(*self.representation.box))

    def _repr_html_(self) -> str:
        rows = {
            "map": visible(self.grid.name),
            "from, to": f"{self.start}, {self.goal}",
            "objectives": visible(", ".join(self.objective_names)),
            "representation": f"{visible(self.representation.name)}, {counted(self.n_var, 'gene')}",
            "obstacles": self.obstacles,
        }
        return pictures.page(self._repr_png_(), type(self).__name__, rows, "map with start (disc) and goal (square)")

    # -- time ---------------------------------------------------------------------------------------------------------

    @property
    def stills(self) -> tuple[GridPathProblem, ...]:
        """The problems that do not move, one a map that there is in a run: this one alone."""
        return (self,)

    def restart(self) -> None:
        """Go back to where runs begin, which this problem never leaves; those whose time passes do."""

    # -- the exact front ----------------------------------------------------------------------------------------------

    def pareto_front(self, *args, **kwargs):
        """Return the exact front, shape (N, n_obj), or None, see Notes.

        ``max_seconds`` (default 2) may be given, and ``epsilon`` or ``share`` where a front that is near to it will do.
        """
        return self._unless_none("pareto_front", *args, **kwargs)

    def pareto_set(self, *args, **kwargs):
        """Return a path for each point of the exact front, shape (N, n_var), or None, as `pareto_front`."""
        return self._unless_none("pareto_set", *args, **kwargs)

    def _unless_none(self, name: str, *args, epsilon: float | None = None, share: float | None = None, **kwargs):
        allowance = Allowance(epsilon, share)
        if allowance.name:
            near = self._near(allowance, *args, **kwargs)
            return None if near is None else {"pareto_front": near.F, "pareto_set": near.X}[name]
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

    def _exact(self, max_seconds: float | None) -> ExactResult | None:
        """Return the exact front, kept for the next call, or None if there is none or the time is too short."""
        budget = Budget(max_seconds=max_seconds)
        seconds = np.inf if max_seconds is None else max_seconds
        if self._front is None and (self._no_front is None or seconds > self._no_front[0]):
            try:
                found = exact_front(self, budget)
            except CapabilityError:
                return None
            except GridPathError as error:
                self._no_front = seconds, str(error)
            else:
                more = "; pareto_front(max_seconds=...) gives it more" if found.seconds >= seconds else ""
                self._front = found if found.complete else None
                self._no_front = seconds, f"the search {found.message}{more}"
        if self._front is None and self._no_front is not None:
            warnings.warn(f"no Pareto front: {self._no_front[1]}", GridPathWarning, stacklevel=7)
        return self._front

    def _near(self, allowance: Allowance, max_seconds: float | None = PARETO_SECONDS) -> ExactResult | None:
        """Return a front that is near enough to the exact one, kept for the next call, or None if the time is too short."""
        budget = Budget(max_seconds=max_seconds)
        found = self._front or self._fronts_near.get(allowance)
        if found is None:
            found = exact_front(self, budget, epsilon=allowance.epsilon, share=allowance.share)
            if not found.success:
                warnings.warn(f"no Pareto front: the search {found.message}", GridPathWarning, stacklevel=4)
                return None
            self._fronts_near[allowance] = found
        return found

    # -- measures -----------------------------------------------------------------------------------------------------

    def decode(self, X: np.ndarray):
        """Return the paths that the rows of X code, see `Paths`."""
        return self.representation.decode(X)

    def score(self, paths) -> np.ndarray:
        """Return the plain objectives of paths, without any penalty, float, shape (N, n_obj)."""
        return self._without_nan(self._scores(check_paths(paths)))

    def _scores(self, paths: Paths) -> np.ndarray:
        """Return what `score` does, NaN included."""
        F = np.empty((len(paths), self.n_obj))
        for k, (objective, prepared_) in enumerate(zip(self.objectives, self._prepared, strict=True)):
            values = objective(paths, prepared_)
            if type(values) is not np.ndarray or values.dtype.kind not in "iuf":
                what = f"what the objective {shown(objective.name)} returned"
                values = checks.array(what, values, expected="one number a path")
            if values.shape != (len(paths),):
                raise GridPathError(
                    f"the objective {shown(objective.name)} returned values of shape {values.shape} for "
                    f"{counted(len(paths), 'path')}, expected one number a path"
                )
            F[:, k] = values
        return F

    def _costs_in(self, number: int, box: Box) -> tuple[np.ndarray | None, MoveCosts | None]:
        """Return the costs of the cells of a box, and of moves, that an objective has, as far as it has any."""
        field, moves = self._prepared[number]
        if isinstance(field, BoxedField):
            return field.within(box), moves
        if field is not None:
            # By the index of the cell, unless the representation has it in a form of its own.
            is_plain = field.shape == (self.grid.occupied.size,)
            field = (
                field.reshape(self.grid.shape)[box.slices] if is_plain else field_of(self.objectives[number], self.grid, box)
            )
        return field, moves

    def _without_nan(self, F: np.ndarray) -> np.ndarray:
        """Return scores if they are numbers."""
        # A minimum is NaN if one of them is.
        if F.size and np.isnan(F.min()):
            i, k = np.argwhere(np.isnan(F))[0]
            raise GridPathError(f"the objective {shown(self.objective_names[k])} returned NaN for path {i}, expected a number")
        return F

    def over_limit(self, vulnerability: np.ndarray) -> np.ndarray:
        """Return by how much vulnerabilities exceed the potential limit; 0 for sums that rounding alone sets apart from it."""
        if self.potential_limit is None:
            raise GridPathError("the problem has no potential limit, expected one with obstacles='limit'")
        over = checks.array("vulnerability", vulnerability, expected="an array of numbers") - self.potential_limit
        over = np.asarray(over, dtype=float)
        return np.where(np.abs(over) <= _ROUNDING * self.potential_limit, 0.0, over)

    def _evaluate(self, x, out, *args, **kwargs):
        # In parts small enough for their temporary arrays to stay in the processor's cache.
        n_parts = min(max(1, round(len(x) * self.n_var / PART_SIZE)), max(1, len(x)))
        if n_parts == 1:
            F, turn, interfering = self._measure(x)
        else:
            parts = [self._measure(part) for part in np.array_split(x, n_parts)]
            F, turn, interfering = (np.concatenate(values) for values in zip(*parts, strict=True))
        self._without_nan(F)
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
        if not self._warned_of_operators:
            self._warn_of_operators(np.asarray(x), interfering, kwargs.get("algorithm"))

    def _warn_of_operators(self, X: np.ndarray, interfering: np.ndarray, algorithm) -> None:
        """Warn, once, of genes or generations that come of operators which know nothing of paths."""
        if X.dtype.kind == "f" and (np.rint(X) != X).any():
            what = "genes that are no whole numbers, as operators for real numbers make them, hardly ever code a legal path"
        elif (name := _maker_without_repair(algorithm)) and len(interfering) and interfering.all():
            what = f"there is no legal path among {len(X)} of {name}, and the algorithm has no repair that knows paths"
        else:
            return
        self._warned_of_operators = True
        warnings.warn(
            f"{what}; operators that make legal paths: NSGA2(**path_operators(problem)), with path_operators from "
            f"pymoo_gridpath.operators",
            GridPathWarning,
            stacklevel=2,
        )

    def _measure(self, X: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        paths = check_paths(self.decode(X))
        return self._scores(paths), paths.turn, paths.interfering_cells


def _row_costs(objective: Objective, grid: OccupancyGrid, box: Box, start: Cell, goal: Cell, field):
    """Return costs of cells whose cheapest paths tell how long paths become that are good by an objective, or None."""
    if objective.additive:
        return visiting_costs(objective, grid, grid.whole, field)
    if not objective.bottleneck:
        return None
    moves, costs = Moves(grid, box=box), np.zeros(grid.shape)
    inside = field.inside if isinstance(field, BoxedField) else np.asarray(field)
    costs[box.slices] = avoiding_costs(objective, moves, moves.index(start), moves.index(goal), inside)
    return costs


def _maker_without_repair(algorithm) -> str:
    """Return the name of the operator that made the rows under evaluation if no repair that knows paths came after it.

    A repair says that it knows paths by a class attribute, as `EdgeFixing` and `PathRepair` do.
    """
    if algorithm is None or getattr(getattr(algorithm, "repair", None), "knows_paths", False):
        return ""
    if getattr(algorithm, "is_initialized", False):
        maker = getattr(getattr(algorithm, "mating", None), "crossover", None)
    else:
        maker = getattr(getattr(algorithm, "initialization", None), "sampling", None)
    return "" if maker is None or getattr(maker, "knows_paths", False) else type(maker).__name__
