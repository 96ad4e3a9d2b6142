"""Reports of small studies, unusual ones and those of which something is missing."""

import dataclasses
import html
import re

import moocore
import numpy as np
import pytest
import synthetic_study as made
from synthetic_study import Page, digests, rows, texts

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.problems import random_dense_grid
from pymoo_gridpath.study import ProblemSpec, Store, Study, run_study
from pymoo_gridpath.study.report import write_report
from pymoo_gridpath.study.report.page.contents import slugs
from pymoo_gridpath.study.report.references import gist
from pymoo_gridpath.study.report.results import collect
from pymoo_gridpath.study.running.record import to_bytes


def test_reports_without_times_do_not_depend_on_them(tmp_path):
    plan = made.make_plan({"g": 1}, ["a", "b"], n_seeds=3)
    for name, factor in (("one", 1.0), ("two", 3.0)):
        store = made.fill(tmp_path / name, plan, n_records=6, n_points=5)
        for run in plan.runs:
            record = store.read(run.key)
            changes = {"seconds": factor * record.seconds, "machine": {"system": name}, "started": name}
            if record.history is not None:
                history = type(record.history)(**{**vars(record.history), "seconds": factor * record.history.seconds})
                changes["history"] = history
            store.path(run.key).write_bytes(to_bytes(type(record)(**{**vars(record), **changes})))
        write_report(tmp_path / name, output=tmp_path / f"{name}-report", formats=(), times=False)
    assert digests(tmp_path / "one-report") == digests(tmp_path / "two-report")
    assert "seconds" not in (tmp_path / "one-report" / "runs.csv").read_text(encoding="utf-8")


@pytest.mark.usefixtures("undrawn")
def test_without_exact_fronts_the_merged_ones_serve_and_are_named(tmp_path):
    plan = made.make_plan({"g": 1}, ["a", "b"], n_seeds=4, reference=False)
    store = made.fill(tmp_path, plan, n_records=6, n_points=6)
    write_report(tmp_path, formats=())
    page, markdown, latex = texts(tmp_path / "report")
    assert "No exact front is at hand for 1 of 1 problems" in page
    assert all("the merged front of all runs" in text for text in (page, markdown, latex))
    assert "measured against the exact front" not in page
    assert {row["reference"] for row in rows(tmp_path / "report" / "runs.csv")} == {"merged"}
    everything = np.concatenate([store.read(run.key).F for run in plan.runs])
    best = np.unique(everything[moocore.is_nondominated(everything)], axis=0)
    assert collect(store).references[0].front.points == pytest.approx(best)


@pytest.mark.parametrize("change", ["incomplete", "failed", "skip"])
@pytest.mark.usefixtures("undrawn")
def test_an_exact_front_that_is_not_whole_does_not_serve(tmp_path, change):
    plan = made.make_plan({"g": 2}, ["a", "exact"], n_seeds=3)
    made.fill(tmp_path, plan, n_records=6, n_points=6, **{change: [plan.problems[0].reference]})
    write_report(tmp_path, formats=())
    first, second = rows(tmp_path / "report" / "problems.csv")
    assert (first["reference"], second["reference"]) == ("merged", "exact")
    words = {"incomplete": "out of time: 60 s", "failed": "ValueError", "skip": "missing"}
    assert words[change] in first["reason"]
    page = texts(tmp_path / "report")[0]
    assert "but on 1 of 2 problems the merged front of all runs" in page
    assert "Problems without an exact front" in page


@pytest.mark.usefixtures("undrawn")
def test_an_exact_front_among_the_algorithms_serves_where_no_other_is_wanted(tmp_path):
    plan = made.make_plan({"g": 2}, ["a", "exact"], n_seeds=3, reference=False)
    exact = [run for run in plan.runs if run.algorithm == 1]
    store = made.fill(tmp_path, plan, n_records=6, n_points=6, incomplete=[exact[1].key])
    references = collect(store).references
    assert [reference.front.exact for reference in references] == [True, False]
    assert references[0].front.points == pytest.approx(store.read(exact[0].key).F)
    assert (references[0].reason, references[0].seconds) == ("", 0.25)
    write_report(tmp_path, formats=())
    assert "No exact front is at hand for 1 of 2 problems" in texts(tmp_path / "report")[0]


