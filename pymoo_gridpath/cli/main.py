"""The command line: plan on a map, list the shipped maps, describe a map file, compare algorithms in a study."""

from __future__ import annotations

import argparse
import io
import os
import re
import signal
import sys
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

import numpy as np

from pymoo_gridpath import checks
from pymoo_gridpath.cli.arguments import folder, positive
from pymoo_gridpath.cli.study import add_study_commands
from pymoo_gridpath.compiled import COMPILED, is_ctrl_c
from pymoo_gridpath.errors import GridError, GridPathError, counted, visible
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.maps import ShippedMap, TextHeader, load_map, map_format, read_text_header, shipped_maps
from pymoo_gridpath.memory import is_want_of_memory, needed, want_of_memory
from pymoo_gridpath.progress import Progress, say, warnings_as_lines
from pymoo_gridpath.representations import REPRESENTATIONS, default_representation

DEFAULT_MAP = "warehouse"

# Rows of the printed table; the files hold all paths.
MAX_ROWS = 40


EXIT_OK, EXIT_NO_PATH, EXIT_BAD_INPUT, EXIT_INTERRUPTED = 0, 1, 2, 130


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code.

    Returns
    -------
    int
        0; 1 if no legal path was found, or runs of a study failed; 2 on bad input, with one line on standard error; 130 if
        Ctrl-C ended the search, with what was found until then written.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # A terminal or pipe that lacks a letter of a map's name shows its number instead.
            stream.reconfigure(errors="backslashreplace")
    given = sys.argv[1:] if argv is None else checks.names("argv", argv)
    arguments = _parser().parse_args(_join_cells(given))
    try:
        with warnings_as_lines():
            code = _carry_out(arguments)
        sys.stdout.flush()
        return code
    except GridPathError as error:
        say(error)
        return EXIT_BAD_INPUT
    except (KeyboardInterrupt, SystemError) as error:
        if not is_ctrl_c(error):
            raise
        say("interrupted")
        return EXIT_INTERRUPTED
    except BrokenPipeError:
        # The reader has gone; keep the interpreter from complaining when it flushes.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_OK
    except OSError as error:
        where = f" ({error.filename})" if error.filename else ""
        say(f"the output cannot be written: {error.strerror or error}{where}")
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_BAD_INPUT


def _carry_out(arguments) -> int:
    """Run the command, and make a sentence of want of memory."""
    try:
        return arguments.run(arguments)
    except Exception as error:
        if not is_want_of_memory(error):
            raise
        # Without what the frames of the error hold.
        sentence = want_of_memory(getattr(arguments, "needs", ""))
    raise GridPathError(sentence)


# -- arguments ----------------------------------------------------------------------------------------------------------


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        """Say what was wrong in one line."""
        self.exit(EXIT_BAD_INPUT, f"{self.prog}: {visible(message)} (see {self.prog} --help)\n")


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="pymoo-gridpath", description="Multi-objective path planning on occupancy grids.")
    parser.add_argument("--version", action="version", version=f"%(prog)s {version('pymoo_gridpath')}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", title="commands")

    plan = commands.add_parser("plan", help="plan the trade-off paths of a query", description=_plan.__doc__)
    plan.set_defaults(run=_plan)
    plan.add_argument("map", nargs="?", metavar="MAP", help=f"map file or name of a shipped map (default: {DEFAULT_MAP})")
    plan.add_argument(
        "--start", type=_cell, metavar="X,Y", help="start cell; x to the right, y up, from 0,0 at the bottom left"
    )
    plan.add_argument("--goal", type=_cell, metavar="X,Y", help="goal cell")
    plan.add_argument("--radius", type=float, default=0.0, metavar="M", help="robot radius in metres (default: a point)")
    _add_map_options(plan)
    search = plan.add_argument_group("search")
    search.add_argument(
        "--algorithm",
        metavar="NAME",
        help="nsga2, spea2, moead, ...; exact for the whole front (default: nsga2; ga for one objective)",
    )
    search.add_argument(
        "--representation",
        choices=REPRESENTATIONS,
        help="how a path is coded (default: cells, which can turn back; integer where corners may be cut, which is the world "
        "of the paper, or where an --axis is given)",
    )
    search.add_argument(
        "--objectives",
        type=lambda text: text.split(","),
        default=["length", "vulnerability"],
        metavar="A,B",
        help="some of length, vulnerability, turn (default: length,vulnerability)",
    )
    search.add_argument(
        "--obstacles", choices=("penalty", "constraint", "limit"), help="how collisions are ruled out (default: penalty)"
    )
    search.add_argument("--penalty", type=float, metavar="P", help="what crossing an occupied cell adds to each objective")
    search.add_argument("--potential-limit", type=float, metavar="P0", help="largest vulnerability, with --obstacles limit")
    search.add_argument(
        "--axis",
        choices=("auto", "x", "y"),
        default="auto",
        help="axis along which paths advance that never turn back (default: auto)",
    )
    search.add_argument("--pop-size", type=positive, metavar="N", help="population size (default: 200)")
    search.add_argument("--generations", type=positive, metavar="N", help="generations of a run (default: 200)")
    search.add_argument("--runs", type=positive, metavar="N", help="runs that are merged into one front (default: 1)")
    search.add_argument(
        "--max-seconds", type=float, metavar="S", help="time for --algorithm exact; what it has found by then is kept"
    )
    search.add_argument("--seed", type=_natural, default=1, help="seed of the first run; run k has seed + k (default: 1)")
    plan.add_argument(
        "-o",
        "--output",
        type=folder,
        default=Path("gridpath-out"),
        metavar="DIR",
        help="where files go (default: gridpath-out)",
    )
    plan.add_argument("--units", choices=("cells", "m"), default="cells", help="axes of the map figure (default: cells)")

    maps = commands.add_parser("maps", help="list the shipped maps", description=_maps.__doc__)
    maps.set_defaults(run=_maps)

    info = commands.add_parser("info", help="describe a map file", description=_info.__doc__)
    info.set_defaults(run=_info)
    info.add_argument("map", metavar="MAP", help="map file or name of a shipped map")
    _add_map_options(info)

    add_study_commands(commands)
    return parser


