"""Stores of made-up runs, of any size and state, whose fronts approach a known one, and how to read their reports."""

from __future__ import annotations

import csv
import hashlib
import io
import itertools
from html.parser import HTMLParser
from pathlib import Path

import moocore
import numpy as np

from pymoo_gridpath.study.planning.plan import Plan, PlannedAlgorithm, PlannedProblem, PlannedRun
from pymoo_gridpath.study.running.record import History, RunRecord, to_bytes
from pymoo_gridpath.study.running.store import Store

VERSIONS = {"pymoo_gridpath": "0.1.0", "pymoo": "0.6.2"}
NSGA2 = {"algorithm": "NSGA2", "pop_size": 100, "smoothness": None, "operators": {"base": "default"}, "parameters": {}}
MACHINE = {"system": "Linux", "processor": "made up", "cores": 2}


def exact_points(rng, n_points=20, n_obj=2):
    """Return a convex front of lengths and further objectives."""
    t = np.sort(rng.random(n_points))
    columns = [40 + 20 * t, 3 + 30 * (1 - t) ** 2]
    if n_obj == 3:
        columns = [40 + 20 * t, 3 + 30 * (1 - t) ** 2 + 8 * rng.random(n_points), 45.0 * rng.permutation(n_points)]
    return np.column_stack(columns)


def problem_spec(objectives, seed):
    """Return the canonical form of a random problem."""
    grid = {"random": {"size": 32, "p0": 0.2, "seed": seed, "corner_cutting": True}}
    rest = {"representation": "integer", "obstacles": "penalty", "penalty": 1.0, "potential_limit": None, "axis": "auto"}
    return {"grid": grid, "start": [0, 0], "goal": [31, 31], "objectives": list(objectives), **rest}


def make_plan(groups, algorithms, n_seeds, objectives=("length", "vulnerability"), reference=True, budget=20_000):
    """Return a plan: groups as {name: number of problems}, algorithms as names, of which "exact" is exact."""
    problems, runs = [], []
    for group, size in groups.items():
        for k in range(size):
            number = len(problems)
            label = group if size == 1 else f"{group} seed {k + 1}"
            key = f"{number:06x}{0xE:06x}{0:020x}" if reference else None
            problems.append(PlannedProblem(label, group, problem_spec(objectives, number), reference=key))
    planned = []
    for name in algorithms:
        spec = {"algorithm": "exact", "max_seconds": 60.0} if name == "exact" else NSGA2
        planned.append(PlannedAlgorithm(name, spec, {}))
    if reference:
        listed = algorithms.index("exact") if "exact" in algorithms else None
        runs += [PlannedRun(problem.reference, k, listed, 0) for k, problem in enumerate(problems)]
    elif "exact" in algorithms:
        listed = algorithms.index("exact")
        runs += [PlannedRun(f"{k:06x}{0xE:06x}{0:020x}", k, listed, 0) for k in range(len(problems))]
    for p in range(len(problems)):
        for a, name in enumerate(algorithms):
            if name != "exact":
                runs += [PlannedRun(f"{p:06x}{a + 16:06x}{seed:020x}", p, a, seed) for seed in range(1, n_seeds + 1)]
    exact = {"algorithm": "exact", "max_seconds": 60.0} if reference else None
    return Plan("made up", {"evaluations": budget}, 0.9, tuple(problems), tuple(planned), tuple(runs), exact)


def make_record(plan, run, F, **changes):
    """Return a record of a run that ends with a front and has no history."""
    algorithm = plan.reference if run.algorithm is None else plan.algorithms[run.algorithm].spec
    objectives = plan.problems[run.problem].spec["objectives"]
    F = np.asarray(F, dtype=float).reshape(-1, len(objectives))
    values = {
        "key": run.key,
        "seed": run.seed,
        "status": "finished",
        "message": "",
        "complete": True,
        "seconds": 2.0,
        "n_eval": 20_000,
        "n_gen": 200,
        "started": "2026-01-01T00:00:00+00:00",
        "versions": VERSIONS,
        "machine": MACHINE,
        "problem": plan.problems[run.problem].spec,
        "algorithm": algorithm,
        "budget": plan.budget,
        "objectives": objectives,
        "X": np.zeros((len(F), 3), dtype=int),
        "F": F[np.lexsort(F.T[::-1])],
        "turn": np.full(len(F), 90.0),
        "n_legal": len(F),
        "n_members": 100,
        "history": None,
    }
    return RunRecord(**{**values, **changes})


