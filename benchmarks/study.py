"""How studies hold up: the same bits on every executor, kills, overhead, and ten thousand stored runs.

    python benchmarks/study.py [executors] [kills] [dask] [overhead] [store]

Without arguments, everything. `executors` and `dask` need the extra `cluster`. Each line is what was measured beside what is
expected.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import gc
import os
import pickle
import random
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import psutil
from pymoo.core.algorithm import Algorithm
from pymoo.optimize import minimize

from pymoo_gridpath.study.planning.build import build_algorithm, build_problem, build_termination
from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.planning.plan import Plan
from pymoo_gridpath.study.report import write_report
from pymoo_gridpath.study.running.execute import Recorder, execute
from pymoo_gridpath.study.running.executors import dask_executor
from pymoo_gridpath.study.running.processes import LocalProcesses
from pymoo_gridpath.study.running.record import from_bytes, to_bytes
from pymoo_gridpath.study.running.runner import run_study
from pymoo_gridpath.study.running.store import Store
from pymoo_gridpath.study.specification.study import AlgorithmSpec, ProblemSpec, Study

N_KILLS = 20
# Alternating blocks of a few runs, once bare and once as a study.
N_PAIRS, N_TOGETHER = 12, 3
N_STORED = 10_000


def study_of_24(generations: int = 60) -> Plan:
    """Return a plan of 24 runs: 2 problems, 3 algorithms, 4 seeds."""
    return plan_study(
        Study(
            problems=[
                ProblemSpec(name="dense", random={"size": 16, "p0": 0.2, "seeds": 1}),
                ProblemSpec(name="field", map="paper16", representation="cells", obstacles="constraint"),
            ],
            algorithms=[
                AlgorithmSpec(name="paper", preset="ahmed-deb-2013", pop_size=60),
                AlgorithmSpec(algorithm="SPEA2", pop_size=40),
                AlgorithmSpec(algorithm="MOEAD", pop_size=40),
            ],
            seeds=4,
            budget={"generations": generations},
            reference=False,
        )
    )


def report(what: str, measured: str, expected: str) -> None:
    print(f"{what:<58} {measured:<28} expected {expected}", flush=True)


def results(plan: Plan, folder: Path) -> dict[str, tuple]:
    """Return what each run found, as bytes."""
    store = Store(folder)
    found = {}
    for run in plan.runs:
        record = store.read(run.key)
        assert record.history is not None, record.message
        arrays = (record.X, record.F, record.history.points, record.history.first, record.history.evaluations)
        found[run.key] = tuple(array.tobytes() for array in arrays)
    return found


def written(folder: Path) -> dict[str, int]:
    return {file.stem: file.stat().st_mtime_ns for file in folder.glob("runs/*/*.npz")}


# -- executors ----------------------------------------------------------------------------------------------------------


def executors(folder: Path) -> None:
    plan = study_of_24()
    run_study(plan, folder / "in-process")
    with LocalProcesses(2) as executor:
        run_study(plan, folder / "processes", executor)
    with cluster(folder, 2) as (address, _), dask_executor(address, 60) as executor:
        run_study(plan, folder / "dask", executor)
    found = [results(plan, folder / name) for name in ("in-process", "processes", "dask")]
    n_same = sum(found[0][key] == found[1][key] == found[2][key] for key in found[0])
    report(f"{len(plan.runs)} runs in process, on 2 processes, on 2 Dask workers", f"{n_same} identical", f"{len(plan.runs)}")


@contextlib.contextmanager
def cluster(folder: Path, n_workers: int) -> Iterator[tuple[str, list[subprocess.Popen]]]:
    """Start a Dask scheduler on loopback with some workers."""
    log = folder / "scheduler.log"
    processes = []

    def start(*arguments: str, output: int) -> subprocess.Popen:
        command = [sys.executable, "-m", "dask", *arguments, "--host", "127.0.0.1", "--no-dashboard"]
        processes.append(subprocess.Popen(command, stdout=output, stderr=output, cwd=folder))
        return processes[-1]

    try:
        with open(log, "w") as file:
            start("scheduler", "--port", "0", "--no-show", output=file.fileno())
        while not (match := re.search(r"Scheduler at:\s+(tcp://\S+)", log.read_text())):
            time.sleep(0.1)
        workers = [start("worker", match[1], "--nthreads", "1", output=subprocess.DEVNULL) for _ in range(n_workers)]
        yield match[1], workers
    finally:
        for process in processes:
            process.terminate()
        for process in processes:
            process.wait()


def dask(folder: Path) -> None:
    plan = study_of_24(150)
    with cluster(folder, 2) as (address, workers), dask_executor(address, 60) as executor:

        def kill():
            while len(written(folder / "study")) < 5:
                time.sleep(0.01)
            # The worker under its nanny is the one that works.
            max(psutil.Process(workers[0].pid).children(recursive=True), key=lambda one: one.cpu_times().user).kill()
            killed.append(len(written(folder / "study")))

        killed: list[int] = []
        thread = threading.Thread(target=kill)
        thread.start()
        outcome = run_study(plan, folder / "study", executor)
        thread.join()
    done = outcome.n_run - outcome.n_failed
    report(f"SIGKILL of one of 2 Dask workers after {killed[0]} runs", f"{done} of {len(plan.runs)} completed", "all")


# -- kills --------------------------------------------------------------------------------------------------------------


def kills(folder: Path) -> None:
    plan = study_of_24(120)
    begin = time.monotonic()
    run_coordinator(plan, folder / "undisturbed").wait()
    duration = time.monotonic() - begin
    random_state = random.Random(1)
    n_lost = n_repeated = n_damaged = 0
    seen: dict[str, int] = {}
    moments = []
    for _ in range(N_KILLS):
        process = run_coordinator(plan, folder / "killed")
        time.sleep(random_state.random() * duration * 0.7)
        process.kill()
        process.wait()
        now = written(folder / "killed")
        n_lost += len(seen.keys() - now.keys())
        n_repeated += sum(seen[key] != now[key] for key in seen.keys() & now.keys())
        n_damaged += len(Store(folder / "killed").check(run.key for run in plan.runs).damaged)
        moments.append(len(now))
        if len(now) == len(plan.runs):
            # Done: from the start again, so that every kill has something to hit.
            same = results(plan, folder / "killed") == results(plan, folder / "undisturbed")
            report("  a killed study that came to its end", "identical" if same else "DIFFERENT", "identical")
            (folder / "killed").rename(folder / f"killed-{len(moments)}")
            now = {}
        seen = now
    run_coordinator(plan, folder / "killed").wait()
    now = written(folder / "killed")
    n_repeated += sum(seen[key] != now[key] for key in seen)
    same = results(plan, folder / "killed") == results(plan, folder / "undisturbed")
    print(f"SIGKILL at {N_KILLS} random moments, after which so many runs were stored: {moments}")
    report("  finished runs lost, carried out again, damaged", f"{n_lost}, {n_repeated}, {n_damaged}", "0, 0, 0")
    report("  results after resuming", "identical" if same else "DIFFERENT", "identical")
    pages = [report_files(folder / name) for name in ("undisturbed", "killed")]
    n_same = sum(pages[0][name] == pages[1].get(name) for name in pages[0])
    report("  files of the report, times left out", f"{n_same} of {len(pages[0])} identical", "all")


_COORDINATOR = """
import pickle, sys
from pymoo_gridpath.study.running.processes import LocalProcesses
from pymoo_gridpath.study.running.runner import run_study
if __name__ == "__main__":
    with open(sys.argv[1], "rb") as file:
        plan = pickle.load(file)
    with LocalProcesses(2) as executor:
        run_study(plan, sys.argv[2], executor)
