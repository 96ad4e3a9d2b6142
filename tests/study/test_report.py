"""Reports of made-up and of real studies: what they say, and that they can be made whatever is missing."""

import csv
import hashlib
import io
import itertools
import math
import re
import shutil
from html.parser import HTMLParser
from pathlib import Path

import moocore
import numpy as np
import pytest
import synthetic_study as made
from matplotlib.text import Text
from scipy import stats

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.study import AlgorithmSpec, ProblemSpec, Store, Study
from pymoo_gridpath.study.record import to_bytes
from pymoo_gridpath.study.report import write_report
from pymoo_gridpath.study.report.comparisons import compare, compare_each
from pymoo_gridpath.study.report.contents import slugs
from pymoo_gridpath.study.report.csv_files import csv_files
from pymoo_gridpath.study.report.figure_style import algorithm_styles, rendered, report_style
from pymoo_gridpath.study.report.front_plots import attainment_surfaces, plot_attainment, plot_fronts
from pymoo_gridpath.study.report.plots import band, plot_convergence, plot_ranks, plot_ratios
from pymoo_gridpath.study.report.results import Curve, collect, gist
from pymoo_gridpath.study.report.settings import settings_blocks
from pymoo_gridpath.study.report.statistics import critical_difference, friedman
from pymoo_gridpath.study.report.tables import Table, escape_latex, percent, probability, ratio, significant, spread

NAMES = ["exact", "a_b & 50 %", "<script>alert(1)</script>", "plain"]


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
    commands = "\n".join(lines).replace(r"$\infty$", "infinite")
    assert len(re.findall(r"(?<!\\)\{", commands)) == len(re.findall(r"(?<!\\)\}", commands))
    assert not re.search(r"(?<!\\)[%#_$]", re.sub(r"\\(label|begin|end)\{[^}]*\}", "", commands))
    for table in re.findall(r"\\begin\{tabular\}\{(\w+)\}(.*?)\\end\{tabular\}", commands, re.DOTALL):
        for line in re.findall(r"^ +(.*) \\\\$", table[1], re.MULTILINE):
            assert len(re.findall(r"(?<!\\)&", line)) == len(table[0]) - 1
    assert len(set(re.findall(r"\\label\{(.*?)\}", latex))) == latex.count(r"\label{")


def test_unfinished_runs_are_counted_and_listed(report, made_plan):
    kinds = [row["status"] for row in rows(report / "runs.csv")]
    assert [kinds.count(kind) for kind in ("finished", "failed", "missing", "damaged")] == [len(made_plan.runs) - 3, 1, 1, 1]
    sentence = f"{len(made_plan.runs) - 3} of {len(made_plan.runs)} planned runs are finished, 1 failed, 1 missing, 1 damaged."
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
        "No run of this study is finished, so that there is nothing to report: 0 of 4 planned runs are finished, 4 missing."
    )
    assert sentence in page
    assert "Caution" in markdown and "img" not in Page(page).tags


