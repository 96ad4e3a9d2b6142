"""The command line: plan on a map, list the shipped maps, describe a map file, compare algorithms in a study."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Sequence
from importlib.metadata import version

from pymoo_gridpath import checks
from pymoo_gridpath.cli.arguments import EXIT_BAD_INPUT, EXIT_INTERRUPTED, EXIT_OK, Parser, join_places
from pymoo_gridpath.cli.explore import add_explore_command
from pymoo_gridpath.cli.maps import add_map_commands
from pymoo_gridpath.cli.plan import add_plan_command
from pymoo_gridpath.cli.study import add_study_commands
from pymoo_gridpath.cli.suites import add_suite_command
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.memory import is_want_of_memory, want_of_memory
from pymoo_gridpath.progress import say, warnings_as_lines

# The commands import what they need when they run, so that --help and bad options take no time.


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
    arguments = _parser().parse_args(join_places(given))
    try:
        with warnings_as_lines():
            code = _carry_out(arguments)
        sys.stdout.flush()
        return code
    except GridPathError as error:
        say(error)
        return EXIT_BAD_INPUT
    except (KeyboardInterrupt, SystemError) as error:
        from pymoo_gridpath.compiled import is_ctrl_c

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


def _parser() -> Parser:
    parser = Parser(prog="pymoo-gridpath", description="Multi-objective path planning on occupancy grids.")
    parser.add_argument("--version", action="version", version=f"%(prog)s {version('pymoo_gridpath')}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND", title="commands")
    add_plan_command(commands)
    add_explore_command(commands)
    add_map_commands(commands)
    add_suite_command(commands)
    add_study_commands(commands)
    return parser