"""


def run_coordinator(plan: Plan, folder: Path) -> subprocess.Popen:
    script, pickled = folder.with_name("coordinator.py"), folder.with_name("plan.pickle")
    script.write_text(_COORDINATOR)
    pickled.write_bytes(pickle.dumps(plan))
    # Killed, it leaves what Python has to say about that.
    return subprocess.Popen([sys.executable, str(script), str(pickled), str(folder)], stderr=subprocess.DEVNULL)


def report_files(folder: Path) -> dict[str, bytes]:
    """Return the files of the report of a study, written without times."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in write_report(folder, times=False)}


# -- overhead -----------------------------------------------------------------------------------------------------------


def overhead(folder: Path) -> None:
    plan = plan_study(
        Study(
            problems=[ProblemSpec(name="dense", random={"size": 32, "p0": 0.2, "seeds": 1})],
            algorithms=[AlgorithmSpec(algorithm="NSGA2", pop_size=200)],
            seeds=N_PAIRS * N_TOGETHER,
            budget={"generations": 200},
            reference=False,
        )
    )
    execute(plan.task(plan.runs[0]))  # load what is compiled

    def bare(runs) -> None:
        for run in runs:
            task = plan.task(run)
            problem = build_problem(task.problem, task.grid)
            algorithm = build_algorithm(task.algorithm, problem)
            minimize(problem, algorithm, build_termination(task.budget or {}, algorithm), seed=task.seed)

    def studied(runs) -> None:
        # A folder of their own, since it holds one study.
        run_study(dataclasses.replace(plan, runs=runs), folder / runs[0].key)

    pairs = []
    for number in range(N_PAIRS):
        runs = plan.runs[number * N_TOGETHER : (number + 1) * N_TOGETHER]
        order: list[Callable] = [bare, studied] if number % 2 else [studied, bare]
        wall, cpu = {}, {}
        for function in order:
            gc.collect()
            times = time.perf_counter(), time.process_time()
            function(runs)
            wall[function], cpu[function] = time.perf_counter() - times[0], time.process_time() - times[1]
        pairs.append((wall[bare], wall[studied], cpu[bare], cpu[studied]))
    seconds, with_study, cpu_bare, cpu_study = np.array(pairs).T
    report(
        f"overhead over minimize at {np.median(seconds) / N_TOGETHER:.2f} s a run, median of {N_PAIRS} pairs",
        f"{statistics.median(with_study / seconds) - 1:+.1%} wall, {statistics.median(cpu_study / cpu_bare) - 1:+.1%} CPU",
        "under 5 %",
    )
    report(
        "  the same, of all together",
        f"{with_study.sum() / seconds.sum() - 1:+.1%} wall, {cpu_study.sum() / cpu_bare.sum() - 1:+.1%} CPU",
        "under 5 %",
    )

    report("  what a study spends beside its algorithms, of their time", f"{spent_beside(plan, folder):+.1%}", "under 5 %")


