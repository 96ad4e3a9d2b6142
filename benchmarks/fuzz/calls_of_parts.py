"""One valid call of every public name, from maps to paths and searches."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, cast

import numpy as np
from pymoo.core.callback import Callback
from pymoo.core.population import Population
from world import Call, World

import pymoo_gridpath
from pymoo_gridpath import (
    GridPathProblem,
    OccupancyGrid,
    algorithms,
    exact,
    fields,
    maps,
    objectives,
    problems,
    quality,
    representations,
)
from pymoo_gridpath.maps.shipped import ShippedMap
from pymoo_gridpath.paths import CellPaths, ColumnPaths, Trajectories
from pymoo_gridpath.paths.frame import MonotoneFrame


def _grids(w: World) -> dict[str, Call]:
    grid, cell = w.grid, (1, 1)
    return {
        "OccupancyGrid": (
            OccupancyGrid,
            {"occupied": w.occupied, "resolution": 0.5, "origin": (1.0, 2.0, 0.3), "corner_cutting": True, "name": "own"},
        ),
        "OccupancyGrid.box_of": (grid.box_of, {"start": cell}),
        "OccupancyGrid.check_cell": (grid.check_cell, {"cell": cell, "role": "start"}),
        "OccupancyGrid.check_query": (grid.check_query, w.query),
        "OccupancyGrid.contains": (grid.contains, {"cell": cell}),
        "OccupancyGrid.crop": (grid.crop, {"box": grid.whole}),
        "OccupancyGrid.downsample": (grid.downsample, {"factor": 2}),
        "OccupancyGrid.from_occupancy": (
            OccupancyGrid.from_occupancy,
            {
                "occupancy": np.array([0, 100, -1, 20, 80, 50]),
                "width": 3,
                "resolution": 0.5,
                "origin": (1.0, 2.0),
                "occupied_from": 60.0,
                "free_up_to": 30.0,
                "unknown": "free",
                "corner_cutting": True,
                "name": "hall",
                "moves": 4,
            },
        ),
        "OccupancyGrid.inflate": (grid.inflate, {"radius": 0.0, "footprint": [(0.6, 0.2), (-0.6, 0.2), (0.0, -0.4)]}),
        "OccupancyGrid.grown_from": (
            grid.grown_from,
            {"original": grid, "robot_radius": 0.5, "footprint": [(0.5, 0.0), (0.0, 0.2), (-0.1, -0.2)]},
        ),
        "OccupancyGrid.grow": (grid.grow, {"cells": 1.5}),
        "OccupancyGrid.check_resolution": (grid.check_resolution, {"need": "a radius in metres"}),
        "OccupancyGrid.radius_in_cells": (grid.radius_in_cells, {"radius": 0.5}),
        "OccupancyGrid.is_free": (grid.is_free, {"cell": cell}),
        "OccupancyGrid.move_graph": (grid.move_graph, {}),
        "OccupancyGrid.nearest_free": (grid.nearest_free, {"cell": cell}),
        "OccupancyGrid.replace": (grid.replace, {"resolution": 2.0, "occupied": w.occupied}),
        "OccupancyGrid.shortest_length": (grid.shortest_length, {"start": cell, "goal": cell}),
        "OccupancyGrid.shortest_lengths": (grid.shortest_lengths, {"start": cell, "limit": 5.0}),
        "OccupancyGrid.to_cells": (grid.to_cells, {"points": np.array([[1.0, 2.0], [3.0, 4.0]])}),
        "OccupancyGrid.to_metres": (grid.to_metres, {"cells": np.array([[1, 2], [3, 4]])}),
        "obstacle_potential": (
            fields.obstacle_potential,
            {"grid": grid, "box": grid.whole, "sigma_m": 0.4, "nearest": True, "cutoff": 0.01},
        ),
        "inflation_cost": (
            fields.inflation_cost,
            {"grid": grid, "cost_scaling_factor": 3.0, "inflation_radius": 0.5, "box": grid.whole},
        ),
        "clearance": (fields.clearance, {"grid": grid}),
    }


def _maps(w: World) -> dict[str, Call]:
    pose = {"resolution": 0.5, "origin": (1.0, 2.0)}
    return {
        "save_map": (maps.save_map, {"grid": w.grid, "path": w.folder / "saved.yaml"}),
        "load_map": (maps.load_map, {"path": w.image, "threshold": 0.5, "unknown": "free", "corner_cutting": True, **pose}),
        "load_shipped": (maps.load_shipped, {"name": "office", "corner_cutting": True}),
        "format_of": (maps.format_of, {"path": w.ros_map}),
        "query_of": (maps.query_of, {"path": w.text_map}),
        "Query": (maps.Query, {**w.query, "radius": 0.1}),
        "read_string": (maps.read_string, {"path": w.text_map, "limit": 1000}),
        "read_image": (
            maps.read_image,
            {"path": w.image, "threshold": 0.5, "unknown": "free", "corner_cutting": True, **pose},
        ),
        "read_movingai": (maps.read_movingai, {"path": w.movingai_map, "corner_cutting": True, **pose}),
        "read_geotiff": (maps.read_geotiff, {"path": w.npy_map, "corner_cutting": True, "threshold": 0.5, "unknown": "free"}),
        "read_raster": (maps.read_raster, {"path": w.npy_map}),
        "read_terrain": (maps.read_terrain, {"path": w.movingai_map, "weights": {"S": 3.0}}),
        "read_npy": (maps.read_npy, {"path": w.npy_map, "corner_cutting": True, **pose}),
        "read_ros": (maps.read_ros, {"path": w.ros_map, "unknown": "occupied", "corner_cutting": True}),
        "read_ros_message": (maps.read_ros_message, {"path": w.ros_message, "unknown": "free", "corner_cutting": True}),
        "read_rosbag": (maps.read_rosbag, {"path": w.bag, "topic": "/map", "unknown": "free", "corner_cutting": True}),
        "grid_of_message": (
            maps.grid_of_message,
            {"message": w.message, "unknown": "free", "corner_cutting": True, "name": "hall"},
        ),
        "read_scen": (maps.read_scen, {"path": w.scen, "grid": maps.read_movingai(w.movingai_map)}),
        "read_text": (maps.read_text, {"path": w.text_map, "corner_cutting": True, **pose}),
        "read_text_header": (maps.read_text_header, {"path": w.text_map}),
        "shipped_maps": (maps.shipped_maps, {}),
        "ScenQuery": (
            maps.ScenQuery,
            {"bucket": 0, "map_name": "a", "width": 4, "height": 3, **w.query, "optimal_length": 4.0},
        ),
        "ShippedMap": (ShippedMap, {"name": "a", "title": "A", "path": w.text_map, **w.query, "radius": 0.1}),
        "TextHeader": (maps.TextHeader, {"name": "a", "title": "A", **pose, "corner_cutting": True, **w.query, "radius": 0.1}),
    }


def _problems(w: World) -> dict[str, Call]:
    problem, limited = w.problem, w.limited
    paths = problem.decode(w.legal_rows)
    road = np.array([(x, 0) for x in range(8)] + [(7, y) for y in range(1, 6)])
    shortening = problems.ShorteningProblem(w.grid, road, n_points=2)
    moving = problems.MovingObstaclesProblem(w.grid, [[(-1, 0), (-2, 0)]], **w.query)
    timed = w.timed
    metres = {"grid": w.grid, **{end: tuple(w.grid.to_metres(cell)) for end, cell in w.query.items()}}
    own = {"grid": w.grid, **w.query, "representation": "integer", "objectives": ("length", "vulnerability"), "axis": "x"}
    return {
        "GridPathProblem": (
            GridPathProblem,
            {**own, "objectives": ["vulnerability"], "obstacles": "limit", "penalty": 9.0, "potential_limit": 5.0},
        ),
        "GridPathProblem.decode": (problem.decode, {"X": w.rows(problem)}),
        "GridPathProblem.evaluate": (partial(problem.evaluate, return_values_of=["F", "turn"]), {"X": w.rows(problem)}),
        "GridPathProblem.from_metres": (GridPathProblem.from_metres, {**metres, "goal_tolerance": 0.5}),
        "MovingObstaclesProblem.from_metres": (
            problems.MovingObstaclesProblem.from_metres,
            {**metres, "movers": [[(-1, 0), (-2, 0)]]},
        ),
        "TimedPathProblem.from_metres": (
            problems.TimedPathProblem.from_metres,
            {**metres, "movers": [[(-1, 0), (-2, 0)]], "horizon": 12},
        ),
        "GridPathProblem.over_limit": (limited.over_limit, {"vulnerability": np.array([1.0, 9.0])}),
        "GridPathProblem.pareto_front": (_fresh(w, "pareto_front"), {"max_seconds": 2.0, "epsilon": 0.02}),
        "GridPathProblem.pareto_set": (_fresh(w, "pareto_set"), {"max_seconds": 2.0}),
        "GridPathProblem.restart": (problem.restart, {}),
        "GridPathProblem.score": (problem.score, {"paths": paths}),
        "MovingObstaclesProblem": (
            problems.MovingObstaclesProblem,
            {
                "base": w.grid,
                "movers": [[(-1, 0), (-2, 0)]],
                **w.query,
                "taut": 3,
                "objectives": ["length", "vulnerability"],
                "penalty": 3.0,
                "max_cells": 60,
            },
        ),
        "MovingObstaclesProblem.decode": (moving.decode, {"X": w.rows(moving)}),
        "MovingObstaclesProblem.is_stale": (moving.is_stale, {"pop": Population.new("X", w.rows(moving))}),
        "MovingObstaclesProblem.over_limit": (limited.over_limit, {"vulnerability": np.array([1.0, 9.0])}),
        "MovingObstaclesProblem.restart": (moving.restart, {}),
        "MovingObstaclesProblem.score": (moving.score, {"paths": moving.decode(w.rows(moving))}),
        "TimedPathProblem": (
            problems.TimedPathProblem,
            {
                "grid": w.grid,
                **w.query,
                "movers": [[(-1, 0), (-2, 0)]],
                "horizon": 12,
                "variance": 0.7,
                "obstacles": "penalty",
                "penalty": 3.0,
            },
        ),
        "TimedPathProblem.decode": (timed.decode, {"X": w.rows(timed)}),
        "TimedPathProblem.over_limit": (limited.over_limit, {"vulnerability": np.array([1.0, 9.0])}),
        "TimedPathProblem.restart": (timed.restart, {}),
        "TimedPathProblem.score": (timed.score, {"paths": timed.decode(w.rows(timed))}),
        "ObstacleClock": (problems.ObstacleClock, {"told": True, "renew": True, "callback": Callback()}),
        "ShorteningProblem": (problems.ShorteningProblem, {"grid": w.grid, "road": road, "radius": 1.0, "n_points": 3}),
        "ShorteningProblem.cells": (shortening.cells, {"x": np.array([0.4, 0.6])}),
        "ShorteningProblem.decode": (shortening.decode, {"X": np.array([[0.4, 0.6], [0.1, 0.9]])}),
        "ShorteningProblem.encode": (shortening.encode, {"places": np.array([[0, 3, 5, 12], [0, 0, 7, 12]])}),
        "ShorteningProblem.waypoints": (shortening.waypoints, {"x": np.array([0.4, 0.6])}),
        "random_movers": (
            problems.random_movers,
            {"grid": w.grid, **w.query, "n_movers": 1, "n_epochs": 3, "random_state": 1},
        ),
        "random_dense_grid": (problems.random_dense_grid, {"size": 8, "p0": 0.3, "random_state": 1}),
        "convex_environment": (problems.convex_environment, {"random_state": 1}),
        "concave_environment": (problems.concave_environment, {"random_state": 1}),
        "maze_environment": (problems.maze_environment, {"random_state": 1}),
        "small_environment": (problems.small_environment, {"name": "caved", "corner_cutting": True}),
        "far_corners": (problems.far_corners, {"grid": w.grid}),
        "make_objectives": (objectives.make_objectives, {"objectives": ["length", "turn"]}),
        "Length": (objectives.Length, {}),
        "LeastClearance": (objectives.LeastClearance, {}),
        **{
            f"{type(one).__name__}.{method}": (getattr(one, method), given)
            for one in (
                *(objectives.Length(), objectives.Turn(), objectives.Vulnerability(2.0), objectives.Inflation()),
                *(objectives.LeastClearance(), objectives.GroundCost(w.field), objectives.Climb(w.field)),
                objectives.Length(),
                objectives.Turn(),
                objectives.Vulnerability(2.0),
                objectives.Inflation(),
                objectives.LeastClearance(),
                objectives.GroundCost(w.field),
                objectives.Climb(w.field),
            )
            for method, given in (
                ("field", {"grid": w.grid}),
                ("field_in", {"grid": w.grid, "box": w.grid.whole}),
                ("moves", {"grid": w.grid}),
                ("on", {"grid": w.grid}),
                ("prepare", {"representation": w.problem.representation, "grid": w.grid}),
            )
        },
        "Objective.field": (objectives.Turn().field, {"grid": w.grid}),
        "Objective.field_in": (objectives.Turn().field_in, {"grid": w.grid, "box": w.grid.whole}),
        "Objective.moves": (objectives.Turn().moves, {"grid": w.grid}),
        "Objective.prepare": (objectives.Turn().prepare, {"representation": w.problem.representation, "grid": w.grid}),
        "register": (pymoo_gridpath.register, {"cls": objectives.Length}),
        "Turn": (objectives.Turn, {}),
        "Vulnerability": (objectives.Vulnerability, {"sigma_m": 2.0, "nearest": False, "cutoff": 0.1}),
        "Vulnerability.potential": (objectives.Vulnerability(2.0).potential, {"grid": w.grid, "box": w.grid.whole}),
        "Inflation": (objectives.Inflation, {"cost_scaling_factor": 3.0, "inflation_radius": 0.5}),
        "Inflation.potential": (objectives.Inflation().potential, {"grid": w.grid, "box": w.grid.whole}),
        "Objective.on": (objectives.Turn().on, {"grid": w.grid}),
        "GroundCost": (objectives.GroundCost, {"cost": w.field, "weight": 2.0, "per": "entry", "name": "mud", "label": "Mud"}),
        "Climb": (objectives.Climb, {"elevation": w.field, "name": "rise", "label": "Rise [m]"}),
        # An objective of one's own, whose field and values are arguments too.
        "Objective": (partial(_own_objective, w), {"field": w.field, "factor": np.ones(5)}),
    }


def _fresh(w: World, method: str) -> Callable:
    """Return a method of a problem that has not been asked before; the first answer is kept."""

    def ask(**arguments):
        return getattr(GridPathProblem(w.grid, **w.query, representation="integer"), method)(**arguments)

    return ask


def _own_objective(w: World, field, factor):
    class Own(objectives.Objective):
        name = label = "own"

        def field(self, grid):
            return field

        def __call__(self, paths, prepared):
            return factor

    problem = GridPathProblem(w.grid, **w.query, representation="integer", objectives=[Own()])
    return problem.evaluate(w.rows(problem))


def _codings(w: World) -> dict[str, Call]:
    found: dict[str, Call] = {
        "default_representation": (representations.default_representation, {"corner_cutting": True, "axis": "x"}),
        "make_representation": (representations.make_representation, {"name": "mixed", "grid": w.grid, **w.query, "axis": "x"}),
    }
    for coding in [*w.codings.values(), w.timed.representation]:
        cls = type(coding)
        X = w.rows(coding)
        own = {"axis": "x"} if isinstance(coding, representations.MonotoneRepresentation) else {}
        if cls is representations.CellSequence:
            own = {"max_cells": 20, "fields": [w.field], "spare": 2.0, "backtracking": True}
            X = coding.repair(X, w.random)
        if cls is representations.TimedPaths:
            own = {"movers": w.timed.movers, "horizon": 12}
        paths = coding.decode(X)
        found[cls.__name__] = (cls, {"grid": w.grid, **w.query, **own})
        arguments: dict[str, dict[str, Any]] = {
            "decode": {"X": X},
            "encode": {"paths": paths},
            "exit_rows": {"X": X},
            "fits": {"sequences": paths.sequences},
            "from_sequences": {"sequences": paths.sequences},
            "genes": {"X": X},
            "prepare": {"field": w.field},
            "repair": {"X": X, "random_state": w.random},
            "row_moves": {"X": X},
            "to_sequences": {"X": X},
        }
        for method, given in arguments.items():
            if hasattr(coding, method):
                found[f"{cls.__name__}.{method}"] = (getattr(coding, method), given)
    return found


def _paths(w: World) -> dict[str, Call]:
    frame, paths = w.frame, cast(ColumnPaths, w.problem.decode(w.rows(w.problem)))
    cells = w.codings["cells"].decode(w.rows(w.codings["cells"]))
    n = frame.n_columns - 1
    return {
        "MonotoneFrame": (MonotoneFrame, {"grid": w.grid, **w.query, "axis": "x"}),
        "MonotoneFrame.admits_path": (frame.admits_path, {}),
        "MonotoneFrame.columns": (frame.columns, {"field": w.field}),
        "MonotoneFrame.flanks_at": (frame.flanks_at, {"row": paths.leave[:, :n], "step": np.ones((len(paths), n), dtype=int)}),
        "MonotoneFrame.from_cells": (frame.from_cells, {"cells": np.array([[1, 2], [3, 4]])}),
        "MonotoneFrame.prefix_sums": (frame.prefix_sums, {"field": w.field}),
        "MonotoneFrame.to_cells": (frame.to_cells, {"column": np.array([0, 1]), "row": np.array([0, 2])}),
        "ColumnPaths": (partial(_measured, ColumnPaths), {"frame": frame, "enter": paths.enter, "leave": paths.leave}),
        "ColumnPaths.cells": (paths.cells, {"index": 1}),
        "ColumnPaths.through": (ColumnPaths.through, {"frame": frame, "exit_rows": paths.leave[:, :n]}),
        "ColumnPaths.total": (paths.total, {"sums": w.problem.representation.prepare(w.field)}),
        "Trajectories": (
            Trajectories,
            {"movers": [{1: (0, 1), 3: (0, 3)}], "after": "gone", "before": "absent", "gaps": "interpolate"},
        ),
        "Trajectories.cells": (Trajectories([[(0, 1), (0, 2)]]).cells, {"n_ticks": 4}),
        "CellPaths": (partial(_measured, CellPaths), {"grid": w.grid, "rows": w.rows(w.codings["cells"])}),
        "CellPaths.cells": (cells.cells, {"index": 1}),
        "CellPaths.total": (cells.total, {"field": w.field.ravel()}),
        "ColumnPaths.moves_total": (paths.moves_total, {"enter": w.enter}),
        "CellPaths.moves_total": (cells.moves_total, {"enter": w.enter}),
    }


def _measured(cls, **arguments):
    paths = cls(**arguments)
    return paths.length, paths.turn, paths.interfering_cells


def _plans(planner):
    """Return a function that has a planner yield all its plans."""

    def plans(problem):
        return list(planner.plans(problem))

    return plans


def _search(w: World) -> dict[str, Call]:
    front = np.array([[0.0, 4.0], [1.0, 1.0], [4.0, 0.0]])
    return {
        "ExactFront.plan": (algorithms.ExactFront().plan, {"problem": w.problem}),
        "ExactFront.plans": (_plans(algorithms.ExactFront()), {"problem": w.problem}),
        "ExactFront.parameters": (algorithms.ExactFront.parameters, {}),
        "ExactFront.refuse": (algorithms.ExactFront.refuse, {"problem": w.problem}),
        **_planners(w),
        "find_algorithm": (algorithms.find_algorithm, {"name": "nsga2"}),
        "hypervolume_ratio": (quality.hypervolume_ratio, {"F": front + 0.5, "front": front}),
        "mean_hypervolume_ratio": (quality.mean_hypervolume_ratio, {"F": [front + 0.5, front], "fronts": [front, front]}),
        "mean_igd_plus": (quality.mean_igd_plus, {"F": [front + 0.5, front], "fronts": [front, front]}),
        "igd_plus": (quality.igd_plus, {"F": front + 0.5, "front": front}),
        "share_found": (quality.share_found, {"F": front, "front": front}),
        "Budget": (exact.Budget, {"max_seconds": 1.0, "max_labels": 1000, "max_memory": 10**8, "watch": lambda meter: False}),
        "Certificate": (exact.Certificate, {"epsilon": 0.02, "share": 0.1}),
        "Certificate.said": (exact.Certificate(0.02, 0.1).said, {"name": "share"}),
        "exact_front": (
            exact.exact_front,
            {"problem": w.problem, "budget": exact.Budget(max_seconds=2.0), "epsilon": 0.02, "share": None},
        ),
        "exact_fronts": (
            exact.exact_fronts,
            {"problems": [w.problem], "budget": exact.Budget(max_seconds=2.0), "executor": None, "epsilon": None, "share": 0.1},
        ),
        "exact_timed_front": (
            exact.exact_timed_front,
            {
                "grid": w.grid,
                **w.query,
                "movers": Trajectories([[(-1, 0), (-2, 0)]]),
                "horizon": 12,
                "variance": 0.7,
                "budget": exact.Budget(max_seconds=2.0),
            },
        ),
        "ExactResult": (
            exact.ExactResult,
            {
                "X": w.legal_rows,
                "F": np.zeros((1, 2)),
                "complete": True,
                "message": "",
                "n_labels": 1,
                "n_bytes": 1,
                "seconds": 1.0,
            },
        ),
    }


def _planners(w: World) -> dict[str, Call]:
    """Calls of the planners that plan cells."""
    problem = GridPathProblem(w.grid, **w.query, representation="cells")
    arguments: dict[type, dict[str, Any]] = {
        algorithms.QuadrantSelection: {
            "speed": 0.5,
            "turn_seconds": 0.1,
            "alternatives": 2,
            "smooth": False,
            "max_paths": 9,
            "strict": True,
        },
        algorithms.RegionOfSight: {
            "radius": 1.0,
            "road": "shortest",
            "search": "shortest",
            "sweep": False,
            "max_passes": 9,
        },
        algorithms.AStar: {"heuristic": "euclidean"},
        algorithms.Dijkstra: {},
        algorithms.BreadthFirst: {},
        algorithms.BestFirst: {"heuristic": "manhattan"},
        algorithms.JumpPointSearch: {"heuristic": "chebyshev"},
        algorithms.OrthogonalJumpPointSearch: {},
    }
    found: dict[str, Call] = {}
    for cls, given in arguments.items():
        found[cls.__name__] = (cls, given)
        found[f"{cls.__name__}.plan"] = (cls(**given).plan, {"problem": problem})
        found[f"{cls.__name__}.plans"] = (_plans(cls(**given)), {"problem": problem})
        found[f"{cls.__name__}.parameters"] = (cls.parameters, {})
        found[f"{cls.__name__}.refuse"] = (cls.refuse, {"problem": problem})
    return found


CALLS = (_grids, _maps, _problems, _codings, _paths, _search)
