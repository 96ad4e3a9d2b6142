"""The report of a study as files."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.files import write_whole
from pymoo_gridpath.study.report.figures.style import check_formats
from pymoo_gridpath.study.report.page.blocks import PAGES, LinkedPages, Picture, latex, linked_files, markdown
from pymoo_gridpath.study.report.page.contents import Contents
from pymoo_gridpath.study.report.page.drawing import draw_all
from pymoo_gridpath.study.report.page.explorers import Rows, rows_of
from pymoo_gridpath.study.report.page.html import page
from pymoo_gridpath.study.report.results import Results, collect
from pymoo_gridpath.study.report.tables.csv_files import csv_files
from pymoo_gridpath.study.running.store import Store

# Folder of the figures.
_FIGURES = "figures"


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
        ``tests.csv``, the figures, and in ``explorer`` a page for each merged front, to look at its paths and choose one. The
        same runs give the same bytes. Figures and pages that a ``report.md`` of before links and the new one does not are
        deleted.

    Raises
    ------
    GridPathError
        If the folder holds no study, an argument is wrong, or a file cannot be written.
    """
    forms = check_formats(checks.names("formats", formats))
    checks.file_path("folder", folder)
    if output is not None:
        checks.file_path("output", output)
    if target is not None:
        target = checks.number("target", target, 0.0, 1.0, above=True, expected="a share above 0, at most 1")
    times = checks.flag("times", times)
    results = collect(Store(folder), target)
    output = Path(folder) / "report" if output is None else Path(output)
    return write_files(results, output, forms, times, rows_of(Store(folder), results))


def write_files(results: Results, directory: Path, forms: Sequence[str], times: bool, rows: Rows | None = None) -> list[Path]:
    """Write the page, the tables and the figures of measured runs into a folder, and return their paths."""
    _make(directory / _FIGURES)
    contents = Contents(results, times, rows)
    blocks = draw_all(contents.blocks(), forms)
    pictures = [block for block in blocks if isinstance(block, Picture)]
    drawn = {f"{_FIGURES}/{one.name}.{form}": data for one in pictures for form, data in one.files.items()}
    linked = [page for block in blocks if isinstance(block, LinkedPages) for page in block.pages]
    drawn |= {f"{PAGES}/{file}": str(text).encode() for _, file, text in linked}
    if linked:
        _make(directory / PAGES)
    # A report of fewer groups would leave figures of the earlier one behind. Other files may be the user's own.
    try:
        before = (directory / "report.md").read_text(encoding="utf-8", errors="replace")
    except OSError:
        before = ""
    earlier = [f"{part}/{name}" for part in (_FIGURES, PAGES) for name in linked_files(before, part)]
    for name in set(earlier) - set(drawn):
        _remove(directory / name)
    texts = {
        "index.html": page(blocks, f"Study {results.plan.name}"),
        "report.md": markdown(blocks, _FIGURES),
        "tables.tex": latex(blocks),
        **csv_files(results, contents.families, times),
    }
    written = [write_whole(directory / name, text.encode()) for name, text in texts.items()]
    return written + [write_whole(directory / name, data) for name, data in drawn.items()]


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"{folder}: the folder cannot be made ({error.strerror}), expected a writable place"
        raise GridPathError(message) from None


def _remove(file: Path) -> None:
    try:
        file.unlink(missing_ok=True)
    except OSError as error:
        raise GridPathError(f"{file}: the file of an earlier report cannot be removed ({error.strerror})") from None
