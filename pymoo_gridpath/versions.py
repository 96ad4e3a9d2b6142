"""The versions of the software that decides about a result."""

from __future__ import annotations

import platform
from functools import lru_cache
from importlib import metadata

_PACKAGES = ("pymoo_gridpath", "pymoo", "numpy", "scipy", "moocore", "numba")


def versions() -> dict[str, str]:
    """Return the versions of Python and of the packages that decide about the result; "none" where one is not installed."""
    return dict(_found())


@lru_cache(maxsize=1)
def _found() -> dict[str, str]:
    found = {"python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            found[package] = "none"
    return found


def __getattr__(name: str) -> str:
    if name != "__version__":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return metadata.version("pymoo_gridpath")
