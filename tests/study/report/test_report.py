"""Reports of a made-up study with gaps and of a real one: what their files say, against the stored runs."""

import json
import math
import re
import shutil

import moocore
import numpy as np
import pytest
import synthetic_study as made
from scipy import stats
from synthetic_study import Page, digests, rows, texts

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.study import ProblemSpec, Store, Study, run_study
from pymoo_gridpath.study.planning.build import build_problem
from pymoo_gridpath.study.report import write_report
from pymoo_gridpath.study.report.results import collect

NAMES = ["exact", "a_b & 50 %", "<script>alert(1)</script>", "plain"]


@pytest.fixture(scope="module")
def made_plan():
    return made.make_plan({"dense & hard": 2, "one": 1}, NAMES, n_seeds=5)


@pytest.fixture(scope="module")
def store(made_plan, tmp_path_factory):
    keys = [run.key for run in made_plan.runs if run.algorithm != 0]
    folder = tmp_path_factory.mktemp("made")
    store = made.fill(folder, made_plan, n_records=12, n_points=8, skip=keys[3:4], failed=keys[4:5])
    damaged = store.path(keys[12])
    damaged.write_bytes(damaged.read_bytes()[:-100])
    return store


@pytest.fixture(scope="module")
def report(store, tmp_path_factory):
    output = tmp_path_factory.mktemp("report")
    before = digests(store.folder)
    files = write_report(store.folder, output=output, formats="png")
    assert digests(store.folder) == before
    assert sorted(files) == sorted(path for path in output.rglob("*") if path.is_file())
    return output


def test_the_same_store_gives_the_same_bytes(store, report, tmp_path):
    shutil.copytree(store.folder, tmp_path / "copy")
    files = write_report(tmp_path / "copy", formats="png")
    assert files[0].parent == tmp_path / "copy" / "report"
    assert digests(tmp_path / "copy" / "report") == digests(report)


def test_the_page_is_whole_and_needs_nothing_else(report):
    page = Page(texts(report)[0])
    assert page.tags.count("h1") == 1 and page.tags.count("img") >= 6 and "script" not in page.tags
    outside = [address for address in page.addresses if not address.startswith(("data:image/png;base64,", "#"))]
    assert outside == []
    assert {address[1:] for address in page.addresses if address.startswith("#")} == set(page.ids)
    assert not re.search(r"url\(|@import", texts(report)[0])
    words = " ".join(page.words)
    for name in (*NAMES, "dense & hard", "ValueError: the <b>reason</b>", "made up", "pymoo 0.6.2"):
        assert name in words


def test_names_are_escaped_in_every_format(report):
    page, markdown, latex = texts(report)
    assert "<script>" not in page and r"\<script\>" in markdown
    assert r"a\_b \& 50 \%" in latex and r"\textless{}script\textgreater{}" in latex
    lines = [line for line in latex.splitlines() if not line.startswith("%")]
    commands = "\n".join(lines).replace(r"$\infty$", "infinite").replace("$-$", "minus")
    assert len(re.findall(r"(?<!\\)\{", commands)) == len(re.findall(r"(?<!\\)\}", commands))
    # A head in several lines is a table in a cell.
    commands = re.sub(r"\\begin\{tabular\}\[b\]\{@\{\}.@\{\}\}(.*?)\\end\{tabular\}", r"\1", commands)
    commands = commands.replace(r"\providecommand{\fitline}[1]", "").replace("{!}{#1}", "")
    assert not re.search(r"(?<!\\)[%#_$]", re.sub(r"\\(label|begin|end)\{[^}]*\}", "", commands))
    tables = re.findall(r"\\begin\{tabular\}\{(\w+)\}(.*?)\\end\{tabular\}", commands, re.DOTALL)
    assert len(tables) == commands.count(r"\begin{table}") > 5
    for table in tables:
        for line in re.findall(r"^ +(.*) \\\\$", table[1], re.MULTILINE):
            assert len(re.findall(r"(?<!\\)&", line)) == len(table[0]) - 1
    assert len(set(re.findall(r"\\label\{(.*?)\}", latex))) == latex.count(r"\label{")


def test_unfinished_runs_are_counted_and_listed(report, made_plan):
    kinds = [row["status"] for row in rows(report / "runs.csv")]
    assert [kinds.count(kind) for kind in ("finished", "failed", "missing", "damaged")] == [len(made_plan.runs) - 3, 1, 1, 1]
    n_runs = len(made_plan.runs)
    sentence = f"{n_runs - 3} of {n_runs} planned runs of algorithms are finished, 1 failed, 1 missing, 1 damaged."
    assert all(sentence in text for text in texts(report)[:2])
    (row,) = [
        row for row in rows(report / "summary.csv") if row["problem"] == "dense & hard seed 1" and row["algorithm"] == NAMES[1]
    ]
    assert (row["planned"], row["finished"], row["missing"]) == ("5", "3", "1")
    assert "On 1 of 2 problems not all algorithms have the same number of finished runs" in texts(report)[1]


