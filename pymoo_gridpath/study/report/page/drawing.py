"""Drawings made into pictures, one at a time so that few figures are in memory, and pages to link."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pymoo_gridpath.study.report.figures.style import rendered, report_style
from pymoo_gridpath.study.report.page.blocks import Block, Drawing, LinkedPages, Picture, Text


def draw_all(blocks: Iterable[Block], formats: Sequence[str]) -> list[Block]:
    """Return blocks with every drawing replaced by its picture, or by what to say if there is nothing to draw, and pages made.

    Parameters
    ----------
    blocks : iterable of Block
    formats : sequence of {"png", "pdf", "svg"}
        Of the files.
    """
    made = [
        _drawn(block, formats) if isinstance(block, Drawing) else _made(block) if isinstance(block, LinkedPages) else block
        for block in blocks
    ]
    return [block for block in made if not isinstance(block, LinkedPages) or block.pages]


def _made(block: LinkedPages) -> LinkedPages:
    """Return links to those pages that there are."""
    pages = ((label, file, page() if callable(page) else page) for label, file, page in block.pages)
    return LinkedPages(block.text, tuple((label, file, page) for label, file, page in pages if page is not None))


def _drawn(drawing: Drawing, formats: Sequence[str]) -> Block:
    with report_style():
        figure = drawing.draw()
        if figure is None:
            return Text(drawing.otherwise)
        # Laid out once for all formats, which takes as long as drawing.
        engine = figure.get_layout_engine()
        if engine is not None:
            engine.execute(figure)
            figure.set_layout_engine("none")
        # The page shows the PNG, whichever files are asked for.
        files = {form: rendered(figure, form) for form in dict.fromkeys(["png", *formats])}
    return Picture(drawing.name, drawing.caption, files["png"], {form: files[form] for form in formats})
