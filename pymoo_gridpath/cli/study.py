"""The commands `pymoo-gridpath study init`, `check`, `run` and `report`."""

from __future__ import annotations

import argparse
import contextlib
import os
from pathlib import Path

from pymoo_gridpath.cli.arguments import EXIT_FAILED, EXIT_INTERRUPTED, EXIT_OK, folder, positive, share
from pymoo_gridpath.errors import counted, visible
from pymoo_gridpath.progress import say
from pymoo_gridpath.study.running.progress import duration

# Other imports of the study stand in the functions, since other commands and --help do without.


def add_study_commands(commands) -> None:
    """Add the command `study` to the subparsers of a command line; each sets ``run``, a function that returns the exit code."""
    study = commands.add_parser(
        "study",
        help="compare algorithms on many problems",
        description="Run a comparison study that a file describes, and write tables and plots.",
    )
    steps = study.add_subparsers(required=True, metavar="STEP", title="steps")

    init = steps.add_parser("init", help="write a study file with comments, to be changed", description=_init.__doc__)
    init.set_defaults(run=_init)
    init.add_argument("file", nargs="?", default="study.toml", metavar="FILE", help="new file (default: study.toml)")

    check = steps.add_parser("check", help="say what is wrong, or how many runs and how long", description=_check.__doc__)
    check.set_defaults(run=_check)
    _add_file(check)
    check.add_argument("--jobs", type=positive, default=1, metavar="N", help="processes that the time is estimated for")

    run = steps.add_parser("run", help="run it, or go on where it was stopped", description=_run.__doc__)
    run.set_defaults(run=_run)
    _add_file(run)
    where = run.add_mutually_exclusive_group()
    where.add_argument("--jobs", type=positive, default=1, metavar="N", help="processes on this computer (default: 1)")
    where.add_argument("--dask", metavar="tcp://HOST:PORT", help="scheduler of a Dask cluster that runs already")
    run.add_argument("--retry-failed", action="store_true", help="run again what ended with an error or was cut short")

    report = steps.add_parser("report", help="write tables, plots and a page", description=_report.__doc__)
    report.set_defaults(run=_report)
    report.add_argument("folder", metavar="DIR", help="what `study run` wrote")
    report.add_argument(
        "--target", type=share, metavar="R", help="share of the best hypervolume to be reached, above 0, at most 1"
    )
    report.add_argument("-o", "--output", type=folder, metavar="DIR2", help="where the report goes (default: DIR/report)")