def test_a_front_that_is_near_enough_does_not_serve(tmp_path):
    plan = made.make_plan({"g": 1}, ["a", "exact"], n_seeds=3, reference=False)
    store = made.fill(tmp_path, plan, n_records=6, n_points=6)
    run = next(run for run in plan.runs if run.algorithm == 1)
    record = store.read(run.key)
    near = record.algorithm | {"parameters": {"epsilon": 0.02}}
    store.write(run.key, to_bytes(type(record)(**{**vars(record), "algorithm": near})))
    assert not collect(store).references[0].front.exact


def test_an_exact_front_of_an_overridden_problem_does_not_serve(tmp_path):
    plan = made.make_plan({"g": 1}, ["a", "exact"], n_seeds=3, reference=False)
    store = made.fill(tmp_path, plan, n_records=6, n_points=6)
    run = next(run for run in plan.runs if run.algorithm == 1)
    record = store.read(run.key)
    other = record.problem | {"representation": "cells"}
    store.write(run.key, to_bytes(type(record)(**{**vars(record), "problem": other})))
    assert not collect(store).references[0].front.exact


def test_a_longer_exact_search_among_the_algorithms_serves_where_the_wanted_one_fell_short(tmp_path):
    plan = made.make_plan({"g": 1}, ["a", "exact"], n_seeds=2)
    longer = dataclasses.replace(plan.runs[0], key="f" * 32)
    wanted = dataclasses.replace(plan.runs[0], algorithm=None)
    plan = dataclasses.replace(plan, runs=(wanted, longer, *plan.runs[1:]))
    store = made.fill(tmp_path, plan, n_records=6, n_points=6, incomplete=[wanted.key])
    results = collect(store)
    assert results.references[0].front.exact and len(results.references[0].front) == len(store.read(longer.key).F)


@pytest.mark.usefixtures("undrawn")
def test_runs_that_are_but_a_reference_are_counted_apart(tmp_path):
    plan = made.make_plan({"g": 3}, ["a", "b"], n_seeds=2)
    references = [problem.reference for problem in plan.problems]
    made.fill(tmp_path, plan, n_records=6, n_points=6, failed=references[:1])
    write_report(tmp_path, formats=())
    sentence = "12 of 12 planned runs of algorithms are finished. 2 of 3 reference runs (exact fronts) are finished, 1 failed."
    page, markdown, _ = texts(tmp_path / "report")
    assert sentence in page and sentence in markdown.replace("\\", "")


@pytest.mark.usefixtures("undrawn")
def test_points_beyond_the_exact_front_are_reported(tmp_path):
    plan = made.make_plan({"g": 1}, ["a"], n_seeds=2)
    store = made.fill(tmp_path, plan, n_records=6, n_points=6)
    exact = store.read(plan.problems[0].reference).F
    run = plan.runs[-1]
    store.write(run.key, to_bytes(made.make_record(plan, run, exact - [3.0, 0.5])))
    results = collect(store)
    assert results.references[0].exceeded and results.runs[-1].ratio > 1.0
    write_report(tmp_path, formats=())
    assert "points beyond the exact front" in texts(tmp_path / "report")[0]


@pytest.mark.parametrize(
    ("groups", "algorithms", "n_seeds", "objectives"),
    [
        ({"g": 1}, ["a"], 1, ("length", "vulnerability")),
        ({"g": 1}, ["a", "b"], 1, ("length", "vulnerability", "turn")),
        ({"g": 3}, ["a", "b", "c"], 1, ("vulnerability", "turn")),
        ({"g": 2, "h": 1}, ["exact"], 1, ("length", "vulnerability")),
    ],
)
def test_small_studies_have_reports_without_nan(tmp_path, groups, algorithms, n_seeds, objectives):
    plan = made.make_plan(groups, algorithms, n_seeds, objectives)
    made.fill(tmp_path, plan, n_records=4, n_points=5)
    write_report(tmp_path, formats=())
    for text in texts(tmp_path / "report"):
        # Pictures are long words.
        assert not re.search(r"\bnan\b", re.sub(r"base64,[^\"]*", "", text), re.IGNORECASE)
    if n_seeds == 1 and len(algorithms) > 1:
        assert "Too few" in texts(tmp_path / "report")[1]
        assert "| yes" not in texts(tmp_path / "report")[1]