def _add_map_options(parser: argparse.ArgumentParser) -> None:
    group = parser.add_argument_group("reading the map")
    group.add_argument("--resolution", type=float, metavar="M", help="metres a cell, for formats that do not say")
    group.add_argument("--unknown", choices=("free", "occupied"), help="what unknown cells of ROS maps and images count as")
    group.add_argument(
        "--threshold", type=float, metavar="T", help="grey level below which an image's pixel is occupied, 0 to 1"
    )
    group.add_argument("--corner-cutting", action="store_true", default=None, help="allow diagonal steps past occupied cells")


def _join_cells(argv: Sequence[str]) -> list[str]:
    """Return arguments in which a cell such as -1,0 is joined to its option, which argparse would take for another option."""
    joined: list[str] = []
    for text in argv:
        if joined and joined[-1] in ("--start", "--goal") and re.fullmatch(r"-\d+,.*", text):
            joined[-1] += f"={text}"
        else:
            joined.append(text)
    return joined


def _cell(text: str) -> tuple[int, int]:
    try:
        x, y = (int(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a cell, expected X,Y such as 12,40") from None
    return x, y


def _natural(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number, zero or more")
    return int(text)


# -- commands -----------------------------------------------------------------------------------------------------------


def _plan(arguments) -> int:
    """Plan paths from a start to a goal, print the trade-off table, and write figures and files."""
    # Imported late, since `maps`, `info` and --help do without.
    from pymoo_gridpath.algorithms import ExactFront, make_algorithm
    from pymoo_gridpath.convergence import ConvergenceRecorder
    from pymoo_gridpath.decision.provenance import describe_source
    from pymoo_gridpath.plotting import save_figures
    from pymoo_gridpath.problems import GridPathProblem

    if arguments.obstacles == "limit" and arguments.potential_limit is None:
        raise GridPathError("--obstacles limit needs --potential-limit P0, the largest vulnerability that a path may have")
    grid, known = _load(arguments.map or DEFAULT_MAP, arguments)
    start, goal = _query(arguments, grid, known)
    # Now, since the map planned on is the one grown by the radius, and the file may be another one after the search.
    unknown, source = _unknown(grid), describe_source(grid)
    grid = _inflate(grid, arguments.radius, start, goal)
    representation = arguments.representation or default_representation(grid.corner_cutting, arguments.axis)
    arguments.needs = _needed(grid, start, representation, arguments)
    problem = GridPathProblem(
        grid,
        start,
        goal,
        representation=representation,
        objectives=arguments.objectives,
        obstacles=arguments.obstacles or "penalty",
        penalty=arguments.penalty,
        potential_limit=arguments.potential_limit,
        axis=arguments.axis,
    )
    name = arguments.algorithm or ("nsga2" if problem.n_obj > 1 else "ga")
    algorithm = make_algorithm(name, problem, pop_size=arguments.pop_size or 200)
    if isinstance(algorithm, ExactFront):
        for option in ("pop_size", "generations", "runs"):
            if getattr(arguments, option) is not None:
                raise GridPathError(
                    f"--{option.replace('_', '-')} is not for --algorithm exact, which finds the whole front at once"
                )
    arguments.generations, arguments.runs = arguments.generations or 200, arguments.runs or 1
    if arguments.max_seconds is not None and not isinstance(algorithm, ExactFront):
        raise GridPathError(f"--max-seconds is for --algorithm exact, not for {name}; expected --generations instead")
    if not COMPILED and _searches_in_kernels(problem, algorithm):
        print(
            "numba is not installed, so the search runs as plain Python, many times slower; pip install 'pymoo_gridpath[fast]'",
            file=sys.stderr,
        )
    _make_directory(arguments.output)

    print(f"{visible(grid.name)}: {grid.width} x {grid.height} cells, from {start} to {goal}", flush=True)
    if unknown is not None:
        print(f"unknown: {unknown}", flush=True)
    with _StopOnCtrlC() as stop:
        results = _search(problem, algorithm, arguments, stop)
        stop.searching = False
        if not any(len(result.pop) for result in results):
            say(f"no path was found: {results[0].message}")
            return EXIT_NO_PATH
        trade_off, files = _write_paths(results, arguments, name, source, stop.requested)

    if stop.requested:
        print("interrupted: what was found until then follows", file=sys.stderr)
    elif results[0].success is False:
        print(f"the front is not complete: the search {results[0].message}", file=sys.stderr)
    print(trade_off.table(max_rows=MAX_ROWS))
    if trade_off.advice:
        say(trade_off.advice)
    if len(results) > 1:
        print(f"{sum(_found_legal(result) for result in results)} of {len(results)} runs found a legal path")
    print("written: " + ", ".join(visible(file) for file in files), flush=True)
    history = [result.algorithm.callback for result in results if isinstance(result.algorithm.callback, ConvergenceRecorder)]
    figures = save_figures(trade_off, arguments.output, history=history or None, units=arguments.units)
    print("figures: " + ", ".join(visible(file) for file in figures))
    if stop.requested:
        return EXIT_INTERRUPTED
    if not trade_off.feasible:
        say(
            "no legal path was found; a larger --pop-size, more --generations or --runs, or --obstacles constraint may find one"
        )
        return EXIT_NO_PATH
    return EXIT_OK


def _maps(arguments) -> int:
    """List the shipped maps with the query that `plan` solves on each by default."""
    for item in shipped_maps():
        grid = load_map(item.name)
        print(
            f"{item.name:<12} {grid.width:>3} x {grid.height:<3} {item.title}; from {_text(item.start)} to {_text(item.goal)}"
        )
    return EXIT_OK


def _info(arguments) -> int:
    """Describe a map file as it is read."""
    grid, known = _load(arguments.map, arguments)
    occupied = grid.n_occupied
    sizes = np.bincount(grid.regions.ravel())[1:]
    x, y, yaw = grid.origin
    rows = {
        "name": grid.name,
        "size": f"{grid.width} x {grid.height} cells, {grid.width * grid.resolution:g} x {grid.height * grid.resolution:g} m",
        "resolution": f"{grid.resolution:g} m a cell",
        "origin": f"x {x:g} m, y {y:g} m, yaw {yaw:g} rad, the corner of cell 0,0",
        "occupied": f"{occupied} cells, {occupied / grid.occupied.size:.1%}",
        **({} if (unknown := _unknown(grid)) is None else {"unknown": unknown}),
        "free regions": f"{len(sizes)}" + (f", the largest of {sizes.max()} cells" if len(sizes) else ""),
        "corners": "may be cut" if grid.corner_cutting else "may not be cut",
    }
    if known and known.start and known.goal:
        rows["query"] = f"from {_text(known.start)} to {_text(known.goal)}, robot radius {known.radius or 0:g} m"
    for key, value in rows.items():
        print(f"{key:<13} {visible(value)}")
    return EXIT_OK


# -- parts --------------------------------------------------------------------------------------------------------------


def _load(name: str, arguments) -> tuple[OccupancyGrid, ShippedMap | TextHeader | None]:
    """Return the grid of a file or of a shipped map, and the query that it names, if it does."""
    options = {key: getattr(arguments, key) for key in ("resolution", "unknown", "threshold", "corner_cutting")}
    grid = load_map(name, **{key: value for key, value in options.items() if value is not None})
    if not Path(name).is_file():
        return grid, next((item for item in shipped_maps() if item.name == name), None)
    return grid, read_text_header(name) if map_format(name) == "a plain text map" else None


def _unknown(grid: OccupancyGrid) -> str | None:
    """Return in words how many cells of a map as read are unknown and what they count as; None if its kind knows none."""
    if grid.unknown is None:
        return None
    n = int(grid.unknown.sum())
    meaning = ("occupied" if grid.occupied[grid.unknown].all() else "free") if n else ""
    return counted(n, "cell") + (f", {n / grid.unknown.size:.1%}, taken as {meaning}" if n else "")


def _query(arguments, grid: OccupancyGrid, known: ShippedMap | TextHeader | None):
    """Return start and goal, by default those that the map names, checked on the map as it was read."""
    start = arguments.start or (known and known.start)
    goal = arguments.goal or (known and known.goal)
    if not start or not goal:
        missing = " and ".join(f"--{role}" for role, cell in (("start", start), ("goal", goal)) if not cell)
        raise GridError(
            f"the map {grid.name!r} needs {missing}, expected a cell X,Y with x from 0 to {grid.width - 1} and y from 0 "
            f"(bottom) to {grid.height - 1}"
        )
    return grid.check_query(start, goal)


def _needed(grid: OccupancyGrid, start, representation: str, arguments) -> str:
    """Return what a plan costs in memory, in words."""
    height, width = grid.box_of(start).shape
    exact = (arguments.algorithm or "").lower() == "exact"
    return needed(representation, height * width, exact, "turn" in arguments.objectives, f"{width} x {height}")


def _inflate(grid: OccupancyGrid, radius: float, start, goal) -> OccupancyGrid:
    inflated = grid.inflate(radius)
    try:
        inflated.check_query(start, goal)
    except GridError as error:
        raise type(error)(f"with obstacles grown by the robot's radius of {radius:g} m, {error}") from None
    return inflated


def _searches_in_kernels(problem, algorithm) -> bool:
    """Return whether a search spends its time in kernels that numba compiles."""
    from pymoo_gridpath.algorithms import ExactFront

    return isinstance(algorithm, ExactFront) or not problem.representation.paper


def _search(problem, algorithm, arguments, stop: _StopOnCtrlC) -> list:
    """Return the Results of the runs, with progress shown, ended early if Ctrl-C asks for it."""
    from pymoo_gridpath.algorithms import ExactFront, minimize_runs
    from pymoo_gridpath.convergence import ConvergenceRecorder

    def observe(run, algorithm):
        progress.update(run, algorithm)
        return stop.requested

    def watch(meter):
        progress.note(f"{meter.n_labels:,} labels, {meter.elapsed:.0f} s")
        return stop.requested

    with Progress(arguments.runs, arguments.generations) as progress:
        if isinstance(algorithm, ExactFront):
            algorithm = ExactFront(max_seconds=arguments.max_seconds, watch=watch)
            return minimize_runs(problem, algorithm, n_runs=1, seed=arguments.seed)
        termination = ("n_gen", arguments.generations)
        return minimize_runs(problem, algorithm, termination, arguments.runs, arguments.seed, ConvergenceRecorder(), observe)


def _found_legal(result) -> bool:
    return bool(np.any(np.asarray(result.pop.get("interfering_cells")) == 0))


def _write_paths(results, arguments, name: str, source: dict, interrupted: bool):
    """Return the trade-off set of the runs, and the files that it was written to."""
    from pymoo_gridpath.decision import TradeOffSet

    settings = {
        "algorithm": {"name": name},
        "robot_radius": arguments.radius,
        "source_map": source,
        "interrupted": interrupted,
    }
    trade_off = TradeOffSet.from_results(results, settings=settings)
    files = [trade_off.to_csv(arguments.output / "paths.csv"), trade_off.to_json(arguments.output / "paths.json")]
    return trade_off, files


def _make_directory(path: Path) -> None:
    """Make the output directory before the search, so that no result is lost for want of it."""
    if path.exists() and not path.is_dir():
        raise GridPathError(f"the output directory {path} is a file, expected a folder or a new name")
    try:
        path.mkdir(parents=True, exist_ok=True)
        writable = os.access(path, os.W_OK)
    except OSError as error:
        raise GridPathError(f"the output directory {path} cannot be made: {error.strerror or error}") from None
    if not writable:
        raise GridPathError(f"the output directory {path} cannot be written to")


def _text(cell) -> str:
    return f"{cell[0]},{cell[1]}"


class _StopOnCtrlC:
    """While open, the first Ctrl-C asks the search to stop after the generation under way, the second ends it at once.

    Once ``searching`` is False, Ctrl-C only makes a note, so that what was found is written.
    """

    def __init__(self):
        self.requested = False
        self.searching = True

    def __enter__(self):
        self._before = signal.signal(signal.SIGINT, self._request)
        return self

    def __exit__(self, *exception):
        signal.signal(signal.SIGINT, self._before)

    def _request(self, number, frame):
        if self.requested and self.searching:
            raise KeyboardInterrupt
        if not self.requested:
            print("\nstopping, and keeping what was found; Ctrl-C again ends at once and loses it", file=sys.stderr)
        self.requested = True


if __name__ == "__main__":
    sys.exit(main())
