"""One valid call of every public name, and which names are public."""

from __future__ import annotations

import calls_of_parts
import calls_of_runs
import calls_of_suites
from public_names import documented, public_names
from world import Call, World

__all__ = ["Call", "World", "calls", "documented", "public_names"]


def calls(w: World) -> dict[str, Call]:
    """Return a valid call of every public name."""
    return {
        name.removeprefix("pymoo_gridpath."): call
        for part in (*calls_of_parts.CALLS, *calls_of_runs.CALLS, *calls_of_suites.CALLS)
        for name, call in part(w).items()
    }
