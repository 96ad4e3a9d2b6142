"""The page of a trade-off set: one HTML file that asks for nothing else."""

from __future__ import annotations

import base64
import functools
import hashlib
import html
import json
import os
import re
from importlib.resources import files
from pathlib import Path

from pymoo_gridpath import checks
from pymoo_gridpath.decision.trade_off import check_set
from pymoo_gridpath.errors import visible
from pymoo_gridpath.explorer.data import page_data
from pymoo_gridpath.files import write_whole

# In the order in which they need each other.
_SCRIPTS = ("inflate.js", "map.js", "charts.js", "controls.js", "page.js")


def save_page(trade_off, file: str | os.PathLike[str], title: str | None = None) -> Path:
    """Write a page on which the paths of a trade-off set can be looked at and chosen from.

    The page is one HTML file of its own. It asks for nothing else, from this machine or a network, and works from a disk, a web
    server or an attachment. Click or hover over the front, step along it by the arrow keys, filter by ranges, choose the named
    paths, see what is passed on the map, and take the waypoints of the chosen path as CSV; with three objectives or more there
    are parallel coordinates. The file's name and ``#12`` is a link to path 12, and ``#knee`` to the knee.

    Parameters
    ----------
    trade_off : TradeOffSet
    file : str or path-like
        Written under a temporary name and renamed.
    title : str, optional
        By default the name of the map.

    Returns
    -------
    pathlib.Path

    Raises
    ------
    GridPathError
        If an argument is of another kind, or the file cannot be written.

    Notes
    -----
    Lengths, clearances and waypoints are in metres where the map has them (cells that are not 1 wide), else in cells. Of a
    large map of which little can be reached from the start, that part is shown, see `OccupancyGrid.box_of`.
    """
    checks.file_path("file", file)
    return write_whole(file, page_text(trade_off, title).encode())


def page_text(trade_off, title: str | None = None) -> str:
    """Return the page of a trade-off set; see `save_page`."""
    check_set(trade_off)
    shown = visible(trade_off.problem.grid.name if title is None else checks.text("title", title))
    data = page_data(trade_off, shown)
    # Nothing of the data can end the element that they stand in, or begin another.
    text = json.dumps(data, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    parts = {**_fixed(), "title": html.escape(shown), "data": text}
    return re.sub("@([a-z_]+)@", lambda match: parts[match[1]], _asset("page.html"))


@functools.cache
def _fixed() -> dict[str, str]:
    """Return what is the same on every page; only a script and a style of these hashes is taken by the browser."""
    script, style = "".join(map(_asset, _SCRIPTS)), _asset("page.css")
    return {"script": script, "style": style, "script_hash": _hash(script), "style_hash": _hash(style)}


def _asset(name: str) -> str:
    return (files("pymoo_gridpath.explorer") / name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()
