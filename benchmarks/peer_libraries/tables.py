"""Tables of what was measured, in Markdown."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable, Sequence

import numpy as np
from peer_libraries.base import Peer, markdown, version_of
from peer_libraries.measure import Case, PathRow, SearchRow

from pymoo_gridpath.neighbourhood import ONE_SIDE, SQRT2

_RULES = {True: "cut", ONE_SIDE: "one side", False: "never cut"}


def machine() -> str:
    """Return processor, cores and system in a sentence."""
    model = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            named = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
        model = named[0] if named else model
    except OSError:
        pass
    return f"{model}, {os.cpu_count()} cores of which one is used, {platform.system()}, Python {platform.python_version()}"


def library_table(peers: Iterable[Peer], missing: dict[str, str]) -> str:
    """Return a table of the packages: version, licence, and whether each was measured, or why not."""
    packages = {peer.package: peer for peer in peers}
    rows = [(name, version_of(name) or "-", peer.licence, missing.get(name, "yes")) for name, peer in packages.items()]
    return markdown(("Package", "Version", "Licence", "Measured"), rows, left=4)


def _diagonal(cost: float) -> str:
    return "√2" if cost == SQRT2 else f"{cost:.4g}"


def _two_digits(value: float) -> str:
    """Return a number rounded to two digits, 143.2 as 140."""
    return f"{float(f'{value:.2g}'):.10g}"


def _share(values: np.ndarray) -> str:
    return f"{int(values.sum())} of {len(values)}"


def _corners(row: PathRow) -> str:
    said = _RULES[row.rule]
    if row.rule != row.peer.rule:
        return f"{said}, not {_RULES[row.peer.rule]}"
    return f"{said}, as built" if row.peer.graph else said


def agreement_table(rows: Sequence[PathRow]) -> str:
    """Return what came back: under which rule, at which costs, and how it agrees with our optima and the published lengths."""
    lines = []
    for row in rows:
        legal, optimal, shortest, excess, off = row.all_judged.T
        known = off[~np.isnan(off)]
        lines.append(
            (
                row.peer.label,
                _corners(row),
                _diagonal(row.peer.diagonal),
                _share(legal),
                _share(optimal),
                _share(shortest),
                f"{np.nanmax(excess, initial=0.0):.2f}",
                _share(known == 0.0),
                f"{known.min():.2f} to {known.max():.2f}" if len(known) else "-",
            )
        )
    head = ("Library and call", "Corners", "Diagonal", "Legal by that rule", "Cheapest at that cost", "Shortest by that rule")
    return markdown((*head, "Most over it, %", "MovingAI's length", "Off it, %"), lines, left=3)


def path_times(rows: Sequence[PathRow], cases: Sequence[Case]) -> str:
    """Return milliseconds of set-up and, the median, of a query by map."""
    lines = []
    for row in rows:
        line = [row.peer.label, _RULES[row.rule]]
        for case in cases:
            seconds = 1e3 * np.array(row.seconds[case.name])
            line += [_two_digits(1e3 * row.set_up[case.name]), _two_digits(float(np.median(seconds)))]
        lines.append(line)
    head = [f"{case.name}: {what}, ms" for case in cases for what in ("set-up", "query")]
    return markdown(("Library and call", "Corners", *head), lines, left=2)


def search_table(rows: Sequence[SearchRow]) -> str:
    """Return medians over the runs of each peer."""
    first = float(np.median([seconds for seconds, *_ in rows[0].runs]))
    lines = []
    for row in rows:
        seconds, ratio, legal = np.median(row.runs, axis=0)
        times, how = f"{seconds / first:.1f}", (row.peer.numbers, row.peer.batch)
        lines.append((row.peer.label, *how, len(row.runs), f"{seconds:.2f}", times, f"{ratio:.3f}", f"{legal:.2f}"))
    head = ("Library", "Whole numbers", "Evaluated all at once by", "Runs", "Seconds", "Times ours")
    return markdown((*head, "Hypervolume ratio", "Legal"), lines, left=3)
