"""Figures with matplotlib: the map with chosen paths, fronts of two and three objectives, convergence, animations.

Every function draws into the Axes that it is given, or into a new figure, and returns the Axes. New figures have a style of
their own that suits a paper; given Axes keep theirs. Settings of matplotlib are left as they were.
"""

from pymoo_gridpath.plotting.animation import animate_moving
from pymoo_gridpath.plotting.convergence import plot_convergence
from pymoo_gridpath.plotting.fronts import plot_front
from pymoo_gridpath.plotting.maps import plot_map, plot_paths
from pymoo_gridpath.plotting.save import save_figures

__all__ = ["animate_moving", "plot_convergence", "plot_front", "plot_map", "plot_paths", "save_figures"]
