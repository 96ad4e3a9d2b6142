"""Trade-off sets out of the files that `TradeOffSet.to_json` writes."""

from __future__ import annotations

import inspect
import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.decision.export import FORMAT, FORMAT_VERSION
from pymoo_gridpath.decision.trade_off import TradeOffSet
from pymoo_gridpath.errors import GridPathError, visible
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.objectives import OBJECTIVES, Objective
from pymoo_gridpath.problems import GridPathProblem
from pymoo_gridpath.problems.standing import StandingProblem
from pymoo_gridpath.representations import REPRESENTATIONS

_MEASURES = ("length", "length_m", "vulnerability", "turn", "interfering_cells", "clearance", "clearance_m")
_IN_METRES = ("length_m", "clearance_m")
_FIELDS = ("cells", "names", "genes", "objectives", *_MEASURES)

# A file of a few bytes shall not take more memory than any real map.
_MOST_CELLS = 2**28

_WORDS = ("map", "query", "settings", "objectives", "labels", "occupied_runs", "feasible", "paths")


class StoredObjective(Objective):
    """An objective of which a file knows the name and the paths' values, but not what they cost: one of somebody's own.

    Parameters
    ----------
    name, label : str
    maximise : bool, default False
    best : str, default ""
    """

    def __init__(self, name: str, label: str, maximise: bool = False, best: str = ""):
        self.name, self.label, self.maximise, self.best = name, label, maximise, best

    def __call__(self, paths, prepared):
        """Refuse to score paths."""
        raise GridPathError(
            f"the file of the trade-off set does not hold what the objective {checks.shown(self.name)} costs, expected the "
            f"problem itself as load_json(path, problem)"
        )


def load_json(path: str | os.PathLike[str], problem=None) -> TradeOffSet:
    """Read a trade-off set that `TradeOffSet.to_json` wrote.

    Parameters
    ----------
    path : str or path-like
    problem : GridPathProblem, optional
        The problem that the paths are of; by default it is made again from what the file says. Objectives of one's own then
        have their names and the values of the stored paths, and score no others, unless their class is registered and takes
        nothing but single numbers and words.

    Returns
    -------
    TradeOffSet
        The same paths in the same order, with the same measures and ``meta``. What the plain file holds besides, ``json.load``
        reads.

    Raises
    ------
    GridPathError
        If the file cannot be read, is no trade-off set of this format, its paths are not what their genes say, or the problem
        is another one.
    """
    checks.file_path("path", path)
    if problem is not None:
        checks.instance("problem", problem, GridPathProblem)
    content, shown = _content(path), visible(path)
    try:
        return _made(content, problem)
    except GridPathError as error:
        raise GridPathError(f"{shown}: {error}") from None
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, OverflowError) as error:
        raise GridPathError(
            f"{shown}: the set cannot be made again ({visible(error)}), expected the file as written, or the problem itself as "
            f"load_json(path, problem)"
        ) from None


def _content(path: str | os.PathLike[str]) -> dict:
    """Return what a file holds, as far as it can be told to be a trade-off set."""
    shown = visible(path)
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise GridPathError(f"{shown}: the file cannot be read ({error.strerror}), expected a trade-off set") from None
    except (ValueError, RecursionError) as error:
        why = f"line {error.lineno}" if isinstance(error, json.JSONDecodeError) else "not text, or nested too deep"
        raise GridPathError(f"{shown}: the file is not JSON ({why}), expected a trade-off set") from None
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        raise GridPathError(f"{shown}: the file holds no trade-off set, expected one with the format {FORMAT!r}")
    if content.get("format_version") != FORMAT_VERSION:
        raise GridPathError(
            f"{shown}: format_version is {checks.shown(content.get('format_version'))}, expected {FORMAT_VERSION}"
        )
    records = content.get("paths")
    if not isinstance(records, list) or not records:
        raise GridPathError(f"{shown}: paths is missing or empty, expected a list of records")
    for k, record in enumerate(records):
        missing = [field for field in _FIELDS if not isinstance(record, dict) or field not in record]
        if missing:
            raise GridPathError(f"{shown}: path {k} has no {missing[0]!r}, expected the fields {', '.join(_FIELDS)}")
    missing = [word for word in _WORDS if word not in content]
    if missing:
        raise GridPathError(f"{shown}: {missing[0]} is missing, expected {', '.join(_WORDS)}")
    return content


