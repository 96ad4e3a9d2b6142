"""Plans that begin with the last population of an earlier one."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from pymoo_gridpath.cli.arguments import folder, options_besides, refuse_given
from pymoo_gridpath.errors import GridPathError, counted, visible

if TYPE_CHECKING:
    import numpy as np

# What a plan leaves for one that goes on: the genes of the last population of each run, and what the ground costs.
POPULATION = "population.npz"

# More runs than this, and a few arrays besides, nobody has waited for.
_MOST_ARRAYS = 1000

# All else is said by the stored plan.
_HEEDED = (
    *("resume", "algorithm", "operators", "pop_size", "generations", "seed"),
    *("output", "waypoints", "spacing", "speed", "html", "show", "units"),
)


class Stored(NamedTuple):
    """What a stored plan says: its problem, the last population of each run, and what made them."""

    problem: Any
    populations: list[np.ndarray]
    settings: dict
    seed: Any


def add_resume(plan, group) -> None:
    """Add the option `--resume`, after all others."""
    group.add_argument(
        "--resume",
        type=folder,
        metavar="DIR",
        help="begin with the last populations that a plan left in this folder, on its map and with its query, representation "
        "and objectives: a new start from there, with random numbers of its own",
    )
    plan.set_defaults(decided_by_plan=options_besides(plan, _HEEDED))


def read_stored(arguments) -> Stored:
    """Return what a plan has left in the folder to resume from.

    Raises
    ------
    GridPathError
        If the folder does not hold the plan of a search, its problem cannot be made again, what is stored does not go together,
        or an option is given that the stored plan decides.
    """
    import numpy as np

    from pymoo_gridpath.decision import load_json

    refuse_given(arguments, arguments.decided_by_plan, "--resume, which takes the map and the problem from the folder")
    if "sampling" in (arguments.operators or {}):
        raise GridPathError("--operators sampling is not for --resume, which begins with the stored population")
    where = arguments.resume
    trade_off = load_json(where / "paths.json")
    problem, file = trade_off.problem, where / POPULATION
    try:
        with np.load(io.BytesIO(file.read_bytes()), allow_pickle=False) as arrays:
            stored = {key: arrays[key] for key in arrays.files[:_MOST_ARRAYS]}
    except FileNotFoundError:
        raise GridPathError(f"{visible(file)}: no such file, expected the plan of an algorithm with a population") from None
    except Exception:
        # What is no archive, or none of these arrays, fails in almost any way.
        raise GridPathError(f"{visible(file)}: the populations cannot be read, expected the file as a plan wrote it") from None
    problem = _with_costs(problem, stored, trade_off, where)
    found = [stored[key] for key in (f"run_{k}" for k in range(len(stored))) if key in stored]
    # An archive of none has none that fits.
    for X in found or [np.empty(0)]:
        fits = X.ndim == 2 and len(X) and X.shape[1] == problem.n_var and X.dtype.kind in "biuf"
        if not fits or not ((problem.xl <= X) & (problem.xu >= X)).all():
            raise GridPathError(
                f"{visible(file)}: a population is not of the problem in paths.json, expected those of one plan"
            )
    return Stored(problem, found, trade_off.meta["settings"], trade_off.meta["seed"])


def _with_costs(problem, stored: dict[str, np.ndarray], trade_off, where: Path):
    """Return the problem with the objectives whose costs are stored, each of its class again."""
    import numpy as np

    from pymoo_gridpath.decision.stored import StoredObjective
    from pymoo_gridpath.objectives import OBJECTIVES
    from pymoo_gridpath.problems import GridPathProblem

    objectives = list(problem.objectives)
    for k, stated in enumerate(trade_off.meta["settings"]["objectives"]):
        name = objectives[k].name
        if not isinstance(objectives[k], StoredObjective):
            continue
        costs = {key: stored.get(_key(name, key)) for key in (OBJECTIVES[name].files if name in OBJECTIVES else ())}
        if not costs or any(values is None for values in costs.values()):
            raise GridPathError(
                f"{visible(where)}: what the objective {name!r} costs is not stored, expected a plan without it"
            )
        objectives[k] = OBJECTIVES[name](**{**costs, **{key: value for key, value in stated.items() if key != "name"}})
    if objectives == list(problem.objectives):
        return problem
    settings = problem.obstacles, problem.penalty, problem.potential_limit
    made = GridPathProblem(problem.grid, problem.start, problem.goal, problem.representation, objectives, *settings)
    if not np.allclose(np.asarray(made.evaluate(trade_off.X, return_values_of=["F"])), trade_off.F):
        raise GridPathError(f"{visible(where)}: what the ground costs does not fit paths.json, expected the files of one plan")
    return made


def _key(objective: str, argument: str) -> str:
    """Return what the costs that an objective was made of are stored as."""
    return f"{objective}.{argument}"


def said(stored: Stored, where: Path) -> str:
    """Return in words what is begun with."""
    members = ", ".join(str(len(X)) for X in stored.populations)
    return (
        f"resumed: a new start from the last population of {counted(len(stored.populations), 'run')} in {visible(where)} "
        f"({members} members), not what going on would have given"
    )


def write_populations(results, folder: Path) -> list[Path]:
    """Write the last population of each run and what the ground costs, and return the file; a planner leaves none."""
    import numpy as np

    from pymoo_gridpath.files import write_whole
    from pymoo_gridpath.planners import Planner

    file = folder / POPULATION
    if not results or any(isinstance(result.algorithm, Planner) for result in results):
        # Nor is there one of what stood here before.
        file.unlink(missing_ok=True)
        return []
    objectives = results[0].problem.objectives
    data = io.BytesIO()
    np.savez_compressed(
        data,
        **{f"run_{k}": result.pop.get("X") for k, result in enumerate(results)},
        **{_key(one.name, key): getattr(one, key) for one in objectives for key in one.files},
    )
    return [write_whole(file, data.getvalue())]
