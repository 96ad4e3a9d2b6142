"""A report as one HTML page that needs no other file."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterable, Iterator, Sequence

from pymoo_gridpath.study.report.page.blocks import PAGES, Block, Caution, Fold, Heading, LinkedPages, Listing, Picture, Text
from pymoo_gridpath.study.report.page.contents import unique_slugs
from pymoo_gridpath.study.report.tables.table import Table

# Of the page for one of a picture.
_PIXELS = 0.66

_CSS = """
body { margin: 0 auto; max-width: 60rem; padding: 1rem;
  font: 1rem/1.5 system-ui, sans-serif; color: #1c1f23; background: #fff; }
h1, h2, h3 { line-height: 1.25; overflow-wrap: anywhere; }
h2 { margin-top: 2.5rem; border-bottom: 1px solid #d5d8dc; }
p, li { overflow-wrap: anywhere; max-width: 46rem; }
nav ul { columns: 14rem; padding-left: 1.2rem; margin: 0; }
.caution { border-left: 4px solid #b8860b; background: #fff8e1; padding: 0.5rem 1rem; margin: 1rem 0; }
.caution p { margin: 0.3rem 0; }
.scroll { overflow-x: auto; margin: 1rem 0 0; }
table { border-collapse: collapse; min-width: min(100%, 30rem); font-size: 0.875rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: 600; padding-bottom: 0.4rem; }
th, td { padding: 0.25rem 0.7rem 0.25rem 0; text-align: right; vertical-align: top; font-weight: 400; white-space: nowrap; }
thead th { border-top: 1.5px solid #1c1f23; border-bottom: 1px solid #1c1f23; white-space: normal; vertical-align: bottom; }
tbody tr:last-child > * { border-bottom: 1.5px solid #1c1f23; }
tbody tr:hover { background: #f2f5f8; }
.name { text-align: left; white-space: normal; min-width: 2ch; max-width: 24rem; overflow-wrap: break-word; }
.note { font-size: 0.8125rem; color: #4a4f57; margin: 0.3rem 0 1rem; }
figure { margin: 1.5rem 0; }
figure img { max-width: 100%; height: auto; }
figcaption { font-size: 0.875rem; color: #33373d; max-width: 46rem; }
details { margin: 1rem 0; }
pre { font-size: 0.8125rem; background: #f6f7f9; padding: 0.5rem 1rem; overflow-x: auto; }
""".strip()


def page(blocks: Sequence[Block], title: str) -> str:
    """Return the page.

    Parameters
    ----------
    blocks : sequence of Block
        With drawings already drawn.
    title : str
    """
    headings = [block.text for block in blocks if isinstance(block, Heading) and block.level == 2]
    ids = unique_slugs(headings)
    anchors = iter(ids)
    links = "\n".join(
        f'<li><a href="#{anchor}">{html.escape(text)}</a></li>' for text, anchor in zip(headings, ids, strict=True)
    )
    lines = [
        "<!DOCTYPE html>",
        '<html lang="en">',
        "<head>",
        '<meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{html.escape(title)}</title>",
        f"<style>\n{_CSS}\n</style>",
        "</head>",
        "<body>",
    ]
    first = 1 if blocks and isinstance(blocks[0], Heading) else 0
    lines += _rendered(blocks[:first], anchors)
    if links:
        lines.append(f'<nav aria-label="Contents"><ul>\n{links}\n</ul></nav>')
    lines += _rendered(blocks[first:], anchors)
    return "\n".join([*lines, "</body>", "</html>", ""])


def _rendered(blocks: Iterable[Block], anchors: Iterator[str]) -> list[str]:
    """Return the lines of blocks; each heading of level 2 takes the next anchor."""
    lines = []
    for block in blocks:
        if isinstance(block, Heading):
            anchor = f' id="{next(anchors)}"' if block.level == 2 else ""
            lines.append(f"<h{block.level}{anchor}>{html.escape(block.text)}</h{block.level}>")
        elif isinstance(block, Text):
            lines.append(f"<p>{html.escape(block.text)}</p>")
        elif isinstance(block, Caution):
            inner = "".join(f"<p>{html.escape(text)}</p>" for text in block.texts)
            lines.append(f'<div class="caution" role="note"><strong>Caution</strong>{inner}</div>')
        elif isinstance(block, Listing):
            lines.append(f"<pre>{html.escape(block.text)}</pre>")
        elif isinstance(block, Table):
            lines.append(block.html())
        elif isinstance(block, Picture):
            lines.append(_figure(block))
        elif isinstance(block, LinkedPages):
            links = (f'<a href="{PAGES}/{file}">{html.escape(label)}</a>' for label, file, _ in block.pages)
            lines.append(f"<p>{html.escape(block.text)} {', '.join(links)}.</p>")
        elif isinstance(block, Fold):
            inner = "\n".join(_rendered(block.blocks, anchors))
            lines.append(f"<details><summary>{html.escape(block.title)}</summary>\n{inner}\n</details>")
        else:
            raise TypeError(f"a drawing cannot be shown before it is drawn: {block.name}")
    return lines


def _figure(picture: Picture) -> str:
    data = base64.b64encode(picture.png).decode()
    # The width that the file states, so that all figures have letters of one size.
    width = round(int.from_bytes(picture.png[16:20], "big") * _PIXELS)
    caption = html.escape(picture.caption)
    # The caption says what there is to see.
    image = f'<img alt="{html.escape(picture.name)}" width="{width}" src="data:image/png;base64,{data}">'
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"