def _made(content: dict, problem) -> TradeOffSet:
    grid = _grid(content)
    query = [
        tuple(checks.array(end, content["query"][end], (2,), "iu", expected="a cell").tolist()) for end in ("start", "goal")
    ]
    if problem is None:
        problem = _problem(content, grid, *query)
    elif (problem.grid.digest, problem.start, problem.goal) != (grid.digest, *query):
        raise GridPathError("the problem has another map or query than the file, expected the one that the paths are of")
    if problem.objective_names != content["objectives"]:
        raise GridPathError(
            f"the problem has the objectives {', '.join(problem.objective_names)}, expected those of the file, "
            f"{checks.shown(content['objectives'])}"
        )
    records = content["paths"]
    X = checks.array("genes", [record["genes"] for record in records], (None, problem.n_var), expected="rows of genes")
    F = np.array([[_number(record["objectives"][name]) for name in problem.objective_names] for record in records])
    known = [name for name in _MEASURES if name not in _IN_METRES or problem.grid.resolution is not None]
    measures = {name: np.array([_number(record[name]) for record in records]) for name in known}
    for objective, values in zip(problem.objectives, F.T, strict=True):
        measures.setdefault(objective.name, -values if objective.maximise else values)
    # What were whole numbers are whole numbers again.
    for name in ("turn", "interfering_cells"):
        measures[name] = measures[name].astype(np.int64)
    meta = {key: content[key] for key in ("map", "query", "settings", "seed", "versions") if key in content}
    made = TradeOffSet._known(problem, X, F, measures, checks.flag("feasible", content["feasible"]), meta)
    for k, record in enumerate(records):
        if made[k].cells.tolist() != record["cells"]:
            raise GridPathError(f"the cells of path {k} are not those of its genes, expected the file as written")
    return made


def _number(value: Any) -> float:
    """Return a number of the file, where null stands for what is not finite."""
    return np.inf if value is None else checks.number("a measure", value)


def _grid(content: dict) -> OccupancyGrid:
    stated = content["map"]
    grid = _cells(content, "occupied_runs", stated, stated["sha256"])
    if "original" not in stated:
        return grid
    original = _cells(content, "original_runs", stated, stated["original"]["sha256"])
    return grid.grown_from(original, stated["robot_radius"], stated["footprint"])


def _cells(content: dict, key: str, stated: dict, digest: str) -> OccupancyGrid:
    """Return the grid of the map's place and steps whose cells are found under a key."""
    runs = checks.array(key, content[key], (None,), "iu", expected="numbers of cells")
    shape = checks.whole("height", stated["height"], 1), checks.whole("width", stated["width"], 1)
    if shape[0] * shape[1] > _MOST_CELLS:
        raise GridPathError(f"the map has {shape[1]} x {shape[0]} cells, expected at most {_MOST_CELLS:,}")
    if (runs < 0).any() or runs.sum(dtype=object) != shape[0] * shape[1]:
        raise GridPathError(f"{key} is of another size than {shape[1]} x {shape[0]} cells, expected one of all cells")
    occupied = np.repeat(np.arange(len(runs)) % 2 == 1, runs).reshape(shape)
    takes = inspect.signature(OccupancyGrid).parameters
    options = {key: value for key, value in stated.items() if key in takes and key not in ("occupied", "unknown")}
    grid = OccupancyGrid(occupied, **options)
    if grid.digest != digest:
        raise GridPathError(f"{key} does not fit the checksum of the map, expected the file as written")
    return grid


def _problem(content: dict, grid: OccupancyGrid, start, goal) -> GridPathProblem:
    """Return the problem that a file describes."""
    settings = content["settings"]
    if "movers" in settings:
        raise GridPathError(
            "the paths are in time, among obstacles that move, of which the file does not hold all, expected the problem "
            "itself as load_json(path, problem)"
        )
    objectives = [_objective(stated, content) for stated in settings["objectives"]]
    penalty = settings["penalty"] if settings["obstacles"] != "constraint" else None
    if start == goal:
        return StandingProblem(grid, start, objectives, settings["obstacles"], penalty, settings["potential_limit"])
    cls: Any = REPRESENTATIONS[checks.known("representation", settings["representation"], REPRESENTATIONS)]
    takes = inspect.signature(cls).parameters
    # Files say of backtracking only where there is none.
    said = ("axis", "max_cells", "backtracking")
    options = {key: settings[key] for key in said if key in takes and settings.get(key) is not None}
    return GridPathProblem(
        grid,
        start,
        goal,
        cls(grid, start, goal, **options),
        objectives,
        settings["obstacles"],
        penalty,
        settings["potential_limit"],
    )


def _objective(stated: dict, content: dict) -> Objective:
    """Return the objective of a name with the numbers that it had; one that cannot be made so knows its name alone."""
    name = checks.text("the name of an objective", stated["name"])
    options = {key: value for key, value in stated.items() if key != "name"}
    if name in OBJECTIVES:
        cls: Any = OBJECTIVES[name]
        takes = inspect.signature(cls).parameters
        if set(options) <= set(takes) and all(one.default is not one.empty or key in options for key, one in takes.items()):
            return cls(**options)
    label = checks.text("the label of an objective", content["labels"].get(name, name))
    # Files of before there were such objectives say nothing of them.
    best = checks.text("the name of the best path", content.get("best", {}).get(name, ""))
    return StoredObjective(name, label, name in content.get("maximised", ()), best)
