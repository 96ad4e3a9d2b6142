"""The same study in this process, in local processes, in threads, and on a real Dask cluster on loopback."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path

import loky
import psutil
import pytest
from small_studies import make_plan, same_runs, stored, wait_until, with_bomb

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.study.running import processes
from pymoo_gridpath.study.running.executor import WorkerLost
from pymoo_gridpath.study.running.executors import dask_executor
from pymoo_gridpath.study.running.processes import LocalProcesses
from pymoo_gridpath.study.running.runner import run_study
from pymoo_gridpath.study.running.store import Store

# -- this computer ------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def pair():
    """Two local processes, started once."""
    with LocalProcesses(2) as executor:
        yield executor


def test_two_processes_find_the_same_bits(plan, done, tmp_path, pair):
    outcome = run_study(plan, tmp_path, pair)
    assert (outcome.n_run, outcome.n_failed, outcome.messages) == (len(plan.runs), 0, [])
    again = run_study(plan, tmp_path, pair)
    assert (again.n_run, again.n_done_before) == (0, len(plan.runs))
    same_runs(plan, done, Store(tmp_path))


def test_another_executor_is_used_as_it_is(plan, done, tmp_path):
    with ThreadPoolExecutor(2) as executor:
        run_study(plan, tmp_path, executor)
        same_runs(plan, done, Store(tmp_path))
        assert executor.submit(int, "3").result() == 3, "it is left open"


def test_loky_carries_out_a_study(plan, done, tmp_path):
    with loky.ProcessPoolExecutor(1) as executor:
        run_study(plan, tmp_path, executor)
    same_runs(plan, done, Store(tmp_path))


class Job:
    """What executors return that are not those of `concurrent.futures`: it can be asked, and waited for, and no more."""

    def __init__(self, future):
        self.done, self.result = future.done, future.result


class Asked(ThreadPoolExecutor):
    def submit(self, fn, /, *args, **kwargs):
        return Job(super().submit(fn, *args, **kwargs))


def test_an_executor_whose_jobs_are_but_asked_will_do(plan, done, tmp_path):
    with Asked(2) as executor:
        run_study(plan, tmp_path, executor)
    same_runs(plan, done, Store(tmp_path))


def test_processes_use_one_thread_and_leave_the_environment_as_it_was(monkeypatch, pair):
    before = dict(os.environ)
    names = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
    assert [pair.submit(os.getenv, name).result() for name in names] == [os.environ.get(name, "1") for name in names]
    assert dict(os.environ) == before


def test_no_process_is_started_for_nothing(plan, done):
    with LocalProcesses(2) as executor:
        run_study(plan, done.folder, executor)
        assert executor._crew is None


@pytest.mark.parametrize("number", [0, -1])
def test_the_number_of_processes_is_checked(number):
    with pytest.raises(GridPathError, match=f"the number of processes is {number}, expected a whole number of at least 1"):
        LocalProcesses(number)


def test_a_worker_that_is_killed_takes_no_run_with_it(tmp_path, pair):
    longer = make_plan(n_seeds=1, generations=40)
    before = pair.submit(os.getpid).result()

    def kill():
        wait_until(lambda: len(stored(tmp_path)) >= 3)
        psutil.Process(before).kill()

    thread = threading.Thread(target=kill)
    thread.start()
    outcome = run_study(longer, tmp_path, pair)
    thread.join()
    assert (outcome.n_run, outcome.n_failed, outcome.messages) == (len(longer.runs), 0, [])
    assert not psutil.pid_exists(before)


def test_a_run_that_kills_its_process_three_times_is_given_up_and_no_other(plan, done, tmp_path):
    # Two are missing, the others are taken from the finished store: the last one kills.
    first, last = next(run for run in plan.runs if run.problem == 0), plan.runs[-1]
    store = Store(tmp_path)
    for run in plan.runs:
        if run not in (first, last):
            store.write(run.key, done.path(run.key).read_bytes())
    with LocalProcesses(1) as executor:
        outcome = run_study(with_bomb(plan), tmp_path, executor)
    assert (outcome.n_done_before, outcome.n_run, outcome.n_failed) == (len(plan.runs) - 2, 2, 1)
    assert (
        len(outcome.messages) == 1 and "the process that carried it out ended without an answer 3 times" in outcome.messages[0]
    )
    assert store.check(run.key for run in plan.runs).failed == [last.key]
    retried = run_study(plan, tmp_path, retry_failed=True)
    assert (retried.n_run, retried.n_failed) == (1, 0)
    same_runs(plan, done, store)


def test_a_foreign_pool_that_breaks_ends_the_study_with_a_sentence(plan, done, tmp_path):
    with ProcessPoolExecutor(1, get_context("spawn")) as executor:
        with pytest.raises(
            GridPathError, match=r"the executor broke .*running again with a new executor goes on from there"
        ) as e:
            run_study(with_bomb(plan), tmp_path, executor)
        assert isinstance(e.value.__cause__, BrokenExecutor)
    outcome = run_study(plan, tmp_path)
    assert outcome.n_done_before + outcome.n_run == len(plan.runs)
    same_runs(plan, done, Store(tmp_path))


def test_a_script_without_a_guard_is_told_about_it(tmp_path, plan):
    script = tmp_path / "script.py"
    script.write_text("from pymoo_gridpath.study.running.processes import LocalProcesses\nLocalProcesses(1).submit(print)\n")
    answer = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=60)
    assert "ended as soon as they were started; a script that runs a study in processes needs if __name__" in answer.stderr


def test_processes_that_nobody_ends_end_with_the_script(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "from pymoo_gridpath.study.running.processes import LocalProcesses\n"
        "if __name__ == '__main__':\n"
        "    print(LocalProcesses(2).submit(int, '3').result())\n"
    )
    answer = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=60)
    assert (answer.returncode, answer.stdout, answer.stderr) == (0, "3\n", "")


@pytest.fixture
def killed_at_once(monkeypatch):
    """Have the first processes killed while they start, as when memory runs out: so many of them."""

    def kill(times: int, when: str = "started") -> list[int]:
        left = [times]
        begin = processes._begin

        def begin_and_kill():
            worker = begin()
            left[0] -= 1
            if left[0] >= 0 and worker is not None:
                worker.process.kill()
            return worker

        def kill_and_start(process):
            # Once it lives, before it was handed what it needs.
            left[0] -= 1
            if left[0] < 0:
                return start(process)
            raise BrokenPipeError

        start = processes._Worker._start
        if when == "started":
            monkeypatch.setattr(processes, "_begin", begin_and_kill)
        else:
            monkeypatch.setattr(processes._Worker, "_start", kill_and_start)
        return left

    return kill


@pytest.mark.parametrize("when", ["started", "handed what they need"])
def test_workers_that_are_killed_while_they_start_are_started_again(plan, done, tmp_path, killed_at_once, when):
    left = killed_at_once(2, when)
    with LocalProcesses(1) as executor:
        outcome = run_study(plan, tmp_path, executor)
    assert (outcome.n_run, outcome.n_failed, outcome.messages) == (len(plan.runs), 0, [])
    assert left[0] < 0
    same_runs(plan, done, Store(tmp_path))


def test_workers_that_are_killed_again_and_again_are_no_matter_of_a_guard(tmp_path, plan, killed_at_once):
    killed_at_once(9)
    with LocalProcesses(2) as executor, pytest.raises(GridPathError) as raised:
        run_study(plan, tmp_path, executor)
    assert re.search(r"as soon as they were started, 3 times \(by .*signal 9.*\), as when memory runs out", str(raised.value))
    assert "__main__" not in str(raised.value)


def test_a_worker_that_is_killed_while_it_answers_loses_its_own_task_alone(pair):
    """Pools that have one queue of results for all wait for ever here."""
    first, second = pair.submit(die_while_answering), pair.submit(str, 7)
    with pytest.raises(WorkerLost, match="ended by signal 9"):
        first.result(timeout=60)
    assert second.result(timeout=60) == "7"
    assert {pair.submit(str, number).result(timeout=60) for number in range(4)} == set("0123")


def die_while_answering():
    def send_half(pipe, data):
        os.write(pipe.fileno(), bytes(data)[: len(data) // 2])
        os.kill(os.getpid(), signal.SIGKILL)

    Connection._send = send_half
    return bytes(10**6)


def test_what_a_task_raises_arrives_with_where_it_was_raised(pair):
    with pytest.raises(ValueError, match="invalid literal") as raised:
        pair.submit(int, "x").result(timeout=60)
    assert "in a local process" in raised.value.__notes__[0]
    with pytest.raises(RuntimeError, match="Unpicklable: only here"):
        pair.submit(raise_unpicklable).result(timeout=60)
    with pytest.raises(Exception, match="pickle"):
        pair.submit(lambda: 1).result(timeout=60)
    with pytest.raises(Exception, match="pickle"):
        pair.submit(return_unpicklable).result(timeout=60)
    assert pair.submit(int, "3").result(timeout=60) == 3


class Unpicklable(Exception):
    def __init__(self, text, needed):
        super().__init__(text)


def raise_unpicklable():
    raise Unpicklable("only here", 1)


def return_unpicklable():
    return lambda: 1


def test_what_is_under_way_is_given_up_or_finished():
    executor = LocalProcesses(1)
    futures = [executor.submit(time.sleep, 60) for _ in range(3)]
    wait_until(futures[0].running)
    begin = time.monotonic()
    executor.abort()
    with pytest.raises(WorkerLost):
        futures[0].result(timeout=30)
    assert all(future.cancelled() for future in futures[1:])
    assert time.monotonic() - begin < 30
    with executor:
        assert executor.submit(int, "3").result(timeout=60) == 3, "it can be used again"
        futures = [executor.submit(time.sleep, 0.1) for _ in range(3)]
    assert all(future.done() and not future.cancelled() for future in futures)


# -- Dask ---------------------------------------------------------------------------------------------------------------


def test_without_distributed_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(GridPathError, match=r"needs the package distributed.*pip install 'pymoo_gridpath\[cluster\]'"):
        dask_executor("tcp://127.0.0.1:1")


class Cluster:
    """A Dask scheduler on loopback, and workers."""

    def __init__(self, folder: Path, **environment: str):
        self.folder = folder
        self.processes: list[subprocess.Popen] = []
        self.scheduler = self._start(
            "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-show", "--no-dashboard", **environment
        )
        self.address = wait_until(lambda: re.search(r"Scheduler at:\s+(tcp://\S+)", self.log(0)))[1]

    def worker(self, *options: str, **environment: str) -> subprocess.Popen:
        options = ("--host", "127.0.0.1", "--nthreads", "1", "--no-dashboard", *options)
        return self._start("worker", self.address, *options, **environment)

    def log(self, number: int) -> str:
        return (self.folder / f"log{number}").read_text()

    def _start(self, *arguments: str, **environment: str) -> subprocess.Popen:
        with open(self.folder / f"log{len(self.processes)}", "w") as log:
            command = [sys.executable, "-m", "dask", *arguments]
            process = subprocess.Popen(command, stdout=log, stderr=log, cwd=self.folder, env={**os.environ, **environment})
        self.processes.append(process)
        return process

    def __enter__(self) -> Cluster:
        return self

    def __exit__(self, *exception) -> None:
        family = [one for process in self.processes if process.poll() is None for one in [process, *children(process)]]
        for one in family:
            try:
                one.kill()
            except psutil.NoSuchProcess:
                continue
        for process in self.processes:
            process.wait()


def children(process) -> list[psutil.Process]:
    """Return the workers under a nanny."""
    return psutil.Process(process.pid).children(recursive=True)


def test_a_dask_cluster(plan, done, tmp_path):
    """One cluster for all, since starting one takes longer than the rest: each loss is worse than the one before."""
    pytest.importorskip("distributed")
    longer, longest = make_plan(n_seeds=1, generations=60), make_plan(n_seeds=3, generations=61)
    without = str(blocking(tmp_path))
    # The scheduler has no need of this package.
    with Cluster(tmp_path, PYTHONPATH=without, DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="1") as cluster:
        nannies = [cluster.worker() for _ in range(2)]
        with dask_executor(cluster.address) as executor:
            wait_until(lambda: cluster.log(0).count("Register worker") == 2)
            outcome = run_study(plan, tmp_path / "short", executor)
            assert (outcome.n_run, outcome.n_failed, outcome.messages) == (len(plan.runs), 0, [])
            same_runs(plan, done, Store(tmp_path / "short"))

            # A worker is lost: all runs complete.
            with meanwhile(tmp_path / "long", lambda: working(nannies[0]).kill()):
                outcome = run_study(longer, tmp_path / "long", executor)
            assert (outcome.n_run, outcome.n_failed, outcome.messages) == (len(longer.runs), 0, [])

            # A run kills whatever worker it is given to: it is given up.
            store, last = Store(tmp_path / "bad"), plan.runs[-1]
            for run in plan.runs:
                if run is not last:
                    store.write(run.key, done.path(run.key).read_bytes())
            outcome = run_study(with_bomb(plan), store.folder, executor)
            assert (outcome.n_run, outcome.n_failed) == (1, 1)
            assert "the workers that carried it out were lost: KilledWorker" in outcome.messages[0]

            # A worker joins that lacks the package: it is named, and no run is blamed.
            late: list[subprocess.Popen] = []
            with (
                meanwhile(tmp_path / "late", lambda: late.append(cluster.worker("--no-nanny", PYTHONPATH=without))),
                pytest.raises(GridPathError, match=r"the Dask worker tcp://.* cannot import pymoo_gridpath"),
            ):
                # More and more of the same study, however long the worker takes to join.
                for n_seeds in range(1, 40):
                    run_study(make_plan(n_seeds=n_seeds, generations=60), tmp_path / "late", executor)
            stored_late = Store(tmp_path / "late").check(stored(tmp_path / "late"))
            assert not stored_late.failed and len(stored_late.meta) >= 3
            late[0].kill()
            wait_until(lambda: len(late) and late[0].poll() is not None)

        # The scheduler itself is lost: a sentence, not a hang, and what is stored is whole.
        time.sleep(1)
        with (
            dask_executor(cluster.address) as executor,
            meanwhile(tmp_path / "lost", cluster.scheduler.kill),
            pytest.raises(GridPathError, match=r"the connection to the Dask scheduler at tcp://.* was lost"),
        ):
            run_study(longest, tmp_path / "lost", executor)
        found = Store(tmp_path / "lost").check(run.key for run in longest.runs)
        assert len(found.meta) >= 3 and not found.failed and not found.damaged


@contextlib.contextmanager
def meanwhile(folder: Path, act):
    """Do something as soon as three runs are stored in a folder."""

    def wait_and_act():
        wait_until(lambda: len(stored(folder)) >= 3)
        act()

    thread = threading.Thread(target=wait_and_act, daemon=True)
    thread.start()
    yield
    thread.join()


def working(nanny: subprocess.Popen) -> psutil.Process:
    """Return the worker under a nanny, as against what else it started."""
    return max(children(nanny), key=lambda one: one.cpu_times().user)


def blocking(folder: Path) -> Path:
    """Return a folder that, on PYTHONPATH, keeps this package from being imported."""
    place = folder / "blocking"
    place.mkdir(exist_ok=True)
    (place / "sitecustomize.py").write_text(
        "import sys\n"
        "class Block:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name.split('.')[0] == 'pymoo_gridpath':\n"
        "            raise ModuleNotFoundError(f'No module named {name!r}', name=name)\n"
        "sys.meta_path.insert(0, Block())\n"
    )
    return place


def older_pymoo(folder: Path) -> Path:
    """Return a folder that, on PYTHONPATH, makes pymoo pass for an older one."""
    place = folder / "older"
    (place / "pymoo-0.6.1.dist-info").mkdir(parents=True, exist_ok=True)
    (place / "pymoo-0.6.1.dist-info" / "METADATA").write_text("Metadata-Version: 2.1\nName: pymoo\nVersion: 0.6.1\n")
    return place


def test_workers_are_checked_first(tmp_path):
    pytest.importorskip("distributed")
    with Cluster(tmp_path) as cluster:
        with pytest.raises(
            GridPathError, match=r"tcp://.* has no worker after 3 s, expected at least one; start one with: dask worker"
        ):
            dask_executor(cluster.address, timeout=3)

        bad = cluster.worker("--no-nanny", PYTHONPATH=str(blocking(tmp_path)))
        with pytest.raises(
            GridPathError, match=r"the Dask worker tcp://.* cannot import pymoo_gridpath .*No module named"
        ) as error:
            dask_executor(cluster.address, timeout=60)
        assert len(str(error.value).splitlines()) == 1
        bad.kill()
        wait_until(lambda: "Remove worker" in cluster.log(0))

        cluster.worker("--no-nanny", PYTHONPATH=str(older_pymoo(tmp_path)))
        with pytest.raises(GridPathError, match=r"the Dask worker tcp://.* has pymoo 0\.6\.1, expected 0\.\d+\.\d+"):
            dask_executor(cluster.address, timeout=60)


def test_nobody_answers():
    pytest.importorskip("distributed")
    with socket.socket() as silent:
        silent.bind(("127.0.0.1", 0))
        port = silent.getsockname()[1]
        begin = time.monotonic()
        with pytest.raises(GridPathError, match=f"no Dask scheduler answers at tcp://127.0.0.1:{port} within 1 s"):
            dask_executor(f"tcp://127.0.0.1:{port}", timeout=1)
        silent.listen()
        with pytest.raises(GridPathError, match=f"no Dask scheduler answers at tcp://127.0.0.1:{port} within 1 s"):
            dask_executor(f"tcp://127.0.0.1:{port}", timeout=1)
        assert time.monotonic() - begin < 20
    for nonsense in ("nowhere", "http://127.0.0.1:1", ""):
        with pytest.raises(GridPathError, match=f"'{nonsense}' is no address of a Dask scheduler, expected tcp://HOST:PORT"):
            dask_executor(nonsense, timeout=1)
