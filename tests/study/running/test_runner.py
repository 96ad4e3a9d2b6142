"""Studies that are run, interrupted, killed and resumed, by real processes."""

from __future__ import annotations

import contextlib
import dataclasses
import errno
import os
import random
import shutil
import signal
import time

import psutil
import pytest
from small_studies import Coordinator, make_plan, same_runs, stored, wait_until, without_grids

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.study.planning.plan import Plan
from pymoo_gridpath.study.running.progress import StudyProgress, duration, remaining_seconds
from pymoo_gridpath.study.running.record import from_bytes, to_bytes
from pymoo_gridpath.study.running.runner import run_study
from pymoo_gridpath.study.running.store import Store
from pymoo_gridpath.versions import versions

N_KILLS = 4


def test_a_study_is_run_once(plan, done):
    before = stored(done.folder)
    assert sorted(before) == sorted(run.key for run in plan.runs)
    outcome = run_study(plan, done.folder)
    assert (outcome.n_planned, outcome.n_done_before, outcome.n_run, outcome.n_failed) == (len(plan.runs), len(plan.runs), 0, 0)
    assert (outcome.messages, outcome.interrupted) == ([], False)
    assert stored(done.folder) == before
    assert done.read_plan().to_json() == plan.to_json()


def larger(plan: Plan, n_done: int) -> Plan:
    """Return a plan of the same study of which at most half is done, however far a fast machine has come."""
    n_seeds = 2
    while n_done > len(plan.runs) // 2:
        n_seeds *= 2
        plan = make_plan(n_seeds)
    return plan


def test_kills_at_random_moments_lose_and_repeat_nothing_that_was_finished(plan, done, tmp_path):
    random_state = random.Random(1)
    folder = tmp_path / "study"
    seen: dict[str, int] = {}
    first = plan
    for _ in range(N_KILLS):
        plan = larger(plan, len(seen))
        coordinator = Coordinator(plan, folder, n_processes=0)
        # From the first moments to some runs on.
        target = len(seen) + random_state.randrange(6)
        wait_until(
            lambda target=target, process=coordinator.process: len(stored(folder)) >= target or process.poll() is not None
        )
        time.sleep(random_state.random() * 0.05)
        coordinator.process.kill()
        coordinator.process.wait()
        now = stored(folder)
        assert {key: now.get(key) for key in seen} == seen, "what was finished is still there, and as it was"
        found = Store(folder).check(run.key for run in plan.runs)
        assert not found.damaged and len(found.meta) == len(now)
        seen = now
    assert seen
    plan = larger(plan, len(seen))
    outcome = run_study(plan, folder)
    assert (outcome.n_done_before, outcome.n_run) == (len(seen), len(plan.runs) - len(seen))
    assert {key: time for key, time in stored(folder).items() if key in seen} == seen
    assert not list(folder.rglob(".*.part"))
    same_runs(first, done, Store(folder))


def test_a_file_system_without_locks_is_told_of(plan, done, tmp_path, monkeypatch):
    def unsupported(descriptor):
        raise OSError(errno.ENOLCK, "no locks")

    monkeypatch.setattr("pymoo_gridpath.study.running.lock._lock", unsupported)
    outcome = run_study(plan, done.folder)
    assert outcome.n_run == 0
    assert outcome.messages == [
        f"the file system of {done.folder} knows no locks; see to it that no other run of a study uses the folder"
    ]


def test_workers_do_not_outlive_a_killed_coordinator(tmp_path):
    plan = make_plan(generations=400)
    coordinator = Coordinator(plan, tmp_path / "study")
    try:
        wait_until(lambda: len(stored(tmp_path / "study")) >= 2)
        family = psutil.Process(coordinator.process.pid).children(recursive=True)
        assert len(family) >= 2
        with pytest.raises(GridPathError, match=r"study is in use by another run of a study, expected one at a time"):
            run_study(plan, tmp_path / "study")
    finally:
        coordinator.process.kill()
        coordinator.process.wait()
    _, alive = psutil.wait_procs(family, timeout=20)
    assert not alive
    with Store(tmp_path / "study").lock():
        pass


@pytest.mark.parametrize("n_processes", [0, 2])
def test_ctrl_c_keeps_what_is_finished(tmp_path, n_processes):
    plan = make_plan(generations=300)
    coordinator = Coordinator(plan, tmp_path / "study", n_processes)
    wait_until(lambda: len(stored(tmp_path / "study")) >= 2)
    begin = time.monotonic()
    # To all of them, as a terminal does.
    os.killpg(coordinator.process.pid, signal.SIGINT)
    out = coordinator.outcome()
    assert time.monotonic() - begin < 30
    n_stored = len(stored(tmp_path / "study"))
    assert "interrupted=True" in out
    assert f"interrupted: {n_stored} of {len(plan.runs)} runs are stored; running again goes on from there" in out
    assert 2 <= n_stored < len(plan.runs)
    found = Store(tmp_path / "study").check(run.key for run in plan.runs)
    assert not found.failed and not found.damaged


