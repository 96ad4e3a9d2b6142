"""Want of memory: how to tell it, and what sizes cost."""

from __future__ import annotations

import errno

# Peak bytes a cell that can be reached, measured on open maps of 700 x 700 and 1400 x 1400 cells with two objectives.
_CELLS, _MONOTONE = 130, 100
# The same for exact fronts, without those of the labels; where turns count, each cell has eight headings.
_EXACT, _EXACT_WITH_TURN = 400, 900

# What numpy, numba, scipy, the C++ library, the loader of shared objects and the threads of Python say.
_TEXTS = (
    "unable to allocate",
    "bad_alloc",
    "cannot allocate memory",
    "out of memory",
    "failed to map",
    "can't start new thread",
)


def is_want_of_memory(error: BaseException | None) -> bool:
    """Return whether want of memory is behind an error: compiled code and libraries make other errors of it."""
    while error is not None:
        if isinstance(error, MemoryError) or getattr(error, "errno", None) == errno.ENOMEM:
            return True
        # Of the system's own errors, those without a number alone are the loader's; others name files, which may be called so.
        may_say = isinstance(error, SystemError | RuntimeError | ImportError) or (
            type(error) is OSError and error.errno is None
        )
        if may_say and any(text in str(error).lower() for text in _TEXTS):
            return True
        # llvmlite says something else while it handles what the loader said.
        error = error.__cause__ or (None if error.__suppress_context__ else error.__context__)
    return False


def want_of_memory(needs: str = "") -> str:
    """Return the sentence for a user, with what `needed` says if that is known."""
    return f"memory ran out{f': {needs}' if needs else ''}; expected a smaller map, coarser cells or more free memory"


def needed(
    representation: str, monotone: bool, n_cells: int, whole_front: bool = False, with_turn: bool = False, size: str = ""
) -> str:
    """Return what a problem costs, in words.

    Parameters
    ----------
    representation : str
        Its name.
    monotone : bool
        Whether its paths advance along an axis.
    n_cells : int
        Cells that are worked on, see `OccupancyGrid.box_of`.
    whole_front : bool
        Whether its exact front is searched.
    with_turn : bool
        Whether the turn is an objective.
    size : str, optional
        How to say the number of cells, such as "4000 x 4000".
    """
    a_cell = _MONOTONE if monotone else _CELLS
    if whole_front:
        a_cell = max(a_cell, _EXACT_WITH_TURN if with_turn else _EXACT)
    what = f"the exact front of a problem in {representation!r}" if whole_front else f"a problem in {representation!r}"
    return f"{what} on {size or f'{n_cells:,}'} cells needs about {max(n_cells * a_cell / 1e9, 0.1):.1f} GB"
