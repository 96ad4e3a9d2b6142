"""Run the experiments of Ahmed and Deb (2013), print what they published beside ours, and draw their figures.

    python benchmarks/paper.py --section 5.5 --output figures

By default each section takes less than 15 minutes on two cores, with fewer runs than the paper where that does not suffice;
``--full`` makes as many, or as many as a test needs to tell. Seeds count from 1. Intervals in brackets hold in 95 %. Obstacle
fields of the paper's figures are lost with these; fields of the same kind stand in.
"""

from __future__ import annotations

import argparse
import os
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from importlib import import_module
from pathlib import Path

# One thread for each process: the arrays are small, and threads of the linear algebra would only get in each other's way.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import matplotlib as mpl
from paper_sections.base import Clock, Settings

SECTIONS = ("2.1", "4.1", "5.3", "5.4", "5.5", "5.6", "6")


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--section", nargs="+", choices=SECTIONS, default=SECTIONS, help="sections (default: all)")
    parser.add_argument("--full", action="store_true", help="as many runs as the paper, or as a test needs")
    parser.add_argument("--output", type=Path, metavar="FOLDER", help="draw the figures there")
    parser.add_argument("--runs", type=int, help="runs of each row")
    parser.add_argument("--members", type=int, help="members of a population (default: 500, of Table 1 200)")
    parser.add_argument("--generations", type=int, help="generations of a run (default: 500)")
    parser.add_argument("--largest", type=int, default=128, help="the most cells a side (default: 128)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="processes (default: as many as cores)")
    given = parser.parse_args(arguments)
    mpl.use("Agg")
    with ProcessPoolExecutor(given.jobs) if given.jobs > 1 else ThreadPoolExecutor(1) as pool:
        settings = Settings(pool, given.full, given.runs, given.members, given.generations, given.largest, given.output)
        for section in given.section:
            print(f"Section {section}\n{'=' * 11}")
            with Clock():
                import_module(f"paper_sections.section_{section.replace('.', '_')}").run(settings)


if __name__ == "__main__":
    main()
