"""The files of a report."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.files import write_whole
from pymoo_gridpath.study.report.page.blocks import Picture, latex, linked_files, markdown
from pymoo_gridpath.study.report.page.contents import Contents
from pymoo_gridpath.study.report.page.drawing import draw_all
from pymoo_gridpath.study.report.page.html import page
from pymoo_gridpath.study.report.results import Results
from pymoo_gridpath.study.report.tables.csv_files import csv_files

# Folder of the figures.
_FIGURES = "figures"


def write_files(results: Results, directory: Path, forms: Sequence[str], times: bool) -> list[Path]:
    """Write the page, the tables and the figures of measured runs into a folder, and return their paths."""
    figures = directory / _FIGURES
    try:
        figures.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"{figures}: the folder cannot be made ({error.strerror}), expected a writable place"
        raise GridPathError(message) from None
    contents = Contents(results, times)
    blocks = draw_all(contents.blocks(), forms)
    pictures = [block for block in blocks if isinstance(block, Picture)]
    drawn = {f"{picture.name}.{form}": data for picture in pictures for form, data in picture.files.items()}
    # A report of fewer groups would leave figures of the earlier one behind. Other files may be the user's own.
    try:
        earlier = linked_files((directory / "report.md").read_text(encoding="utf-8", errors="replace"), _FIGURES)
    except OSError:
        earlier = []
    for name in set(earlier) - set(drawn):
        _remove(figures / name)
    texts = {
        "index.html": page(blocks, f"Study {results.plan.name}"),
        "report.md": markdown(blocks, _FIGURES),
        "tables.tex": latex(blocks),
        **csv_files(results, contents.families, times),
    }
    written = [write_whole(directory / name, text.encode()) for name, text in texts.items()]
    return written + [write_whole(figures / name, data) for name, data in drawn.items()]


def _remove(file: Path) -> None:
    try:
        file.unlink(missing_ok=True)
    except OSError as error:
        raise GridPathError(f"{file}: the file of an earlier report cannot be removed ({error.strerror})") from None
