"""The problems of a study, as its file describes them."""

from __future__ import annotations

import functools
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError, StudyError
from pymoo_gridpath.grid import CornerCutting, OccupancyGrid
from pymoo_gridpath.grid.arguments import as_footprint
from pymoo_gridpath.maps import MAX_CELLS
from pymoo_gridpath.objectives import Objective, make_objectives
from pymoo_gridpath.planners.signature import parameters_of
from pymoo_gridpath.problems import OBSTACLES, Suite, make_suite
from pymoo_gridpath.study.specification import own, values
from pymoo_gridpath.study.specification.base import AXES, check_problem_settings, make_spec, set_fields, set_given
from pymoo_gridpath.study.specification.kinds import OBJECTIVE, SUITE
from pymoo_gridpath.study.specification.moving import MovingObstacles, check_moving
from pymoo_gridpath.study.specification.values import Where

UNKNOWN = ("free", "occupied")
# What is minimised where neither the problem nor a suite says so.
_OBJECTIVES = ("length", "vulnerability")
# What says which steps a grid has.
_STEPS = ("corner_cutting", "moves")


@dataclass(frozen=True)
class RandomFamily:
    """A family of random grids with a path from corner to corner, see `pymoo_gridpath.problems.random_dense_grid`.

    Parameters
    ----------
    size : int
        Cells a side.
    p0 : float
        Probability of an obstacle in a cell off the path, 0 to 1.
    seeds : int, sequence of int or mapping
        One grid each: how many (from 1 on), a list, or ``{"first": 100, "count": 11}``.
    corner_cutting : bool or "one side", default True
        As in the paper. Elsewhere a grid may turn out to have no path, which `plan_study` refuses.
    moves : {8, 4}, default 8
        How many neighbours a cell has.
    """

    owner: ClassVar[str] = "a random family"

    size: int
    p0: float
    seeds: Any = 1
    corner_cutting: CornerCutting = True
    moves: int = 8

    def __post_init__(self):
        set_fields(
            self,
            size=values.whole(self.size, ("size",), 2, int(MAX_CELLS**0.5)),
            p0=values.real(self.p0, ("p0",), 0.0, 1.0),
            seeds=values.seeds(self.seeds, ("seeds",)),
            corner_cutting=values.corner_cutting(self.corner_cutting, ("corner_cutting",)),
            moves=values.moves(self.moves, ("moves",)),
        )


@dataclass(frozen=True)
class QueryRange:
    """Every ``step``-th query of a ``.scen`` file, counted from 0, from ``first`` to ``last`` inclusive (None: to the end)."""

    owner: ClassVar[str] = "a range of queries"

    first: int = 0
    last: int | None = None
    step: int = 1

    def __post_init__(self):
        values.whole(self.first, ("first",))
        values.whole(self.step, ("step",), 1)
        if self.last is not None and values.whole(self.last, ("last",)) < self.first:
            raise StudyError(f"last is {self.last}, before first, which is {self.first}, so that there is no query", ("last",))


