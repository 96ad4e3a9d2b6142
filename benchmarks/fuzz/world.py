"""What calls of the package are made with."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
from pymoo.optimize import minimize
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

from pymoo_gridpath import (
    GridPathProblem,
    OccupancyGrid,
    algorithms,
    convergence,
    decision,
    exact,
    operators,
    problems,
    representations,
    study,
)
from pymoo_gridpath.paths.frame import MonotoneFrame

Call = tuple[Callable, dict[str, Any]]


class World:
    """What calls are made with: a small grid with everything that grows from it, and files in a folder of their own."""

    def __init__(self, folder: Path):
        self.folder = folder
        occupied = np.zeros((6, 8), dtype=bool)
        occupied[2:4, 3:5] = True
        self.occupied = occupied
        self.grid = OccupancyGrid(occupied, resolution=0.5, origin=(1.0, 2.0, 0.3), name="small")
        self.query: dict[str, Any] = {"start": (0, 0), "goal": (7, 5)}
        self.field = np.arange(48.0).reshape(6, 8) / 8
        self.enter = np.arange(384.0).reshape(8, 6, 8) / 8
        self.random = np.random.default_rng(1)

    @cached_property
    def codings(self) -> dict[str, Any]:
        known: Any = representations.REPRESENTATIONS
        return {name: known[name](self.grid, **self.query) for name in known}

    @cached_property
    def frame(self) -> MonotoneFrame:
        return MonotoneFrame(self.grid, **self.query)

    @cached_property
    def problem(self) -> GridPathProblem:
        return GridPathProblem(self.grid, **self.query, representation="integer")

    @cached_property
    def timed(self) -> problems.TimedPathProblem:
        return problems.TimedPathProblem(self.grid, **self.query, movers=[[(-1, 0), (-2, 0)]], horizon=12)

    @cached_property
    def limited(self) -> GridPathProblem:
        return GridPathProblem(
            self.grid,
            **self.query,
            representation="integer",
            obstacles="limit",
            potential_limit=5.0,
            objectives=["vulnerability"],
        )

    @cached_property
    def result(self):
        options = operators.default_operators(self.problem)
        algorithm = algorithms.make_algorithm("NSGA2", self.problem, pop_size=12, operators=options)
        return minimize(self.problem, algorithm, ("n_gen", 3), seed=1, callback=convergence.ConvergenceRecorder())

    @cached_property
    def moving_clock(self) -> problems.ObstacleClock:
        problem = problems.MovingObstaclesProblem(self.grid, [[(-1, 0)]], **self.query, taut=1)
        clock = problems.ObstacleClock()
        minimize(problem, algorithms.make_algorithm("NSGA2", problem, pop_size=6), ("n_gen", 1), seed=1, callback=clock)
        return clock

    @property
    def recorder(self) -> convergence.ConvergenceRecorder:
        return cast(Any, self.result).algorithm.callback

    @cached_property
    def trade_off(self) -> decision.TradeOffSet:
        return decision.TradeOffSet.from_results(self.result)

    def rows(self, coding) -> np.ndarray:
        return np.random.default_rng(3).integers(coding.xl, coding.xu + 1, (5, coding.n_var))

    @cached_property
    def legal_rows(self) -> np.ndarray:
        return exact.exact_front(self.problem).X

    @cached_property
    def study(self):
        return study.Study(
            problems=[study.ProblemSpec(name="one", random={"size": 8, "p0": 0.2, "seeds": 1})],
            algorithms=[study.AlgorithmSpec(name="nsga2", algorithm="NSGA2", pop_size=12)],
            seeds=1,
            budget={"generations": 2},
        )

    @cached_property
    def store(self):
        folder = self.folder / "study"
        study.run_study(self.study, folder)
        return study.Store(folder)

    def file(self, name: str, data: bytes) -> Path:
        path = self.folder / name
        if not path.exists():
            path.write_bytes(data)
        return path

    @cached_property
    def text_map(self) -> Path:
        return self.file("map.txt", b"....\n.##.\n....\n")

    @cached_property
    def movingai_map(self) -> Path:
        return self.file("map.map", b"type octile\nheight 3\nwidth 4\nmap\n....\n.@@.\n....\n")

    @cached_property
    def scen(self) -> Path:
        return self.file("map.scen", b"version 1\n0\tmap.map\t4\t3\t0\t0\t3\t2\t4.41421356\n")

    @cached_property
    def image(self) -> Path:
        return self.file("map.pgm", b"P2\n4 3\n255\n" + b"254 254 254 254 254 0 0 254 254 254 254 254\n")

    @cached_property
    def ros_map(self) -> Path:
        text = "image: {}\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
        return self.file("map.yaml", text.format(self.image.name).encode())

    @cached_property
    def message(self) -> SimpleNamespace:
        turned = SimpleNamespace(x=0.0, y=0.0, z=0.0, w=1.0)
        pose = SimpleNamespace(position=SimpleNamespace(x=1.0, y=2.0, z=0.0), orientation=turned)
        info = SimpleNamespace(resolution=0.05, width=3, height=2, origin=pose)
        return SimpleNamespace(info=info, data=np.array([0, 100, -1, 0, 0, 0], dtype=np.int8))

    @cached_property
    def ros_message(self) -> Path:
        text = (
            "info:\n  resolution: 0.05\n  width: 2\n  height: 1\n  origin:\n    position: {x: 1.0, y: 2.0, z: 0.0}\n"
            "    orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}\ndata:\n- 0\n- -1\n"
        )
        return self.file("message.yaml", text.encode())

    @cached_property
    def bag(self) -> Path:
        path = self.folder / "map.bag"
        if not path.exists():
            typestore = get_typestore(Stores.ROS1_NOETIC)
            types: Any = typestore.types
            time, info = types["builtin_interfaces/msg/Time"](0, 0), self.message.info
            pose = types["geometry_msgs/msg/Pose"](
                types["geometry_msgs/msg/Point"](**vars(info.origin.position)),
                types["geometry_msgs/msg/Quaternion"](**vars(info.origin.orientation)),
            )
            message = types["nav_msgs/msg/OccupancyGrid"](
                types["std_msgs/msg/Header"](0, time, "map"),
                types["nav_msgs/msg/MapMetaData"](time, info.resolution, info.width, info.height, pose),
                self.message.data,
            )
            with Writer(path) as bag:
                connection = bag.add_connection("/map", "nav_msgs/msg/OccupancyGrid", typestore=typestore)
                bag.write(connection, 0, typestore.serialize_ros1(message, "nav_msgs/msg/OccupancyGrid"))
        return path

    @cached_property
    def npy_map(self) -> Path:
        path = self.folder / "map.npy"
        np.save(path, self.occupied)
        return path

    @cached_property
    def json(self) -> Path:
        return self.trade_off.to_json(self.folder / "set.json")

    @cached_property
    def toml(self) -> Path:
        text = (
            'name = "one"\nseeds = 1\nbudget = { generations = 2 }\n[[problems]]\nrandom = { size = 8, p0 = 0.2, seeds = 1 }\n'
            '[[algorithms]]\nalgorithm = "NSGA2"\npop_size = 12\n'
        )
        return self.file("study.toml", text.encode())
