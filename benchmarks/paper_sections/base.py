"""What the sections share: settings, scenarios, runs to a first legal path, merged runs, intervals, tables and figures."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from pymoo.optimize import minimize
from scipy import stats

from paper_sections.genetic import genetic_algorithm
from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.algorithms import FirstLegalPath, Setup, ahmed_deb_2013, minimize_runs
from pymoo_gridpath.decision import TradeOffSet
from pymoo_gridpath.plotting import plot_front, plot_map, plot_paths
from pymoo_gridpath.plotting.style import NAME_STYLES, figure_style
from pymoo_gridpath.problems import random_dense_grid
from pymoo_gridpath.quality import ReferenceFront

#: The paper's two objectives, and each alone.
TWO, LENGTH, VULNERABILITY = ("length", "vulnerability"), ("length",), ("vulnerability",)

#: How lines that have no names of paths are drawn: the first solid, the next dotted over it.
LOOKS = [NAME_STYLES[name] for name in ("shortest", "smoothest", "safest", "knee")]


@dataclass(frozen=True)
class Settings:
    """How large the experiments are, and where they are carried out.

    Attributes
    ----------
    full : bool
        Whether to make as many runs as the paper, or more where a test needs them.
    runs, members, generations : int, optional
        Runs of each row, members of a population and generations, in place of the paper's.
    largest : int
        The most cells a side; larger scenarios are made smaller, and have as many obstacles for their size.
    output : pathlib.Path, optional
        Where figures go; without it none is drawn.
    pool : concurrent.futures.Executor
    """

    pool: Executor
    full: bool = False
    runs: int | None = None
    members: int | None = None
    generations: int | None = None
    largest: int = 128
    output: Path | None = field(default=None)

    def n_runs(self, few: int, many: int) -> int:
        """Return the number of runs of a row: as given, or else many if full."""
        return self.runs or (many if self.full else few)

    @property
    def size(self) -> dict[str, int]:
        """Members and generations as `ahmed_deb_2013` takes them."""
        return {"pop_size": self.members or 500, "n_gen": self.generations or 500}

    def scattered(self, side: int, n_obstacles: int, seed: int) -> OccupancyGrid:
        """Return a scenario of section 6 with exactly so many obstacles; fewer if it is to be smaller."""
        small = min(side, self.largest)
        rng = np.random.default_rng([side, seed])
        # At p0 = 1 what is free is the path.
        off = np.flatnonzero(random_dense_grid(small, 1.0, rng).occupied)
        occupied = np.zeros(small * small, dtype=bool)
        occupied[rng.choice(off, min(round(n_obstacles * (small / side) ** 2), len(off)), replace=False)] = True
        return OccupancyGrid(occupied.reshape(small, small), corner_cutting=True, name=f"{small} x {small}")

    def random(self, side: int, p0: float, seed: int) -> OccupancyGrid:
        """Return a scenario of section 6."""
        return random_dense_grid(min(side, self.largest), p0, np.random.default_rng([side, round(100 * p0), seed]))

    def save(self, ax: Any, name: str) -> None:
        """Write the figure of some Axes to the folder of figures."""
        assert self.output is not None
        self.output.mkdir(parents=True, exist_ok=True)
        path = self.output / f"{name}.png"
        ax.figure.savefig(path, dpi=150, bbox_inches="tight")
        print(f"figure: {path}")


def corners(grid: OccupancyGrid) -> tuple[OccupancyGrid, tuple[int, int], tuple[int, int]]:
    """Return a grid and its two corners, as all queries of the paper."""
    return grid, (0, 0), (grid.width - 1, grid.height - 1)


def setup(grid: OccupancyGrid, options: dict[str, Any]) -> Setup:
    """Return a run of the paper on a grid; with one objective its algorithm is `genetic_algorithm`."""
    made = ahmed_deb_2013(*corners(grid), **options)
    if made.problem.n_obj == 1:
        made = made._replace(algorithm=genetic_algorithm(made.problem, options["pop_size"]))
    return made


# -- runs to a first legal path -----------------------------------------------------------------------------------------


class Ended(NamedTuple):
    """What a run found: whether a legal path, after how many generations, how many cells its best path crosses, and this."""

    found: bool
    generations: int
    crossed: int
    cells: np.ndarray


def until_legal(settings: Settings, grids: Sequence[OccupancyGrid], **options: Any) -> list[Ended]:
    """Return what one run of the paper finds on each grid, ended by its first legal path; run k has the seed k + 1."""
    run = partial(_until_legal, options=settings.size | options)
    return list(settings.pool.map(run, grids, range(1, len(grids) + 1)))


def _until_legal(grid: OccupancyGrid, seed: int, options: dict[str, Any]) -> Ended:
    problem, algorithm, _ = setup(grid, options)
    result: Any = minimize(problem, algorithm, FirstLegalPath(options["n_gen"]), seed=seed)
    crossed = np.asarray(result.pop.get("interfering_cells")).ravel()
    best = int(crossed.argmin())
    cells = problem.decode(result.pop.get("X")[[best]]).cells(0)
    # pymoo has begun to count the next generation.
    return Ended(not crossed[best], result.algorithm.n_iter - 1, int(crossed[best]), cells)


# -- runs of one problem, and merged --------------------------------------------------------------------------------------


class Runs(NamedTuple):
    """Runs of one problem: the set of each, and of all merged."""

    each: list[TradeOffSet]
    merged: TradeOffSet

    def ratios(self, reference: ReferenceFront) -> np.ndarray:
        """Return the hypervolume of the legal paths of each run over that of a front."""
        return np.array([ratio(one, reference) for one in self.each])


def ratio(found: TradeOffSet, reference: ReferenceFront) -> float:
    """Return the hypervolume of legal paths over that of a front."""
    return reference.hypervolume_ratio(found.F if found.feasible else found.F[:0])


def several(settings: Settings, grid: OccupancyGrid, n_runs: int, **options: Any) -> Runs:
    """Return runs of the paper on a grid with the seeds 1 to n_runs; options are those of `ahmed_deb_2013`."""
    each = one_each(settings, [grid] * n_runs, **options)
    return Runs(each, TradeOffSet.from_genes(each[0].problem, np.concatenate([one.X for one in each])))


def one_each(settings: Settings, grids: Sequence[OccupancyGrid], **options: Any) -> list[TradeOffSet]:
    """Return what one run of the paper finds on each grid; run k has the seed k + 1."""
    options = settings.size | options
    genes = list(settings.pool.map(partial(_genes, options=options), grids, range(1, len(grids) + 1)))
    problems = [ahmed_deb_2013(*corners(grid), **options).problem for grid in grids]
    return [TradeOffSet.from_genes(problem, X) for problem, X in zip(problems, genes, strict=True)]


def _genes(grid: OccupancyGrid, seed: int, options: dict[str, Any]) -> np.ndarray:
    """Return what one run found. It is set up here, since not all algorithms can be sent to another process."""
    return TradeOffSet.from_results(minimize_runs(*setup(grid, options), n_runs=1, seed=seed)).X


def exact(grid: OccupancyGrid, objectives: Sequence = TWO) -> ReferenceFront:
    """Return the exact front of a scenario, of all paths that never turn back."""
    problem: Any = ahmed_deb_2013(*corners(grid), objectives=objectives).problem
    front = problem.pareto_front(max_seconds=None)
    assert front is not None
    return ReferenceFront(front)


# -- what is printed --------------------------------------------------------------------------------------------------------


def share(n_found: int, n_runs: int) -> str:
    """Return a share of runs in percent with its 95 % interval, by Wilson."""
    low, high = stats.binomtest(n_found, n_runs).proportion_ci(method="wilson")
    return f"{100 * n_found / n_runs:.0f} % [{100 * low:.0f}, {100 * high:.0f}]"


def median(values: Sequence | np.ndarray, digits: int = 4) -> str:
    """Return a median with its 95 % interval by ranks, if there are enough values for one, six or more."""
    values = np.sort(np.asarray(values, dtype=float))
    if not len(values):
        return "-"
    text = f"{np.median(values):.{digits}f}"
    # The least k for which the interval of the k-th least and the k-th largest holds in 95 %.
    k = int(stats.binom.ppf(0.025, len(values), 0.5))
    return f"{text} [{values[k - 1]:.{digits}f}, {values[-k]:.{digits}f}]" if k else text


def against(first: np.ndarray, second: np.ndarray) -> str:
    """Return on how many scenarios only one of two methods succeeded, and the p value of McNemar's exact test."""
    only = int((first & ~second).sum()), int((second & ~first).sum())
    p = stats.binomtest(only[0], sum(only)).pvalue if sum(only) else 1.0
    return f"{only[0]} : {only[1]}, p = {p:.2g}"


