"""The folder of a study: one file a run, written whole or not at all."""

from __future__ import annotations

import contextlib
import errno
import itertools
import json
import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.files import UNFINISHED, make_folder, replace_file
from pymoo_gridpath.study.planning.plan import MAX_RUNS, Plan, PlannedProblem
from pymoo_gridpath.study.running.lock import locked
from pymoo_gridpath.study.running.record import DamagedRecordError, RunRecord, from_bytes, read_meta

# Folders of runs are named by the first two digits of their keys.
_PART = re.compile("[0-9a-f]{2}")
_DIGEST = re.compile("[0-9a-f]{64}")
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)

# Keys are hashes of what a run is; longer names of files are none on most systems.
_LONGEST_KEY = 200


@dataclass(frozen=True)
class StoredRuns:
    """What a store has of some runs.

    Attributes
    ----------
    meta : dict of dict
        Of each run that is there, finished or failed, by key: its status, and the message of a failed one.
    missing : list of str
        Keys of runs that are not there, damaged ones among them.
    damaged : list of pathlib.Path
        What stands under the names of runs and is not what was written: damaged files, folders, links that lead nowhere. Where
        it was moved to if it was set aside.
    odd : list of pathlib.Path
        What else no study writes and stands in its way, such as a folder with the name of an unfinished file; as ``damaged``.
    failed : list of str
        Keys of runs that are there and failed.
    incomplete : list of str
        Keys of exact fronts that are there and not whole, for want of time or memory.
    versions : collections.Counter
        How many runs were made with which versions, as sorted tuples of pairs (package, version).
    """

    meta: dict[str, dict[str, Any]] = field(default_factory=dict)
    missing: list[str] = field(default_factory=list)
    damaged: list[Path] = field(default_factory=list)
    odd: list[Path] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)
    incomplete: list[str] = field(default_factory=list)
    versions: Counter = field(default_factory=Counter)


