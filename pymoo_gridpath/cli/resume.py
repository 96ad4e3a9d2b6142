"""Plans that begin with the last population of an earlier one."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from pymoo_gridpath.cli.arguments import folder, options_besides, refuse_given
from pymoo_gridpath.errors import GridPathError, counted, visible

if TYPE_CHECKING:
    import numpy as np

# What a plan leaves for one that goes on: the genes of the last population of each run.
POPULATION = "population.npz"

# More runs than this nobody has waited for.
_MOST_RUNS = 1000

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
        If the folder does not hold the plan of a search, its problem cannot be made again, or an option is given that the
        stored plan decides.
    """
    import numpy as np

    from pymoo_gridpath.decision import load_json
    from pymoo_gridpath.decision.stored import StoredObjective

    refuse_given(arguments, arguments.decided_by_plan, "--resume, which takes the map and the problem from the folder")
    if "sampling" in (arguments.operators or {}):
        raise GridPathError("--operators sampling is not for --resume, which begins with the stored population")
    where = arguments.resume
    trade_off = load_json(where / "paths.json")
    problem, file = trade_off.problem, where / POPULATION
    unknown = [one.name for one in problem.objectives if isinstance(one, StoredObjective)]
    if unknown:
        raise GridPathError(
            f"{visible(where)}: what the objective {unknown[0]!r} costs is not stored, expected a plan without it"
        )
    try:
        with np.load(io.BytesIO(file.read_bytes()), allow_pickle=False) as arrays:
            found = [arrays[f"run_{k}"] for k in range(min(len(arrays.files), _MOST_RUNS))]
    except FileNotFoundError:
        raise GridPathError(f"{visible(file)}: no such file, expected the plan of an algorithm with a population") from None
    except Exception:
        # What is no archive, or none of these arrays, fails in almost any way.
        raise GridPathError(f"{visible(file)}: the populations cannot be read, expected the file as a plan wrote it") from None
    # An archive of none has none that fits.
    for X in found or [np.empty(0)]:
        fits = X.ndim == 2 and len(X) and X.shape[1] == problem.n_var and X.dtype.kind in "biuf"
        if not fits or not ((problem.xl <= X) & (problem.xu >= X)).all():
            raise GridPathError(
                f"{visible(file)}: a population is not of the problem in paths.json, expected those of one plan"
            )
    return Stored(problem, found, trade_off.meta["settings"], trade_off.meta["seed"])


def said(stored: Stored, where: Path) -> str:
    """Return in words what is begun with."""
    members = ", ".join(str(len(X)) for X in stored.populations)
    return (
        f"resumed: a new start from the last population of {counted(len(stored.populations), 'run')} in {visible(where)} "
        f"({members} members), not what going on would have given"
    )


def write_populations(results, folder: Path) -> list[Path]:
    """Write the last population of each run, and return the file; a planner has none to go on from."""
    import numpy as np

    from pymoo_gridpath.files import write_whole
    from pymoo_gridpath.planners import Planner

    file = folder / POPULATION
    if not results or any(isinstance(result.algorithm, Planner) for result in results):
        # Nor is there one of what stood here before.
        file.unlink(missing_ok=True)
        return []
    data = io.BytesIO()
    np.savez_compressed(data, **{f"run_{k}": result.pop.get("X") for k, result in enumerate(results)})
    return [write_whole(file, data.getvalue())]