@dataclass(frozen=True, kw_only=True)
class ProblemSpec:
    """One table ``[[problems]]``: a map and query, queries of a ``.scen`` file, a family of random grids, or one of a suite.

    Parameters
    ----------
    name : str, optional
        What tables call it; by default the map's name, or such as ``random-32-0.2``. Unique in a study.
    random : RandomFamily or mapping, optional
    map : str, optional
        A map file, relative to the study file, or the name of a shipped map.
    scen : str, optional
        A MovingAI scenario file; ``map`` is by default the same name without ``.scen``.
    suite : str, mapping, type or Suite, optional
        One of the problems of a published suite: a table of its name as ``class`` and of its arguments, such as
        ``{ class = "asletismac", instance = "ASLETISMAC_NO_X14_Y14_PM_K3_BF" }``; see `pymoo_gridpath.problems.SUITES`. Names
        of files among them are relative to the study file.
    grid : OccupancyGrid, optional
        In Python, in place of ``map``.
    queries : QueryRange, mapping or sequence of int, optional
        Which queries of ``scen``, counted from 0; all by default.
    start, goal : (int, int), optional
        Cells (x, y), y up; by default those that the map names.
    radius : float, default 0
        Robot radius in metres, by which obstacles are grown.
    footprint : sequence of (float, float), optional
        In place of the radius, the corners of the robot in metres, see `OccupancyGrid.inflate`.
    resolution, unknown, threshold, corner_cutting, moves : optional
        How the map is read, see `pymoo_gridpath.maps.load_map`.
    moving : MovingObstacles or mapping, optional
        Obstacles that move while the search goes on; paths are then coded as "cells", and obstacles are a penalty.
    objectives, representation, obstacles, penalty, potential_limit, axis : optional
        See `GridPathProblem`; objectives of a suite go by their names, and all of these are the default then. An objective or
        the representation may be of your own: the path of its class, ``"package.module:Class"``, a table of ``class`` and its
        arguments, the class, or an object; a representation is made anew for each grid and query.

    Raises
    ------
    StudyError
        If a value is of a wrong type or out of its range, or they do not go together.
    """

    owner: ClassVar[str] = "a problem"

    name: str | None = None
    random: Any = None
    map: str | None = None
    scen: str | None = None
    suite: Any = None
    grid: OccupancyGrid | None = None
    queries: Any = None
    start: tuple[int, int] | None = None
    goal: tuple[int, int] | None = None
    radius: float = 0.0
    footprint: Any = None
    resolution: float | None = None
    unknown: str | None = None
    threshold: float | None = None
    corner_cutting: CornerCutting | None = None
    moves: int | None = None
    moving: Any = None
    objectives: Any = None
    representation: Any = None
    obstacles: str = "penalty"
    penalty: float | None = None
    potential_limit: float | None = None
    axis: str = "auto"

    def __post_init__(self):
        self._check_source()
        set_given(self, "name", "map", "scen", check=values.text)
        set_given(self, "start", "goal", check=values.cell)
        set_fields(self, radius=values.real(self.radius, ("radius",)), queries=_queries(self.queries))
        set_given(self, "footprint", check=lambda value, where: values.told(where, as_footprint, value))
        if self.footprint is not None and self.radius:
            raise StudyError("there are a radius and a footprint, expected one of them", ("footprint",))
        set_given(self, "resolution", check=lambda value, where: values.real(value, where, open_below=True))
        set_given(self, "unknown", check=lambda value, where: values.choice(value, UNKNOWN, where))
        set_given(self, "threshold", check=lambda value, where: values.real(value, where, 0.0, 1.0))
        set_given(self, "corner_cutting", check=values.corner_cutting)
        set_given(self, "moves", check=values.moves)
        set_given(self, "objectives", check=self._objectives)
        set_fields(self, obstacles=values.choice(self.obstacles, OBSTACLES, ("obstacles",)))
        set_fields(self, axis=values.choice(self.axis, AXES, ("axis",)))
        check_problem_settings(self)
        self._check_obstacles()
        if self.moving is not None:
            set_fields(self, moving=make_spec(MovingObstacles, self.moving, ("moving",)))
            check_moving(self)

    def _check_source(self) -> None:
        sources = [key for key in ("random", "suite", "map", "grid") if getattr(self, key) is not None]
        if self.scen is not None and sources and sources[0] in ("random", "suite"):
            sources.append("scen")
        if len(sources) > 1:
            raise StudyError(f"the problem has {sources[0]} and {sources[1]}, expected one of them", (sources[1],))
        if not sources and self.scen is None:
            raise StudyError("the problem has no grid, expected one of the keys random, suite, map or scen")
        if self.grid is not None and not isinstance(self.grid, OccupancyGrid):
            raise StudyError(f"grid is {values.show(self.grid)}, expected an OccupancyGrid", ("grid",))
        if self.random is not None:
            set_fields(self, random=make_spec(RandomFamily, self.random, ("random",)))
        if self.suite is not None:
            set_fields(self, suite=own.form(own.read(self.suite, SUITE, ("suite",))))
            self._check_suite()
        misplaced = {
            "suite": ("start", "goal", "radius", "footprint", "resolution", "unknown", "threshold", *_STEPS, "queries"),
            "random": ("start", "goal", "radius", "footprint", "resolution", "unknown", "threshold", *_STEPS, "queries"),
            "grid": ("resolution", "unknown", "threshold", *_STEPS),
        }
        for source, keys in misplaced.items():
            for key in keys:
                if getattr(self, source) is not None and getattr(self, key) not in (None, 0.0):
                    inside = f"; write it into the table {source}" if self._takes(source, key) else ""
                    raise StudyError(f"{key} is for maps from a file, not for a problem with {source}{inside}", (key,))
        if self.scen is not None and (self.start or self.goal):
            key = "start" if self.start else "goal"
            raise StudyError(f"{key} comes from the scen file; expected queries, to say which of it", (key,))
        if self.scen is None and self.queries is not None:
            raise StudyError("queries are those of a scen file, and the problem has no scen", ("queries",))

    def _takes(self, source: str, key: str) -> bool:
        """Whether the table of a source has a place for what stands beside it."""
        if source == "random":
            return key in _STEPS
        return source == "suite" and key in parameters_of(own.read(self.suite, SUITE, ("suite",)).cls)

    def _check_suite(self) -> None:
        where = ("suite",)
        try:
            made = self.made_suite()
        except GridPathError as error:
            raise StudyError(str(error), where) from None
        if made is not None and not made.backtracking:
            for key in ("representation", "moving"):
                if getattr(self, key) is not None:
                    raise StudyError(
                        f"{key} is not for a suite whose paths do not backtrack, which says how they are coded", (key,)
                    )

    def made_suite(self, folder: str | os.PathLike[str] = "") -> Suite | None:
        """Return the problem of a suite, with its files in a folder; None if the problem is of none."""
        if self.suite is None:
            return None
        cls: Any
        cls, _, arguments = own.read(self.suite, SUITE, ("suite",))
        files = {key: beside(folder, arguments[key]) for key in cls.files if isinstance(arguments.get(key), str)}
        return make_suite(cls, **arguments | files)

    def _objectives(self, value: Any, where: Where) -> tuple[Any, ...]:
        suite = self.made_suite()
        return _objectives(value if suite is None else values.told(where, suite.chosen, value))

    @functools.cached_property
    def scored_by(self) -> tuple[Any, ...]:
        """The objectives, those that are the default included, as the study holds them."""
        suite = self.made_suite()
        default = _OBJECTIVES if suite is None else suite.objectives
        return _objectives(default) if self.objectives is None else self.objectives

    def _check_obstacles(self) -> None:
        if self.obstacles == "constraint" and self.penalty is not None:
            raise StudyError("penalty is for obstacles 'penalty' and 'limit', not for 'constraint'", ("penalty",))
        if self.obstacles != "limit" and self.potential_limit is not None:
            raise StudyError(f"potential_limit is for obstacles 'limit', not for {self.obstacles!r}", ("potential_limit",))
        if self.obstacles == "limit" and self.potential_limit is None:
            raise StudyError("obstacles 'limit' needs potential_limit, the largest vulnerability of a path", ("obstacles",))

    @property
    def label(self) -> str:
        """What tables call it."""
        if self.name is not None:
            return self.name
        if self.random is not None:
            return f"random-{self.random.size}-{self.random.p0:g}"
        if self.grid is not None:
            return self.grid.name
        if (suite := self.made_suite()) is not None:
            return suite.label
        source = str(self.map or self.scen)
        return Path(source.removesuffix(".scen")).stem


