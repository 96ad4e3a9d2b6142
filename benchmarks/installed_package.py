"""Install a package with one of each of the seven kinds by pip, run its suites, and use each by name wherever names are taken.

    python benchmarks/installed_package.py

The package is that of the page "Extend it", with an algorithm besides, in a folder outside the repository. Pip installs it
without the network into a folder on PYTHONPATH, so that no environment is changed. It takes a minute or two, most of it for the
suites.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]

ALGORITHM = '''

from pymoo.algorithms.moo.nsga2 import NSGA2


@register
class Patient(NSGA2):
    """NSGA-II that keeps how patient it is."""

    def __init__(self, pop_size=100, patience=3, **kwargs):
        super().__init__(pop_size=pop_size, **kwargs)
        self.patience = patience
'''
ENTRY_POINT = '\n[project.entry-points."pymoo_gridpath.algorithms"]\nPatient = "trails:Patient"\n'
SUITE = """

from trails import Patient

from pymoo_gridpath.testing import AlgorithmSuite


class TestPatient(AlgorithmSuite):
    algorithm = Patient
"""

STUDY = """
seeds = 2
budget = { generations = 3 }
reference = false
[[problems]]
map = "meadow.boxes"
start = [3, 5]
goal = [56, 34]
objectives = ["length", { class = "walking_time", summit = 2 }]
representation = "stops"
[[problems]]
suite = { class = "ponds", size = 12, seed = 2 }
representation = "stops"
[[algorithms]]
algorithm = "Patient"
pop_size = 12
parameters = { patience = 5 }
operators = { mutation = "Nudge" }
[[algorithms]]
algorithm = "weighted"
"""

PYTHON = """
import json, sys
import pymoo_gridpath as gp
from pymoo.optimize import minimize

grid = gp.load_map("meadow.boxes")
problem = gp.GridPathProblem(grid, (3, 5), (56, 34), "stops", ["length", "walking_time"])
algorithm = gp.make_algorithm("Patient", problem, pop_size=12, operators={"mutation": "Nudge"})
planner = gp.make_algorithm("weighted", problem)
for one, termination in ((algorithm, ("n_gen", 3)), (planner, None)):
    assert len(minimize(problem, one, termination, seed=1).F)
trails = sys.modules["trails"]
from pymoo_gridpath.maps import format_of
operator, reader = algorithm.mating.mutation, format_of("meadow.boxes")
from pymoo_gridpath.problems import make_suite
suite = make_suite("ponds", size=12)
assert len(suite.problem().pareto_front())
found = [problem.objectives[1], problem.representation, operator, planner, reader, algorithm, suite]
print(json.dumps([type(one).__module__ + ":" + type(one).__name__ for one in found]))
"""

# What the runs of a stored study are made of, and how they ended.
STORED = """
import json, sys
from pymoo_gridpath.study import Store
store = Store(sys.argv[1])
plan = store.read_plan()
records = [store.read(run.key) for run in plan.runs]
assert {record.status for record in records} == {"finished"}, [record.message for record in records]
problem, algorithms = plan.problems[0].spec, [item.spec for item in plan.algorithms]
assert plan.problems[1].label == "ponds-12-2" and plan.problems[1].source.startswith("the suite ponds, which follows")
first = algorithms[0]
named = [problem["objectives"][1], problem["representation"], first["operators"]["mutation"], algorithms[1]["algorithm"]]
print(json.dumps([one["class"] for one in [*named, first["algorithm"]]] + [one["code"] for one in named] + [len(records)]))
"""

CLUSTER = """
import sys
from distributed import Client, LocalCluster
from pymoo_gridpath.cli import main

if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as cluster:
        print(len(cluster.workers), "workers", file=sys.stderr)
        sys.exit(main(["study", "run", "study.toml", "-o", "dask", "--dask", cluster.scheduler_address]))
