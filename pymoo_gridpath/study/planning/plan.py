"""The plan of a study: every run that it asks for, each with its key."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

from pymoo_gridpath.algorithms import CAPABILITIES
from pymoo_gridpath.memory import needed
from pymoo_gridpath.planners.base import is_reference
from pymoo_gridpath.study.planning.canonical import n_cells, resolve
from pymoo_gridpath.study.planning.moving import budget_of
from pymoo_gridpath.study.planning.stored import check_plan
from pymoo_gridpath.study.specification import own
from pymoo_gridpath.study.specification.kinds import is_monotone, objective_name
from pymoo_gridpath.study.specification.operators import planner_of

#: Runs that a study may have.
MAX_RUNS = 1_000_000

#: Part of every key. Whoever changes what the canonical dictionaries mean raises it, so that old results do not pass for new.
SCHEMA = 2


class Task(NamedTuple):
    """One run, self-contained: small, picklable, and without need of any file.

    Attributes
    ----------
    key : str
        32 hexadecimal digits, see `run_key`.
    problem, algorithm : dict
        What `pymoo_gridpath.study.planning.build` makes the problem and the algorithm of.
    budget : dict or None
        ``{"evaluations": n}`` or ``{"generations": n}``; None for the exact front, which has its own.
    seed : int
    grid : bytes or None
        The packed cells of a map, see `pymoo_gridpath.study.planning.build.pack_grid`; None where the problem says how its grid
        is made.
    """

    key: str
    problem: dict[str, Any]
    algorithm: dict[str, Any]
    budget: dict[str, int] | None
    seed: int
    grid: bytes | None


@dataclass(frozen=True)
class PlannedProblem:
    """One problem of a study.

    Attributes
    ----------
    label : str
        Its name in tables, unique in the study: the group's, with the seed or the number of the query if there are several.
    group : str
        The name of the table in the study file that it stems from.
    spec : dict
        What it is, in canonical form.
    grid : bytes or None
        The packed cells of a map; None for random grids, and in a plan read from a file.
    reference : str or None
        The key of the run whose front it is measured against; None if no exact front can be had or is wanted.
    no_reference : str
        Why no exact front can be had, so that no run looks for it; empty otherwise.
    source : str
        Where its map comes from, in words; empty for random grids. Part of no key: the cells of the map are.
    place : dict or None
        What of its map changes no result, but what pages show, see `pymoo_gridpath.study.planning.build.place_of_grid`; None
        where there is nothing of that.
    original : bytes or None
        The packed cells of the map before its obstacles grew, if they did; None in a plan read from a file.
    """

    label: str
    group: str
    spec: dict[str, Any]
    grid: bytes | None = None
    reference: str | None = None
    source: str = ""
    place: dict[str, Any] | None = None
    original: bytes | None = None
    no_reference: str = ""


@dataclass(frozen=True)
class PlannedAlgorithm:
    """One algorithm of a study.

    Attributes
    ----------
    label : str
        Its name in tables, unique in the study.
    spec : dict
        What it is, as written, with the defaults that hold for every problem.
    overrides : dict
        What it changes in the problems it solves, such as the representation.
    """

    label: str
    spec: dict[str, Any]
    overrides: dict[str, Any]


@dataclass(frozen=True)
class PlannedRun:
    """One run of a study.

    Attributes
    ----------
    key : str
    problem : int
        Index of its problem.
    algorithm : int or None
        Index of its algorithm; None if the run is but the reference of its problem.
    seed : int
    """

    key: str
    problem: int
    algorithm: int | None
    seed: int


@dataclass(frozen=True)
class Plan:
    """Every run of a study.

    Attributes
    ----------
    name : str
    budget : dict
        ``{"evaluations": n}`` or ``{"generations": n}``, of runs on problems whose obstacles do not move; empty without any.
    target : float
        Share of the reference's hypervolume that "to target" asks for.
    problems : tuple of PlannedProblem
    algorithms : tuple of PlannedAlgorithm
    runs : tuple of PlannedRun
        Each key once; those that others are measured against first.
    reference : dict or None
        The exact algorithm of the references; None if the study wants none.
    """

    name: str
    budget: dict[str, int]
    target: float
    problems: tuple[PlannedProblem, ...]
    algorithms: tuple[PlannedAlgorithm, ...]
    runs: tuple[PlannedRun, ...]
    reference: dict[str, Any] | None = None

    def task(self, run: PlannedRun) -> Task:
        """Return what is needed to execute a run wherever."""
        planned = self.problems[run.problem]
        if run.algorithm is None:
            assert self.reference is not None
            spec, overrides = self.reference, {}
        else:
            spec, overrides = self.algorithms[run.algorithm].spec, self.algorithms[run.algorithm].overrides
        problem, algorithm = resolve(planned.spec, spec, overrides)
        budget = None if has_own_budget(algorithm) else budget_of(problem, self.budget)
        return Task(run.key, problem, algorithm, budget, run.seed, planned.grid)

    def to_json(self) -> dict[str, Any]:
        """Return the plan without the grids, of values that `json` writes."""
        plan = {**vars(self), "problems": [asdict(item) for item in self.problems]}
        for problem in plan["problems"]:
            del problem["grid"], problem["original"]
        plan["algorithms"] = [asdict(item) for item in self.algorithms]
        # Ten thousands of them, so that names are left out.
        plan["runs"] = [[run.key, run.problem, run.algorithm, run.seed] for run in self.runs]
        return plan

    @classmethod
    def from_json(cls, data: Mapping[str, Any]) -> Plan:
        """Return the plan that `to_json` wrote, without grids.

        Raises
        ------
        StudyError
            If it is no such plan: something is missing, of another type, or does not belong together.
        """
        check_plan(data)
        return cls(
            **{
                **data,
                "problems": tuple(PlannedProblem(**item) for item in data["problems"]),
                "algorithms": tuple(PlannedAlgorithm(**item) for item in data["algorithms"]),
                "runs": tuple(PlannedRun(*item) for item in data["runs"]),
            }
        )


def has_own_budget(algorithm: Mapping[str, Any]) -> bool:
    """Whether a canonical algorithm is a planner, which ends by itself or a budget of its own, and not by the study's."""
    content = algorithm.get("algorithm")
    return content.get("planner", False) if isinstance(content, Mapping) else planner_of(content) is not None


