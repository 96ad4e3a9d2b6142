"""Draw one figure: the exact front, what the paper's method finds, and what path-aware operators find, on the same axes.

Grids are those of section 6 of Ahmed and Deb (2013), 32 x 32 cells with p0 = 0.16 (about 165 obstacles). The paper's method
has its full 250,000 evaluations in a single run, and the path-aware one 10,000, from random paths. Of seeds 1 to 7 the default
is the one on which the paper's method reaches the median share of the exact front's hypervolume: 0.83, of 0.41 to 0.96. Run
with ``python benchmarks/three_fronts.py docs/images/fronts.png``; it takes a minute or two.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import moocore
import numpy as np
from pymoo.optimize import minimize
from quality import ratio

from pymoo_gridpath import GridPathProblem
from pymoo_gridpath.algorithms import ahmed_deb_2013, make_algorithm
from pymoo_gridpath.objectives import Vulnerability
from pymoo_gridpath.operators import path_operators
from pymoo_gridpath.plotting import plot_map
from pymoo_gridpath.problems import random_dense_grid

COLOURS = {"exact": "#2b2b2b", "paper": "#d1495b", "path-aware": "#2274a5"}


def legal_front(result) -> np.ndarray:
    """Return the non-dominated legal points of a Result's population."""
    population: Any = result.pop
    F: Any = population.get("F")[population.get("interfering_cells") == 0]
    F = np.unique(F, axis=0)
    return F[moocore.is_nondominated(F)] if len(F) else F


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path, help="where the figure goes")
    parser.add_argument("--seed", type=int, default=7, help="seed of the grid and of both runs")
    parser.add_argument("--n-gen", type=int, default=500, help="generations of the paper's method, with 500 individuals")
    arguments = parser.parse_args()
    grid = random_dense_grid(32, 0.16, arguments.seed)
    problem = GridPathProblem(grid, (0, 0), (31, 31), objectives=("length", Vulnerability(variance=0.5)))
    exact: Any = problem.pareto_front(max_seconds=600.0)
    paper_result = minimize(*ahmed_deb_2013(grid, (0, 0), (31, 31), n_gen=arguments.n_gen), seed=arguments.seed)
    aware = make_algorithm("NSGA2", problem, pop_size=100, operators=path_operators(problem, "random"))
    aware_result = minimize(problem, aware, ("n_eval", 10_000), seed=arguments.seed)
    fronts = {"paper": legal_front(paper_result), "path-aware": legal_front(aware_result)}
    labels = {
        "paper": f"paper's method, {500 * arguments.n_gen:,} evaluations",
        "path-aware": "path-aware operators, 10,000 evaluations",
    }

    figure, (left, right) = plt.subplots(
        1, 2, figsize=(10.5, 4.6), gridspec_kw={"width_ratios": [1, 1.25]}, layout="constrained"
    )
    plot_map(grid, ax=left)
    for name, result in (("paper", paper_result), ("path-aware", aware_result)):
        population: Any = result.opt
        decoded = problem.decode(population.get("X"))
        legal = np.flatnonzero(decoded.interfering_cells == 0)
        for k in legal:
            cells = decoded.cells(int(k))
            left.plot(*cells.T, color=COLOURS[name], lw=1.2, alpha=0.5, zorder=4 if name == "paper" else 3)
    order = np.argsort(exact[:, 0])
    right.step(*exact[order].T, where="post", color=COLOURS["exact"], lw=1, zorder=2)
    right.plot(*exact.T, "o", ms=7, mfc="none", mec=COLOURS["exact"], label=f"exact front, {len(exact)} points", zorder=5)
    for name, F in fronts.items():
        text = f"{labels[name]}: {ratio(F, exact):.2f} of its hypervolume"
        right.plot(*F.T, "s" if name == "paper" else "o", ms=4, color=COLOURS[name], label=text, zorder=4)
    right.set(xlabel="Path length [cells]", ylabel="Path vulnerability")
    right.legend(frameon=False, fontsize=9, loc="lower left", bbox_to_anchor=(0.0, 1.0))
    right.spines[["top", "right"]].set_visible(False)
    figure.savefig(arguments.file, dpi=150)
    print(", ".join(f"{name} {ratio(F, exact):.3f}" for name, F in fronts.items()), f"of {len(exact)} points; {arguments.file}")


if __name__ == "__main__":
    main()
