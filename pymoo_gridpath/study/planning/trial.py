"""Short runs of the algorithms of a study, so that settings that do not fit are refused before anything runs."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping
from typing import Any, NamedTuple

from pymoo.core.callback import Callback

from pymoo_gridpath.study.planning.build import build_algorithm, build_problem, build_termination
from pymoo_gridpath.study.planning.canonical import n_cells, steps_of
from pymoo_gridpath.study.planning.moving import clock_of, tried

# Of a trial, where the algorithm takes so few.
_POP_SIZE = 12
# Cells of a grid that a trial is made on itself: some hundredths of a second.
_MOST_CELLS = 10_000
# What stands in for larger ones: it has a path that advances along x and along y, with corners cut or not.
_STAND_IN = {"size": 32, "p0": 0.1, "seed": 1}
# pymoo compiles their survival anew in each process, some seconds long. NSGA-II takes the same settings of a study.
_SLOW_TO_COMPILE = ("AGEMOEA", "AGEMOEA2")


class Pair(NamedTuple):
    """A problem and an algorithm that is to solve it, both in canonical form.

    Attributes
    ----------
    problem, algorithm : dict
        See `pymoo_gridpath.study.planning.canonical.resolve`.
    grid : bytes or None
        The packed cells of a map.
    label : str
        The problem's.
    index : int
        The algorithm's among those of the study.
    """

    problem: Mapping[str, Any]
    algorithm: Mapping[str, Any]
    grid: bytes | None
    label: str
    index: int

    @property
    def kind(self) -> str:
        """The same for pairs of which one trial is enough: what operators and algorithms tell apart."""
        of_problem = [self.problem["representation"], self.problem["obstacles"], len(self.problem["objectives"])]
        of_problem.append("moving" in self.problem)
        return json.dumps([*of_problem, steps_of(self.problem["grid"]), self.algorithm], sort_keys=True)


def one_of_each_kind(pairs: list[Pair]) -> list[Pair]:
    """Return one pair of each kind, on the smallest grid."""
    found: dict[str, Pair] = {}
    for pair in pairs:
        known = found.setdefault(pair.kind, pair)
        if n_cells(pair.problem["grid"]) < n_cells(known.problem["grid"]):
            found[pair.kind] = pair
    return list(found.values())


def run_briefly(pair: Pair) -> None:
    """Raise what a run of a pair would, as far as two generations of a small population show that."""
    try:
        _run(_small(pair))
    except Exception:
        # The small population or the other grid may be to blame.
        _run(pair)


def _small(pair: Pair) -> Pair:
    problem, algorithm, grid = dict(pair.problem), dict(pair.algorithm), pair.grid
    stand_in = None
    if n_cells(problem["grid"]) > _MOST_CELLS:
        kept = steps_of(problem["grid"])
        last = _STAND_IN["size"] - 1
        grid, stand_in = None, _STAND_IN | kept
        metres = {key: problem["grid"][key] for key in ("resolution",) if key in problem["grid"]}
        problem |= {"grid": {"random": stand_in, **metres}, "start": [0, 0], "goal": [last, last]}
    if "moving" in problem:
        problem = tried(problem, stand_in)
    if "pop_size" in algorithm:
        algorithm["pop_size"] = min(algorithm["pop_size"], _POP_SIZE)
    if "n_offsprings" in algorithm.get("parameters", {}):
        few = min(algorithm["parameters"]["n_offsprings"], _POP_SIZE)
        algorithm["parameters"] = {**algorithm["parameters"], "n_offsprings": few}
    if algorithm.get("algorithm") in _SLOW_TO_COMPILE:
        algorithm["algorithm"] = "NSGA2"
    return pair._replace(problem=problem, algorithm=algorithm, grid=grid)


def _run(pair: Pair) -> None:
    problem = build_problem(pair.problem, pair.grid)
    algorithm: Any = build_algorithm(pair.algorithm, problem)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of so few members
        termination, clock = build_termination({"generations": 2}, algorithm), clock_of(problem, Callback())
        algorithm.setup(problem, termination=termination, seed=1, callback=clock)
        for _ in range(2):
            if algorithm.has_next():
                algorithm.next()
