"""What a suite of problems is, and suites by name."""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import Cell, OccupancyGrid
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.problems.grid_path import GridPathProblem
from pymoo_gridpath.registry import Registry
from pymoo_gridpath.representations import CellSequence


class Suite(ABC):
    """One of the problems that a publication defines: a map, a query, and what paths are scored by.

    A suite of your own sets `name` and `follows`, keeps the arguments of its constructor as attributes of their names, and says
    what `query` and `objectives` are. `pymoo_gridpath.registry.register` makes it known by its name, and
    `pymoo_gridpath.testing.SuiteSuite` tests that it does all that it must.

    Attributes
    ----------
    name : str
        What it is registered as, such as ``"asletismac"``.
    follows : str
        Whose definitions it follows, and what of these is not to be had.
    backtracking : bool
        Whether paths may lead away from the goal along x or y.
    files : tuple of str
        Arguments that may be the name of a map file; in a study it is relative to that.
    """

    name: str
    follows: str
    backtracking: bool = True
    files: ClassVar[tuple[str, ...]] = ()

    @property
    @abstractmethod
    def label(self) -> str:
        """What tables call the problem, unlike the others of the suite."""

    @property
    @abstractmethod
    def query(self) -> tuple[OccupancyGrid, Cell, Cell]:
        """The grid, the start and the goal."""

    @property
    @abstractmethod
    def objectives(self) -> tuple[Objective, ...]:
        """All objectives that are defined."""

    @property
    def coding(self) -> dict[str, Any]:
        """The arguments of `CellSequence` that code the paths of the suite, and no others."""
        return {} if self.backtracking else {"backtracking": False}

    def chosen(self, objectives: Sequence[Any] | Any | None = None) -> list[Any]:
        """Return objectives in which the names of those of the suite have become these; all of them by default."""
        if objectives is None:
            return list(self.objectives)
        own = {one.name: one for one in self.objectives}
        given = [objectives] if isinstance(objectives, str | type | Mapping | Objective) else objectives
        given = checks.items("objectives", given, f"names such as {next(iter(own))!r}, or Objective objects")
        return [own.get(one, one) if isinstance(one, str) else one for one in given]

    def problem(self, objectives: Sequence[str | Objective] | None = None, **options: Any) -> GridPathProblem:
        """Return the problem, coded as cells.

        Parameters
        ----------
        objectives : sequence of str or Objective, optional
            Some of the suite's by their names, others as of `GridPathProblem`; by default all of the suite's.
        **options
            What else `GridPathProblem` takes. A ``representation`` only where paths may backtrack.

        Raises
        ------
        GridError
            If the problem does not have a path.
        GridPathError
            As `GridPathProblem`.
        """
        grid, start, goal = self.query
        if not self.backtracking:
            if options.get("representation") is not None:
                raise GridPathError(
                    f"representation is {checks.shown(options['representation'])}, expected none: paths of {self.label} do not "
                    f"backtrack, as one of the suite codes them"
                )
            options["representation"] = CellSequence(grid, start, goal, **self.coding)
        options.setdefault("representation", CellSequence.name)
        return GridPathProblem(grid, start, goal, objectives=self.chosen(objectives), **options)

    def __repr__(self) -> str:
        settings = {key: getattr(self, key) for key in inspect.signature(type(self)).parameters}
        return f"{type(self).__name__}({', '.join(f'{key}={value!r}' for key, value in settings.items())})"


#: Suites by name: those of this package, those that were registered, and those of installed packages.
SUITES: Registry[type[Suite]] = Registry("suite", "pymoo_gridpath.suites", Suite)


def make_suite(suite: str | type[Suite], **arguments: Any) -> Suite:
    """Return one of the problems of a suite by name.

    Parameters
    ----------
    suite : str or type
        One of `SUITES`: "asletismac", "random-cost", "guards", "small-environments", "region-of-sight", or another that is
        registered; or the class itself.
    **arguments
        Those of its class.

    Returns
    -------
    Suite

    Raises
    ------
    GridPathError
        If there is no such suite, it takes no such argument or lacks one, or an argument is wrong.

    Examples
    --------
    >>> suite = make_suite("asletismac", instance="ASLETISMAC_CH_X8_Y8_PM_K3_BF")
    >>> problem = suite.problem(["length", "ascent"])
    >>> problem.pareto_front().round(2).tolist()
    [[10.49, 2.68], [11.07, 2.3]]
    """
    cls: Any = suite
    if not isinstance(cls, type):
        cls = SUITES[checks.known("suite", suite, SUITES)]
    elif not issubclass(cls, Suite):
        raise GridPathError(f"suite is {checks.shown(cls)}, expected a class derived from Suite")
    try:
        inspect.signature(cls).bind(**arguments)
    except TypeError as error:
        takes = ", ".join(str(one) for one in inspect.signature(cls).parameters.values())
        raise GridPathError(f"the suite {cls.name!r} cannot be made: {error}; expected ({takes})") from None
    return cls(**arguments)
