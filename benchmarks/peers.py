"""Other libraries beside ours, in one go and on one core: NSGA-II on the paper's problem, and shortest paths on grids.

    python benchmarks/peers.py FOLDER [--maps arena lak304d random-64-64-20] [--queries 20] [--output FILE]
    python benchmarks/peers.py --parts searches --packages pygmo pymoo --sizes 32 128

FOLDER holds maps of the MovingAI benchmark, each with its queries beside it as NAME.map.scen. The libraries are those of the
extra ``peers``; one that is not there is named with the reason, and left out. Paths: each library is called as its
documentation says; the corner rule that it follows is measured on maps of four cells, and each path is checked against that
rule, our optimum under it, at the library's own cost of a diagonal and at the square root of two, and the published length. A
seeded dense map is added, of which nothing is published. Setting up (a graph, an array) is timed apart from the query, which
takes the least time of all repeats. Searches: the coding and objectives of Ahmed and Deb (2013), as many evaluations for each,
rows evaluated all at once; the hypervolume of the last population's legal paths over that of the exact front; medians over
seeds. Times are processor time; progress goes to standard error.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

# One core for each, before any of them is imported.
os.environ.update({f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "NUMBA", "RAYON")})

import logging

from peer_libraries.measure import cases_of, dense_case, measure_paths, measure_searches, split
from peer_libraries.paths import path_peers
from peer_libraries.searches import search_peers
from peer_libraries.tables import agreement_table, library_table, machine, path_times, search_table

from pymoo_gridpath.algorithms import ahmed_deb_2013
from pymoo_gridpath.problems import random_dense_grid

PARTS = ("paths", "searches")
MAPS = ("arena", "lak304d", "random-64-64-20")


def wanted(peers: list, packages: list[str] | None) -> list:
    """Return our rows and those of some packages, of all by default."""
    return [peer for peer in peers if packages is None or peer.package in {"pymoo_gridpath", *packages}]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, nargs="?", help="maps of MovingAI with their queries; needed for paths")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=PARTS)
    parser.add_argument("--packages", nargs="+", help="measure these beside ours alone, by the names that pip knows")
    parser.add_argument("--maps", nargs="+", default=MAPS, help=f"names of maps (default: {' '.join(MAPS)})")
    parser.add_argument("--queries", type=int, default=20, help="of each map (default: 20)")
    parser.add_argument("--repeats", type=int, default=2, help="of each query (default: 2)")
    parser.add_argument("--sizes", type=int, nargs="+", default=[32], help="cells a side of the searches (default: 32)")
    parser.add_argument("--p0", type=float, default=0.1, help="share of cells that are occupied (default: 0.1)")
    parser.add_argument("--pop-size", type=int, default=500)
    parser.add_argument("--n-gen", type=int, default=100)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--patience", type=float, default=15.0, help="seconds; who takes longer has no further run")
    parser.add_argument("--output", type=Path, help="a file for the tables, in Markdown; standard output by default")
    arguments = parser.parse_args()
    if "paths" in arguments.parts and arguments.folder is None:
        parser.error("paths need a folder of MovingAI's maps")
    # One of them tells of every step.
    logging.disable(logging.INFO)

    all_paths = wanted(list(path_peers()), arguments.packages) if "paths" in arguments.parts else []
    all_searches = wanted(search_peers(), arguments.packages) if "searches" in arguments.parts else []
    (paths, no_paths), (searches, no_searches) = split(all_paths), split(all_searches)
    texts = [
        f"Measured by `benchmarks/peers.py` on {machine()}.",
        library_table([*all_paths, *all_searches], no_paths | no_searches),
    ]
    if paths:
        cases = [*cases_of(arguments.folder, arguments.maps, arguments.queries), dense_case(arguments.queries)]
        rows, failed = measure_paths(paths, cases, arguments.repeats)
        texts += [
            f"### What comes back, {arguments.queries} queries on each of {', '.join(case.name for case in cases)}",
            agreement_table(rows),
        ]
        texts += [f"`{label}` failed: {why}" for label, why in failed.items()]
        texts += ["### Processor time of a path", path_times(rows, cases)]
    for size in arguments.sizes if searches else ():
        grid = random_dense_grid(size, arguments.p0, 1)
        problem = ahmed_deb_2013(grid, (0, 0), (size - 1, size - 1)).problem
        found = measure_searches(searches, problem, arguments.pop_size, arguments.n_gen, arguments.seeds, arguments.patience)
        n_eval = f"{arguments.pop_size} members, {arguments.n_gen} generations"
        texts += [
            f"### NSGA-II, {size} x {size} cells, p0 = {arguments.p0:g}, {problem.n_var} genes, {n_eval}",
            search_table(found),
        ]
        # What was slow is slower on larger maps.
        slow = {row.peer.label for row in found if row.runs[0][0] > arguments.patience}
        searches = [peer for peer in searches if peer.label not in slow]
        if slow and size != arguments.sizes[-1]:
            texts.append(f"Left out below, for they took more than {arguments.patience:g} s here: {'; '.join(sorted(slow))}.\n")
    text = "\n\n".join(part.strip("\n") for part in texts) + "\n"
    if arguments.output:
        arguments.output.write_text(text, encoding="utf-8")
    else:
        print(text, end="")


if __name__ == "__main__":
    main()
