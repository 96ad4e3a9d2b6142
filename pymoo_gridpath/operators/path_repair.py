"""Repair: rows of genes made legal paths."""

from __future__ import annotations

from pymoo.core.repair import Repair

from pymoo_gridpath.operators.path_terrain import terrain_of
from pymoo_gridpath.registry import OPERATORS
from pymoo_gridpath.representations.base import max_cells, representation_of
from pymoo_gridpath.search.sequences import are_legal, mend


@OPERATORS.register
class PathRepair(Repair):
    """Make legal paths of rows that are none, and leave the others as they are.

    First come the representation's own rules, such as the paper's edge fixing. Of what is still no legal path, occupied
    cells are dropped, the broken stretches joined by shortest routes, and loops cut. Children of `SpliceCrossover` and
    `PathMutation` need no repair; those of operators that know nothing of paths do.
    """

    # Whoever has such a repair need not be told that other operators know nothing of paths.
    knows_paths = True

    # Rows of what makes legal paths need not be looked at.
    keeps_legal = True

    def _do(self, problem, X, random_state=None, **kwargs):
        assert random_state is not None
        representation, terrain = representation_of(problem), terrain_of(problem)
        X = representation.repair(X, random_state)
        broken = ~are_legal(representation.to_sequences(X), terrain)
        if broken.any():
            paths = representation.to_sequences(X[broken])
            mended = mend(paths, representation.moves, terrain.start, terrain.goal, max_cells(problem))
            X[broken] = representation.from_sequences(mended)
        return X