def test_measures_are_those_of_the_stored_fronts(report, store, made_plan):
    for row in rows(report / "runs.csv"):
        if row["status"] != "finished":
            continue
        record = store.read(row["key"])
        problem = next(problem for problem in made_plan.problems if problem.label == row["problem"])
        exact = store.read(problem.reference).F
        low, span = exact.min(axis=0), np.ptp(exact, axis=0)
        sets = [(F - low) / span for F in (record.F, exact)]
        volumes = [moocore.hypervolume(F, ref=[1.1, 1.1]) for F in sets]
        assert float(row["ratio"]) == pytest.approx(volumes[0] / volumes[1], abs=1e-9)
        assert float(row["igd_plus"]) == pytest.approx(moocore.igd_plus(sets[0], ref=sets[1]), abs=1e-12)
        found = [any(np.allclose(f, z, rtol=1e-9, atol=0) for f in record.F) for z in exact]
        assert float(row["share"]) == pytest.approx(np.mean(found))
        if record.history is not None:
            history = record.history
            ratios = [
                moocore.hypervolume((F - low) / span, ref=[1.1, 1.1]) / volumes[1] if len(F) else 0.0
                for F in map(history.front, range(len(history)))
            ]
            reached = [k for k, value in enumerate(ratios) if value >= made_plan.target]
            expected = (history.evaluations[reached[0]], history.seconds[reached[0]]) if reached else (math.inf, math.inf)
            assert (float(row["evaluations_to_target"]), float(row["seconds_to_target"])) == pytest.approx(expected)


def test_the_summary_is_of_the_rows_of_runs(report):
    runs = rows(report / "runs.csv")
    for row in rows(report / "summary.csv"):
        members = [run for run in runs if run["algorithm"] == row["algorithm"] and run["status"] == "finished"]
        if row["level"] != "study":
            members = [run for run in members if run["group"] == row["group"]]
        if row["level"] == "problem":
            members = [run for run in members if run["problem"] == row["problem"]]
        assert int(row["finished"]) == len(members)
        values = [float(run["ratio"]) for run in members]
        found = [float(row[f"ratio_{part}"]) for part in ("q1", "median", "q3")]
        assert found == pytest.approx(np.quantile(values, [0.25, 0.5, 0.75]))
        reached = sum(float(run["seconds_to_target"]) < math.inf for run in members)
        assert int(row["reached_target"]) == reached
        assert float(row["feasible_rate"]) == np.mean([run["feasible"] == "true" for run in members])


def test_tests_are_those_of_scipy_on_the_rows_of_runs(report):
    runs = [row for row in rows(report / "runs.csv") if row["group"] == "one" and row["status"] == "finished"]
    found = [row for row in rows(report / "tests.csv") if row["scope"] == "one" and row["measure"] == "ratio"]
    assert len(found) == 3
    for row in found:
        x, y = ([float(run["ratio"]) for run in runs if run["algorithm"] == row[side]] for side in ("first", "second"))
        expected = stats.mannwhitneyu(x, y, method="exact")
        assert float(row["p"]) == pytest.approx(expected.pvalue)
        assert float(row["effect"]) == pytest.approx(expected.statistic / (len(x) * len(y)))
    assert sorted(float(row["p_holm"]) for row in found)[0] == pytest.approx(3 * min(float(row["p"]) for row in found))


def test_wrong_arguments_are_refused(store, tmp_path):
    with pytest.raises(GridPathError, match="format 'jpg'"):
        write_report(store.folder, output=tmp_path / "out", formats=("jpg",))
    with pytest.raises(GridPathError, match="target is 0, expected a share above 0, at most 1"):
        write_report(store.folder, output=tmp_path / "out", target=0)
    assert not (tmp_path / "out").exists()
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(GridPathError, match="cannot be made"):
        write_report(store.folder, output=tmp_path / "file")


def test_another_target_counts(store):
    low, high = collect(store, 0.01), collect(store, 1.0)
    assert all(a.evaluations_to_target <= b.evaluations_to_target for a, b in zip(low.runs, high.runs, strict=True) if a.curve)
    assert sum(math.isinf(run.seconds_to_target) for run in high.runs) > sum(
        math.isinf(run.seconds_to_target) for run in low.runs
    )


def test_genes_are_not_read(store, monkeypatch):
    asked, read = [], Store.read
    monkeypatch.setattr(Store, "read", lambda self, key, genes=True: asked.append(genes) or read(self, key, genes))
    collect(store)
    assert asked and not any(asked)


def test_the_definitions_say_what_is_approximate(report):
    markdown = texts(report)[1]
    assert "evaluations may exceed it by up to one generation" in markdown
    assert "chi-square approximation" in markdown and "rounded to nine decimals" in markdown


def test_a_real_study_has_a_report(done, tmp_path):
    write_report(done.folder, output=tmp_path, formats=())
    found = rows(tmp_path / "runs.csv")
    assert {row["status"] for row in found} == {"finished"}
    assert all(0.0 <= float(row["ratio"]) <= 1.0 and row["reference"] == "exact" for row in found)
    assert any(float(row["ratio"]) > 0.3 for row in found)
    for row in found:
        history = done.read(row["key"]).history
        if row["evaluations_to_target"] not in ("", "inf"):
            assert int(row["evaluations_to_target"]) in history.evaluations


