"""Small pictures of grids and paths, made of nothing but arrays: for notebooks and terminals.

Everything here takes arrays ``[y, x]`` with y up and cells (x, y), and knows no class of the package, so that each of them can
show itself.
"""

from __future__ import annotations

import base64
import html
import io
import os
import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageDraw

# Colours of Okabe and Ito's palette, by what paths go by.
PALETTE = {
    "shortest": "#0072B2",
    "safest": "#009E73",
    "smoothest": "#D55E00",
    "knee": "#CC3377",
    "earliest": "#56B4E9",
    "widest": "#E69F00",
    "cheapest": "#8C4A2F",
    "flattest": "#7A7A00",
}
OCCUPIED, GROWN, UNKNOWN, OTHERS, INK = "#3b3f45", "#8fa3bf", "#b9bec6", "#8a8f98", "#111418"
# Unknown cells that count as occupied.
UNSEEN = "#6f757d"

# The longer side of a picture is at most so many dots, and a cell is no larger than this.
_MOST_DOTS, _MOST_CELL = 320, 10

# On a terminal each of these covers those before it, where a character stands for several cells.
_FREE, _MAYBE, _NEAR, _UNSEEN, _BLOCKED, _OTHER, _FIRST = range(7)


class Line(NamedTuple):
    """A path to draw: its cells (x, y), shape (n, 2), its colour, and what it is called, if anything."""

    cells: np.ndarray
    color: str
    name: str = ""


class Scene(NamedTuple):
    """What is to be drawn: occupied cells, shape (height, width), unknown ones, paths and marked cells.

    Attributes
    ----------
    occupied : numpy.ndarray of bool
    unknown : numpy.ndarray of bool, optional
        Of these, too, some may be occupied.
    others : sequence of numpy.ndarray
        Cells of paths that stay in the background.
    lines : sequence of Line
    start, goal : (int, int), optional
    grown : numpy.ndarray of bool, optional
        Which occupied cells are so because obstacles grew by the robot's size.
    """

    occupied: np.ndarray
    unknown: np.ndarray | None = None
    others: Sequence[np.ndarray] = ()
    lines: Sequence[Line] = ()
    start: tuple[int, int] | None = None
    goal: tuple[int, int] | None = None
    grown: np.ndarray | None = None

    def cropped(self, x0: int, y0: int, x1: int, y1: int) -> Scene:
        """Return the part of the scene from the cell (x0, y0) on and up to (x1, y1), which is not in it."""
        part, corner = (slice(y0, y1), slice(x0, x1)), np.array([x0, y0])
        return Scene(
            self.occupied[part],
            None if self.unknown is None else self.unknown[part],
            [cells - corner for cells in self.others],
            [line._replace(cells=line.cells - corner) for line in self.lines],
            *(None if end is None else (end[0] - x0, end[1] - y0) for end in (self.start, self.goal)),
            grown=None if self.grown is None else self.grown[part],
        )


# -- pictures for notebooks -----------------------------------------------------------------------------------------------