def approach(rng, exact, quality, n_records=100, budget=20_000):
    """Return the history of a run that comes nearer to a front in steps, and its last front."""
    distance = np.exp(-np.linspace(0.0, 2.0 + 3.0 * quality, n_records)) + 0.08 * (1.0 - quality)
    noise = 0.5 + rng.random(exact.shape)
    evaluations = np.linspace(100, budget, n_records).astype(np.int64)
    points, first, last = [], [], []
    span = np.ptp(exact, axis=0)
    begin = int(n_records * 0.02 * rng.integers(0, 4))
    steps = [*range(begin, n_records, 3), n_records]
    F = np.empty((0, exact.shape[1]))
    for k, following in itertools.pairwise(steps):
        kept = rng.random(len(exact)) < 0.4 + 0.6 * quality
        kept[0] = True
        F = exact[kept] + 0.6 * distance[k] * noise[kept] * span * (rng.random(kept.sum()) > 0.7 * quality)[:, None]
        F = F[moocore.is_nondominated(F)]
        points.append(F)
        first += [k] * len(F)
        last += [following - 1] * len(F)
    best = np.full(n_records, np.inf)
    for F_k, a in zip(points, steps, strict=False):
        best[a:] = F_k[:, 0].min()
    n_legal = np.where(np.arange(n_records) < begin, 0, np.linspace(20, 100, n_records)).astype(np.int64)
    spans = np.array(first, dtype=np.int32), np.array(last, dtype=np.int32)
    seconds = np.linspace(0.01, 2.0, n_records)
    members = np.full(n_records, 100, dtype=np.int64)
    return History(evaluations, seconds, n_legal, members, best, np.concatenate(points), *spans), F


def fill(folder, plan, n_records=100, n_points=20, skip=(), failed=(), incomplete=(), seed=0):
    """Write the store of a plan, whose later algorithms are better; keys of runs to skip, fail, or leave incomplete."""
    store = Store(folder)
    store.write_plan(plan)
    n_obj = len(plan.problems[0].spec["objectives"])
    fronts = [exact_points(np.random.default_rng([seed, p]), n_points, n_obj) for p in range(len(plan.problems))]
    for run in plan.runs:
        if run.key in skip:
            continue
        exact = fronts[run.problem]
        spec = plan.reference if run.algorithm is None else plan.algorithms[run.algorithm].spec
        if run.key in failed:
            message = 'Traceback (most recent call last):\n  File "x.py", line 1\nValueError: the <b>reason</b>'
            record = make_record(plan, run, [], status="failed", message=message, complete=False)
        elif spec["algorithm"] == "exact":
            complete = run.key not in incomplete
            F = exact if complete else exact[::3]
            message = "" if complete else "out of time: 60 s\nmore"
            record = make_record(plan, run, F, complete=complete, message=message, n_eval=0, n_gen=1, seconds=0.25)
        else:
            rng = np.random.default_rng([seed, run.problem, run.algorithm, run.seed])
            quality = min(1.0, 0.5 + 0.5 * (run.algorithm + 1) / len(plan.algorithms) + 0.05 * rng.standard_normal())
            history, F = approach(rng, exact, max(quality, 0.1), n_records, plan.budget["evaluations"])
            record = make_record(plan, run, F, history=history, n_eval=int(history.evaluations[-1]))
        path = store.path(run.key)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(to_bytes(record))
    return store


def digests(folder):
    """Return the hash of each file under a folder by name."""
    files = sorted(path for path in Path(folder).rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def rows(path):
    """Return the rows of a CSV file as dictionaries."""
    return list(csv.DictReader(io.StringIO(Path(path).read_text(encoding="utf-8"))))


def texts(folder):
    """Return the texts of a report that people read."""
    names = ("index.html", "report.md", "tables.tex")
    return [(Path(folder) / name).read_text(encoding="utf-8") for name in names]


class Page(HTMLParser):
    """Checks that tags are closed in order, and keeps text and addresses."""

    VOID = ("meta", "img", "br")

    def __init__(self, text):
        super().__init__()
        self.open, self.tags, self.words, self.addresses, self.ids = [], [], [], [], []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.addresses += [value for name, value in attrs if name in ("src", "href", "srcset", "data", "action")]
        self.ids += [value for name, value in attrs if name == "id"]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)
