"""The report of a study: tables, figures, and one page that collects them."""

from typing import TYPE_CHECKING

from pymoo_gridpath.lazy import lazy

if TYPE_CHECKING:
    from pymoo_gridpath.study.report.writing import write_report

__all__ = ["write_report"]
# Where it is used, so that the commands that do not report need not wait for matplotlib.
__getattr__, __dir__ = lazy(__name__, {"write_report": "writing"})
