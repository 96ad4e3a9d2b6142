"""The report of a study: tables, figures, and one page that collects them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from pymoo_gridpath import checks

__all__ = ["write_report"]


def write_report(
    folder: str | os.PathLike[str],
    output: str | os.PathLike[str] | None = None,
    target: float | None = None,
    formats: str | Sequence[str] = ("png", "pdf"),
    times: bool = True,
) -> list[Path]:
    """Write the report of a study from what its folder holds, whether all runs are finished or not.

    Parameters
    ----------
    folder : path-like
        Of the study; it is only read, but for the output if that stands in it.
    output : path-like, optional
        Where the files go; by default ``report`` in the folder.
    target : float, optional
        The hypervolume ratio that "evaluations and seconds to target" ask for, by default the study's.
    formats : sequence of {"png", "pdf", "svg"}, default ("png", "pdf")
        Of the figures' files. The page holds its own.
    times : bool, default True
        Whether to report seconds, machines and versions. Without them, reports of the same study that ran elsewhere are equal.

    Returns
    -------
    list of pathlib.Path
        ``index.html`` (everything on one page), ``report.md``, ``tables.tex``, ``runs.csv``, ``problems.csv``, ``summary.csv``,
        ``tests.csv``, and the figures. The same runs give the same bytes. Figures that a ``report.md`` of before links and
        the new one does not are deleted.

    Raises
    ------
    GridPathError
        If the folder holds no study, an argument is wrong, or a file cannot be written.
    """
    # Imported here, so that the commands that do not report need not wait for matplotlib.
    from pymoo_gridpath.study.report.figures.style import check_formats
    from pymoo_gridpath.study.report.results import collect
    from pymoo_gridpath.study.report.writing import write_files
    from pymoo_gridpath.study.running.store import Store

    forms = check_formats(checks.names("formats", formats))
    checks.file_path("folder", folder)
    if output is not None:
        checks.file_path("output", output)
    if target is not None:
        target = checks.number("target", target, 0.0, 1.0, above=True, expected="a share above 0, at most 1")
    times = checks.flag("times", times)
    results = collect(Store(folder), target)
    return write_files(results, Path(folder) / "report" if output is None else Path(output), forms, times)