def show(title: str, head: Sequence[str], rows: Sequence[Sequence]) -> None:
    """Print a table under a title, all columns but the first to the right."""
    texts = [list(head)] + [[str(entry) for entry in row] for row in rows]
    widths = [max(len(row[k]) for row in texts) for k in range(len(head))]
    print(f"\n{title}")
    for row in texts:
        cells = [row[0].ljust(widths[0])] + [entry.rjust(width) for entry, width in zip(row[1:], widths[1:], strict=True)]
        print("  " + " | ".join(cells).rstrip(), flush=True)


def progress(*row: object) -> None:
    """Say what is known so far, beside what is printed."""
    print(*row, sep=" | ", file=sys.stderr, flush=True)


def draw_set(settings: Settings, name: str, found: TradeOffSet, reference: ReferenceFront) -> None:
    """Draw a front beside the exact one, and its paths on their map, if figures are wanted."""
    if settings.output and found.feasible:
        settings.save(plot_front(found, reference.points, reference_label="exact front"), f"{name}-front")
        settings.save(plot_paths(found), f"{name}-paths")


def draw_map(settings: Settings, name: str, grid: OccupancyGrid, paths: Mapping[str, np.ndarray]) -> None:
    """Draw paths, cells (x, y) of shape (n, 2) by their labels, on their map, if figures are wanted."""
    if not settings.output:
        return
    _, start, goal = corners(grid)
    ax = plot_map(grid, start=start, goal=goal, legend=False)
    with figure_style(ax):
        for (label, cells), look in zip(paths.items(), LOOKS, strict=False):
            ax.plot(*cells.T, color=look.color, linestyle=look.dashes, linewidth=1.6, label=label, zorder=4)
        ax.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0, handlelength=3)
    settings.save(ax, name)


class Clock:
    """Print how long a section took."""

    def __enter__(self) -> None:
        self.begin = time.perf_counter()

    def __exit__(self, *_: object) -> None:
        print(f"\n{time.perf_counter() - self.begin:.0f} s")
