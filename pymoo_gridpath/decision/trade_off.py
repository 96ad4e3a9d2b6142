"""The trade-off set: what a planner chooses from."""

from __future__ import annotations

import functools
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pymoo.core.algorithm import Algorithm

from pymoo_gridpath import checks
from pymoo_gridpath.decision import drawn, export, provenance
from pymoo_gridpath.decision.advice import advice_on
from pymoo_gridpath.decision.knee import knee_point
from pymoo_gridpath.decision.measures import PathMeasures, risk_of
from pymoo_gridpath.decision.record import PathRecord
from pymoo_gridpath.decision.worth import worth_keeping
from pymoo_gridpath.errors import GridPathError, counted
from pymoo_gridpath.fields import BoxedField, clearance
from pymoo_gridpath.files import write_whole
from pymoo_gridpath.objectives import Objective
from pymoo_gridpath.operators.bands import band_of
from pymoo_gridpath.pictures import png
from pymoo_gridpath.representations.base import representation_of
from pymoo_gridpath.search.smoother import Smoother
from pymoo_gridpath.versions import versions

#: What members of every trade-off set go by, in the order in which tables and figures show them. Before them comes the
#: "earliest" of paths in time, and before the knee what other objectives call their best path, `Objective.best`.
NAMES = ("shortest", "safest", "smoothest", "knee")

_LEAST = {"shortest": "length", "safest": "vulnerability", "smoothest": "turn"}


