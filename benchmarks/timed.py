"""How long the exact front among moving obstacles takes, and whether it is that of an enumeration.

    python benchmarks/timed.py [--cases 200]

First so many random cases of 4 x 4 cells, up to 10 ticks and up to 3 movers, compared with an enumeration; then
32 x 32 cells, 64 ticks and 8 movers, in seconds of processor time once the kernels are compiled.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.exact import exact_timed_front
from pymoo_gridpath.paths import Trajectories
from pymoo_gridpath.testing.timed import enumerated, wander


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=200, help="small cases to enumerate (default: 200)")
    arguments = parser.parse_args()
    rng = np.random.default_rng(32)
    occupied = rng.random((32, 32)) < 0.1
    occupied[[0, -1], [0, -1]] = False
    ways = [wander(rng, 32, 64) for _ in range(8)]
    for what in ("with compiling", "compiled"):
        begin = time.process_time()
        found = exact_timed_front(OccupancyGrid(occupied), (0, 0), (31, 31), Trajectories(ways), 64)
        print(f"{what}: {time.process_time() - begin:.2f} s, {found.n_labels:,} labels, {found.message}", flush=True)
    same = n_points = 0
    for case in range(arguments.cases):
        rng = np.random.default_rng([4, case])
        # Walls that leave a way along one side or the other.
        occupied = rng.random((4, 4)) < 0.2
        occupied[0], occupied[:, -1] = False, False
        horizon, n_movers, cutting = int(rng.integers(3, 11)), int(rng.integers(1, 4)), bool(rng.integers(2))
        ways = [wander(rng, 4, horizon) for _ in range(n_movers)]
        grid = OccupancyGrid(occupied, corner_cutting=cutting)
        F = exact_timed_front(grid, (0, 0), (3, 3), Trajectories(ways), horizon).F
        n_points += len(F)
        expected = np.reshape(enumerated(occupied, cutting, (0, 0), (3, 3), ways, horizon), (-1, 3))
        same += F.shape == expected.shape and np.allclose(F, expected, rtol=0, atol=1e-12)
    print(f"{same} of {arguments.cases} small cases equal the enumeration, {n_points} points in all")


if __name__ == "__main__":
    main()
