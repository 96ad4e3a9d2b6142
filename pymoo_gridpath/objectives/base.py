"""What an objective is, those of the paper, and what is asked of any."""

from __future__ import annotations

import functools
from abc import ABC
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.checks import shown
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.fields import (
    BoxedField,
    check_costs,
)
from pymoo_gridpath.grid import SQRT2, Box, OccupancyGrid, check_box, check_grid
from pymoo_gridpath.neighbourhood import HEADINGS
from pymoo_gridpath.paths import TURN_UNIT, Paths
from pymoo_gridpath.registry import Registry
from pymoo_gridpath.search.bottleneck import best_level
from pymoo_gridpath.search.moves import Moves

#: What the costs of a path may be put together by.
COMBINATIONS = ("sum", "least", "greatest")

# How many times as much the worst cells cost as those that are a little worse than need be, and at most from level to level:
# chosen by measurement of what searches find of exact fronts.
_STEEPNESS, _MOST_GROWTH = 2.0**8, 4.0

#: What a step costs: the same wherever it is, straight or diagonal, or as an array by [heading, y, x] of the cell entered.
MoveCosts = tuple[float, float] | np.ndarray


class Prepared(NamedTuple):
    """What an objective says of a grid, in the form in which paths of a representation add it up.

    Attributes
    ----------
    field : numpy.ndarray or BoxedField, optional
        Costs of cells, for ``paths.total(field)``.
    moves : (float, float) or numpy.ndarray of shape (8, height, width), optional
        Costs of moves; an array is for ``paths.moves_total(moves)``.
    """

    field: np.ndarray | BoxedField | None = None
    moves: MoveCosts | None = None