class Store:
    """The folder of a study.

    ``runs/<first two digits>/<key>.npz`` is a run, ``plan.json`` the plan, ``grids/<digest>.z`` the cells of a map, as planned
    on and as they were before they grew, ``study.toml`` the study file as it was given, ``damaged/`` what was found damaged.
    Nothing stands under its name before it
    is whole and on the disk.

    Parameters
    ----------
    folder : path-like
        Made when first written to.
    """

    def __init__(self, folder: str | os.PathLike):
        self.folder = Path(checks.file_path("folder", folder))

    def path(self, key: str) -> Path:
        """Return the file of a run, whether it is there or not."""
        is_name = isinstance(key, str) and key.isascii() and Path(key).name == key and "\0" not in key
        if not is_name or not 0 < len(key) <= _LONGEST_KEY:
            raise GridPathError(f"key is {checks.shown(key)}, expected the key of a run")
        return self.folder / "runs" / key[:2] / f"{key}.npz"

    def write(self, key: str, data: bytes) -> None:
        """Store the bytes of a run, in place of what there was.

        Raises
        ------
        GridPathError
            If it cannot be written, as when the disk is full.
        """
        self._write(self.path(key), checks.instance("data", data, bytes))

    def read(self, key: str, genes: bool = True) -> RunRecord:
        """Return a run.

        Parameters
        ----------
        key : str
        genes : bool, default True
            Whether to unpack X, the largest array; without, it has no columns.

        Raises
        ------
        GridPathError
            If it is not there.
        DamagedRecordError
            If its file is not what was written.
        """
        record = from_bytes(self._read(key), checks.flag("genes", genes))
        if record.key != key:
            raise DamagedRecordError(f"the file of run {key} holds the run {record.key}")
        return record

    def check(self, keys: Iterable[str], set_aside: bool = False) -> StoredRuns:
        """Read and verify runs, and say what is there.

        Parameters
        ----------
        keys : iterable of str
        set_aside : bool, default False
            Whether damaged files, and what else stands in the way, are moved to ``damaged/``.

        Raises
        ------
        GridPathError
            If the keys are no texts, set_aside is no truth value, a folder or a file cannot be read, or what is damaged cannot
            be moved.
        """
        set_aside = checks.flag("set_aside", set_aside)
        # An iterator has no length, which is what tells lists from what only looks like one.
        if isinstance(keys, Iterator):
            keys = list(itertools.islice(keys, MAX_RUNS + 1))
            if len(keys) > MAX_RUNS:
                raise GridPathError(f"keys has no end, expected at most {MAX_RUNS:,}")
        keys = checks.names("keys", keys)
        found = StoredRuns()
        with readable(self.folder):
            odd = list(self._odd())
        for path in odd:
            found.odd.append(self._set_aside(path) if set_aside else path)
        with readable(self.folder):
            present = self._present()
        for key in keys:
            if key not in present:
                found.missing.append(key)
                continue
            try:
                meta = read_meta(self._read(key))
                if meta["key"] != key:
                    raise DamagedRecordError(f"the file of run {key} holds the run {meta['key']}")
            except DamagedRecordError:
                found.missing.append(key)
                found.damaged.append(self._set_aside(self.path(key)) if set_aside else self.path(key))
                continue
            failed = meta["status"] == "failed"
            # No more, since a study may have hundreds of thousands.
            found.meta[key] = {"status": meta["status"], "message": meta["message"] if failed else ""}
            if failed:
                found.failed.append(key)
            elif not meta["complete"]:
                found.incomplete.append(key)
            found.versions[tuple(sorted(meta["versions"].items()))] += 1
        return found

    def write_plan(self, plan: Plan, study: str | None = None) -> None:
        """Store the plan, the grids of its maps, and the text of the study file if there is one."""
        checks.instance("plan", plan, Plan)
        if study is not None:
            checks.text("study", study)
        for planned in plan.problems:
            for digest, cells in ((_planned_on(planned), planned.grid), (_before(planned), planned.original)):
                file = self._grid_file(digest)
                if cells is not None and file is not None and not file.exists():
                    self._write(file, cells)
        self._write(self.folder / "plan.json", json.dumps(plan.to_json(), separators=(",", ":")).encode())
        file = self.folder / "study.toml"
        if study is not None:
            self._write(file, study.encode())
        elif file.exists():
            # It belonged to another plan.
            try:
                file.unlink()
            except OSError as error:
                raise GridPathError(f"{file} cannot be removed: {error.strerror}") from None

    def read_grid(self, planned: PlannedProblem) -> bytes | None:
        """Return the packed cells of a problem's map, or None of random grids, or where they are not there."""
        return self._cells(_planned_on(checks.instance("planned", planned, PlannedProblem)))

    def read_original(self, planned: PlannedProblem) -> bytes | None:
        """Return the packed cells of a problem's map before obstacles grew, or None if none did, or they are not there."""
        return self._cells(_before(checks.instance("planned", planned, PlannedProblem)))

    def _cells(self, digest: str) -> bytes | None:
        file = self._grid_file(digest)
        with readable(self.folder):
            return file.read_bytes() if file is not None and file.is_file() else None

    def _grid_file(self, digest: str) -> Path | None:
        return self.folder / "grids" / f"{digest}.z" if _DIGEST.fullmatch(digest) else None

    def read_plan(self) -> Plan:
        """Return the plan, without the grids of maps.

        Raises
        ------
        GridPathError
            If there is none, or it cannot be read.
        """
        path = self.folder / "plan.json"
        with readable(path):
            try:
                data = path.read_bytes()
            except FileNotFoundError:
                raise GridPathError(f"{self.folder} has no plan.json, expected the folder of a study that was run") from None
        try:
            return Plan.from_json(json.loads(data))
        except RecursionError:
            why = "it is nested too deeply"
        except ValueError as error:  # of JSON, or a StudyError
            why = error
        raise GridPathError(f"{path} is not a plan that this version can read ({why}); `study run` writes it anew")

    @contextlib.contextmanager
    def lock(self) -> Iterator[bool]:
        """Keep other coordinators off the folder while open, and remove what a killed one had not finished writing.

        Yields
        ------
        bool
            False if the file system knows no locks, so that others are not kept off.

        Raises
        ------
        GridPathError
            If another has it, or the folder cannot be written to.
        """
        with contextlib.ExitStack() as stack:
            try:
                make_folder(self.folder)
                held = stack.enter_context(locked(self.folder / "lock"))
                if held:
                    self._remove_unfinished()
            except BlockingIOError:
                raise GridPathError(
                    f"{self.folder} is in use by another run of a study, expected one at a time; wait for it or choose another "
                    "folder"
                ) from None
            except OSError as error:
                where = f" ({error.filename})" if error.filename not in (None, str(self.folder)) else ""
                raise GridPathError(f"{self.folder} cannot be written to: {error.strerror}{where}") from None
            yield held

    # -- parts ------------------------------------------------------------------------------------------------------------

    def _present(self) -> set[str]:
        names = (file.name for part in self._parts() for file in os.scandir(part))
        return {name.removesuffix(".npz") for name in names if name.endswith(".npz")}

    def _parts(self) -> list[Path]:
        """Return the folders that hold the runs."""
        runs = self.folder / "runs"
        return [part for part in runs.iterdir() if part.is_dir()] if runs.is_dir() else []

    def _odd(self) -> Iterator[Path]:
        """Yield what is no folder where runs are to stand, and folders named like unfinished files."""
        runs = self.folder / "runs"
        if os.path.lexists(runs) and not runs.is_dir():
            yield runs
        elif runs.is_dir():
            yield from (part for part in runs.iterdir() if _PART.fullmatch(part.name) and not part.is_dir())
        for folder in (self.folder, *self._parts()):
            if folder.is_dir():
                yield from (Path(entry.path) for entry in os.scandir(folder) if _is_unfinished(entry) and entry.is_dir())

    def _read(self, key: str) -> bytes:
        path = self.path(key)
        if os.path.lexists(path) and not os.path.isfile(path):
            raise DamagedRecordError(f"{path} is a folder, or a link that leads nowhere, expected the file of a run")
        with readable(path):
            try:
                return path.read_bytes()
            except FileNotFoundError:
                raise GridPathError(f"{self.folder} has no run {key}, expected one that was stored") from None

    def _write(self, path: Path, data: bytes) -> None:
        try:
            make_folder(path.parent)
            replace_file(path, data)
        except OSError as error:
            hint = "; what is stored is whole, and running again goes on from there" if error.errno in _FULL else ""
            raise GridPathError(f"{path} cannot be written: {error.strerror}{hint}") from None

    def _set_aside(self, path: Path) -> Path:
        """Move what is damaged out of the way and return where to."""
        folder = self.folder / "damaged"
        try:
            make_folder(folder)
            number, target = 1, folder / path.name
            while os.path.lexists(target):
                number += 1
                target = folder / f"{path.stem}-{number}{path.suffix}"
            os.replace(path, target)
        except OSError as error:
            raise GridPathError(f"{path} is damaged and cannot be moved to {folder}: {error.strerror}") from None
        return target

    def _remove_unfinished(self) -> None:
        for folder in (self.folder, *self._parts()):
            for entry in os.scandir(folder):
                if _is_unfinished(entry) and not entry.is_dir():
                    os.unlink(entry.path)


def _planned_on(planned: PlannedProblem) -> str:
    return planned.spec["grid"].get("digest", "")


def _before(planned: PlannedProblem) -> str:
    return (planned.place or {}).get("original", "")


@contextlib.contextmanager
def readable(path: Path) -> Iterator[None]:
    """Make a sentence of what keeps a file, or something in a folder, from being read."""
    try:
        yield
    except OSError as error:
        raise GridPathError(f"{error.filename or path} cannot be read: {error.strerror}") from None


def _is_unfinished(entry: os.DirEntry) -> bool:
    return UNFINISHED.fullmatch(entry.name) is not None
