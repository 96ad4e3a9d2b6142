"""Compare exact fronts of the path problems of Weise and Mostaghim with a plain dynamic programme, and with published fronts.

    python benchmarks/asletismac.py
    python benchmarks/asletismac.py --backtracking
    python benchmarks/asletismac.py --published PF.mat

Every pair and triple of the five objectives on every instance of 3 to 14 cells a side: 288 instances, 16 of which do not have a
path, so 5,440 fronts; with ``--backtracking`` those of the 288 instances where paths may go back. The programme is that of
``tests/plain_asletismac.py``, in plain Python. ``PF.mat`` is the file of that name that PlatEMO has beside its problem MaOPP,
with the fronts of all five objectives together; what is not dominated of some of them in it is the front of these. Points that
differ by less than 1e-5 are ties; published values are rounded to that, ours as well then, and may be off by 1e-4.

The first takes a minute of processor time, the second five minutes, the last half a minute.
"""

from __future__ import annotations

import argparse
import itertools
import sys
import time
from collections.abc import Callable
from pathlib import Path

import moocore
import numpy as np
from scipy.io import loadmat

from pymoo_gridpath.errors import GridError
from pymoo_gridpath.exact import exact_front
from pymoo_gridpath.problems import Asletismac

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from plain_asletismac import front, same  # pyright: ignore[reportMissingImports]

NAMES = ("length", "delay", "ascent", "travel_time", "turn")
CHOICES = [chosen for n in (2, 3) for chosen in itertools.combinations(NAMES, n)]

# The columns of the published fronts.
_PUBLISHED = ("ascent", "length", "travel_time", "turn", "delay")

# By how much published values may be off.
_PUBLISHED_OFF = 1e-4


def published(path: str) -> Callable[[str, tuple[str, ...]], np.ndarray]:
    """Return a function from an instance and objectives to the published front."""
    fronts = {name: points.reshape(-1, len(_PUBLISHED)) for name, points in loadmat(path).items() if name[0] != "_"}
    return lambda name, chosen: rounded(fronts[name][:, [_PUBLISHED.index(one) for one in chosen]])


def rounded(points: np.ndarray) -> np.ndarray:
    """Return what is not dominated of points once they are rounded."""
    points = np.unique(points.round(5), axis=0)
    return points[moocore.is_nondominated(points)] if len(points) else points


def are_published(found: np.ndarray, expected: np.ndarray) -> bool:
    """Whether a front is a published one."""
    found = rounded(found)
    return found.shape == expected.shape and bool(np.abs(found - expected).max() <= _PUBLISHED_OFF)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--backtracking", action="store_true", help="the instances whose paths may go back")
    parser.add_argument("--published", metavar="PF.mat", help="compare with published fronts in place of the programme")
    arguments = parser.parse_args()
    if arguments.published and arguments.backtracking:
        parser.error("fronts were published of instances without backtracking")
    other = published(arguments.published) if arguments.published else front
    are_same = are_published if arguments.published else lambda F, points: same(F.tolist(), points)
    n_fronts = n_same = n_none = 0
    largest, ours, theirs = 0, 0.0, 0.0
    for name in Asletismac.instances(arguments.backtracking):
        suite = Asletismac(name)
        try:
            suite.problem()
        except GridError:
            n_none += len(other(name, NAMES[:2])) == 0
            continue
        for chosen in CHOICES:
            begin = time.process_time()
            found = exact_front(suite.problem(chosen))
            middle = time.process_time()
            expected = other(name, chosen)
            ours, theirs = ours + middle - begin, theirs + time.process_time() - middle
            n_fronts += 1
            if found.complete and "max_cells" not in found.message and are_same(found.F, expected):
                n_same += 1
            else:
                print(f"{name} {', '.join(chosen)}: {found.message}, expected {len(expected)} points")
            largest = max(largest, len(found.F))
    print(f"{n_same} of {n_fronts} fronts are the same, the largest of {largest} points; {n_none} instances without a path")
    print(f"processor time: {ours:.1f} s with making the problems, {theirs:.1f} s for what they are compared with")
    sys.exit(n_same < n_fronts)


if __name__ == "__main__":
    main()