def beside(folder: str | os.PathLike[str], name: str) -> str:
    """Return the path of a map in a folder, or the name of a shipped one; a file goes first, as in `load_map`."""
    path = Path(folder) / name
    shipped = not os.path.exists(path) and Path(name).name == name and not Path(name).suffix
    return name if shipped else os.fspath(path)


def problem_in(item: Any, where: Where, folder: Path) -> ProblemSpec:
    """Return a problem of a study; files of objectives in its table are looked for in the study's folder, as maps are."""
    if isinstance(item, Mapping) and isinstance(item.get("objectives"), list | tuple):
        item = {**item, "objectives": [_with_files(one, folder) for one in item["objectives"]]}
    return make_spec(ProblemSpec, item, where)


def _with_files(item: Any, folder: Path) -> Any:
    """Return an objective, a table with its files where they are."""
    if not isinstance(item, Mapping):
        return item
    try:
        files = own.read({"class": item.get("class")}, OBJECTIVE, ("objectives",)).cls.files
    except StudyError:
        # It is said by whoever makes the problem.
        return item
    found = {key: str((folder / item[key]).absolute()) for key in files if isinstance(item.get(key), str)}
    return {**item, **found}


def _objectives(value: Any) -> tuple[Any, ...]:
    """Return objectives by name, by the path of their class, or as tables of class and arguments."""
    where = ("objectives",)
    try:
        items: list[Any] = [value] if isinstance(value, str | type | Objective) else checks.items("objectives", value, "names")
    except GridPathError:
        items = [None]
    if not all(isinstance(item, str | type | Mapping | Objective) for item in items):
        raise StudyError(f"objectives is {values.show(value)}, expected a list of names", where)
    try:
        given = [own.read(item, OBJECTIVE, where) for item in items if not _is_name(item)]
        made = iter([item.cls(**item.arguments) for item in given])
        make_objectives([item if _is_name(item) else next(made) for item in items])
    except StudyError:
        raise
    except (GridPathError, TypeError) as error:
        raise StudyError(str(error), where) from None
    return tuple(own.form(own.read(item, OBJECTIVE, where)) for item in items)


def _is_name(value: Any) -> bool:
    return isinstance(value, str) and not own.is_path(value)


def _queries(value: Any) -> tuple[int, ...] | QueryRange | None:
    if value is None or isinstance(value, QueryRange):
        return value
    if isinstance(value, Mapping):
        return make_spec(QueryRange, value, ("queries",))
    if isinstance(value, Iterable) and not isinstance(value, str):
        return values.each_once(value, ("queries",))
    raise StudyError(
        f"queries is {values.show(value)}, expected a list such as [0, 10], or {{ first = 0, last = 40, step = 10 }}",
        ("queries",),
    )
