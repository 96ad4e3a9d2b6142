"""The command line, in this process and in one of its own."""

import contextlib
import io
import subprocess
import sys
from unittest import mock

from matplotlib.figure import Figure

from pymoo_gridpath.cli import main

#: A search of a moment.
FAST = ["--pop-size", "30", "--generations", "10"]


#: What a process runs that draws nothing: its figures are empty. What follows is its arguments.
UNDRAWN = """
import sys
from matplotlib.figure import Figure
from pymoo_gridpath.cli import main

Figure.savefig = lambda figure, *args, **kwargs: None
sys.exit(main(sys.argv[1:]))
"""


def run_process(*arguments, cwd=None, **options):
    command = [sys.executable, "-m", "pymoo_gridpath.cli", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=cwd, timeout=500, check=False, **options)


def run(*arguments):
    """What a process would do, without the seconds that it takes to start and to draw: figures are empty."""
    with (
        contextlib.redirect_stdout(io.StringIO()) as out,
        contextlib.redirect_stderr(io.StringIO()) as err,
        mock.patch.object(Figure, "savefig", lambda figure, *args, **kwargs: None),
    ):
        status = main([str(argument) for argument in arguments])
    return subprocess.CompletedProcess(arguments, status, out.getvalue(), err.getvalue())
