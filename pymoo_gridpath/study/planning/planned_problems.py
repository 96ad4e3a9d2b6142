"""The problems of a study with their maps read: each grid and query in canonical form."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from pymoo_gridpath.checks import printable
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import Cell, OccupancyGrid
from pymoo_gridpath.maps import Query, load_map, query_of, read_scen
from pymoo_gridpath.maps.queries import check_grown, ends_of
from pymoo_gridpath.memory import is_want_of_memory, want_of_memory
from pymoo_gridpath.neighbourhood import neighbourhood_of
from pymoo_gridpath.representations import default_representation
from pymoo_gridpath.study.planning import canonical
from pymoo_gridpath.study.planning.build import build_grid, build_problem, pack_grid, place_of_grid
from pymoo_gridpath.study.planning.moving import moving_entry
from pymoo_gridpath.study.planning.plan import PlannedProblem, run_key
from pymoo_gridpath.study.specification.kinds import objective_entry, representation_entry
from pymoo_gridpath.study.specification.moving import REPRESENTATION
from pymoo_gridpath.study.specification.problem import ProblemSpec, QueryRange, beside
from pymoo_gridpath.study.specification.study import Study


class _Item(NamedTuple):
    """One problem of a group before its settings are added."""

    suffix: str
    grid: dict[str, Any]
    cells: bytes | None
    start: Cell
    goal: Cell
    place: dict[str, Any] | None = None
    original: bytes | None = None


def plan_problems(study: Study) -> tuple[list[PlannedProblem], list[int]]:
    """Return all problems, and for each the index of the table that it stems from."""
    problems: list[PlannedProblem] = []
    groups: list[int] = []
    labels: dict[str, int] = {}
    maps: dict[tuple, OccupancyGrid] = {}
    for k, spec in enumerate(study.problems):
        items = list(_items(study, k, spec, maps))
        for item in items:
            label = f"{spec.label}/{item.suffix}" if len(items) > 1 else spec.label
            if label in labels:
                raise study.error(f"the problem {label!r} has the name of another; give one of them another name", place_of(k))
            labels[label] = k
            content = _settings(spec, item)
            if spec.moving is not None:
                content |= _moving(study, k, spec, item, content)
            problems.append(
                PlannedProblem(
                    label,
                    spec.label,
                    content,
                    item.cells,
                    source=_source(spec, items),
                    place=item.place,
                    original=item.original,
                )
            )
            groups.append(k)
    _refuse_twins(study, problems, groups)
    return problems, groups


def _source(spec: ProblemSpec, items: list[_Item]) -> str:
    """Return where the map of a problem comes from, in words."""
    if spec.random is not None:
        return ""
    if (suite := spec.made_suite()) is not None:
        return f"the suite {suite.name}, which {suite.follows}"
    words = [str(spec.map or (spec.grid.name if spec.grid is not None else str(spec.scen).removesuffix(".scen")))]
    if spec.scen is not None:
        words.append(f"query {items[0].suffix} of {spec.scen}" if len(items) == 1 else f"numbered queries of {spec.scen}")
    given = {"resolution": spec.resolution, "unknown": spec.unknown, "threshold": spec.threshold}
    words += [f"{key} {value}" for key, value in given.items() if value is not None]
    if spec.radius:
        words.append(f"obstacles grown by {spec.radius:g} m")
    if spec.footprint:
        words.append(f"obstacles grown by a footprint of {len(spec.footprint)} corners")
    return ", ".join(words)


def _items(study: Study, k: int, spec: ProblemSpec, maps: dict[tuple, OccupancyGrid]) -> Iterator[_Item]:
    if spec.random is not None:
        family = spec.random
        goal = (family.size - 1, family.size - 1)
        for seed in family.seeds:
            content = {"size": family.size, "p0": family.p0, "seed": seed}
            content |= canonical.settled_steps(family.corner_cutting, family.moves)
            grid = {"random": content}
            if neighbourhood_of(family.moves, family.corner_cutting).restricts:
                # Elsewhere there is always a path.
                refuse(study, (*place_of(k), "random"), f"seed {seed}: ", build_grid(grid).check_query, (0, 0), goal)
            yield _Item(str(seed), grid, None, (0, 0), goal)
        return
    if (suite := spec.made_suite(study.folder)) is not None:
        where = (*place_of(k), "suite")
        grid, start, goal = refuse(study, where, "", lambda: suite.query)
        refuse(study, where, "", grid.check_query, start, goal)
        content, cells = pack_grid(grid)
        yield _Item("", content, cells, start, goal, *place_of_grid(grid))
        return
    grid, queries = _map_queries(study, k, spec, maps)
    robot = (*place_of(k), "radius" if spec.footprint is None else "footprint")
    grown = refuse(study, robot, "", grid.inflate, spec.radius, spec.footprint)
    (content, cells), place = pack_grid(grown), place_of_grid(grown)
    for suffix, start, goal in queries:
        about = f"query {suffix}: " if spec.scen else ""
        where = (*place_of(k), "queries" if spec.scen else "start")
        refuse(study, where, about, grid.check_query, start, goal)
        if grown is not grid:
            refuse(study, robot, about, check_grown, grown, start, goal)
        yield _Item(suffix, content, cells, start, goal, *place)


def _map_queries(study: Study, k: int, spec: ProblemSpec, maps) -> tuple[OccupancyGrid, list[tuple[str, Cell, Cell]]]:
    """Return the grid of a problem as it was read, and its queries with what tells them apart."""
    scen = None if spec.scen is None else study.folder / spec.scen
    known = Query()
    if scen is not None and not os.path.isfile(scen):
        raise study.error(f"{printable(scen)}: no such file, expected a .scen file of queries", (*place_of(k), "scen"))
    if spec.grid is not None:
        grid = spec.grid
    else:
        path = beside(study.folder, spec.map if spec.map is not None else str(spec.scen).removesuffix(".scen"))
        where = (*place_of(k), "map" if spec.map is not None else "scen")
        options = {key: getattr(spec, key) for key in ("resolution", "unknown", "threshold", "corner_cutting", "moves")}
        key = (path, *options.values())
        if key not in maps:
            maps[key] = refuse(study, where, "", load_map, path, **options)
        grid = maps[key]
        if scen is None and not (spec.start and spec.goal):
            known = refuse(study, where, "", query_of, path)
    if scen is not None:
        return grid, _scen_queries(study, k, spec, scen, grid)
    start, goal = refuse(study, place_of(k), "", ends_of, grid, known, spec.start, spec.goal)
    return grid, [("", start, goal)]


def _scen_queries(study: Study, k: int, spec: ProblemSpec, path: Path, grid: OccupancyGrid) -> list[tuple[str, Cell, Cell]]:
    found = refuse(study, (*place_of(k), "scen"), "", read_scen, path, grid)
    if not found:
        raise study.error(f"{spec.scen} holds no query", (*place_of(k), "scen"))
    wanted = spec.queries or QueryRange()
    if isinstance(wanted, QueryRange):
        last = len(found) - 1 if wanted.last is None else wanted.last
        numbers = range(wanted.first, last + 1, wanted.step)
        end = max(wanted.first, last)
    else:
        numbers, end = wanted, max(wanted)
    if end >= len(found):
        raise study.error(
            f"queries go up to {end}, but {spec.scen} has {len(found)} of them, counted from 0", (*place_of(k), "queries")
        )
    return [(str(n), found[n].start, found[n].goal) for n in numbers]


def _moving(study: Study, k: int, spec: ProblemSpec, item: _Item, content: dict[str, Any]) -> dict[str, Any]:
    """Return the obstacles that move in a problem in canonical form, once they are known to leave a way in every epoch."""
    where, about = (*place_of(k), "moving"), f"problem {spec.label!r}{f', {item.suffix}' * bool(item.suffix)}: "
    grid = build_grid(item.grid, item.cells)
    found = {"moving": refuse(study, where, about, moving_entry, spec.moving, grid, item.start, item.goal)}
    refuse(study, where, about, build_problem, content | found, item.cells)
    return found


def _settings(spec: ProblemSpec, item: _Item) -> dict[str, Any]:
    """Return the canonical form of a problem, but for obstacles that move."""
    default: Any = REPRESENTATION
    if (suite := spec.made_suite()) is not None:
        default = representation_entry({"class": REPRESENTATION, **suite.coding})
    elif spec.moving is None:
        default = default_representation(canonical.steps_of(item.grid)["corner_cutting"], spec.axis)  # pyright: ignore[reportArgumentType]
    return canonical.settle(
        {
            "grid": item.grid,
            "start": list(item.start),
            "goal": list(item.goal),
            "objectives": [objective_entry(one) for one in spec.scored_by],
            "representation": default if spec.representation is None else representation_entry(spec.representation),
            "obstacles": spec.obstacles,
            "penalty": spec.penalty,
            "potential_limit": spec.potential_limit,
            "axis": spec.axis,
        }
    )


def _refuse_twins(study: Study, problems: list[PlannedProblem], groups: list[int]) -> None:
    seen: dict[str, int] = {}
    for k, problem in enumerate(problems):
        key = run_key(problem.spec, {}, None, 0)
        if key in seen:
            other = f"{problems[seen[key]].label!r} ({study.line(place_of(groups[seen[key]]))})"
            message = f"the problem {problem.label!r} is the same as {other}, expected each once"
            raise study.error(message, place_of(groups[k]))
        seen[key] = k


def place_of(k: int) -> tuple[str, int]:
    return "problems", k


def refuse(study: Study, where, about: str, function, *arguments, **options) -> Any:
    """Return what a function returns, and put the place in the study before what it says is wrong."""
    try:
        return function(*arguments, **options)
    except GridPathError as error:
        raise study.error(f"{about}{error}", where) from None
    except Exception as error:
        # pymoo's own checks of arguments, some of them on several lines.
        text = f"{type(error).__name__}: {' '.join(str(error).split())}"
        raise study.error(f"{about}{want_of_memory() if is_want_of_memory(error) else text}", where) from None
