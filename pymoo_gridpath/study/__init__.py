"""Comparison studies: which problems, algorithms, seeds and budget; running them anywhere; what came of it, with statistics."""

from pymoo_gridpath.lazy import lazy

# Imported where they are first used, since the command line reads this package for every command.
_HOMES = {
    "AlgorithmSpec": "specification.algorithm",
    "History": "running.record",
    "LocalProcesses": "running.processes",
    "MovingObstacles": "specification.moving",
    "Outcome": "running.runner",
    "ProblemSpec": "specification.problem",
    "QueryRange": "specification.problem",
    "RandomFamily": "specification.problem",
    "RunRecord": "running.record",
    "Store": "running.store",
    "Study": "specification.study",
    "compare": "report.comparison",
    "dask_executor": "running.executors",
    "load_study": "specification.toml_file",
    "plan_study": "planning.expand",
    "run_study": "running.runner",
    "write_report": "report.writing",
}

__all__ = sorted(_HOMES)  # pyright: ignore[reportUnsupportedDunderAll]
__getattr__, __dir__ = lazy(__name__, _HOMES)