def test_a_folder_without_a_study_is_refused(tmp_path):
    with pytest.raises(GridPathError, match="has no plan"):
        write_report(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_wrong_arguments_are_refused(store, tmp_path):
    with pytest.raises(GridPathError, match="format 'jpg'"):
        write_report(store.folder, output=tmp_path / "out", formats=("jpg",))
    with pytest.raises(GridPathError, match="target is 0, expected a hypervolume ratio"):
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


# -- comparisons --------------------------------------------------------------------------------------------------------


def results_of(tmp_path, n_problems, n_algorithms, n_seeds):
    plan = made.make_plan({"g": n_problems}, [f"a{k}" for k in range(n_algorithms)], n_seeds)
    return collect(made.fill(tmp_path, plan, n_records=4, n_points=6))


@pytest.mark.parametrize(("n_algorithms", "n_seeds", "tells"), [(2, 3, False), (2, 4, True), (3, 4, False), (3, 5, True)])
def test_nothing_is_significant_where_nothing_could_be(tmp_path, n_algorithms, n_seeds, tells):
    results = results_of(tmp_path, 1, n_algorithms, n_seeds)
    comparison = compare(results, [0], "ratio")
    assert comparison.could_tell is tells
    assert any("Too few seeds" in warning for warning in comparison.warnings) is not tells
    # Whatever the values: those of the greatest difference.
    for run in results.runs:
        run.ratio = run.algorithm + 0.001 * run.seed
    assert any(pair.significant for pair in compare(results, [0], "ratio").pairs) is tells


@pytest.mark.parametrize(("n_problems", "tells"), [(5, False), (6, True)])
def test_problems_are_the_samples_of_several_problems(tmp_path, n_problems, tells):
    results = results_of(tmp_path, n_problems, 2, 2)
    for run in results.runs:
        run.ratio = 0.5 + 0.1 * run.algorithm + 0.001 * run.problem
    comparison = compare(results, range(n_problems), "ratio")
    assert (comparison.could_tell, comparison.pairs[0].significant) == (tells, tells)
    assert comparison.beaten_by(1) == ([0] if tells else []) and comparison.beaten_by(0) == []
    assert (comparison.pairs[0].better, comparison.pairs[0].worse) == (0, n_problems)
    assert f"at least {6} are needed" in " ".join(comparison.warnings) or tells


def test_less_is_better_for_igd_plus(tmp_path):
    results = results_of(tmp_path, 1, 2, 4)
    for run in results.runs:
        run.igd_plus = 1.0 + run.algorithm + 0.01 * run.seed
    comparison = compare(results, [0], "igd_plus")
    assert comparison.pairs[0].effect == 1.0 and comparison.beaten_by(0) == [1]


def test_rounding_breaks_no_ties(tmp_path):
    results = results_of(tmp_path, 1, 2, 6)
    for run in results.runs:
        run.ratio = 0.9 + 1e-13 * run.algorithm
    assert (compare(results, [0], "ratio").pairs[0].p, compare(results, [0], "ratio").pairs[0].effect) == (1.0, 0.5)


def test_differences_of_medians_that_rounding_parts_are_equal(tmp_path):
    results = results_of(tmp_path, 4, 3, 2)
    medians = [[0.9, 0.3, 0.7, 0.5], [0.8, 0.4, 0.6, 0.4], [0.0] * 4]
    assert 0.4 - 0.3 != 0.5 - 0.4
    for run in results.runs:
        run.ratio = medians[run.algorithm][run.problem]
    pair = compare(results, range(4), "ratio").pairs[0]
    assert (pair.statistic, pair.p, pair.effect) == (7.5, pytest.approx(0.625), 0.5)
    # The median of two values that are rounded is not.
    for run in results.runs:
        run.ratio = (0.1, 0.2)[run.seed - 1] if run.algorithm == 0 else 0.15
    assert compare(results, range(4), "ratio").friedman.ranks.tolist() == [2.0, 2.0, 2.0]


def test_two_algorithms_have_no_average_ranks(tmp_path):
    # Seven orders of eight would part them after Nemenyi, but not by the Wilcoxon test if the eighth is the clearest.
    results = results_of(tmp_path, 8, 2, 2)
    for run in results.runs:
        run.ratio = (0.9, 0.5)[run.algorithm] if run.problem == 7 else (0.5, 0.6)[run.algorithm]
    comparison = compare(results, range(8), "ratio")
    assert critical_difference(2, 8) < 7 / 8 - 1 / 8 and comparison.pairs[0].p == pytest.approx(2 * 30 / 2**8)
    assert comparison.friedman is None
    files = write_report(tmp_path, output=tmp_path / "out", formats="svg")
    assert not [path for path in files if path.name.startswith("ranks")]
    assert "Average ranks by" not in texts(tmp_path / "out")[1]
    assert "friedman" not in {row["test"] for row in rows(tmp_path / "out" / "tests.csv")}


def test_problems_that_lack_an_algorithm_are_left_out_of_its_pairs(tmp_path):
    results = results_of(tmp_path, 7, 3, 2)
    for run in results.runs:
        if run.algorithm == 2 and run.problem < 3:
            run.status = "missing"
    comparison = compare(results, range(7), "ratio")
    assert [pair.n_first for pair in comparison.pairs] == [7, 4, 4]
    assert comparison.n_blocks == 4
    assert any("3 of 7 problems lack finished runs" in warning for warning in comparison.warnings)


def test_tests_of_single_problems_are_corrected_together(tmp_path):
    results = results_of(tmp_path, 3, 2, 5)
    each = compare_each(results, range(3), "ratio")
    p = sorted(pair.p for comparison in each for pair in comparison.pairs)
    assert min(pair.p_holm for comparison in each for pair in comparison.pairs) == pytest.approx(min(1.0, 3 * p[0]))


def test_csv_says_where_no_test_could_tell(tmp_path):
    from pymoo_gridpath.study.report.csv_files import Family

    results = results_of(tmp_path, 1, 3, 3)
    files = csv_files(results, [Family("group", [("g", compare(results, [0], "ratio"))])], times=True)
    found = list(csv.DictReader(io.StringIO(files["tests.csv"])))
    assert {row["significant"] for row in found} == {"too few values"}


# -- figures ------------------------------------------------------------------------------------------------------------


def test_attainment_surfaces_are_attained_by_so_many_runs():
    rng = np.random.default_rng(5)
    fronts = [rng.integers(0, 9, (4, 2)).astype(float) for _ in range(6)] + [np.empty((0, 2))]
    shares = (0.0, 0.25, 0.5, 0.75, 0.86, 1.0)
    surfaces = attainment_surfaces(fronts, shares)
    for share, surface in zip(shares, surfaces, strict=True):
        needed = max(math.ceil(share * len(fronts)), 1)
        for z in itertools.product(range(10), repeat=2):
            attained = sum((front <= z).all(axis=1).any() for front in fronts)
            assert (surface <= z).all(axis=1).any() == (attained >= needed)
    assert len(surfaces[-1]) == 0


def test_bands_are_the_quartiles_of_what_runs_had():
    curves = [
        Curve(np.array([10.0, 20.0, 40.0]), np.array([0.1, 0.2, 0.4]), np.ones(3), np.ones(3)),
        Curve(np.array([20.0, 30.0]), np.array([0.5, 0.7]), np.ones(2), np.ones(2)),
    ]
    steps, values = band(curves, "ratio")
    assert (steps[0], steps[-1]) == (20.0, 40.0)
    assert values[1][steps < 30] == pytest.approx((0.2 + 0.5) / 2)
    assert values[1][-1] == pytest.approx((0.4 + 0.7) / 2)


def drawn_texts(figure):
    """Yield the texts of a figure that are seen; ticks beyond an axis have labels too."""
    for text in figure.findobj(Text):
        axis = next((axis for ax in figure.axes for axis in (ax.xaxis, ax.yaxis) if text in axis.get_ticklabels()), None)
        if axis is not None:
            low, high = sorted(axis.get_view_interval())
            if not axis.axes.axison:
                continue
            ticks = axis.get_major_ticks()
            if not any(text is tick.label1 and tick.label1.get_visible() and low <= tick.get_loc() <= high for tick in ticks):
                continue
        if text.get_visible() and text.get_text().strip():
            yield text


def overlaps(figure):
    """Return pairs of texts of a figure that cover one another, and texts that leave it."""
    figure.draw_without_rendering()
    boxes = [(text.get_text(), text.get_window_extent()) for text in drawn_texts(figure)]
    small = [(text, box.shrunk(0.98, 0.8)) for text, box in boxes]
    width, height = figure.bbox.width, figure.bbox.height
    outside = [text for text, box in boxes if box.x0 < -1 or box.y0 < -1 or box.x1 > width + 1 or box.y1 > height + 1]
    assert len(boxes) >= 8
    return outside + [(a, b) for (a, p), (b, q) in itertools.combinations(small, 2) if p.overlaps(q)]


def test_labels_of_many_algorithms_do_not_overlap(tmp_path):
    names = [f"algorithm with long name {k}, and more of it" for k in range(8)]
    plan = made.make_plan({f"problem-{k} of many": 1 for k in range(12)}, names, 2)
    results = collect(made.fill(tmp_path, plan, n_records=4, n_points=5))
    styles = algorithm_styles(names, [False] * 8)
    assert len({(style.color, style.marker) for style in styles}) == 8
    ranks = friedman(np.random.default_rng(0).random((9, 8)))
    close = friedman(np.tile(np.arange(8.0), (60, 1)))
    with report_style():
        assert overlaps(plot_ratios(results, results.groups, styles)) == []
        assert overlaps(plot_convergence(results, range(12), styles)) == []
        assert overlaps(plot_ranks(ranks, names, "title")) == []
        assert overlaps(plot_ranks(close, names, "title")) == []
        assert overlaps(plot_fronts(results, 0, styles)) == []
        assert overlaps(plot_attainment(results, 0, styles)) == []


@pytest.mark.parametrize("form", ["png", "pdf", "svg"])
def test_equal_figures_have_equal_bytes(form):
    ranks = friedman(np.arange(12.0).reshape(4, 3) % 5)
    with report_style():
        files = {rendered(plot_ranks(ranks, ["a", "b", "c"], "title"), form) for _ in range(2)}
    assert len(files) == 1
    assert not re.search(rb"20\d\d-\d\d-\d\d|D:20\d\d", files.pop())


def test_algorithms_keep_their_look():
    labels = [f"a{k}" for k in range(20)]
    styles = algorithm_styles(labels, [k == 3 for k in range(20)])
    assert len({(style.color, style.marker) for style in styles}) == 20
    assert len({style.label for style in algorithm_styles(["x" * 40 + "y" * 40, "x" * 40 + "z" + "y" * 40], [False] * 2)}) == 2


# -- tables -------------------------------------------------------------------------------------------------------------


def test_numbers_are_never_shown_better_than_they_are():
    assert [ratio(value) for value in (0.98, 0.99999, 1.0, 1.00004, math.nan)] == [
        "0.9800",
        "0.9999",
        "1.0000",
        "1.0000",
        "\N{EN DASH}",
    ]
    assert [percent(value) for value in (1.0, 0.9999, 0.5, 0.0001, 0.0)] == ["100 %", ">99.9 %", "50 %", "<0.1 %", "0 %"]
    assert [significant(value) for value in (0.0, 0.00999999, 1.5, 12345.6, 1e-7, math.inf)] == [
        "0",
        "0.0100",
        "1.50",
        "12346",
        "1.00e-07",
        "∞",
    ]
    assert [probability(value) for value in (0.0499, 0.0001, 1.0)] == ["0.050", "<0.001", "1.000"]
    assert spread((1.0, 1.0, 1.0), ratio) == "1.0000" and spread((0.5, 1.0, 1.0), ratio) == "1.0000 [0.5000, 1.0000]"


def test_tables_survive_any_name():
    table = Table("t", "caption_1", ["a|b", "n"], [["new\nline", "<1>"], ["\\{}~^", "∞"]])
    assert [line.count("|") - line.count(r"\|") for line in table.markdown().splitlines()[2:6]] == [3, 3, 3, 3]
    assert escape_latex("\\{}~^<∞") == r"\textbackslash{}\{\}\textasciitilde{}\textasciicircum{}\textless{}$\infty$"


def test_no_cell_is_taken_for_the_argument_of_the_line_before():
    table = Table("t", "c", ["[a]", "n"], [["[2pt]", "1"], ["*", "2"], [" [x", "3"], ["a[*", "[4"]])
    found = [line.strip() for line in table.latex().splitlines() if line.endswith(r" \\")]
    assert found == [r"{[}a] & n \\", r"{[}2pt] & 1 \\", r"{*} & 2 \\", r"{[}x & 3 \\", r"a[* & [4 \\"]


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


def test_genes_are_not_read(store, monkeypatch):
    asked, read = [], Store.read
    monkeypatch.setattr(Store, "read", lambda self, key, genes=True: asked.append(genes) or read(self, key, genes))
    collect(store)
    assert asked and not any(asked)


def test_the_definitions_say_what_is_approximate(report):
    markdown = texts(report)[1]
    assert "evaluations may exceed it by up to one generation" in markdown
    assert "chi-square approximation" in markdown and "rounded to nine decimals" in markdown


def test_slugs_differ():
    assert list(slugs(["a b", "a/b", "A-B", "ü", "é"]).values()) == ["a-b", "a-b-2", "A-B-3", "group", "group-2"]


def test_the_gist_of_a_traceback_is_its_last_line():
    assert gist("Traceback (most recent call last):\n  File\nValueError: why\n") == "ValueError: why"
    assert gist("out of time\nmore") == "out of time" and gist("") == ""


def test_the_settings_say_what_an_algorithm_changes_in_which_problems(tmp_path):
    study = Study(
        problems=[
            ProblemSpec(random={"size": 8, "p0": 0.2, "seeds": 1}, name="random"),
            ProblemSpec(map="paper16", name="map", representation="cells"),
        ],
        algorithms=[AlgorithmSpec(preset="ahmed-deb-2013"), AlgorithmSpec(algorithm="NSGA2", representation="cells")],
        seeds=1,
        budget={"generations": 1},
    )
    Store(tmp_path).write_plan(study.plan())
    table = settings_blocks(collect(Store(tmp_path)), times=False)[-1]
    assert [row[-1] for row in table.rows] == [
        "penalty 1.0 on random; representation integer; penalty 1.0 on map",
        "representation cells on random; nothing on map",
    ]
