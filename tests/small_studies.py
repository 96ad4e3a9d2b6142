"""Small studies, and processes that run them and can be killed."""

from __future__ import annotations

import dataclasses
import os
import pickle
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.planning.plan import Plan
from pymoo_gridpath.study.running.record import History, RunRecord
from pymoo_gridpath.study.running.store import Store
from pymoo_gridpath.study.specification.study import AlgorithmSpec, ProblemSpec, Study

#: What a run finds, as opposed to when and how fast.
HISTORY = ("evaluations", "n_legal", "n_members", "best_length", "points", "first", "last")
FOUND = ("status", "complete", "n_eval", "n_gen", "n_legal", "n_members", "objectives")

_COORDINATOR = """
import pickle, signal, sys
from pymoo_gridpath.study.running.processes import LocalProcesses
from pymoo_gridpath.study.running.runner import run_study
from pymoo_gridpath.study.running.store import Store

def hold_after(most):
    def write_and_hold(self, key, data, write=Store.write, written=[]):
        write(self, key, data)
        written.append(key)
        if len(written) == most:
            signal.pause()
    Store.write = write_and_hold

if __name__ == "__main__":
    # Processes that are started in the background may have been told to ignore it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    plan, folder, n_processes, most = sys.argv[1:]
    if most != "all":
        hold_after(int(most))
    with open(plan, "rb") as file:
        plan = pickle.load(file)
    executor = LocalProcesses(int(n_processes)) if int(n_processes) else None
    print("begins", flush=True)
    print(run_study(plan, folder, executor), flush=True)
"""


def make_plan(n_seeds: int = 2, generations: int = 8, n_problems: int = 2) -> Plan:
    """Return a plan of every sort of run: integers, cells, the paper's preset, constraints, the exact front."""
    study = Study(
        problems=[
            ProblemSpec(name="dense", random={"size": 12, "p0": 0.2, "seeds": n_problems}),
            ProblemSpec(
                name="field", map="paper16", representation="cells", obstacles="constraint", objectives=["length", "turn"]
            ),
        ],
        algorithms=[
            AlgorithmSpec(name="paper", preset="ahmed-deb-2013", pop_size=24),
            AlgorithmSpec(name="nsga2", algorithm="NSGA2", pop_size=20),
            AlgorithmSpec(name="spea2", algorithm="SPEA2", pop_size=20),
            AlgorithmSpec(name="moead", algorithm="MOEAD", pop_size=20),
        ],
        seeds=n_seeds,
        budget={"generations": generations},
    )
    return plan_study(study)


def same_runs(plan: Plan, one: Store, other: Store) -> None:
    """Assert that two stores hold the same results of every run, bit for bit."""
    for run in plan.runs:
        a, b = one.read(run.key), other.read(run.key)
        assert [getattr(a, name) for name in FOUND] == [getattr(b, name) for name in FOUND], run
        for x, y in [(a.X, b.X), (a.F, b.F), *((getattr(a.history, name), getattr(b.history, name)) for name in HISTORY)]:
            assert (x.dtype, x.shape, x.tobytes()) == (y.dtype, y.shape, y.tobytes()), run


def without_grids(plan: Plan) -> Plan:
    """Return a plan whose runs on maps raise, since their cells are missing."""
    return dataclasses.replace(plan, problems=tuple(dataclasses.replace(item, grid=None) for item in plan.problems))


class Bomb(bytes):
    """A grid that ends the process which unpickles it."""

    def __reduce__(self):
        return os._exit, (1,)

    def __deepcopy__(self, memo):
        return self


def with_bomb(plan: Plan, problem: int = -1) -> Plan:
    """Return a plan one of whose problems kills the process that it is handed to."""
    problems = list(plan.problems)
    problems[problem] = dataclasses.replace(problems[problem], grid=Bomb(problems[problem].grid or b""))
    return dataclasses.replace(plan, problems=tuple(problems))


class Coordinator:
    """A process that runs a plan in a folder, or so much of it as it may store: then it holds until it is killed."""

    def __init__(self, plan: Plan, folder: Path, n_processes: int = 2, most: int | None = None):
        script, pickled = folder.parent / "coordinator.py", folder.parent / "plan.pickle"
        script.write_text(_COORDINATOR)
        pickled.write_bytes(pickle.dumps(plan))
        command = [sys.executable, str(script), str(pickled), str(folder), str(n_processes), str(most or "all")]
        # In a session of its own, so that signals reach it and its workers as those of a terminal do.
        self.process = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
        )
        assert self.process.stdout is not None
        assert self.process.stdout.readline() == "begins\n", self.process.communicate()

    def outcome(self) -> str:
        out, err = self.process.communicate(timeout=120)
        assert self.process.returncode == 0, err
        return out


def stored(folder: Path) -> dict[str, int]:
    """Return when each run in a folder was written, in nanoseconds."""
    return {file.stem: file.stat().st_mtime_ns for file in folder.glob("runs/*/*.npz")}


def wait_until(condition, seconds: float = 120.0):
    """Return what a condition returns once that is true."""
    end = time.monotonic() + seconds
    while not (value := condition()):
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)
    return value


def history(n_records: int = 3) -> History:
    """Return a made-up history."""
    return History(
        evaluations=np.arange(1, n_records + 1) * 20,
        seconds=np.linspace(0.1, 1, n_records),
        n_legal=np.arange(n_records),
        n_members=np.full(n_records, 20),
        best_length=np.array([np.inf] + [12.5] * (n_records - 1)),
        points=np.array([[3.0, 1.0], [2.0, 2.0], [2.0, 1.5]]),
        first=np.array([1, 1, 2], dtype=np.int32),
        last=np.array([2, 1, 2], dtype=np.int32),
    )


def record(**changes) -> RunRecord:
    """Return a made-up run."""
    values = {
        "key": "ab" * 16,
        "seed": 3,
        "status": "finished",
        "message": "",
        "complete": True,
        "seconds": 1.25,
        "n_eval": 60,
        "n_gen": 3,
        "started": "2026-01-02T03:04:05.678+00:00",
        "versions": {"python": "3.12.1", "pymoo": "0.6.2"},
        "machine": {"system": "Linux x86_64", "processor": 'a "fast" one \u2192', "cores": 2},
        "problem": {"grid": {"random": {"size": 8}}, "penalty": None},
        "algorithm": {"algorithm": "NSGA2"},
        "budget": {"generations": 3},
        "objectives": ["length", "vulnerability"],
        "X": np.array([[0, 200, -1], [1, 1, 1]]),
        "F": np.array([[2.0, 1.5], [3.0, 1.0]]),
        "turn": np.array([90.0, 45.0]),
        "n_legal": 2,
        "n_members": 20,
        "history": history(),
    }
    return RunRecord(**(values | changes))