def test_a_single_objective_has_a_report(tmp_path):
    plan = made.make_plan({"g": 1}, ["a", "b"], 2, ("length",))
    store = made.Store(tmp_path)
    store.write_plan(plan)
    for run in plan.runs:
        F = [[40.0 + (run.seed == 2)]]
        store.write(run.key, to_bytes(made.make_record(plan, run, F)))
    write_report(tmp_path, formats=())
    ratios = [row["ratio"] for row in rows(tmp_path / "report" / "runs.csv")]
    assert ratios == ["1", "0", "1", "0"]
    assert "it has one objective" in texts(tmp_path / "report")[0]


def test_runs_without_a_legal_path_count_as_nothing(tmp_path):
    plan = made.make_plan({"g": 1}, ["a", "b"], 3, reference=False)
    store = made.Store(tmp_path)
    store.write_plan(plan)
    for run in plan.runs:
        store.write(run.key, to_bytes(made.make_record(plan, run, [], n_legal=0)))
    write_report(tmp_path, formats=())
    page, markdown, _ = texts(tmp_path / "report")
    assert "no legal path is known" in page and "0 of 3" in page
    assert "against no front, since no run found a legal path" in markdown
    found = rows(tmp_path / "report" / "runs.csv")
    assert {(row["feasible"], row["ratio"], row["igd_plus"], row["evaluations_to_target"]) for row in found} == {
        ("false", "0", "inf", "inf")
    }
    assert {row["p"] for row in rows(tmp_path / "report" / "tests.csv")} == {"1"}


def test_a_study_without_finished_runs_says_so_in_one_sentence(tmp_path):
    plan = made.make_plan({"g": 1}, ["a", "b"], 2)
    made.Store(tmp_path).write_plan(plan)
    write_report(tmp_path)
    page, markdown, _ = texts(tmp_path / "report")
    sentence = (
        "No run of this study is finished, so that there is nothing to report: 0 of 4 planned runs of algorithms are finished, "
        "4 missing. 0 of 1 reference runs (exact fronts) are finished, 1 missing."
    )
    assert sentence in page
    assert "Caution" in markdown and "img" not in Page(page).tags