class Objective(ABC):
    """A quantity of a path to be minimised.

    Subclass it to add one of your own: set `name` and `label`, and say what a path costs. There are three kinds of costs, which
    add up where an objective has several: of each visited cell (`field`), of each move from a cell to the next (`moves`), and
    of turning (`turn_cost`). None is negative; whole numbers, truth values and short floats count as floats. What adds up
    has an exact front and needs no code to score paths. Another quantity is computed from the paths by ``__call__``.

    Attributes
    ----------
    name : str
        What tables and files call it.
    label : str
        What an axis of a figure says, with the unit.
    turn_cost : float
        Cost of 45 degrees of turning.
    combine : {"sum", "least", "greatest"}
        What a path has of the costs along it: their sum, or the least or the greatest of the cells' costs.
    maximise : bool
        Whether more of that is better. Objectives are minimised, so the score of a path is the negative then; tables and
        figures show it as it is. A ``__call__`` of its own returns the negative, too.
    best : str
        What the best path of a set by this objective goes by, such as "shortest"; empty if it has no name of its own.
    penalty_unit : float
        What a penalty of 1 adds to it: 1, or the objective's own step where it counts in larger ones.
    local : bool
        Whether the cost of a cell depends on its neighbourhood alone, so that `field_in` does not work out the whole field.
    in_cells : bool
        Whether its values are lengths in cells, which tables, figures and pages give in metres of a map that states its
        resolution. Its label says ``[cells]`` then.
    files : tuple of str
        Arguments that may be the name of a file: runs of a study are known by what it holds, and not by its name alone.

    Examples
    --------
    >>> class Mud(Objective):
    ...     name, label = "mud", "Mud on the way"
    ...
    ...     def field(self, grid):
    ...         cost = np.zeros(grid.shape)
    ...         cost[2:5, :4] = 1.5  # rows y, columns x
    ...         return cost
    >>> from pymoo_gridpath import GridPathProblem
    >>> problem = GridPathProblem(OccupancyGrid(np.zeros((8, 8))), (0, 0), (0, 7), "cells", objectives=["length", Mud()])
    >>> problem.pareto_front().round(2).tolist()
    [[7.0, 4.5], [10.9, 3.0], [11.49, 1.5], [12.07, 0.0]]

    Time on a slope, where it takes longer to go up than down:

    >>> class Climb(Objective):
    ...     name, label = "climb", "Metres climbed"
    ...
    ...     def moves(self, grid):
    ...         height = np.add.outer(np.zeros(grid.height), np.arange(grid.width) % 4)
    ...         cost = np.zeros((8, *grid.shape))
    ...         for heading, (dx, dy) in enumerate(HEADINGS):
    ...             # The cell that a step comes from; what wraps around the edge is no step.
    ...             cost[heading] = np.maximum(height - np.roll(height, (dy, dx), (0, 1)), 0)
    ...         return cost
    >>> problem = GridPathProblem(OccupancyGrid(np.zeros((8, 8))), (0, 0), (7, 0), "cells", objectives=["length", Climb()])
    >>> problem.pareto_front().tolist()
    [[7.0, 6.0]]
    """

    name: str
    label: str
    turn_cost: float = 0.0
    combine: str = "sum"
    maximise: bool = False
    best: str = ""
    penalty_unit: float = 1.0
    local: bool = False
    in_cells: bool = False
    files: tuple[str, ...] = ()

    def on(self, grid: OccupancyGrid) -> Objective:
        """Return the objective with everything written out that a map decides where it is not given; itself if that is nothing.

        A problem has its objectives so, and says them so in the files of its paths.
        """
        return self

    def field(self, grid: OccupancyGrid) -> np.ndarray | None:
        """Return the cost of each visited cell, the start included, shape (height, width), or None if cells cost nothing."""
        return None

    def field_in(self, grid: OccupancyGrid, box: Box) -> np.ndarray | None:
        """Return the cost of each cell in a box, shape (height, width) of the box, or None.

        What `field` says of these cells. Override it too where that can be had without the cost of all other cells.
        """
        whole = self.field(grid)
        box = check_box(box, grid)
        return whole if whole is None or box == grid.whole else np.asarray(whole)[box.slices]

    def moves(self, grid: OccupancyGrid) -> MoveCosts | None:
        """Return the cost of each move from a cell to the next, or None if moves cost nothing.

        Returns
        -------
        (float, float), numpy.ndarray of shape (8, height, width), or None
            The cost of a straight and of a diagonal step wherever they are; or the cost of entering each cell along each
            heading, by [heading, y, x] of the cell entered. Headings are those of `pymoo_gridpath.neighbourhood.HEADINGS`:
            0 is to the right, and on counter-clockwise by 45 degrees. Entries of steps that are not legal count for illegal
            paths alone.
        """
        return None

    @property
    def additive(self) -> bool:
        """Whether it adds up costs that it names, less being better, so that there is an exact front."""
        cls = type(self)
        names_some = cls.field is not Objective.field or cls.moves is not Objective.moves or self.turn_cost != 0.0
        return self.combine == "sum" and names_some and not self.maximise

    @property
    def bottleneck(self) -> bool:
        """Whether the worst cell of a path decides, as where the least clearance is maximised: there is an exact front then."""
        cls = type(self)
        worst = "least" if self.maximise else "greatest"
        return self.combine == worst and cls.field is not Objective.field and cls.__call__ is Objective.__call__

    def prepare(self, representation, grid: OccupancyGrid) -> Prepared:
        """Return what the objective says of a grid in the form in which paths of a representation add it up.

        Raises
        ------
        GridPathError
            If a cost is negative, or not finite where a path may go.
        """
        grid = check_grid(grid)
        if not all(hasattr(representation, name) for name in ("box", "prepare")):
            raise GridPathError(f"representation is {shown(representation)}, expected a Representation")
        return prepared(self, representation, boxed_field_of(self, grid, representation.box))

    def __call__(self, paths: Paths, prepared: Prepared) -> np.ndarray:
        """Score a batch of paths; by default by the costs that the objective names.

        Parameters
        ----------
        paths : Paths
            N paths.
        prepared : Prepared
            What `prepare` returned for their representation.

        Returns
        -------
        numpy.ndarray of float, shape (N,)
        """
        total = self._total(paths, *prepared)
        return -total if self.maximise else total

    def _total(self, paths: Paths, field, moves) -> np.ndarray:
        """Return what paths have of the costs along them."""
        if self.combine != "sum":
            cells, offsets = paths.sequences
            chosen = np.minimum if self.combine == "least" else np.maximum
            return chosen.reduceat(np.asarray(field).take(cells), offsets[:-1]) if len(paths) else np.empty(0)
        terms = [] if field is None else [paths.total(field)]
        if isinstance(moves, tuple):
            terms.append(moves[0] * paths.n_straight + moves[1] * paths.n_diagonal)
        elif moves is not None:
            terms.append(paths.moves_total(moves))
        if self.turn_cost:
            terms.append(paths.turn * (self.turn_cost / TURN_UNIT))
        return functools.reduce(np.add, terms)

    def __repr__(self) -> str:
        settings = ", ".join(f"{key}={value!r}" for key, value in vars(self).items())
        return f"{type(self).__name__}({settings})"


