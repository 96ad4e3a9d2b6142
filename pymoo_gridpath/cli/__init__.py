"""The command line."""

from pymoo_gridpath.cli.main import main

__all__ = ["main"]
