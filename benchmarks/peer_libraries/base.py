"""What both kinds of peers share: the package they come from, whether it is there, and what is said of it."""

from __future__ import annotations

import importlib
from collections.abc import Iterable, Sequence
from importlib import metadata


class Peer:
    """A library, or ours, in one way of calling it.

    Attributes
    ----------
    package : str
        Name of the distribution that pip installs.
    module : str
        What is imported of it.
    licence : str
        Of the package; metadata do not say it in one way.
    label : str
        How it is called in tables.
    """

    package = module = "pymoo_gridpath"
    licence = "Apache-2.0"
    label = ""

    @classmethod
    def missing(cls) -> str | None:
        """Return why the library cannot be measured, None if it can."""
        try:
            importlib.import_module(cls.module)
        except ImportError as error:
            version = version_of(cls.package)
            return f"{cls.package} {version} does not import: {error}" if version else f"{cls.package} is not installed"
        return None


def version_of(package: str) -> str | None:
    """Return the version of an installed distribution."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def markdown(head: Sequence[str], rows: Iterable[Sequence[object]], left: int = 1) -> str:
    """Return a table in Markdown; all but the first so many columns are aligned to the right."""
    lines = [list(head), ["---"] * left + ["---:"] * (len(head) - left), *([str(cell) for cell in row] for row in rows)]
    if any(len(line) != len(head) for line in lines):
        raise ValueError(f"rows have {[len(line) for line in lines]} cells, expected {len(head)} each")
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |" for line in lines) + "\n"
