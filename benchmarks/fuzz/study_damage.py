"""The ways to damage the folder of a study: its runs, and what lies beside them."""

from __future__ import annotations

import hashlib
import json
import shutil
from pathlib import Path
from random import Random

from study_mutations import change_number, change_type, change_word, drop, flatten, nest, repeat, write_over

from pymoo_gridpath.study.running import record


def make_folder(path: Path, random: Random) -> None:
    path.unlink()
    path.mkdir()
    (path / "inside").write_text("mine")


def dangling(path: Path, random: Random) -> None:
    path.unlink()
    path.symlink_to("nowhere")


def circular(path: Path, random: Random) -> None:
    path.unlink()
    path.symlink_to(path.name)


def cut_short(path: Path, random: Random) -> None:
    data = path.read_bytes()
    path.write_bytes(data[: random.choice([0, 1, len(data) // 2, len(data) - 1])])


def flip(path: Path, random: Random) -> None:
    data = bytearray(path.read_bytes())
    data[random.randrange(len(data))] ^= 1 << random.randrange(8)
    path.write_bytes(data)


def another(path: Path, random: Random) -> None:
    path.write_bytes(random.choice(sorted(set(path.parents[1].glob("*/*.npz")) - {path})).read_bytes())


def sealed(path: Path, random: Random) -> None:
    """Seal what is no run as one."""
    data = random.choice([b"", b"PK", b"x" * 100, b"\0" * 30 + b"{}", b"\0" * 26 + b"\2\0\0\0{}"])
    path.write_bytes(data + record._SEAL + hashlib.sha256(data).hexdigest().encode())


def part_folder(path: Path, random: Random) -> None:
    folder = random.choice([path.parent, path.parents[2]]) / f".{path.name}.0123abcd.part"
    folder.mkdir()
    (folder / "inside").write_text("mine")


def part_file(path: Path, random: Random) -> None:
    (random.choice([path.parent, path.parents[2]]) / f".{path.name}.0123abcd.part").write_bytes(b"half")


def foreign(path: Path, random: Random) -> None:
    name = random.choice(["notes.txt", "x.npz", "é\x1b.npz", ".hidden", "a" * 200, "ff"])
    target = random.choice([path.parent, path.parents[1], path.parents[2]]) / name
    target.mkdir() if random.random() < 0.5 else target.write_bytes(b"mine")


def no_part(path: Path, random: Random) -> None:
    shutil.rmtree(path.parent)
    path.parent.write_bytes(b"mine") if random.random() < 0.5 else path.parent.symlink_to("nowhere")


def no_runs(path: Path, random: Random) -> None:
    shutil.rmtree(path.parents[1])
    path.parents[1].write_bytes(b"mine") if random.random() < 0.5 else path.parents[1].symlink_to("nowhere")


OF_RUNS = [make_folder, dangling, circular, cut_short, flip, another, sealed, part_folder, part_file, foreign, no_part, no_runs]
NAMED = [make_folder, dangling, circular, cut_short, another, part_folder]


def damaged_plan(folder: Path, random: Random) -> None:
    path = folder / "plan.json"
    data = json.loads(path.read_text())
    random.choice([change_type, change_number, change_word, nest, flatten, drop, repeat])(data, random)
    path.write_text(json.dumps(data))


def odd_entry(folder: Path, random: Random) -> None:
    path = folder / random.choice(["plan.json", "study.toml", "lock", "damaged", "report"])
    if path.is_file():
        path.unlink()
    random.choice([path.mkdir, lambda: path.symlink_to("nowhere"), lambda: path.write_bytes(b"\xff\x00")])()


def broken_plan(folder: Path, random: Random) -> None:
    path = folder / "plan.json"
    path.write_text(write_over(path.read_text(), random))


OF_FOLDERS = [damaged_plan, odd_entry, broken_plan]