#: Objectives by name: those of the paper, those that were registered, and those of installed packages.
OBJECTIVES: Registry[type[Objective]] = Registry("objective", "pymoo_gridpath.objectives", Objective)


@OBJECTIVES.register
class Length(Objective):
    """Length of the path in cells: straight steps count 1, diagonal ones sqrt(2).

    References
    ----------
    Ahmed and Deb (2013), section 3.1.
    """

    name = "length"
    label = "Path length [cells]"
    in_cells = True
    best = "shortest"

    def moves(self, grid):
        return 1.0, SQRT2


@OBJECTIVES.register
class Turn(Objective):
    """Total turn in degrees, the sum of the absolute heading changes; the smoothest path has the least.

    References
    ----------
    Ahmed and Deb (2013), sections 3.3 and 5.6.
    """

    name = "turn"
    label = "Total turn [degrees]"
    best = "smoothest"
    turn_cost = float(TURN_UNIT)
    penalty_unit = TURN_UNIT


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
    >>> from pymoo_gridpath.objectives import Vulnerability
    >>> make_objectives(["length", Vulnerability(variance=2.0)])
    (Length(), Vulnerability(variance=2.0))
    """
    if isinstance(objectives, str | Objective):
        objectives = [objectives]
    made = []
    for item in checks.items("objectives", objectives, "names such as 'length', or Objective objects"):
        if isinstance(item, str):
            cls = OBJECTIVES[item]
            try:
                item = cls()
            except TypeError as error:
                raise GridPathError(f"the objective {shown(item)} cannot be made without arguments: {error}") from error
        elif not isinstance(item, Objective):
            raise GridPathError(f"objective {shown(item)} is neither a name nor an Objective")
        if not isinstance(getattr(item, "name", None), str):
            raise GridPathError(f"the objective {type(item).__name__} has no name, expected a text as its attribute 'name'")
        what = f"of the objective {shown(item.name)}"
        checks.number(f"turn_cost {what}", item.turn_cost, 0.0, expected="the cost of 45 degrees of turning, zero or more")
        checks.one_of(f"combine {what}", item.combine, COMBINATIONS)
        checks.flag(f"maximise {what}", item.maximise)
        checks.text(f"best {what}", item.best)
        made.append(item)
    names = [item.name for item in made]
    if not names or len(set(names)) < len(names):
        raise GridPathError(f"objectives are {shown(names)}, expected one or more, each once")
    return tuple(made)


def axis_of(objective: Objective, grid: OccupancyGrid) -> tuple[str, float]:
    """Return what an axis of a figure says of an objective on a map, and by what its values are multiplied there."""
    if objective.in_cells and grid.resolution is not None:
        return objective.label.replace("[cells]", "[m]"), grid.resolution
    return objective.label, 1.0


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


def prepared(objective: Objective, representation, field: np.ndarray | BoxedField | None) -> Prepared:
    """Return what an objective says of the grid of a representation, whose field has been worked out.

    Raises
    ------
    GridPathError
        Of the costs of moves, see `moves_of`; or if there is no cost that its ``__call__`` could add up.
    """
    moves = moves_of(objective, representation.grid)
    is_sum = objective.combine == "sum"
    if type(objective).__call__ is Objective.__call__:
        named = [field, moves, objective.turn_cost or None] if is_sum else [field]
        if all(cost is None for cost in named):
            raise GridPathError(
                f"the objective {shown(objective.name)} names no cost, expected one of cells, as 'field' returns it"
                + (", one of 'moves', a 'turn_cost', or a __call__ of its own" if is_sum else "")
            )
    if field is None:
        return Prepared(None, moves)
    return Prepared(representation.prepare(field) if is_sum else np.ravel(field), moves)


def moves_of(objective: Objective, grid: OccupancyGrid) -> MoveCosts | None:
    """Return the costs of moves of an objective, as floats, or None if it has none.

    An array is that of the whole grid, whichever part of it a problem is about, and 0 where it is not finite for a step that is
    not legal.

    Raises
    ------
    GridPathError
        If it is neither a pair of costs nor an array of them, or a cost is negative, or that of a legal step is not finite.
    """
    given = objective.moves(grid)
    if given is None:
        return None
    what = f"the cost of moves of the objective {shown(objective.name)}"
    expected = f"two numbers, for straight and diagonal steps, or an array of shape {(8, *grid.shape)}: (8, height, width)"
    costs = checks.array(what, given, expected=expected).astype(float, order="C")
    if costs.shape == (2,):
        if not (np.isfinite(costs) & (costs >= 0.0)).all():
            raise GridPathError(f"{what} is {shown(given)}, expected finite numbers of zero or more")
        return float(costs[0]), float(costs[1])
    if costs.shape != (8, *grid.shape):
        raise GridPathError(f"{what} is of shape {costs.shape}, expected {expected}")
    finite = np.isfinite(costs)
    for wrong, reason in (
        (finite & (costs < 0.0), "zero or more, also for steps that are not legal"),
        (~finite & Moves(grid).entered.reshape(costs.shape), "a finite number where a step is legal"),
    ):
        if wrong.any():
            heading, y, x = np.argwhere(wrong)[0]
            dx, dy = HEADINGS[heading]
            raise GridPathError(
                f"{what} is {costs[heading, y, x]:g} for the step ({dx}, {dy}), heading {heading}, to the cell ({x}, {y}), "
                f"expected {reason}"
            )
    return np.where(finite, costs, 0.0)


def levels_of(objective: Objective, field: np.ndarray) -> np.ndarray:
    """Return how good each cell is by an objective whose worst cell decides: 0 for the best, 1 for the next, and so on.

    Parameters
    ----------
    objective : Objective
    field : numpy.ndarray
        Its field, or a part of it.

    Returns
    -------
    numpy.ndarray of int64, of the same shape
    """
    return np.unique(-field if objective.maximise else field, return_inverse=True)[1].reshape(field.shape)


def avoiding_costs(objective: Objective, moves: Moves, start: int, goal: int, field: np.ndarray) -> np.ndarray:
    """Return costs of cells that lead paths along cells which are good by an objective whose worst cell decides.

    Nothing where a cell is no worse than what the best path has to pass; from there on each level costs so many times as much
    as the one before, and the worst of all 1.

    Parameters
    ----------
    objective : Objective
    moves : Moves
    start, goal : int
        Indices of two cells that a path joins.
    field : numpy.ndarray, shape (height, width) of the box of the moves
        The objective's.

    Returns
    -------
    numpy.ndarray of float, of the same shape
    """
    levels = levels_of(objective, field)
    over = levels - best_level(moves, levels.ravel(), start, goal)
    last = over[moves.legal.reshape(over.shape) > 0].max(initial=1)
    growth = min(_STEEPNESS ** (1 / last), _MOST_GROWTH)
    return np.where(over > 0, growth ** np.minimum(over - last, 0.0), 0.0)


def visiting_costs(objective: Objective, grid: OccupancyGrid, box: Box, field=None) -> np.ndarray | BoxedField | None:
    """Return about what a visit of each cell costs, whichever way it is entered: for searches that need no more than that.

    The field; where moves have costs of their own in each cell, with the mean of those over the legal steps into it. None where
    all cells cost the same, or costs do not add up to what is to be little.

    Parameters
    ----------
    objective : Objective
    grid : OccupancyGrid
    box : Box
        The cells that are wanted.
    field : numpy.ndarray or BoxedField, optional
        That of the objective in the box, if it is at hand.
    """
    if objective.combine != "sum" or objective.maximise:
        return None
    field = field_of(objective, grid, box) if field is None else field
    costs = moves_of(objective, grid)
    if not isinstance(costs, np.ndarray):
        return field
    steps = Moves(grid, box=box).entered.reshape(8, *box.shape)
    inside = costs[(slice(None), *box.slices)]
    mean = (inside * steps).sum(axis=0) / np.maximum(steps.sum(axis=0), 1)
    return mean if field is None else np.asarray(field) + mean
