"""The command `pymoo-gridpath plan`."""

from __future__ import annotations

import functools
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pymoo_gridpath.cli.arguments import (
    EXIT_FAILED,
    EXIT_INTERRUPTED,
    EXIT_OK,
    folder,
    html_file,
    natural,
    operators,
    positive,
    share,
)
from pymoo_gridpath.cli.ground import add_ground, given_ground, ground_of
from pymoo_gridpath.cli.maps import add_reading, load, show
from pymoo_gridpath.cli.query import add_query, ends, grown
from pymoo_gridpath.cli.resume import add_resume, read_stored, said, write_populations
from pymoo_gridpath.cli.suites import add_suite, suite_problem
from pymoo_gridpath.cli.waypoints import add_waypoint_options, check_waypoint_options, write_waypoints
from pymoo_gridpath.errors import GridPathError, visible
from pymoo_gridpath.interrupt import StopOnCtrlC
from pymoo_gridpath.progress import Progress, say

if TYPE_CHECKING:
    from pymoo_gridpath.grid import OccupancyGrid

DEFAULT_MAP = "warehouse"
DEFAULT_OBJECTIVES = ["length", "vulnerability"]

# Options that planners take, each those that its constructor does.
PLANNERS_OWN = ("max_seconds", "epsilon", "share")

RISKS = ("robot", "paper", "inflation")

# Rows of the printed table; the files hold all paths.
MAX_ROWS = 40


