"""Measure the page of a trade-off set in this machine's Chromium: its size, how soon it is ready, how fast a path appears.

    python benchmarks/explorer.py
    python benchmarks/explorer.py --page front.html    # of a page that there is
    python benchmarks/explorer.py --axe axe.min.js     # and look for faults of accessibility by axe-core, which is not shipped

The large page has 512 x 512 cells and 1,500 random walks of 700 cells, which are harder to pack than paths of a front.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
from chromium import Chromium, Page, find_chromium
from scipy import ndimage

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.explorer import save_page
from pymoo_gridpath.neighbourhood import HEADINGS
from pymoo_gridpath.objectives import Vulnerability

SIDE, N_PATHS, N_CELLS = 512, 1500, 700

# From the choice until the picture is there: a frame is drawn, and one dot of it read back, which waits for the drawing.
TIME_OF_A_PATH = """
(async () => {
  const times = [];
  const canvas = document.getElementById("map");
  for (let k = 0; k < 200; k++) {
    const before = performance.now();
    choose((7 * k) % nPaths);
    drawNow();
    canvas.getContext("2d").getImageData(0, 0, 1, 1);
    times.push(performance.now() - before);
    await new Promise(requestAnimationFrame);
  }
  return times;
})()
"""
FRAMES = """
(async () => {
  const times = [];
  let last = await new Promise(requestAnimationFrame);
  for (let k = 0; k < 100; k++) {
    step(1);
    const now = await new Promise(requestAnimationFrame);
    times.push(now - last);
    last = now;
  }
  return times;
})()
"""
LOAD = "performance.getEntriesByType('navigation')[0].loadEventEnd"


class LargeSet:
    """What a page asks of a trade-off set, with random walks for paths."""

    feasible = True
    advice = ""
    named: ClassVar = {"shortest": 0, "safest": 700, "smoothest": 3, "knee": 44}
    # A waypoint for every 25 cells, and the end.
    smoother = SimpleNamespace(places=lambda cells: np.r_[0 : len(cells) - 1 : 25, len(cells) - 1])

    def __init__(self, seed: int = 1):
        random = np.random.default_rng(seed)
        self.problem = large_problem(random)
        self.objective_names = self.problem.objective_names
        heading = np.cumsum(random.choice([-1, 0, 0, 0, 0, 1], size=(N_PATHS, N_CELLS)), axis=1) % len(HEADINGS)
        walks = np.abs(np.cumsum(np.array(HEADINGS)[heading], axis=1))
        # Walks that come to the edge turn back.
        self.cells = SIDE - 1 - np.abs(SIDE - 1 - walks)
        names = (*self.objective_names, "clearance")
        self.measures = {name: np.sort(random.gamma(2.0, 100.0, N_PATHS)) for name in names}
        self.F = np.stack([self.measures[name] for name in self.objective_names], axis=1)
        self.measures["interfering_cells"] = np.zeros(N_PATHS, dtype=int)

    def index(self, name: str) -> int:
        return self.named[name]

    def __len__(self) -> int:
        return N_PATHS

    def __iter__(self):
        return (SimpleNamespace(cells=cells) for cells in self.cells)


def large_problem(random) -> GridPathProblem:
    """Return a problem of three objectives on a map with round obstacles."""
    rough = ndimage.gaussian_filter(random.standard_normal((SIDE, SIDE)), 3.0)
    occupied = rough > np.quantile(rough, 0.8)
    occupied[:8, :8] = occupied[-8:, -8:] = False
    labels = np.asarray(ndimage.label(~occupied)[0])  # pyright: ignore
    occupied[labels != labels[0, 0]] = True
    grid = OccupancyGrid(occupied, resolution=0.05, name="large")
    ys, xs = np.nonzero(~occupied)
    k = int(np.argmax(xs + ys))
    return GridPathProblem(grid, (0, 0), (int(xs[k]), int(ys[k])), "cells", ("length", Vulnerability(variance=0.5), "turn"))


def quartiles(times: list[float]) -> str:
    return ", ".join(f"{value:.1f}" for value in np.percentile(times, (50, 95, 100))) + " ms (median, 95 %, most)"


def busy(page: Page) -> float:
    """Return the milliseconds of a processor that the page's main thread has taken, whatever else the machine does."""
    metrics = {one["name"]: one["value"] for one in page.call("Performance.getMetrics")["metrics"]}
    return 1000.0 * metrics["TaskDuration"]


def report(browser: Chromium, file: Path, axe: Path | None) -> bool:
    """Print what was measured; return whether it keeps the figures."""
    page, size = browser.open("about:blank"), file.stat().st_size
    page.call("Performance.enable", timeDomain="threadTicks")
    before = busy(page)
    page.go(file.resolve().as_uri())
    load, requests, complaints = page.run(LOAD), page.requests, page.complaints
    loaded = busy(page)
    times = page.run(TIME_OF_A_PATH)
    chosen = busy(page)
    print(f"size        {size:,} bytes")
    print(f"load        {load:.0f} ms, {loaded - before:.0f} ms of a processor")
    print(f"a new path  {quartiles(times)}, {(chosen - loaded) / len(times):.1f} ms of a processor")
    print(f"a frame     {quartiles(page.run(FRAMES))}, stepping along the front")
    print(f"requests    {len(requests) - 1} besides the page; complaints: {complaints or 'none'}")
    good = size < 1e6 and load < 1000 and np.percentile(times, 95) < 16 and len(requests) == 1 and not complaints
    return accessible(page, axe) and good if axe else good


def accessible(page: Page, axe: Path) -> bool:
    """Print what axe-core finds in both themes; return whether nothing is serious or critical."""
    page.run(axe.read_text(encoding="utf-8"))
    worst = []
    for theme in ("light", "dark"):
        page.run(f"setTheme('{theme}'); document.getElementById('more').open = true; 0")
        found = page.run("axe.run().then((all) => all.violations.map((one) => [one.impact, one.id, one.nodes.length]))")
        print(f"axe-core    {theme}: {found or 'nothing'}")
        worst += [impact for impact, _, _ in found if impact in ("serious", "critical")]
    return not worst


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--page", type=Path)
    parser.add_argument("--axe", type=Path)
    arguments = parser.parse_args()
    if find_chromium() is None:
        print("there is no Chromium on this machine", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as folder, Chromium() as browser:
        file = arguments.page or save_page(LargeSet(), Path(folder) / "large.html")
        return 0 if report(browser, file, arguments.axe) else 1


if __name__ == "__main__":
    sys.exit(main())
