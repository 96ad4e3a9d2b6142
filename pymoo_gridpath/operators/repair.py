"""Repair: genes rewritten so that paths stay on the grid."""

from __future__ import annotations

from pymoo.core.repair import Repair

from pymoo_gridpath.registry import OPERATORS
from pymoo_gridpath.representations.base import representation_of


@OPERATORS.register
class EdgeFixing(Repair):
    """Bring moves that leave the grid back by the paper's random rule, and round genes that are not whole.

    A move beyond the edge is replaced by one to a row between the vehicle's row and the edge, with a probability that
    rises linearly from the vehicle's row to the edge, see `MonotoneRepresentation.repair`. Since the fixed gene is
    written back, decoding and evaluation draw no random number. Children of operators that know only real numbers come
    out with the problem's ``vtype``.

    References
    ----------
    Ahmed and Deb (2013), section 2.1.
    """

    # Whoever has such a repair need not be told that other operators know nothing of paths.
    knows_paths = True

    def _do(self, problem, X, random_state=None, **kwargs):
        assert random_state is not None
        return representation_of(problem).repair(X, random_state)