@pytest.mark.usefixtures("undrawn")
def test_each_merged_front_has_a_page_to_choose_from(done, tmp_path):
    files = write_report(done.folder, output=tmp_path, formats=())
    index, markdown, _ = texts(tmp_path)
    links = [address for address in Page(index).addresses if not address.startswith(("data:", "#"))]
    plan = done.read_plan()
    assert sorted(links) == sorted(str(file.relative_to(tmp_path)) for file in files if file.parent.name == "explorer")
    fronts: dict[str, list[np.ndarray]] = {}
    for run in plan.runs:
        problem = plan.problems[run.problem]
        if run.algorithm is not None and problem.label in ("dense/1", "field") and len(F := done.read(run.key).F):
            fronts.setdefault(f"explorer/front-{problem.group}-{plan.algorithms[run.algorithm].label}.html", []).append(F)
    assert set(links) == set(fronts) and len(links) == 8
    assert all(f"]({link})" in markdown for link in links)
    names = {"dense": ("length", "vulnerability"), "field": ("length", "turn")}
    for link in links:
        text = (tmp_path / link).read_text(encoding="utf-8")
        data = json.loads(re.search(r'id="data">(.*)</script>', text)[1])
        group, algorithm = re.fullmatch(r"explorer/front-(\w+)-(\w+)\.html", link).groups()
        columns = {column["key"]: column["values"] for column in data["columns"]}
        front = np.stack([columns[name] for name in names[group]], axis=1)
        merged = np.concatenate(fronts[link])
        merged = np.unique(merged[moocore.is_nondominated(merged, keep_weakly=True)], axis=0)
        np.testing.assert_allclose(front, merged, rtol=1e-6)
        assert data["map"]["name"] == f"{algorithm} on {'dense/1' if group == 'dense' else group}"
    # A page whose runs are gone goes with the next report.
    (tmp_path / links[0]).write_text("old")
    (tmp_path / "explorer" / "mine.html").write_text("mine")
    shutil.copytree(done.folder, tmp_path / "copy")
    for run in plan.runs:
        if run.algorithm is not None and plan.algorithms[run.algorithm].label == "moead":
            (tmp_path / "copy" / done.path(run.key).relative_to(done.folder)).unlink()
    write_report(tmp_path / "copy", output=tmp_path, formats=())
    left = {file.name for file in (tmp_path / "explorer").iterdir()}
    assert left == {"mine.html", *(link.removeprefix("explorer/") for link in links if "moead" not in link)}
    assert (tmp_path / links[0]).read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


@pytest.mark.usefixtures("undrawn")
def test_pages_know_the_robot_and_where_the_map_lies(tmp_path):
    occupied = np.zeros((10, 12), dtype=bool)
    occupied[4:6, 5] = True
    grid = OccupancyGrid(occupied, 0.25, (-3.0, 1.0, 0.5), name="hall")
    footprint = [(0.3, 0.1), (-0.3, 0.1), (-0.3, -0.1), (0.3, -0.1)]
    study = Study(
        problems=[ProblemSpec(grid=grid, start=(0, 0), goal=(11, 9), footprint=footprint)],
        algorithms=[{"algorithm": "exact"}],
        seeds=1,
        budget={"generations": 1},
        reference=False,
    )
    run_study(study, tmp_path / "study")
    store = Store(tmp_path / "study")
    (planned,) = store.read_plan().problems
    assert planned.place == {
        "origin": [-3.0, 1.0, 0.5],
        "robot_radius": pytest.approx(0.1**0.5),
        "footprint": [list(corner) for corner in footprint],
        "original": grid.digest,
    }
    solved = build_problem(planned.spec, store.read_grid(planned), planned.place, store.read_original(planned))
    grown = grid.inflate(footprint=footprint)
    assert solved.grid.original == grid.replace(name="grid") and solved.grid == grown.replace(name="grid")
    assert solved.grid.footprint == grown.footprint
    write_report(store.folder, output=tmp_path, formats=())
    (page,) = (tmp_path / "explorer").glob("*.html")
    data = json.loads(re.search(r'id="data">(.*)</script>', page.read_text(encoding="utf-8"))[1])
    assert data["map"]["origin"] == [-3.0, 1.0, 0.5] and data["grown"] is not None
    assert "Clearance of the robot" in [column["label"] for column in data["columns"]]
    # A folder of before has no more than what was planned on, and makes a page still.
    store._grid_file(grid.digest).unlink()
    solved = build_problem(planned.spec, store.read_grid(planned), planned.place, store.read_original(planned))
    assert solved.grid.original is solved.grid and solved.grid.origin == grid.origin


def test_genes_of_another_front_make_no_page(report):
    """Those of the made-up study are none: its points were drawn."""
    assert not (report / "explorer").exists() and "explorer/" not in texts(report)[1]
