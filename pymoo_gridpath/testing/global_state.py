"""The state of numpy's global generator, which nothing may draw from."""

from __future__ import annotations

from typing import Any

import numpy as np


def global_state() -> tuple[bytes, int]:
    """Return the state in a form that can be compared."""
    state: Any = np.random.get_state(legacy=True)  # noqa: NPY002
    return state[1].tobytes(), state[2]