"""

KINDS = ("objective", "representation", "operator", "planner", "map format", "algorithm", "suite")


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        source = folder / "trails"
        shutil.copytree(ROOT / "docs" / "extend", source, ignore=shutil.ignore_patterns("__pycache__"))
        for file, more in (("trails.py", ALGORITHM), ("pyproject.toml", ENTRY_POINT), ("test_trails.py", SUITE)):
            (source / file).write_text((source / file).read_text(encoding="utf-8") + more, encoding="utf-8")
        (source / "meadow.boxes").rename(folder / "meadow.boxes")
        (folder / "study.toml").write_text(STUDY, encoding="utf-8")
        (folder / "cluster.py").write_text(CLUSTER, encoding="utf-8")
        options = ["--quiet", "--disable-pip-version-check", "--no-index", "--no-deps", "--no-build-isolation"]
        run(folder, "pip", "-m", "pip", "install", *options, "--target", "site", "./trails")

        expected = [f"trails:{cls}" for cls in ("WalkingTime", "Stops", "Nudge", "WeightedPaths", "Boxes", "Patient", "Ponds")]
        table = {"Python": json.loads(run(folder, "Python", "-c", PYTHON).splitlines()[-1]) == expected}
        query = ["--start", "3,5", "--goal", "56,34", "--representation", "stops", "--objectives", "length,walking_time"]
        for algorithm in (["weighted"], ["Patient", "--operators", "mutation=Nudge", "--pop-size", "12", "--generations", "3"]):
            command = ["plan", "meadow.boxes", *query, "--algorithm", *algorithm, "-o", "planned"]
            run(folder, f"command line, {algorithm[0]}", "-m", "pymoo_gridpath.cli", *command)
        planned = json.loads((folder / "planned" / "paths.json").read_text(encoding="utf-8"))
        mutation = planned["settings"]["runs"][0]["operators"]["mutation"]["name"]
        suite = ["--suite", '{ class = "ponds", size = 12 }', "--objectives", "walking_time,length", "--algorithm", "exact"]
        run(folder, "command line, ponds", "-m", "pymoo_gridpath.cli", "plan", *suite, "-o", "ponds")
        table["command line"] = mutation == "Nudge" and bool(planned["paths"])
        run(
            folder, "study, 2 processes", "-m", "pymoo_gridpath.cli", "study", "run", "study.toml", "-o", "local", "--jobs", "2"
        )
        run(folder, "study, Dask, 2 workers", "cluster.py")
        named = [expected[0], expected[1], expected[2], expected[3], expected[5]]
        for label, stored in (("study, 2 processes", "local"), ("study, Dask, 2 workers", "dask")):
            found = json.loads(run(folder, f"records of {stored}", "-c", STORED, stored))
            table[label] = found == [*named, *["trails 1.0"] * 4, 6]
        suites = run(folder / "trails", "suites", "-m", "pytest", "-q", "-p", "no:cacheprovider").splitlines()[-1]

    print(f"\n{'':16}" + "".join(f"{kind:>16}" for kind in KINDS))
    for where, whether in table.items():
        cells = ["found" if whether else "MISSING"] * len(KINDS)
        print(f"{where:23}" + "".join(f"{cell:>16}" for cell in cells)[7:])
    print("suites:", suites)
    sys.exit(not all(table.values()))


def run(folder: Path, label: str, *arguments: str) -> str:
    """Run Python where the package is installed; print how long it took, and return what it printed."""
    site = folder if (folder / "site").exists() or folder.name != "trails" else folder.parent
    paths = os.pathsep.join([str(site / "site"), str(ROOT)])
    began = time.perf_counter()
    command = [sys.executable, "-W", "ignore::UserWarning", *arguments]
    done = subprocess.run(
        command, cwd=folder, env=os.environ | {"PYTHONPATH": paths}, capture_output=True, text=True, check=False
    )
    if done.returncode:
        sys.exit(f"{label} failed:\n{done.stdout}\n{done.stderr}")
    print(f"{label}: {time.perf_counter() - began:.1f} s", flush=True)
    return done.stdout


if __name__ == "__main__":
    main()