def test_damaged_files_are_told_set_aside_and_run_again(plan, done, tmp_path):
    keys = [run.key for run in plan.runs]
    store = Store(tmp_path)
    for key in keys:
        store.write(key, done.path(key).read_bytes())
    whole = store.path(keys[3]).read_bytes()
    store.path(keys[3]).write_bytes(whole[:100] + b"x" + whole[101:])
    store.path(keys[4]).write_bytes(b"")
    outcome = run_study(plan, tmp_path)
    assert (outcome.n_run, outcome.n_done_before) == (2, len(keys) - 2)
    assert outcome.messages == [
        f"2 stored runs were found damaged, set aside in {tmp_path / 'damaged'} (such as {keys[3]}.npz) and carried out again",
    ]
    assert len(list((tmp_path / "damaged").iterdir())) == 2
    same_runs(plan, done, store)


def test_odd_entries_are_set_aside_and_named_and_the_study_goes_on(plan, done, tmp_path):
    keys = [run.key for run in plan.runs]
    shutil.copytree(done.folder, tmp_path / "study")
    store = Store(tmp_path / "study")
    folder, link, loop = (store.path(key) for key in keys[:3])
    for path in (folder, link, loop):
        path.unlink()
    folder.mkdir()
    (folder / "inside").write_text("mine")
    link.symlink_to("nowhere")
    loop.symlink_to(loop.name)
    parts = [folder.parent / ".x.npz.0123abcd.part", store.folder / ".plan.json.0123abcd.part"]
    for part in parts:
        part.mkdir()
        (part / "inside").write_text("mine")
    outcome = run_study(plan, store.folder)
    assert (outcome.n_run, outcome.n_failed) == (3, 0)
    aside = store.folder / "damaged"
    assert (
        outcome.messages[0]
        == f"3 stored runs were found damaged, set aside in {aside} (such as {folder.name}) and carried out again"
    )
    assert sorted(outcome.messages[1:]) == sorted(
        f"{part.name} is nothing that a study writes where it stood, and was set aside in {aside}" for part in parts
    )
    assert sorted(path.name for path in aside.iterdir()) == sorted(path.name for path in (folder, link, loop, *parts))
    assert all((aside / path.name / "inside").read_text() == "mine" for path in (folder, *parts))
    same_runs(plan, done, store)
    assert run_study(plan, store.folder).messages == []


@pytest.mark.parametrize("damage", ["a file for a folder of runs", "a link for all runs"])
def test_what_stands_where_runs_are_to_stand_is_set_aside(damage, plan, done, tmp_path):
    shutil.copytree(done.folder, tmp_path / "study")
    store = Store(tmp_path / "study")
    runs = store.folder / "runs"
    if damage == "a link for all runs":
        shutil.rmtree(runs)
        runs.symlink_to("nowhere")
        name = "runs"
    else:
        part = store.path(plan.runs[0].key).parent
        shutil.rmtree(part)
        part.write_text("mine")
        name = part.name
    outcome = run_study(plan, store.folder)
    assert outcome.messages == [
        f"{name} is nothing that a study writes where it stood, and was set aside in {store.folder / 'damaged'}"
    ]
    same_runs(plan, done, store)


def test_failed_runs_stay_unless_they_are_to_be_retried(plan, done, tmp_path):
    # As another problem than the one that this process keeps, so that it is built anew.
    bad = without_grids(make_plan(generations=9))
    for problem in bad.problems:
        if problem.group == "field":
            problem.spec["goal"] = [14, 15]
    n_bad = sum(bad.problems[run.problem].group == "field" for run in bad.runs)
    outcome = run_study(bad, tmp_path)
    assert (outcome.n_run, outcome.n_failed) == (len(bad.runs), n_bad)
    assert len(outcome.messages) == 1
    assert outcome.messages[0].startswith(f"{n_bad} runs were stored as failed, such as the reference on field with seed 0: ")
    assert "the cells of the map are missing, expected those that were planned with; --retry-failed" in outcome.messages[0]
    again = run_study(bad, tmp_path)
    assert (again.n_run, again.n_failed, again.messages) == (0, n_bad, outcome.messages)
    retried = run_study(bad, tmp_path, retry_failed=True)
    assert (retried.n_run, retried.n_failed, retried.n_done_before) == (n_bad, n_bad, len(bad.runs) - n_bad)


def test_other_versions_are_told(plan, done, tmp_path):
    store = Store(tmp_path)
    for number, run in enumerate(plan.runs):
        record = from_bytes(done.path(run.key).read_bytes())
        if number < 5:
            record.versions["pymoo"] = "0.6.1"
        store.write(run.key, to_bytes(record))
    outcome = run_study(plan, tmp_path)
    assert outcome.n_run == 0
    assert outcome.messages == [
        "5 stored runs were made with other versions than are installed here "
        f"(pymoo 0.6.1, not {versions()['pymoo']}) and kept as they are"
    ]