class TradeOffSet:
    """The paths worth choosing from: legal, mutually non-dominated in the plain objectives, one for each point.

    Build it with `from_results` or `from_genes`. Penalties play no part in it. Paths that cross obstacles are dropped; only
    if there is no other, those that cross the fewest are kept and `feasible` is False. Of paths with equal objectives the
    smoothest is kept (then the one whose genes come first). Paths are in ascending order of the first objective.

    On a map with obstacles hardly two paths have equal objectives, though many are nearly equal. With a ``band``, objectives
    count in steps of that share of their range on the front, at most 0.5, so that one path is kept for each step of the front,
    and it is the smoothest: 0.01 may cost a hundredth of the range and save many turns.

    Attributes
    ----------
    problem : GridPathProblem
    X : numpy.ndarray, shape (N, n_var)
        Genes.
    F : numpy.ndarray of float, shape (N, n_obj)
        Plain objectives.
    paths : ColumnPaths or CellPaths
        The decoded paths, or what else the representation decodes to.
    measures : dict of str to numpy.ndarray, shape (N,)
        ``length`` [cells], ``length_m``, ``vulnerability``, ``turn`` [degrees], ``interfering_cells``, ``clearance``
        [cells], ``clearance_m`` and every other objective of the problem by its name; see `PathRecord`. Maps in cells have none
        in metres. Of what is maximised, such as the least clearance, it is the value itself, of which ``F`` holds the negative.
    feasible : bool
        Whether the paths are legal: no interfering cell, and the potential limit is kept if the problem has one.
    meta : dict
        What made it, as plain data: ``map``, ``query``, ``settings``, ``seed``, ``versions``.

    Notes
    -----
    ``trade_off["knee"]`` or ``trade_off.knee`` is a `PathRecord`; so is ``trade_off[0]``. `shortest`, `safest` and `smoothest`
    have the least length, vulnerability and turn *of the set*, whatever its objectives; of a problem with another `Risk`, the
    safest path is that of which this is least. Ties go to the path that is better in the first objective that differs. `knee`
    is defined in `knee_point`, on the objectives of the problem. Of paths in time, those of a `TimedPathProblem`, `earliest` is
    the one that arrives first. Other objectives may have a name for their best path: the "widest" has the largest least
    clearance.

    References
    ----------
    Ahmed and Deb (2013), section 5.1: of paths on the same point of the front the smoothest is kept.

    Examples
    --------
    >>> import numpy as np
    >>> from pymoo_gridpath import GridPathProblem, OccupancyGrid
    >>> grid = OccupancyGrid([[0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]], corner_cutting=True)
    >>> problem = GridPathProblem(grid, (0, 0), (3, 3))
    >>> trade_off = TradeOffSet.from_genes(problem, np.array([[1, 1, 1], [0, 0, 2], [3, 0, 0]]))
    >>> len(trade_off), trade_off.feasible
    (2, True)
    >>> trade_off.safest.cells.tolist()
    [[0, 0], [0, 1], [0, 2], [0, 3], [1, 3], [2, 3], [3, 3]]
    >>> trade_off.safest.names
    ('safest',)
    """

    def __init__(self, problem, X, meta: dict | None = None, band: float = 0.0):
        band = band_of(band)
        measures = PathMeasures(problem)
        if meta is not None:
            meta = provenance.plain(checks.instance("meta", meta, Mapping))
        X = np.atleast_2d(checks.array("X", X, kinds="biufO", expected="rows of genes"))
        if X.size == 0:
            raise GridPathError("there are no paths to choose from, expected at least one row of genes")
        if X.dtype.kind in "fO":
            X = problem.representation.genes(X)
        keep, self.feasible = worth_keeping(problem, measures, X, band)
        self.problem = problem
        self.X = X[keep]
        self.paths = problem.decode(self.X)
        self.F = np.asarray(problem.score(self.paths), dtype=float)
        self.meta = meta or {}
        self._algorithms: list[type[Algorithm]] = []
        self._cells = [np.asarray(self.paths.cells(k)) for k in range(len(keep))]
        self.measures = self._measure(measures)

    @classmethod
    def from_results(cls, results, settings: Mapping | None = None, band: float = 0.0) -> TradeOffSet:
        """Build the set from the Result of a run, or from the Results of several runs merged into one front.

        Parameters
        ----------
        results : pymoo.core.result.Result or sequence of them
            Of the same grid, query, representation and objectives. Candidates are each Result's optimum and its final
            population, where a path across obstacles may have dominated a legal one.
        settings : mapping, optional
            What else to record under ``meta["settings"]``.
        band : float, default 0
            Which difference in objectives does not count, see `TradeOffSet`.

        Raises
        ------
        GridPathError
            If there is no Result, one holds no paths, or they belong to different problems.
        """
        runs = [results] if hasattr(results, "opt") else checks.items("results", results, "a Result of pymoo, or several")
        _check_settings(settings)
        if not runs:
            raise GridPathError("there are no Results, expected one or more")
        problem = _common_problem(runs)
        X = np.concatenate([_genes(run, k) for k, run in enumerate(runs)])
        made = cls(problem, X, _meta(problem, settings, band, [provenance.describe_run(run) for run in runs]), band)
        algorithms = (getattr(run, "algorithm", None) for run in runs)
        made._algorithms = [type(one) for one in algorithms if isinstance(one, Algorithm)]
        return made

    @classmethod
    def from_genes(cls, problem, X, settings: Mapping | None = None, band: float = 0.0) -> TradeOffSet:
        """Build the set from rows of genes of any origin.

        Parameters
        ----------
        problem : GridPathProblem
        X : array_like, shape (N, n_var)
        settings : mapping, optional
            What else to record under ``meta["settings"]``.
        band : float, default 0
            Which difference in objectives does not count, see `TradeOffSet`.

        Raises
        ------
        GridPathError
            If there are no rows, or they do not fit the problem.
        """
        representation_of(problem)
        _check_settings(settings)
        return cls(problem, X, _meta(problem, settings, band, []), band)

    @classmethod
    def _known(cls, problem, X: np.ndarray, F: np.ndarray, measures: dict[str, np.ndarray], feasible: bool, meta: dict):
        """Return a set of which everything is known: paths of a set that was chosen and measured before."""
        made = cls.__new__(cls)
        made.problem, made.X, made.F, made.measures, made.feasible, made.meta = problem, X, F, measures, feasible, meta
        made.paths = problem.decode(X)
        made._algorithms = []
        made._cells = [np.asarray(made.paths.cells(k)) for k in range(len(X))]
        return made

    def _measure(self, measures: PathMeasures) -> dict[str, np.ndarray]:
        grid, box = self.problem.grid, self.problem.representation.box
        field = BoxedField(clearance(grid.crop(box)), box, grid.width, functools.partial(clearance, grid))
        length = np.asarray(self.paths.length, dtype=float)
        found = {
            "length": length,
            **({} if grid.resolution is None else {"length_m": length * grid.resolution}),
            "vulnerability": measures.vulnerability(self.paths),
            "turn": np.asarray(self.paths.turn),
            "interfering_cells": np.asarray(self.paths.interfering_cells),
            "clearance": np.array([field.take(cells @ (1, grid.width)).min() for cells in self._cells]),
        }
        found["clearance"] = np.minimum(found["clearance"], self.paths.mover_distance)
        if grid.resolution is not None:
            found["clearance_m"] = measures.clearance_m(self._cells)
        for objective, values in zip(self.problem.objectives, self.F.T, strict=True):
            found.setdefault(objective.name, -values if objective.maximise else values)
        return found

    # -- members ------------------------------------------------------------------------------------------------------

    @property
    def objective_names(self) -> list[str]:
        """Names of the columns of F."""
        return [objective.name for objective in self.problem.objectives]

    @functools.cached_property
    def named(self) -> dict[str, int]:
        """Index of the path that goes by each of `NAMES`, and by what else its objectives call their best path."""
        # Paths stand in the order of their objectives, so the first of equal ones is the better.
        least_of = {**_LEAST, "safest": self._safety}
        found = {name: int(np.argmin(self.measures[of])) for name, of in least_of.items() if of in self.measures}
        for objective, values in zip(self.problem.objectives, self.F.T, strict=True):
            found.setdefault(objective.best, int(np.argmin(values)))
        found["knee"] = knee_point(self.F)
        return {name: found[name] for name in names_for(self.problem.objectives)}

    @property
    def _safety(self) -> str:
        """The measure of which the safest path has the least."""
        risk = risk_of(self.problem)
        return _LEAST["safest"] if risk is None else risk.name

    def index(self, name: str) -> int:
        """Return the index of the path that goes by a name.

        Raises
        ------
        GridPathError
            If there is no such name.
        """
        if not (isinstance(name, str) and name in self.named):
            raise GridPathError(f"there is no path {checks.shown(name)}, expected one of {', '.join(self.named)}")
        return self.named[name]

    def names(self, index: int) -> tuple[str, ...]:
        """Return the names that the path at an index goes by, none for most, and none if the paths are not legal."""
        index = checks.whole("index", index, 0, len(self) - 1)
        return tuple(name for name, k in self.named.items() if k == index and self.feasible)

    @property
    def earliest(self) -> PathRecord:
        """The path in time that arrives first; there is none of paths on a map that stands still."""
        return self["earliest"]

    @property
    def shortest(self) -> PathRecord:
        """The path of least length."""
        return self["shortest"]

    @property
    def safest(self) -> PathRecord:
        """The path of least risk: by default of least vulnerability."""
        return self["safest"]

    @property
    def smoothest(self) -> PathRecord:
        """The path of least total turn."""
        return self["smoothest"]

    @property
    def knee(self) -> PathRecord:
        """The path at the knee of the front, see `knee_point`."""
        return self["knee"]

    def __len__(self) -> int:
        return len(self.X)

    def __iter__(self) -> Iterator[PathRecord]:
        return (self[k] for k in range(len(self)))

    def __getitem__(self, key: int | str) -> PathRecord:
        """Return the path at an index or of a name."""
        k = self.index(key) if isinstance(key, str) else range(len(self))[key]
        value = {name: values[k].item() for name, values in self.measures.items()}
        cells, grid = self._cells[k], self.problem.grid
        return PathRecord(
            index=k,
            names=self.names(k),
            cells=cells,
            points=None if grid.resolution is None else grid.to_metres(cells),
            length=value["length"],
            length_m=value.get("length_m"),
            vulnerability=value["vulnerability"],
            turn=value["turn"],
            interfering_cells=value["interfering_cells"],
            clearance=value["clearance"],
            clearance_m=value.get("clearance_m"),
            objectives=dict(zip(self.objective_names, self.F[k].tolist(), strict=True)),
            genes=self.X[k],
            grid=grid,
            smoother=self.smoother,
        )

    @functools.cached_property
    def smoother(self) -> Smoother:
        """What makes waypoints of the paths, see `PathRecord.waypoints`."""
        return Smoother(self.problem.grid, self.problem.start, self.problem.representation.timed)

    # -- words and files ----------------------------------------------------------------------------------------------

    @property
    def infeasibility(self) -> str:
        """Why the set is not feasible, in words; empty if it is."""
        if self.feasible:
            return ""
        crossed = self.measures["interfering_cells"].min()
        if crossed == 0:
            return f"no path keeps the potential limit of {self.problem.potential_limit:g}"
        return f"no path is legal; these cross {counted(crossed, 'occupied cell')}, the fewest found"

    @functools.cached_property
    def least_length(self) -> float | None:
        """Length in cells of the shortest of all legal paths on the grid, in any coding and where nothing moves.

        None if length is no objective.
        """
        if "length" not in self.objective_names:
            return None
        return self.problem.grid.shortest_length(self.problem.start, self.problem.goal)

    @property
    def advice(self) -> str:
        """What to try where there is nothing to choose from, or where the paths are long; empty where all is well.

        The front is one point if a single path is the best by all of several objectives. The shortest path found is long if it
        is over 5 % longer than the shortest of all. Of that nothing is said if length is no objective, if the paths are not
        legal, and where the shortest of all may not be one of them: under a potential limit, and among obstacles that move.
        """
        return advice_on(self, self._algorithms)

    def table(self, max_rows: int | None = None) -> str:
        """Return a plain text table, one line a path, with the names of those that have one, in metres where the map has them.

        Where length is an objective a line says how long the shortest of all paths is, and another, if those found are much
        longer, what to try: `least_length` and `advice`.

        Parameters
        ----------
        max_rows : int, optional
            Show no more paths than this; the named ones are always shown.
        """
        return export.table_text(self, max_rows)

    __str__ = table

    def __repr__(self) -> str:
        legal = "" if self.feasible else ", NOT feasible"
        return f"<TradeOffSet: {len(self)} paths in {', '.join(self.objective_names)}{legal}>"

    def _repr_html_(self) -> str:
        return drawn.html_of(self)

    def _repr_png_(self) -> bytes:
        return png(drawn.scene_of(self))

    def to_pandas(self):
        """Return one row a path with its number, its names and every measure, as `to_csv` writes them.

        Returns
        -------
        pandas.DataFrame
            With the columns ``path``, ``names`` (joined by ``;``, empty for most) and those of `measures`.

        Raises
        ------
        GridPathError
            If pandas is not installed; it is the extra ``pandas``.
        """
        return export.data_frame(self)

    def to_csv(self, path: str | os.PathLike[str]) -> Path:
        """Write one row a path with its number, its names (joined by ``;``) and every measure in full precision.

        The file is written under a temporary name and renamed.
        """
        return write_whole(path, export.csv_text(self).encode())

    def to_json(self, path: str | os.PathLike[str]) -> Path:
        """Write all paths with their cells, points in metres and measures, and what made them, to one strict JSON file.

        Numbers that are not finite become null. The file is written under a temporary name and renamed; `load_json`
        reads it.
        """
        return write_whole(path, export.json_text(self).encode())