def spent_beside(plan: Plan, folder: Path) -> float:
    """Return the time of runs outside of their algorithms as a share of that inside, both of the same runs."""
    inside = {"next": 0.0, "_update": 0.0}

    def timed(cls: type, name: str) -> Callable:
        function = getattr(cls, name)

        def call(*arguments):
            begin = time.perf_counter()
            try:
                return function(*arguments)
            finally:
                inside[name] += time.perf_counter() - begin

        setattr(cls, name, call)
        return function

    next_, update = timed(Algorithm, "next"), timed(Recorder, "_update")
    try:
        begin = time.perf_counter()
        run_study(dataclasses.replace(plan, runs=plan.runs[-8:]), folder / "beside")
        total = time.perf_counter() - begin
    finally:
        Algorithm.next, Recorder._update = next_, update
    # The recorder is called by the algorithm.
    algorithms = inside["next"] - inside["_update"]
    return total / algorithms - 1


# -- ten thousand runs --------------------------------------------------------------------------------------------------


def store(folder: Path) -> None:
    """Measure with 50 problems, 4 algorithms, 50 seeds: records of real runs with other keys, and noise on what they found."""
    plan = plan_study(
        Study(
            problems=[ProblemSpec(name="dense", random={"size": 16, "p0": 0.2, "seeds": 50})],
            algorithms=[AlgorithmSpec(algorithm=name, pop_size=40) for name in ("NSGA2", "SPEA2", "MOEAD", "NSGA3")],
            seeds=N_STORED // 200,
            budget={"generations": 100},
        )
    )
    fill(plan, folder / "study")
    size = sum(file.stat().st_size for file in folder.glob("study/runs/*/*.npz"))
    (folder / "plan.pickle").write_bytes(pickle.dumps(plan))
    (folder / "again.py").write_text(
        "import pickle, sys\nfrom pymoo_gridpath.study.running.runner import run_study\n"
        "outcome = run_study(pickle.load(open(sys.argv[1], 'rb')), sys.argv[2])\n"
        "assert outcome.n_run == 0 and outcome.n_failed == 0, outcome\n"
    )
    begin = time.perf_counter()
    subprocess.run([sys.executable, folder / "again.py", folder / "plan.pickle", folder / "study"], check=True)
    seconds = time.perf_counter() - begin
    about = f"{len(plan.runs):,} stored runs, {size / len(plan.runs) / 1000:.1f} kB each"
    report(f"{about}: nothing to do", f"{seconds:.1f} s", "under 5 s")
    begin = time.perf_counter()
    Store(folder / "study").check(run.key for run in plan.runs)
    report("  of which verifying all", f"{time.perf_counter() - begin:.2f} s", "under 2 s")
    (folder / "report.py").write_text(
        "import sys\nfrom pymoo_gridpath.study.report import write_report\nwrite_report(sys.argv[1])\n"
    )
    begin = time.perf_counter()
    subprocess.run([sys.executable, folder / "report.py", folder / "study"], check=True)
    seconds = time.perf_counter() - begin
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e6
    report("  report", f"{seconds:.0f} s, {peak:.2f} GB", "under 60 s, 2 GB")


def fill(plan: Plan, folder: Path) -> None:
    """Store a record for every run of a plan: what one run of its algorithm found, shifted a little."""
    folder_of = Store(folder)
    folder_of.write_plan(plan)
    rng = np.random.default_rng(1)
    models = {}
    for run in plan.runs:
        task = plan.task(run)
        if run.algorithm is None:
            data = execute(task)
        else:
            kind = (run.algorithm, run.problem % 5)
            if kind not in models:
                models[kind] = from_bytes(execute(task))
            model = models[kind]
            shift = rng.random() * 0.1
            history = dataclasses.replace(model.history, points=model.history.points + shift)
            data = to_bytes(
                dataclasses.replace(model, key=run.key, seed=run.seed, problem=task.problem, F=model.F + shift, history=history)
            )
        path = folder_of.path(run.key)
        path.parent.mkdir(parents=True, exist_ok=True)
        # Without waiting for the disk, unlike Store.write.
        path.write_bytes(data)


PARTS = (executors, kills, dask, overhead, store)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    names = [part.__name__ for part in PARTS]
    parser.add_argument("parts", nargs="*", metavar="part", help=f"some of {', '.join(names)}; default: all")
    chosen = parser.parse_args().parts or names
    for name in chosen:
        if name not in names:
            parser.error(f"there is no part {name!r}, expected some of {', '.join(names)}")
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}", flush=True)
    for part in PARTS:
        if part.__name__ in chosen:
            with tempfile.TemporaryDirectory() as folder:
                part(Path(folder))


if __name__ == "__main__":
    main()
