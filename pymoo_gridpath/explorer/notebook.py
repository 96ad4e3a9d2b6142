"""The page of a trade-off set within a notebook."""

from __future__ import annotations

import html

from pymoo_gridpath import checks
from pymoo_gridpath.explorer.page import page_text

# A notebook that is not trusted loses the frame: what stands beside it says so, and shows a picture.
_OTHERWISE = "A picture of the paths, where the page above is not shown: trust the notebook, or write the page by save_page"


class Explorer:
    """The page of a trade-off set as a notebook shows it, in a frame of its own; `explore` makes one.

    Parameters
    ----------
    trade_off, title, height
        As in `explore`.
    """

    def __init__(self, trade_off, title: str | None = None, height: int = 720):
        self.height = checks.whole("height", height, 200, 4000)
        self.page = page_text(trade_off, title)
        self.trade_off = trade_off

    def __repr__(self) -> str:
        return f"<Explorer of {self.trade_off!r}; notebooks show it, save_page writes it>"

    def _repr_html_(self) -> str:
        frame = (
            f'<iframe srcdoc="{html.escape(self.page)}" sandbox="allow-scripts allow-downloads" '
            f'title="Explorer of trade-off paths" width="100%" height="{self.height}" '
            f'style="border: 1px solid #8888; border-radius: 6px"></iframe>'
        )
        return f"<div>{frame}<details><summary>{_OTHERWISE}</summary>{self.trade_off._repr_html_()}</details></div>"

    def _repr_png_(self) -> bytes:
        return self.trade_off._repr_png_()


def explore(trade_off, title: str | None = None, height: int = 720) -> Explorer:
    """Show the page of a trade-off set in a notebook; what is to be seen there is said in `save_page`.

    Parameters
    ----------
    trade_off : TradeOffSet
    title : str, optional
        By default the name of the map.
    height : int, default 720
        Of the frame, in pixels of the page, 200 to 4000.

    Returns
    -------
    Explorer
        What the last line of a cell shows. The page runs in a sandbox: it can start a download, and nothing else.

    Raises
    ------
    GridPathError
        If an argument is of another kind or out of its range.
    """
    return Explorer(trade_off, title, height)