def png(scene: Scene) -> bytes:
    """Return a scene as a PNG file of at most 320 dots a side.

    A cell is a square of dots, or where there are too many, a dot stands for a square of cells and shows the darkest, so that
    thin walls stay in sight.
    """
    height, width = scene.occupied.shape
    shrink = -(-max(height, width) // _MOST_DOTS)
    size = 1 if shrink > 1 else max(1, min(_MOST_CELL, _MOST_DOTS // max(height, width)))
    codes = _shrunk(_codes(scene), shrink)[::-1].repeat(size, axis=0).repeat(size, axis=1)
    picture = Image.fromarray(codes, mode="P")
    colors = ["#ffffff", UNKNOWN, GROWN, UNSEEN, OCCUPIED, OTHERS, INK, *(line.color for line in scene.lines)]
    picture.putpalette([part for color in colors for part in bytes.fromhex(color[1:])])
    draw = ImageDraw.Draw(picture)

    def place(cells) -> list[tuple[float, float]]:
        x, y = (np.asarray(cells, dtype=float).reshape(-1, 2).T + 0.5) * (size / shrink)
        return list(zip(x.tolist(), (len(codes) - y).tolist(), strict=True))

    thin, ink = max(1, size // 6), _FIRST
    for cells in scene.others:
        draw.line(place(cells), fill=_OTHER, width=thin)
    for k, line in enumerate(scene.lines):
        draw.line(place(line.cells), fill=ink + 1 + k, width=thin + 1, joint="curve")
    for cell, square in ((scene.start, False), (scene.goal, True)):
        if cell is not None:
            ((x, y),), r = place(cell), max(3, 0.35 * size)
            shape = draw.rectangle if square else draw.ellipse
            shape((x - r, y - r, x + r, y + r), fill=_FREE, outline=ink, width=max(1, int(r / 3)))
    # The edge of the map, where its cells have the colour of the page.
    draw.rectangle((0, 0, picture.width - 1, picture.height - 1), outline=_MAYBE)
    file = io.BytesIO()
    picture.save(file, "PNG", optimize=True)
    return file.getvalue()


def page(picture: bytes, title: str, rows: Mapping[str, object] | Sequence[Sequence[object]], alt: str) -> str:
    """Return a picture beside a small table, as HTML that also an untrusted notebook shows.

    Parameters
    ----------
    picture : bytes
        A PNG file.
    title : str
    rows : mapping or sequence of sequences
        What a table of two columns says, or all rows of a table, the first of which is its head.
    alt : str
        What the picture shows, in words.
    """
    if isinstance(rows, Mapping):
        head, body = "", [(key, value) for key, value in rows.items()]
    else:
        head = f"<tr>{''.join(f'<th>{_escape(cell)}</th>' for cell in rows[0])}</tr>"
        body = list(rows[1:])
    lines = ""
    for first, *rest in body:
        lines += f"<tr><th>{_escape(first)}</th>{''.join(f'<td>{_escape(cell)}</td>' for cell in rest)}</tr>"
    image = f'<img alt="{_escape(alt)}" src="data:image/png;base64,{base64.b64encode(picture).decode()}">'
    table = f"<table>{head}{lines}</table>"
    return f"<div><strong>{_escape(title)}</strong><table><tr><td>{image}</td><td>{table}</td></tr></table></div>"


def _escape(text: object) -> str:
    return html.escape(str(text))


def _codes(scene: Scene) -> np.ndarray:
    codes = np.full(scene.occupied.shape, _FREE, dtype=np.uint8)
    codes[scene.occupied] = _BLOCKED
    if scene.unknown is not None:
        codes[scene.unknown] = np.where(scene.occupied[scene.unknown], _UNSEEN, _MAYBE)
    if scene.grown is not None:
        codes[scene.grown] = _NEAR
    return codes


def _shrunk(codes: np.ndarray, factor: int) -> np.ndarray:
    """Return the largest code of each square of so many cells a side; squares at the right and the top may be smaller."""
    if factor == 1:
        return codes
    padded = np.pad(codes, [(0, -side % factor) for side in codes.shape])
    height, width = (side // factor for side in padded.shape)
    return padded.reshape(height, factor, width, factor).max(axis=(1, 3))


# -- half blocks for terminals --------------------------------------------------------------------------------------------

# Of the 256 colours that terminals know, the nearest.
_TERMINAL = {"free": 255, "unknown": 250, "grown": 110, "unseen": 243, "occupied": 238, "others": 245, "start": 16, "goal": 16}
_MARKS = {"upper": "\u2580", "lower": "\u2584", "both": "\u2588", "path": "\u2022"}


def can_draw(stream) -> bool:
    """Whether a stream is a terminal that shows blocks: pipes and files get none."""
    try:
        if not stream.isatty() or os.environ.get("TERM") == "dumb":
            return False
        "".join(_MARKS.values()).encode(stream.encoding or "ascii")
    except (AttributeError, LookupError, UnicodeEncodeError, ValueError):  # a stand-in, an unknown encoding, a closed stream
        return False
    return True


def half_blocks(scene: Scene, columns: int, lines: int, colors: bool = True) -> str:
    """Return a scene as text for a terminal, two rows of cells in a line of characters.

    Parameters
    ----------
    scene : Scene
    columns, lines : int
        At most so many characters a line, and lines.
    colors : bool, default True
        Whether the terminal shows colours; without, paths are dots.

    Examples
    --------
    >>> print(half_blocks(Scene(np.array([[1, 1, 0], [0, 1, 0]], dtype=bool)), 10, 10, colors=False))
    ▄█
    """
    height, width = scene.occupied.shape
    factor = max(1, -(-width // columns), -(-height // (2 * lines)))
    codes = _codes(scene)
    for cells in scene.others:
        codes[cells[:, 1], cells[:, 0]] = _OTHER
    for k, line in enumerate(scene.lines):
        codes[line.cells[:, 1], line.cells[:, 0]] = _FIRST + k
    last = _FIRST + len(scene.lines)
    for cell in (scene.start, scene.goal):
        if cell is not None:
            codes[cell[1], cell[0]] = last
    small = _shrunk(codes, factor)[::-1]
    if len(small) % 2:
        small = np.pad(small, [(0, 1), (0, 0)])
    pairs = zip(small[::2], small[1::2], strict=True)
    if not colors:
        return "\n".join("".join(map(_plain_mark, *pair)).rstrip() for pair in pairs)
    palette = [_TERMINAL[name] for name in ("free", "unknown", "grown", "unseen", "occupied", "others")]
    palette += [*(nearest_color(line.color) for line in scene.lines), _TERMINAL["start"]]
    text = (
        "".join(f"\x1b[38;5;{palette[a]};48;5;{palette[b]}m{_MARKS['upper']}" for a, b in zip(*pair, strict=True))
        for pair in pairs
    )
    # A colour that the character before has already need not be said again.
    return "\n".join(re.sub(r"(\x1b\[[\d;]*m)(\S)((?:\1\2)+)", _said_once, line) + "\x1b[0m" for line in text)


def legend(scene: Scene) -> str:
    """Return what the paths of a scene on a terminal of colours are called, on one line."""
    return "  ".join(f"\x1b[38;5;{nearest_color(line.color)}m{_MARKS['both'] * 2}\x1b[0m {line.name}" for line in scene.lines)


def _said_once(match: re.Match) -> str:
    code, mark, rest = match.groups()
    return code + mark * (1 + len(rest) // len(code + mark))


def _plain_mark(upper: int, lower: int) -> str:
    if max(upper, lower) >= _OTHER:
        return _MARKS["path"]
    return {(True, True): _MARKS["both"], (True, False): _MARKS["upper"], (False, True): _MARKS["lower"]}.get(
        (_NEAR <= upper <= _BLOCKED, _NEAR <= lower <= _BLOCKED), " "
    )


def nearest_color(color: str) -> int:
    """Return which of the 216 colours of a terminal's cube is the nearest to one such as "#0072B2"."""
    steps = np.array([0, 95, 135, 175, 215, 255])
    r, g, b = (int(np.abs(steps - part).argmin()) for part in bytes.fromhex(color[1:]))
    return 16 + 36 * r + 6 * g + b
