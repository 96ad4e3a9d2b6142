"""The command `pymoo-gridpath explore`."""

from __future__ import annotations

from pathlib import Path

from pymoo_gridpath.cli.arguments import EXIT_OK, html_file
from pymoo_gridpath.errors import visible


def add_explore_command(commands) -> None:
    """Add the command `explore`; it sets ``run``, a function that returns the exit code."""
    explore = commands.add_parser("explore", help="make a page to choose a path from", description=_explore.__doc__)
    explore.set_defaults(run=_explore)
    explore.add_argument("paths", metavar="PATHS", help="a file that plan has written, such as gridpath-out/paths.json")
    explore.add_argument(
        "-o", "--output", type=html_file, metavar="FILE", help="the page (default: PATHS with the suffix .html)"
    )
    explore.add_argument("--title", metavar="TEXT", help="what stands above the page (default: the name of the map)")
    explore.add_argument("--show", action="store_true", help="draw the map with the paths on a terminal that can, too")


def _explore(arguments) -> int:
    """Make one file of the paths that `plan` found, for any browser and without a network, to look at and to choose from."""
    from pymoo_gridpath.cli.maps import show
    from pymoo_gridpath.decision import load_json
    from pymoo_gridpath.decision.drawn import scene_of
    from pymoo_gridpath.explorer import save_page

    trade_off = load_json(arguments.paths)
    if arguments.show:
        show(scene_of(trade_off))
    page = save_page(trade_off, arguments.output or Path(arguments.paths).with_suffix(".html"), arguments.title)
    print(f"page: {visible(page)}")
    return EXIT_OK
