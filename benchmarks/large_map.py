"""What a large map costs of which little can be reached: 4000 x 4000 cells around a room of 300 x 300, and the room alone.

Makes both maps as a map saver does, plans the exact front on each in processes of their own, one after the other in turns, and
prints the medians of processor time and peak memory and their ratios; both fronts and paths have to be the same.

    python benchmarks/large_map.py --rounds 5
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

from pymoo_gridpath.maps import load_map

SIZE, ROOM, MARGIN, RESOLUTION = 4000, 300, 10, 0.05
FREE, OCCUPIED, UNKNOWN = 254, 0, 205

# How far the room lies from the corner of each map, and so its start and its goal from theirs.
MAPS = {"whole": (SIZE - ROOM) // 2, "cropped": MARGIN}

MEASURED = """
import resource, sys
from pymoo_gridpath.cli import main
code = main(sys.argv[1:])
used = resource.getrusage(resource.RUSAGE_SELF)
print(f"\\n{used.ru_utime + used.ru_stime} {used.ru_maxrss}")
sys.exit(code)
"""


def write_map(folder: Path, name: str, offset: int) -> None:
    """Write a room with walls and some blocks in it, among cells that nobody has seen."""
    pixels = np.full((ROOM + 2 * offset,) * 2, UNKNOWN, dtype=np.uint8)
    room = pixels[offset:-offset, offset:-offset]
    room[:] = FREE
    room[[0, -1]] = room[:, [0, -1]] = OCCUPIED
    for x, y in np.random.default_rng(1).integers(40, ROOM - 60, (12, 2)):
        room[y : y + 12, x : x + 12] = OCCUPIED
    Image.fromarray(pixels).save(folder / f"{name}.png")
    corner = -(offset + ROOM / 2) * RESOLUTION
    (folder / f"{name}.yaml").write_text(
        f"image: {name}.png\nresolution: {RESOLUTION}\norigin: [{corner}, {corner}, 0.0]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )


def plan(folder: Path, name: str, offset: int) -> tuple[float, float]:
    """Plan in a process of its own, and return its processor time in seconds and its peak memory in GB."""
    start, goal = (f"{offset + k},{offset + k}" for k in (10, ROOM - 10))
    options = [
        "--algorithm",
        "exact",
        "--radius",
        "0.2",
        "--risk",
        "paper",
        "--start",
        start,
        "--goal",
        goal,
        "-o",
        str(folder / name),
    ]
    command = [sys.executable, "-c", MEASURED, "plan", str(folder / f"{name}.yaml"), *options]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    seconds, kilobytes = map(float, done.stdout.splitlines()[-1].split())
    return seconds, kilobytes * 1024 / 1e9


def found(document: dict) -> tuple[list[dict], list[np.ndarray]]:
    """Return the objectives of the paths of a result, and their points in metres."""
    return [path["objectives"] for path in document["paths"]], [np.array(path["points"]) for path in document["paths"]]


def main() -> int:
    parser = argparse.ArgumentParser(description=str(__doc__).splitlines()[0])
    parser.add_argument("--rounds", type=int, default=5, metavar="N", help="plans on each map (default: 5)")
    rounds = parser.parse_args().rounds
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for map_name, offset in MAPS.items():
            write_map(folder, map_name, offset)
            plan(folder, map_name, offset)  # compiles, and fills the system's memory of files
            grid = load_map(folder / f"{map_name}.yaml")
            print(f"{map_name}: {grid.width} x {grid.height} cells, {grid.occupied.size - grid.n_occupied} free")
        used = {map_name: [] for map_name in MAPS}
        for _ in range(rounds):
            for map_name, offset in MAPS.items():
                used[map_name].append(plan(folder, map_name, offset))
        results = {map_name: json.loads((folder / map_name / "paths.json").read_text()) for map_name in MAPS}
    fronts, points = zip(*map(found, results.values()), strict=True)
    same = fronts[0] == fronts[1] and all(a.shape == b.shape and np.allclose(a, b) for a, b in zip(*points, strict=True))
    medians = {name: [statistics.median(column) for column in zip(*values, strict=True)] for name, values in used.items()}
    for map_name, (seconds, gigabytes) in medians.items():
        print(f"{map_name}: {seconds:.2f} s of processor time, {gigabytes:.3f} GB")
    time, memory = (a / b for a, b in zip(medians["whole"], medians["cropped"], strict=True))
    print(f"ratios: {time:.2f} of time, {memory:.2f} of memory; {'the same' if same else 'OTHER'} {len(fronts[0])} paths")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
