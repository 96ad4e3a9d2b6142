"""A page to choose a path from: one file that any browser opens, without a network, and the same within a notebook."""

from pymoo_gridpath.explorer.notebook import Explorer, explore
from pymoo_gridpath.explorer.page import save_page

__all__ = ["Explorer", "explore", "save_page"]
