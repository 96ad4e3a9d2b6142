"""The command `pymoo-gridpath suites`, and the option of `plan` that names a problem of one."""

from __future__ import annotations

import inspect
import textwrap
import tomllib
from typing import Any

from pymoo_gridpath.cli.arguments import EXIT_OK, options_besides, refuse_given
from pymoo_gridpath.errors import GridPathError, visible

# What a plan of a suite's problem takes; all else the suite says.
_HEEDED = (
    *("suite", "objectives", "obstacles", "penalty", "potential_limit"),
    *("algorithm", "operators", "pop_size", "generations", "runs", "seed", "max_seconds", "epsilon", "share"),
    *("output", "waypoints", "spacing", "speed", "html", "show", "units"),
)
_EXAMPLE = '{ class = "asletismac", instance = "ASLETISMAC_NO_X14_Y14_PM_K3_BF" }'


def add_suite_command(commands) -> None:
    """Add the command `suites`; it sets ``run``, a function that returns the exit code."""
    suites = commands.add_parser("suites", help="list the published suites of problems", description=_suites.__doc__)
    suites.set_defaults(run=_suites)


def add_suite(plan, group) -> None:
    """Add the option `--suite`, after all others that a suite decides."""
    group.add_argument(
        "--suite",
        metavar="TABLE",
        help=f"in place of a map, a problem of a published suite, as the key suite of a study has it: {_EXAMPLE}; "
        f"objectives go by the suite's names, by default all",
    )
    plan.set_defaults(decided_by_suite=options_besides(plan, _HEEDED))


def suite_problem(arguments) -> Any:
    """Return the problem that the option names.

    Raises
    ------
    GridPathError
        If there is no such problem, or an option is given that the suite decides.
    """
    from pymoo_gridpath.study import ProblemSpec

    refuse_given(arguments, arguments.decided_by_suite, "--suite, which says what is planned on and how paths are coded")
    suite = ProblemSpec(suite=_table(arguments.suite)).made_suite()
    assert suite is not None
    return suite.problem(
        arguments.objectives,
        obstacles=arguments.obstacles or "penalty",
        penalty=arguments.penalty,
        potential_limit=arguments.potential_limit,
    )


def _table(text: str) -> Any:
    """Return the name or the table that a text says."""
    if not text.lstrip().startswith("{"):
        return text
    try:
        found = tomllib.loads(f"suite = {text}")
    except (tomllib.TOMLDecodeError, RecursionError):
        found = {}
    if list(found) != ["suite"]:
        raise GridPathError(f"--suite is {visible(text)}, expected a name, or a table such as {_EXAMPLE}")
    return found["suite"]


def _suites(arguments) -> int:
    """List the published suites of problems, with what tells the problems of each apart and whose definitions it follows."""
    from pymoo_gridpath.problems import SUITES

    for name, suite in SUITES.items():
        takes = ", ".join(str(one).partition(":")[0] for one in inspect.signature(suite).parameters.values())
        print(f"{name}: {takes}")
        print(textwrap.fill(suite.follows, 100, initial_indent="  ", subsequent_indent="  "))
    return EXIT_OK
