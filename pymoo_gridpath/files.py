"""Files that are written whole or not at all."""

from __future__ import annotations

import contextlib
import os
import re
import uuid
from pathlib import Path

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError, visible

#: Names of files that were being written when a process was killed.
UNFINISHED = re.compile(r"\..+\.[0-9a-f]{8}\.part")


def write_whole(path: str | os.PathLike[str], data: bytes) -> Path:
    """Write a file as `replace_file` does.

    Raises
    ------
    GridPathError
        If the file cannot be written.
    """
    path = Path(checks.file_path("path", path))
    try:
        replace_file(path, data)
    except OSError as error:
        shown = visible(path)
        raise GridPathError(f"{shown}: the file cannot be written ({error.strerror}), expected a writable place") from None
    return path


def replace_file(path: Path, data: bytes) -> None:
    """Write a file under a temporary name beside it and rename it, so that a crash leaves the old file or the new one.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    temporary = path.with_name(f".{path.name}.{uuid.uuid4().hex[:8]}.part")
    try:
        with open(temporary, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
    _sync_folder(path.parent)


def make_folder(folder: Path) -> None:
    """Make a folder and those above it that are missing, each on the disk before anything stands in it.

    Raises
    ------
    OSError
        If one cannot be made.
    """
    if folder.is_dir():
        return
    if folder.parent != folder:
        make_folder(folder.parent)
    folder.mkdir(exist_ok=True)
    _sync_folder(folder.parent)


def _sync_folder(folder: Path) -> None:
    """Bring the names in a folder to the disk, so that a power failure does not undo a renaming."""
    if os.name == "nt":
        return  # folders cannot be opened there
    # Some folders cannot be read, and some file systems cannot do it; the file is in place all the same.
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