def test_a_folder_without_a_study_is_refused(tmp_path):
    with pytest.raises(GridPathError, match="has no plan"):
        write_report(tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("undrawn")
def test_figures_of_an_earlier_report_go_and_other_files_stay(tmp_path):
    plan = made.make_plan({"g": 1}, ["a"], 1)
    made.fill(tmp_path, plan, n_records=4, n_points=5)
    figures = tmp_path / "report" / "figures"
    written = {path.name for path in write_report(tmp_path, formats=("png", "pdf")) if path.parent == figures}
    assert {"fronts-g.png", "fronts-g.pdf"} < written
    own = {"fronts-mine.png", "fronts-g.jpg", "ratios-old.pdf", "mine.png"}
    for name in own:
        (figures / name).write_bytes(b"")
    files = write_report(tmp_path, formats="svg")
    names = {path.name for path in figures.iterdir()}
    assert names == own | {path.name for path in files if path.parent == figures}
    assert "fronts-g.svg" in names and not names & written
    assert "fronts-g.svg" in texts(tmp_path / "report")[1]


@pytest.mark.usefixtures("undrawn")
def test_no_figure_goes_that_only_another_text_links(tmp_path):
    plan = made.make_plan({"](figures/fronts-b.png)": 1}, ["a", "](figures/fronts-c.png)"], 2)
    made.fill(tmp_path, plan, n_records=4, n_points=5)
    figures = tmp_path / "report" / "figures"
    figures.mkdir(parents=True)
    own = {f"fronts-{letter}.png" for letter in "abc"}
    for name in own:
        (figures / name).write_bytes(b"")
    (tmp_path / "report" / "report.md").write_text("My own ![one](figures/fronts-a.png)", encoding="utf-8")
    for _ in range(2):
        write_report(tmp_path, formats=())
        assert {path.name for path in figures.iterdir()} == own


@pytest.mark.usefixtures("undrawn")
def test_groups_may_be_called_like_parts_of_the_report(tmp_path):
    groups = {"Settings": 1, "Overview": 1, "all": 2, "Settings-2": 1}
    plan = made.make_plan(groups, ["a", "b", "c"], 2)
    made.fill(tmp_path, plan, n_records=4, n_points=5)
    files = write_report(tmp_path, formats="svg")
    text, _, latex = texts(tmp_path / "report")
    page = Page(text)
    assert len(set(page.ids)) == len(page.ids) == text.count("<h2")
    assert [address[1:] for address in page.addresses if address.startswith("#")] == page.ids
    assert len(set(re.findall(r"\\label\{(.*?)\}", latex))) == latex.count(r"\label{")
    assert len(set(files)) == len(files)


@pytest.mark.usefixtures("undrawn")
def test_the_page_shows_the_study_file_as_it_was(tmp_path):
    text = 'name = "<b>"\n\n# a & b, `c`\n[[problems]]\nmap = "office.map"\nradius = 0.25\n'
    plan = made.make_plan({"g": 1}, ["a", "b"], n_seeds=2)
    store = made.fill(tmp_path, plan, n_records=4, n_points=5)
    write_report(tmp_path, formats=())
    assert "The study file" not in texts(tmp_path / "report")[0]
    store.write_plan(plan, text)
    write_report(tmp_path, formats=())
    page, markdown, _ = texts(tmp_path / "report")
    assert f"<pre>{html.escape(text)}</pre>" in page and text in "".join(Page(page).words)
    assert all(f"\n    {line}\n" in markdown for line in text.splitlines() if line)


def test_slugs_differ():
    assert list(slugs(["a b", "a/b", "A-B", "ü", "é"]).values()) == ["a-b", "a-b-2", "A-B-3", "group", "group-2"]


def test_the_gist_of_a_traceback_is_its_last_line():
    assert gist("Traceback (most recent call last):\n  File\nValueError: why\n") == "ValueError: why"
    assert gist("out of time\nmore") == "out of time" and gist("") == ""


@pytest.mark.usefixtures("undrawn")
def test_what_is_certified_of_exact_fronts_stands_in_the_tables(tmp_path):
    problem = ProblemSpec(grid=random_dense_grid(40, 0.2, 3), start=(0, 0), goal=(39, 39), representation="cells")
    near = {"algorithm": "exact", "name": "near", "parameters": {"epsilon": 0.05}}
    cut = {"algorithm": "exact", "name": "cut", "max_labels": 300}
    searched = {"algorithm": "NSGA2", "name": "searched", "pop_size": 10}
    study = Study(problems=[problem], algorithms=[near, cut, searched], seeds=1, budget={"generations": 2})
    run_study(study, tmp_path / "store")
    write_report(tmp_path / "store", output=tmp_path / "report", formats="png")
    found = {row["algorithm"]: row for row in rows(tmp_path / "report" / "runs.csv")}
    records = {name: Store(tmp_path / "store").read(row["key"]) for name, row in found.items()}
    for name in ("near", "cut"):
        certified, row = records[name].certified, found[name]
        assert certified is not None and f"within {certified.short}" in records[name].message
        assert (float(row["certified_epsilon"]), float(row["certified_share"])) == (certified.epsilon, certified.share)
        assert f"| {certified.short} |" in (tmp_path / "report" / "report.md").read_text(encoding="utf-8")
    assert 0.0 < records["near"].certified.epsilon <= 0.05 and records["searched"].certified is None
    assert (found["searched"]["certified_epsilon"], found["searched"]["certified_share"]) == ("", "")