def _add_file(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", metavar="FILE", help="study file, such as `study init` writes")
    parser.add_argument(
        "-o", "--output", type=folder, metavar="DIR", help="where results are kept (default: the file's name with -results)"
    )


# -- commands -----------------------------------------------------------------------------------------------------------


def _init(arguments) -> int:
    """Write a small study with comments that teach what a study file may hold."""
    from pymoo_gridpath.study.specification.toml_file import write_starter

    path = write_starter(arguments.file)
    print(f"written: {visible(path)}\nnext: pymoo-gridpath study check {visible(path)}")
    return EXIT_OK


def _check(arguments) -> int:
    """Check a study file, and say how many runs it asks for, how many are stored, and about how long the others will take."""
    from pymoo_gridpath.study.planning.estimate import estimate
    from pymoo_gridpath.study.planning.expand import plan_study
    from pymoo_gridpath.study.running.store import Store
    from pymoo_gridpath.study.specification.toml_file import load_study

    study = load_study(arguments.file)
    plan = plan_study(study)
    print(f"{visible(plan.name)}: {_counts(study, plan)}")
    only_references = sum(run.algorithm is None for run in plan.runs)
    measured = f", {only_references} of them exact fronts to measure against" if only_references else ""
    print(f"runs: {len(plan.runs):,}{measured}", flush=True)
    for line in _without_exact_front(plan):
        print(line, flush=True)
    due = plan.runs
    folder = _results(arguments)
    if os.path.isdir(folder):
        found = Store(folder).check([run.key for run in plan.runs])
        missing = set(found.missing)
        due = tuple(run for run in plan.runs if run.key in missing)
        failed = f", {len(found.failed):,} of them failed" if found.failed else ""
        damaged = f", {len(found.damaged):,} damaged" if found.damaged else ""
        print(f"stored in {visible(folder)}: {len(found.meta):,}{failed}{damaged}; to run: {len(due):,}", flush=True)
    if due:
        print(f"time: {_time(estimate(plan, due), len(due), arguments.jobs)}")
    return EXIT_OK


def _run(arguments) -> int:
    """Run what is not stored yet of a study; what was stored by an earlier run, even if it was killed, is kept."""
    from pymoo_gridpath.study.planning.expand import plan_study
    from pymoo_gridpath.study.running.executors import dask_executor
    from pymoo_gridpath.study.running.processes import LocalProcesses
    from pymoo_gridpath.study.running.runner import run_study
    from pymoo_gridpath.study.specification.toml_file import load_study

    study = load_study(arguments.file)
    plan = plan_study(study)
    folder = _results(arguments)
    print(f"{visible(plan.name)}: {_counts(study, plan)}; {len(plan.runs):,} runs, stored in {visible(folder)}", flush=True)
    with contextlib.ExitStack() as stack:
        executor = None
        if arguments.dask is not None:
            executor = stack.enter_context(dask_executor(arguments.dask))
        elif arguments.jobs > 1:
            executor = stack.enter_context(LocalProcesses(arguments.jobs))
        text = None if study.source is None else study.source.text
        outcome = run_study(plan, folder, executor, retry_failed=arguments.retry_failed, study=text, tell=say)
    if outcome.interrupted:
        return EXIT_INTERRUPTED
    print(f"done: {outcome.n_run:,} run now, {outcome.n_done_before:,} before, {outcome.n_failed:,} failed")
    print(f"next: pymoo-gridpath study report {visible(folder)}")
    return EXIT_FAILED if outcome.n_failed else EXIT_OK


def _report(arguments) -> int:
    """Write tables (CSV, Markdown, LaTeX), plots and a page that collects them, of all runs that are stored."""
    from pymoo_gridpath.study.report import write_report

    files = [Path(file) for file in write_report(arguments.folder, output=arguments.output, target=arguments.target)]
    page = next((file for file in files if file.suffix == ".html"), files[0])
    print(f"written: {len(files)} files in {visible(page.parent)}\npage: {visible(page)}")
    return EXIT_OK


# -- parts --------------------------------------------------------------------------------------------------------------


def _results(arguments) -> Path:
    """Return where results are kept: by default in the current folder, named like the study file."""
    return arguments.output or Path(f"{Path(arguments.file).stem}-results")


def _counts(study, plan) -> str:
    return ", ".join(
        (counted(len(plan.problems), "problem"), counted(len(plan.algorithms), "algorithm"), counted(len(study.seeds), "seed"))
    )


def _without_exact_front(plan) -> list[str]:
    """Return a sentence for each reason why problems have no exact front to measure against."""
    labels: dict[str, list[str]] = {}
    for problem in plan.problems:
        if problem.no_reference:
            labels.setdefault(problem.no_reference, []).append(visible(problem.label))
    lines = []
    for why, found in labels.items():
        others = f" and {counted(len(found) - 1, 'other problem')}" if found[1:] else ""
        lines.append(f"no exact front of {found[0]}{others}: {why}; the merged front of all runs stands in")
    return lines


def _time(found, n_runs: int, jobs: int) -> str:
    """Return an estimate in words."""
    # No more processes work than there are runs.
    text = f"{'at most ' if found.open_ended else ''}about {duration(found.seconds / min(jobs, n_runs))}"
    if jobs > 1:
        text += f" with {jobs} processes"
    if found.n_measured < found.n_kinds:
        text += f", from {found.n_measured} of {found.n_kinds} pairs of problem and algorithm"
    if found.open_ended:
        text += ", if searches for exact fronts take all of their time"
    return text