def test_what_is_stored_is_told_before_anything_runs(plan, done, tmp_path, monkeypatch):
    store = Store(tmp_path)
    record = from_bytes(done.path(plan.runs[0].key).read_bytes())
    record.versions["pymoo"] = "0.6.1"
    store.write(record.key, to_bytes(record))
    told = []
    outcome = run_study(plan, tmp_path, tell=lambda message: told.append((message, len(stored(tmp_path)))))
    assert [message for message, _ in told] == outcome.messages
    assert told[0][0].startswith("1 stored run was made with other versions") and told[0][1] == 1


def test_a_folder_of_another_study_is_refused_and_a_changed_one_told(plan, done, tmp_path):
    run_study(make_plan(n_seeds=2), tmp_path, study="name = 'two'")
    with pytest.raises(GridPathError, match="holds another study, none of whose runs this one asks for; choose another folder"):
        run_study(make_plan(generations=9), tmp_path)
    assert (tmp_path / "study.toml").read_text() == "name = 'two'"
    n_less = len(make_plan(n_seeds=2).runs) - len(make_plan(n_seeds=1).runs)
    (message,) = run_study(make_plan(n_seeds=1), tmp_path).messages
    assert message.startswith(f"{n_less} runs were part of the study before and no longer")
    assert not (tmp_path / "study.toml").exists(), "it was that of another plan"


def test_exact_fronts_that_were_cut_short_are_retried(tmp_path):
    made = make_plan(n_seeds=1)
    reference = next(run for run in made.runs if run.algorithm is None)
    store = Store(tmp_path)
    run_study(made, tmp_path)
    store.write(reference.key, to_bytes(dataclasses.replace(store.read(reference.key), complete=False)))
    assert run_study(made, tmp_path).n_run == 0
    assert run_study(made, tmp_path, retry_failed=True).n_run == 1
    assert store.read(reference.key).complete


def test_a_study_that_grows_runs_what_is_new(plan, done, tmp_path):
    run_study(make_plan(n_seeds=1), tmp_path)
    before = stored(tmp_path)
    outcome = run_study(plan, tmp_path)
    assert outcome.n_done_before == len(before) == 15
    assert {key: time for key, time in stored(tmp_path).items() if key in before} == before
    same_runs(plan, done, Store(tmp_path))


def test_a_folder_that_cannot_be_written_to(plan, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(GridPathError, match=r"file cannot be written to"):
        run_study(plan, tmp_path / "file")


# -- progress -----------------------------------------------------------------------------------------------------------


def read_all(master: int) -> str:
    """Return everything that was written to a terminal."""
    os.set_blocking(master, False)
    parts = []
    with contextlib.suppress(BlockingIOError):
        while True:
            parts.append(os.read(master, 100_000))
    return b"".join(parts).decode()


def test_progress_is_shown_on_a_terminal(plan, tmp_path):
    pty = pytest.importorskip("pty", reason="there are no pseudo-terminals on Windows")
    master, slave = pty.openpty()
    with os.fdopen(slave, "w") as terminal:
        run_study(make_plan(1), tmp_path, stream=terminal)
        shown = read_all(master)
    os.close(master)
    assert "/15, about " in shown and " s left" in shown
    assert shown.endswith("\r\x1b[K"), "the line is cleared in the end"


def test_progress_is_silent_elsewhere(tmp_path):
    with open(tmp_path / "log", "w") as file:
        run_study(make_plan(1), tmp_path / "study", stream=file)
    assert (tmp_path / "log").read_text() == ""


def test_the_rest_takes_what_runs_of_its_kind_took():
    assert remaining_seconds({}, {"a": 3}, 10.0) is None
    # 10 s of runs in 5 s: two at a time. Left: 2 runs of 4 s, 1 of 2 s, and 1 unknown of the mean 10 / 3.
    spent = {"a": [4.0, 4.0], "b": [2.0]}
    assert remaining_seconds(spent, {"a": 2, "b": 1, "c": 1}, 5.0) == pytest.approx((8 + 2 + 10 / 3) / 2)
    assert [duration(seconds) for seconds in (3.4, 99, 240, 7200, 360_000)] == ["4 s", "99 s", "4 min", "2 h", "4.2 days"]


def test_progress_counts_failures(tmp_path):
    pty = pytest.importorskip("pty", reason="there are no pseudo-terminals on Windows")
    master, slave = pty.openpty()
    with os.fdopen(slave, "w") as terminal:
        progress = StudyProgress(["a", "a", "b"], terminal)
        progress.interval = 0.0
        progress.done("a", 1.0)
        progress.done("b", 0.0, failed=True)
        shown = read_all(master)
    os.close(master)
    assert "run 1/3, about" in shown and "run 2/3, 1 failed, about" in shown