def add_plan_command(commands) -> None:
    """Add the command `plan`; it sets ``run``, a function that returns the exit code."""
    plan = commands.add_parser("plan", help="plan the trade-off paths of a query", description=_plan.__doc__)
    plan.set_defaults(run=_plan)
    plan.add_argument("map", nargs="?", metavar="MAP", help=f"map file or name of a shipped map (default: {DEFAULT_MAP})")
    add_query(plan)
    add_reading(plan)
    search = plan.add_argument_group("search")
    search.add_argument(
        "--algorithm",
        metavar="NAME",
        help="an algorithm or planner: nsga2, spea2, moead, ... (default: nsga2; ga for one objective)",
    )
    search.add_argument(
        "--representation",
        metavar="NAME",
        help="how a path is coded (default: cells, which can turn back; integer where corners may be cut, which is the world "
        "of the paper, or where an --axis is given)",
    )
    search.add_argument(
        "--objectives",
        type=lambda text: text.split(","),
        metavar="A,B",
        help="some of length, vulnerability, turn, inflation, clearance (default: length,vulnerability)",
    )
    search.add_argument(
        "--risk",
        choices=RISKS,
        help="what vulnerability means: robot, a bell of the nearest obstacle in metres (default on maps that state their "
        "resolution); paper, a sum of bells in cells (default on others); inflation, the formula of navigation2",
    )
    search.add_argument(
        "--sigma-m",
        type=float,
        metavar="M",
        help="standard deviation of the robot's risk in metres (default: 0.3, at least 2 cells)",
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
    search.add_argument(
        "--operators",
        type=operators,
        metavar="KIND=NAME,...",
        help="sampling, crossover, mutation, repair or others, by name, such as crossover=SpliceCrossover",
    )
    search.add_argument("--pop-size", type=positive, metavar="N", help="population size (default: 200)")
    search.add_argument("--generations", type=positive, metavar="N", help="generations of a run (default: 200)")
    search.add_argument("--runs", type=positive, metavar="N", help="runs that are merged into one front (default: 1)")
    search.add_argument("--max-seconds", type=float, metavar="S", help="time of a planner; what it has found by then is kept")
    near = search.add_mutually_exclusive_group()
    near.add_argument(
        "--epsilon",
        type=share,
        metavar="E",
        help="of --algorithm exact: content with a front proven to be within this factor in each objective, such as 2%%",
    )
    near.add_argument(
        "--share", type=share, metavar="S", help="the same with a share of each objective's range, where one may be zero"
    )
    search.add_argument("--seed", type=natural, default=1, help="seed of the first run; run k has seed + k (default: 1)")
    add_ground(plan)
    plan.add_argument(
        "-o",
        "--output",
        type=folder,
        default=Path("gridpath-out"),
        metavar="DIR",
        help="where files go (default: gridpath-out)",
    )
    add_waypoint_options(plan)
    plan.add_argument("--html", type=html_file, metavar="FILE", help="write a page to choose a path from")
    plan.add_argument("--show", action="store_true", help="draw the map with the paths on a terminal that can")
    plan.add_argument("--units", choices=("cells", "m"), help="axes of the map figure (default: metres if the map has them)")
    add_suite(plan, search)
    add_resume(plan, search)


def _plan(arguments) -> int:
    """Plan paths from a start to a goal, print the trade-off table, and write figures and files."""
    # Imported late, since `maps`, `info` and --help do without.
    from pymoo_gridpath.algorithms import find_algorithm
    from pymoo_gridpath.decision.provenance import describe_source
    from pymoo_gridpath.grid.picture import unknown_of
    from pymoo_gridpath.maps import query_of
    from pymoo_gridpath.problems import GridPathProblem
    from pymoo_gridpath.problems.standing import StandingProblem
    from pymoo_gridpath.representations import default_representation

    if arguments.resume is not None:
        return _go_on(arguments)
    if arguments.suite is not None:
        return _plan_suite(arguments)
    if arguments.obstacles == "limit" and arguments.potential_limit is None:
        raise GridPathError("--obstacles limit needs --potential-limit P0, the largest vulnerability that a path may have")
    arguments.objectives = DEFAULT_OBJECTIVES if arguments.objectives is None else arguments.objectives
    map_name = arguments.map or DEFAULT_MAP
    grid = load(map_name, arguments)
    if arguments.units == "m":
        # Now, and not once the search has ended.
        grid.check_resolution("--units m")
    check_waypoint_options(arguments, grid)
    # Now, since the map planned on is the one grown by the radius, and the file may be another one after the search.
    unknown, source = unknown_of(grid), describe_source(grid)
    grid, ground = ground_of(grid, map_name, arguments)
    arguments.objectives = [*arguments.objectives, *ground]
    grid = grown(grid, arguments)
    start, goal = ends(grid, query_of(map_name), arguments)
    objectives = _objectives(arguments, grid)
    representation = arguments.representation or default_representation(grid.corner_cutting, arguments.axis)
    name = arguments.algorithm or ("nsga2" if len(arguments.objectives) > 1 else "ga")
    spec = find_algorithm(name, len(arguments.objectives))
    _settle_options(spec, name, arguments)
    arguments.needs = _needed(grid, start, representation, arguments, spec.reference)
    settings = {
        "objectives": objectives,
        "obstacles": arguments.obstacles or "penalty",
        "penalty": arguments.penalty,
        "potential_limit": arguments.potential_limit,
    }
    standing = start == goal
    if standing:
        problem = StandingProblem(grid, start, **settings)
    else:
        problem = GridPathProblem(grid, start, goal, representation, axis=arguments.axis, **settings)
    algorithm = None if standing else _algorithm(name, spec, problem, arguments)
    return _carry_out(problem, name, spec, algorithm, arguments, source, unknown)


def _plan_suite(arguments) -> int:
    """Plan on a problem of a suite."""
    from pymoo_gridpath.algorithms import find_algorithm
    from pymoo_gridpath.decision.provenance import describe_source

    problem = suite_problem(arguments)
    grid, arguments.objectives = problem.grid, problem.objective_names
    if arguments.units == "m":
        grid.check_resolution("--units m")
    check_waypoint_options(arguments, grid)
    name = arguments.algorithm or ("nsga2" if problem.n_obj > 1 else "ga")
    spec = find_algorithm(name, problem.n_obj)
    _settle_options(spec, name, arguments)
    arguments.needs = _needed(grid, problem.start, problem.representation.name, arguments, spec.reference)
    algorithm = _algorithm(name, spec, problem, arguments)
    return _carry_out(problem, name, spec, algorithm, arguments, describe_source(grid), None)


def _go_on(arguments) -> int:
    """Plan from the last populations of an earlier plan."""
    from pymoo_gridpath.algorithms import find_algorithm

    stored = read_stored(arguments)
    problem, settings = stored.problem, stored.settings
    if arguments.units == "m":
        problem.grid.check_resolution("--units m")
    check_waypoint_options(arguments, problem.grid)
    name = arguments.algorithm or settings["algorithm"]["name"]
    spec = find_algorithm(name, problem.n_obj)
    if isinstance(spec, type):
        raise GridPathError(f"--resume is not for --algorithm {name}, a planner that begins with no population")
    _settle_options(spec, name, arguments)
    arguments.objectives, arguments.runs = problem.objective_names, len(stored.populations)
    arguments.pop_size = arguments.pop_size or settings["runs"][0]["pop_size"]
    arguments.needs = _needed(problem.grid, problem.start, problem.representation.name, arguments, False)
    print(said(stored, arguments.resume), flush=True)
    starts = [_algorithm(name, spec, problem, arguments, start=X) for X in stored.populations]
    return _carry_out(problem, name, spec, starts, arguments, settings["source_map"], None, stored.seed)


def _carry_out(problem, name: str, spec, algorithm, arguments, source: dict, unknown: str | None, resumed=None) -> int:
    """Search, print and write; of a plan that goes on there is an algorithm for each run, and the seed of the one before."""
    from pymoo_gridpath.compiled import COMPILED
    from pymoo_gridpath.convergence import ConvergenceRecorder
    from pymoo_gridpath.decision.drawn import scene_of
    from pymoo_gridpath.explorer import save_page
    from pymoo_gridpath.plotting import save_figures

    grid, start, goal, standing = problem.grid, problem.start, problem.goal, algorithm is None
    if not COMPILED and not standing and (isinstance(spec, type) or not problem.representation.paper):
        print(
            "numba is not installed, so the search runs as plain Python, many times slower; pip install 'pymoo_gridpath[fast]'",
            file=sys.stderr,
        )
    _make_directory(arguments.output)

    print(f"{visible(grid.name)}: {grid.width} x {grid.height} cells, from {start} to {goal}", flush=True)
    if unknown is not None:
        print(f"unknown: {unknown}", flush=True)
    with StopOnCtrlC() as stop:
        results = [] if standing else _search(problem, name, spec, algorithm, arguments, stop)
        stop.searching = False
        if results and not any(len(result.pop) for result in results):
            say(f"no path was found: {results[0].message}")
            return EXIT_FAILED
        trade_off, files = _write_paths(problem, results, arguments, name, source, stop.requested, resumed)

    if stop.requested:
        print("interrupted: what was found until then follows", file=sys.stderr)
    if results and results[0].success is False:
        print(f"the front is not complete: the search {results[0].message}", file=sys.stderr)
    elif results and not stop.requested and (arguments.epsilon or arguments.share):
        print(f"{name}: {results[0].message}")
    print(trade_off.table(max_rows=MAX_ROWS))
    if arguments.show:
        show(scene_of(trade_off))
    if trade_off.advice:
        say(trade_off.advice)
    if len(results) > 1:
        print(f"{sum(_n_legal(result.algorithm) > 0 for result in results)} of {len(results)} runs found a legal path")
    print("written: " + ", ".join(visible(file) for file in files), flush=True)
    write_waypoints(trade_off, arguments)
    history = [result.algorithm.callback for result in results if isinstance(result.algorithm.callback, ConvergenceRecorder)]
    figures = save_figures(trade_off, arguments.output, history=history or None, units=arguments.units)
    print("figures: " + ", ".join(visible(file) for file in figures))
    if arguments.html:
        print(f"page: {visible(save_page(trade_off, arguments.html))}")
    if stop.requested:
        return EXIT_INTERRUPTED
    if not trade_off.feasible:
        say(
            "no legal path was found; a larger --pop-size, more --generations or --runs, or --obstacles constraint may find one"
        )
        return EXIT_FAILED
    return EXIT_OK


# -- parts ---------------------------------------------------------------------------------------------------------------


def _objectives(arguments, grid: OccupancyGrid) -> list:
    """Return the objectives asked for, with the risk that is meant in the place of the vulnerability."""
    from pymoo_gridpath.fields import PAPER_VARIANCE
    from pymoo_gridpath.objectives import Inflation, Vulnerability

    risk, sigma_m = arguments.risk, arguments.sigma_m
    given = "--risk" if sigma_m is None else "--sigma-m"
    if risk is None and sigma_m is None:
        return arguments.objectives
    if Vulnerability.name not in arguments.objectives:
        raise GridPathError(f"{given} is for the objective vulnerability, which is not among --objectives")
    if sigma_m is not None and risk not in (None, "robot"):
        raise GridPathError(f"--sigma-m is for the robot's risk, not for --risk {risk}")
    if risk == "paper":
        meant = Vulnerability(variance=PAPER_VARIANCE)
    elif risk == "inflation":
        meant = Inflation()
    else:
        grid.check_resolution(f"{given} {risk if sigma_m is None else f'{sigma_m:g}'}")
        meant = Vulnerability(sigma_m=sigma_m)
    return [meant if name == Vulnerability.name else name for name in arguments.objectives]


def _needed(grid: OccupancyGrid, start, representation: str, arguments, whole_front: bool) -> str:
    """Return what a plan costs in memory, in words."""
    from pymoo_gridpath.memory import needed
    from pymoo_gridpath.representations import REPRESENTATIONS

    height, width = grid.box_of(start).shape
    monotone = REPRESENTATIONS[representation].monotone
    cells, turn = f"{width} x {height}", "turn" in arguments.objectives
    return needed(representation, monotone, height * width, whole_front, turn, cells)


def _settle_options(spec, name: str, arguments) -> None:
    """Refuse options that an algorithm or planner does not take, and fill in the others."""
    is_planner = isinstance(spec, type)
    takes = {
        "pop_size": spec.takes_pop_size,
        "operators": spec.takes_operators or not is_planner,
        "generations": spec.takes_generations,
        "runs": not spec.deterministic,
        **{option: is_planner and option in spec.parameters() for option in PLANNERS_OWN},
    }
    for option, taken in takes.items():
        if getattr(arguments, option) is not None and not taken:
            why = "a planner that takes none" if is_planner else "which takes --generations"
            raise GridPathError(f"--{option.replace('_', '-')} is not for --algorithm {name}, {why}")
    arguments.generations, arguments.runs = arguments.generations or 200, arguments.runs or 1


def _algorithm(name: str, spec, problem, arguments, start=None, **more):
    """Return the algorithm or planner, one that begins with given genes if there are any.

    Of the time and of what is given besides, a planner gets what it takes.
    """
    from pymoo_gridpath.algorithms import make_algorithm
    from pymoo_gridpath.operators import default_operators
    from pymoo_gridpath.operators.sampling import GivenRows

    given: dict[str, Any] = {"pop_size": arguments.pop_size or 200} if spec.takes_pop_size else {}
    if arguments.operators is not None:
        given["operators"] = arguments.operators
    if start is not None:
        given["operators"] = {
            **given.get("operators", {}),
            "sampling": GivenRows(start, default_operators(problem)["sampling"]),
        }
    if isinstance(spec, type):
        more = {**{option: getattr(arguments, option) for option in PLANNERS_OWN}, **more}
        given |= {key: value for key, value in more.items() if key in spec.parameters()}
    return make_algorithm(name, problem, **given)


def _search(problem, name: str, spec, algorithm, arguments, stop: StopOnCtrlC) -> list:
    """Return the Results of the runs, with progress shown, ended early if Ctrl-C asks for it."""
    from pymoo_gridpath.algorithms import minimize_runs
    from pymoo_gridpath.convergence import ConvergenceRecorder

    def observe(run, algorithm):
        progress.update(run, algorithm, _n_legal)
        return stop.requested

    so_far: list[str] = []

    def keep(run, planner):
        so_far[:] = [planner.message]

    def watch(meter):
        progress.note(", ".join([*so_far, f"{meter.n_labels:,} labels", f"{meter.elapsed:.0f} s"]))
        if stop.requested:
            meter.message = "stopped by Ctrl-C"
        return stop.requested

    with Progress(arguments.runs, arguments.generations) as progress:
        if isinstance(spec, type):
            planner = _algorithm(name, spec, problem, arguments, watch=watch)
            return minimize_runs(problem, planner, n_runs=arguments.runs, seed=arguments.seed, observe=keep)
        termination = ("n_gen", arguments.generations)
        if not isinstance(algorithm, list):
            return minimize_runs(
                problem, algorithm, termination, arguments.runs, arguments.seed, ConvergenceRecorder(), observe
            )
        results = []
        for k, one in enumerate(algorithm):
            own = functools.partial(lambda run, _, algorithm: observe(run, algorithm), k)
            results += minimize_runs(problem, one, termination, 1, arguments.seed + k, ConvergenceRecorder(), own)
            if stop.requested:
                break
        return results


def _n_legal(algorithm) -> int:
    from pymoo_gridpath.problems.members import Members

    return Members(algorithm).n_legal


def _write_paths(problem, results, arguments, name: str, source: dict, interrupted: bool, resumed=None):
    """Return the trade-off set of the runs, and the files that it was written to; without a run, the robot stays."""
    from pymoo_gridpath.decision import TradeOffSet

    settings = {
        "algorithm": {"name": name if results else None},
        "robot_radius": problem.grid.robot_radius,
        "source_map": source,
        "interrupted": interrupted,
        **({} if resumed is None else {"resumed_from_seed": resumed}),
        **given_ground(arguments),
    }
    if results:
        trade_off = TradeOffSet.from_results(results, settings=settings)
    else:
        trade_off = TradeOffSet.from_genes(problem, problem.row, settings)
    files = [trade_off.to_csv(arguments.output / "paths.csv"), trade_off.to_json(arguments.output / "paths.json")]
    return trade_off, files + write_populations(results, arguments.output)


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
