"""Multi-objective path planning on occupancy grids, as problems and operators for pymoo.

The names that most programs need stand here, ``import pymoo_gridpath as gp``; each is imported where it is first used.
"""

from typing import TYPE_CHECKING

from pymoo_gridpath.lazy import lazy

if TYPE_CHECKING:
    from pymoo_gridpath.algorithms import ExactFront, ahmed_deb_2013, make_algorithm, minimize_runs
    from pymoo_gridpath.convergence import ConvergenceRecorder
    from pymoo_gridpath.decision import TradeOffSet, load_json
    from pymoo_gridpath.errors import GridPathError
    from pymoo_gridpath.explorer import explore, save_page
    from pymoo_gridpath.grid import OccupancyGrid
    from pymoo_gridpath.maps import load_map, shipped_maps
    from pymoo_gridpath.operators import paper_operators, path_operators
    from pymoo_gridpath.plotting import plot_convergence, plot_front, plot_map, plot_paths, save_figures
    from pymoo_gridpath.problems import GridPathProblem, random_dense_grid
    from pymoo_gridpath.registry import register

    __version__: str

_HOMES = {
    "ConvergenceRecorder": "convergence",
    "ExactFront": "algorithms",
    "GridPathError": "errors",
    "GridPathProblem": "problems",
    "OccupancyGrid": "grid",
    "TradeOffSet": "decision",
    "__version__": "versions",
    "ahmed_deb_2013": "algorithms",
    "explore": "explorer",
    "load_json": "decision",
    "load_map": "maps",
    "make_algorithm": "algorithms",
    "minimize_runs": "algorithms",
    "paper_operators": "operators",
    "path_operators": "operators",
    "plot_convergence": "plotting",
    "plot_front": "plotting",
    "plot_map": "plotting",
    "plot_paths": "plotting",
    "random_dense_grid": "problems",
    "register": "registry",
    "save_figures": "plotting",
    "save_page": "explorer",
    "shipped_maps": "maps",
}

# Written out for those who read it without running it, such as editors.
__all__ = [
    "ConvergenceRecorder",
    "ExactFront",
    "GridPathError",
    "GridPathProblem",
    "OccupancyGrid",
    "TradeOffSet",
    "__version__",
    "ahmed_deb_2013",
    "explore",
    "load_json",
    "load_map",
    "make_algorithm",
    "minimize_runs",
    "paper_operators",
    "path_operators",
    "plot_convergence",
    "plot_front",
    "plot_map",
    "plot_paths",
    "random_dense_grid",
    "register",
    "save_figures",
    "save_page",
    "shipped_maps",
]
__getattr__, __dir__ = lazy(__name__, _HOMES)