def is_deterministic(algorithm: Mapping[str, Any]) -> bool:
    """Whether a canonical algorithm draws no random number, so that one seed is enough."""
    return _says(algorithm, "deterministic")


def is_truth(algorithm: Mapping[str, Any]) -> bool:
    """Whether a complete result of a canonical algorithm is what others are measured against."""
    planner = planner_of(algorithm.get("algorithm"))
    if planner is not None:
        return is_reference(planner, algorithm.get("parameters", {}))
    return _says(algorithm, "reference")


def _says(algorithm: Mapping[str, Any], flag: str) -> bool:
    content = algorithm.get("algorithm")
    if content is None:
        return False
    if isinstance(content, Mapping):
        return content[flag]
    # Not by what is registered, which may import what a stored plan names.
    return getattr(planner_of(content) or CAPABILITIES[content], flag)


def run_key(problem: Mapping[str, Any], algorithm: Mapping[str, Any], budget: Mapping[str, int] | None, seed: int) -> str:
    """Return the key of a run: a hash of all that its result depends on, but for the versions of the software.

    Of files that objectives are made of it says what they hold, and not where they are.

    Parameters
    ----------
    problem, algorithm : mapping
        In canonical form, see `pymoo_gridpath.study.planning.canonical.resolve`.
    budget : mapping or None
    seed : int

    Returns
    -------
    str
        The first 32 hexadecimal digits of the SHA-256 of their JSON.
    """
    problem = {**problem, "objectives": [_without_places(one) for one in problem["objectives"]]}
    content = {"schema": SCHEMA, "problem": problem, "algorithm": algorithm, "budget": budget, "seed": seed}
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def _without_places(objective: Any) -> Any:
    """Return an objective in canonical form, of its files what they hold and not where they are."""
    if isinstance(objective, str) or "files" not in objective:
        return objective
    arguments = {key: value for key, value in objective["arguments"].items() if key not in objective["files"]}
    return {**objective, "arguments": arguments}


def needed_for(task: Task) -> str:
    """Return what a run costs in memory, in words."""
    problem = task.problem
    turn = "turn" in map(objective_name, problem["objectives"])
    representation = problem["representation"]
    return needed(
        own.shown(representation),
        is_monotone(representation),
        n_cells(problem["grid"]),
        _says(task.algorithm, "reference"),
        turn,
    )
