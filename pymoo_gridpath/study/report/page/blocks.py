"""What a report is made of, in no format yet, and its text in Markdown and LaTeX."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from matplotlib.figure import Figure

from pymoo_gridpath.study.report.tables.table import LATEX_HEAD, Table, escape_latex, escape_markdown

# Of a table in LaTeX, which is not broken across pages.
_MOST_ROWS = 50


@dataclass(frozen=True)
class Heading:
    """A heading of level 1 (the title) to 3."""

    text: str
    level: int = 2


@dataclass(frozen=True)
class Text:
    """A paragraph."""

    text: str


@dataclass(frozen=True)
class Caution:
    """Sentences that a reader must not miss, one each."""

    texts: tuple[str, ...]


@dataclass(frozen=True)
class Listing:
    """The text of a file, shown as it is."""

    text: str


@dataclass(frozen=True)
class Drawing:
    """A figure that is still to be drawn.

    Attributes
    ----------
    name : str
        Of its files.
    caption : str
    draw : callable
        Returns the figure, or None if there is nothing to draw.
    otherwise : str
        What to say then.
    """

    name: str
    caption: str
    draw: Callable[[], Figure | None]
    otherwise: str


@dataclass(frozen=True)
class Picture:
    """A drawn figure: its caption, what a page shows, and its files by format."""

    name: str
    caption: str
    png: bytes
    files: dict[str, bytes]


@dataclass(frozen=True)
class LinkedPages:
    """Links to pages of their own in a folder beside the report.

    Attributes
    ----------
    text : str
        What stands before the links.
    pages : tuple of (str, str, str or callable)
        The words of each link, the name of its file, and its page, or what returns it, or None if there is none.
    """

    text: str
    pages: tuple[tuple[str, str, str | Callable[[], str | None]], ...]


@dataclass(frozen=True)
class Fold:
    """Blocks that a page shows on demand."""

    title: str
    blocks: tuple[Block, ...]


Block = Heading | Text | Caution | Listing | Table | Drawing | Picture | LinkedPages | Fold

# Folder of the pages that a report links.
PAGES = "explorer"


def markdown(blocks: Iterable[Block], folder: str) -> str:
    """Return blocks in Markdown; pictures are linked as PNG files of a folder."""
    return "\n".join(_markdown(block, folder) for block in blocks)


def _markdown(block: Block, folder: str) -> str:
    if isinstance(block, Heading):
        return f"{'#' * block.level} {escape_markdown(block.text)}\n"
    if isinstance(block, Text):
        return f"{escape_markdown(block.text)}\n"
    if isinstance(block, Caution):
        return "\n".join(f"> **Caution.** {escape_markdown(text)}\n" for text in block.texts)
    if isinstance(block, Listing):
        return "".join(f"    {line}\n" for line in block.text.splitlines())
    if isinstance(block, Table):
        return block.markdown()
    if isinstance(block, Picture):
        return _markdown_picture(block, folder)
    if isinstance(block, LinkedPages):
        links = ", ".join(f"[{escape_markdown(label)}]({PAGES}/{file})" for label, file, _ in block.pages)
        return f"{escape_markdown(block.text)} {links}.\n"
    if isinstance(block, Fold):
        if len(block.blocks) == 1 and isinstance(block.blocks[0], Table):
            # Its caption is its title.
            return markdown(block.blocks, folder)
        return f"**{escape_markdown(block.title)}**\n\n{markdown(block.blocks, folder)}"
    raise TypeError(f"a drawing has no text before it is drawn: {block.name}")


def _markdown_picture(picture: Picture, folder: str) -> str:
    """Return a picture with links to all its files, by which `linked_files` finds them."""
    caption = escape_markdown(picture.caption)
    if not picture.files:
        return f"{caption}\n"
    form = "png" if "png" in picture.files else next(iter(picture.files))
    others = ", ".join(f"[{other}]({folder}/{picture.name}.{other})" for other in picture.files if other != form)
    return f"![{picture.name}]({folder}/{picture.name}.{form})\n\n{caption}{f' Also as {others}.' if others else ''}\n"


def linked_files(text: str, folder: str) -> list[str]:
    """Return the names of the figures, or pages, in a folder that a report in Markdown links; its texts link none."""
    if not text.startswith("# Study "):
        return []
    name = r"(?:ratios|convergence|attainment|fronts|ranks|front)[A-Za-z0-9.-]*\.(?:png|pdf|svg|html)"
    return re.findall(rf"\]\({re.escape(folder)}/({name})\)", text)


def latex(blocks: Iterable[Block]) -> str:
    """Return the tables of blocks in LaTeX, and their warnings as comments."""
    parts = [LATEX_HEAD]
    for block in blocks:
        if isinstance(block, Heading):
            parts.append(f"% -- {' '.join(block.text.splitlines())}\n")
        elif isinstance(block, Caution):
            parts += [f"% Caution. {escape_latex(text)}\n" for text in block.texts]
        for inner in block.blocks if isinstance(block, Fold) else (block,):
            if isinstance(inner, Table) and inner.for_papers:
                long = len(inner.rows) > _MOST_ROWS
                parts.append(f"% {inner.name} is too long for a page\n" if long else inner.latex())
    return "\n".join(parts)