def names_for(objectives: Sequence[Objective]) -> tuple[str, ...]:
    """Return the names that paths go by which are scored by these objectives, in the order in which they are shown."""
    best = dict.fromkeys(objective.best for objective in objectives if objective.best)
    first = tuple(name for name in best if name == "earliest")
    others = tuple(name for name in best if name not in ("earliest", *NAMES))
    return (*first, *NAMES[:-1], *others, NAMES[-1])


def check_set(trade_off: TradeOffSet) -> TradeOffSet:
    """Return a trade-off set if it is one, or has what figures ask of one."""
    if all(hasattr(trade_off, name) for name in ("problem", "F", "objective_names", "feasible", "index")):
        return trade_off
    return checks.instance("trade_off", trade_off, TradeOffSet)


def _genes(run, number: int) -> np.ndarray:
    populations = [getattr(run, source, None) for source in ("opt", "pop")]
    found = [np.atleast_2d(population.get("X")) for population in populations if population is not None and len(population)]
    if not found:
        why = getattr(run, "message", None) or "its optimum and its population are empty, expected a finished run"
        raise GridPathError(f"Result {number} holds no paths: {why}")
    return np.concatenate(found)


def _common_problem(runs: Sequence) -> Any:
    """Return the problem that all runs solved."""
    problems: list[Any] = [getattr(run, "problem", None) for run in runs]
    for problem in problems:
        representation_of(problem)
    first = problems[0]
    for k, problem in enumerate(problems):
        if problem is first:
            continue
        mine, other = provenance.describe_problem(first), provenance.describe_problem(problem)
        for part, keys in (("map", mine["map"]), ("query", mine["query"]), ("settings", _MUST_AGREE)):
            differ = [key for key in keys if mine[part].get(key) != other[part].get(key)]
            if differ:
                raise GridPathError(f"Results 0 and {k} differ in the {part} ({differ[0]}), expected runs of one problem")
    return first


_MUST_AGREE = ("representation", "axis", "max_cells", "backtracking", "objectives", "potential_limit", "movers")


def _check_settings(settings: Mapping | None) -> None:
    checks.instance("settings", settings, Mapping, optional=True)


def _meta(problem, settings: Mapping | None, band: Any, runs: list[dict]) -> dict:
    meta = provenance.describe_problem(problem)
    meta["settings"]["runs"] = runs
    if band := band_of(band):
        meta["settings"]["band"] = band
    meta["settings"].update(settings or {})
    seeds = [run["seed"] for run in runs]
    meta["seed"] = seeds[0] if len(seeds) == 1 else seeds or None
    meta["versions"] = versions()
    return meta
