"""Tables of reports: numbers, names that are markup, and what the settings say."""

import math
import re
import shutil
import subprocess

import pytest
import synthetic_study as made
from synthetic_study import texts

from pymoo_gridpath.study import AlgorithmSpec, ProblemSpec, Store, Study
from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.report import write_report
from pymoo_gridpath.study.report.page.blocks import Fold, markdown
from pymoo_gridpath.study.report.page.settings import settings_blocks
from pymoo_gridpath.study.report.results import collect
from pymoo_gridpath.study.report.tables.table import (
    NOTHING,
    Table,
    escape_latex,
    percent,
    probability,
    ratio,
    signed,
    significant,
    spread,
)
from pymoo_gridpath.study.running.record import to_bytes


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
    assert [probability(value) for value in (0.0499, 0.05, 0.0001, 1.0)] == ["<0.050", "0.050", "<0.001", "1.000"]
    assert [signed(value) for value in (-1.0, 0.25, math.nan)] == ["\N{MINUS SIGN}1.000", "0.250", "\N{EN DASH}"]
    assert spread((1.0, 1.0, 1.0), ratio) == "1.0000" and spread((0.5, 1.0, 1.0), ratio) == "1.0000 [0.5000, 1.0000]"


def test_tables_survive_any_name():
    table = Table("t", "caption_1", ["a|b", "n"], [["new\nline", "<1>"], ["\\{}~^", "∞"]])
    assert [line.count("|") - line.count(r"\|") for line in table.markdown().splitlines()[2:6]] == [3, 3, 3, 3]
    assert escape_latex("\\{}~^<∞") == r"\textbackslash{}\{\}\textasciitilde{}\textasciicircum{}\textless{}$\infty$"


def test_no_cell_is_taken_for_the_argument_of_the_line_before():
    table = Table("t", "c", ["[a]", "n"], [["[2pt]", "1"], ["*", "2"], [" [x", "3"], ["a[*", "[4"]])
    found = [line.strip() for line in table.latex().splitlines() if line.endswith(r" \\")]
    assert found == [r"{[}a] & n \\", r"{[}2pt] & 1 \\", r"{*} & 2 \\", r"{[}x & 3 \\", r"a[* & [4 \\"]


def test_latex_joins_no_letters():
    # Of these, LaTeX makes dashes, quotes and Spanish marks.
    for letters in ("--", "---", "``", "''", ",,", "!`", "?`"):
        escaped = escape_latex(f"a{letters}b")
        assert letters not in escaped.replace("{}", " ") and escaped.replace("{}", "") == f"a{letters}b"
    assert escape_latex("it's a-b, c") == "it's a-b, c"


NASTY = [
    "a_b & 50 %",
    "#1 ~x^2 \\foo{bar}",
    "[x] *y* $z$ and more of it [2pt]",
    "naïve é ü ß “q” …",
    "<b> -- ``q'' ,,r'' !`",
    "|\"| it's ∞ \\\\",
]


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="needs pdflatex")
def test_latex_compiles_whatever_the_names(tmp_path):
    plan = made.make_plan({"g_1 & {h}": 2, "[2pt]": 1, "* \\\\": 1, "% comment": 1}, NASTY, 6)
    made.fill(tmp_path, plan, n_records=4, n_points=5)
    write_report(tmp_path, formats=())
    tables = texts(tmp_path / "report")[2]
    packages = r"\usepackage[T1]{fontenc}\usepackage{booktabs,graphicx}"
    document = rf"\documentclass{{article}}{packages}\begin{{document}}\input{{tables.tex}}\end{{document}}"
    (tmp_path / "report" / "all.tex").write_text(document, encoding="utf-8")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "all.tex"]
    done = subprocess.run(command, cwd=tmp_path / "report", capture_output=True, check=False)
    log = done.stdout.decode(errors="replace")
    assert done.returncode == 0, log[-2000:]
    # No table is wider than the page.
    assert tables.count(r"\begin{table}") > 10 and "Overfull" not in log and "Missing" not in log


@pytest.mark.usefixtures("undrawn")
def test_a_table_too_long_for_a_page_is_not_among_those_in_latex(tmp_path):
    plan = made.make_plan({"g": 1}, [f"a{k}" for k in range(12)], 2)
    made.fill(tmp_path, plan, n_records=4, n_points=5)
    write_report(tmp_path, formats=())
    latex = texts(tmp_path / "report")[2]
    # 66 pairs.
    assert r"\label{tab:g-tests-ratio}" not in latex and "% g-tests-ratio is too long for a page" in latex
    assert r"\label{tab:g-quality}" in latex


def test_in_markdown_a_folded_table_has_one_title():
    table = Table("t", "Each one.", ["a", "b"], [["1", "2"]])
    assert markdown([Fold("Each one", (table,))], "f").count("Each one") == 1
    assert markdown([Fold("More", (table, table))], "f").startswith("**More**\n")


# -- settings -----------------------------------------------------------------------------------------------------------


def tables_of(tmp_path, study):
    """Return the tables of a study's settings by name, with rows as dictionaries."""
    store = Store(tmp_path)
    store.write_plan(plan_study(study))
    blocks = list(settings_blocks(collect(store), times=False))
    blocks += [inner for block in blocks if isinstance(block, Fold) for inner in block.blocks]
    tables = {block.name: block for block in blocks if isinstance(block, Table)}
    return {name: [dict(zip(table.header, row, strict=True)) for row in table.rows] for name, table in tables.items()}


def study_of(algorithms, **changes):
    random = ProblemSpec(random={"size": 8, "p0": 0.2, "seeds": [3, 4, 5, 9]}, name="random")
    plain = ProblemSpec(map="paper16", name="map", representation="cells", obstacles="constraint", start=(0, 1), goal=(15, 15))
    values = {"problems": [random, plain], "algorithms": algorithms, "seeds": 1, "budget": {"generations": 1}}
    return Study(**(values | changes))


def test_the_settings_say_what_an_algorithm_changes_in_which_problems(tmp_path):
    algorithms = [AlgorithmSpec(preset="ahmed-deb-2013"), AlgorithmSpec(algorithm="NSGA2", representation="cells")]
    rows = tables_of(tmp_path, study_of(algorithms))["algorithms"]
    assert [row["changes in problems"] for row in rows] == [
        "on random: penalty of 1 a cell; on map: representation integer",
        "on random: representation cells; on map: nothing",
    ]


def test_the_settings_say_how_an_algorithm_treats_obstacles_and_no_more(tmp_path):
    plain = ProblemSpec(map="paper16", representation="integer", obstacles="constraint")
    algorithms = [
        AlgorithmSpec(name="penalty", algorithm="NSGA2", obstacles="penalty"),
        AlgorithmSpec(name="limit", algorithm="NSGA2", obstacles="limit", potential_limit=4.0, representation="binary"),
    ]
    rows = tables_of(tmp_path, study_of(algorithms, problems=[plain]))["algorithms"]
    assert [row["changes in problems"] for row in rows] == [
        "penalty of 2 a cell",
        "representation binary, vulnerability at most 4, penalty of 256 a cell",
    ]


def test_the_settings_say_what_problems_are(tmp_path):
    study = study_of([AlgorithmSpec(algorithm="NSGA2")])
    tables = tables_of(tmp_path, study)
    random, plain = tables["problems"]
    assert (random["number"], random["grid"]) == ("4", "random, 8 x 8 cells, p0 = 0.2, seeds 3 to 5, 9")
    assert (random["query"], random["representation"], random["obstacles"]) == ("0,0 to 7,7", "integer", "penalty of 2 a cell")
    digest = plan_study(study).problems[-1].spec["grid"]["digest"]
    assert plain["grid"] == f"paper16, 16 x 16 cells, digest {digest[:8]}" and plain["obstacles"] == "constraint"
    assert (plain["query"], plain["objectives"], plain["representation"]) == ("0,1 to 15,15", "length, vulnerability", "cells")
    assert [row["grid"].rsplit(" ", 1)[1] for row in tables["each-problem"][:4]] == ["3", "4", "5", "9"]


def test_the_settings_say_what_algorithms_are_in_words(tmp_path):
    algorithms = [
        AlgorithmSpec(name="default", algorithm="NSGA2"),
        AlgorithmSpec(name="random", algorithm="MOEAD", pop_size=50, operators="random", parameters={"n_neighbors": 7}),
        AlgorithmSpec(
            name="own", algorithm="SPEA2", smoothness=False, operators={"base": "paper", "crossover": "SpliceCrossover"}
        ),
        AlgorithmSpec(name="preset", preset="ahmed-deb-2013"),
        AlgorithmSpec(algorithm="exact", max_seconds=5.0),
    ]
    problems = [ProblemSpec(random={"size": 8, "p0": 0.2}, name="integer"), ProblemSpec(map="paper16", representation="mixed")]
    rows = tables_of(tmp_path, study_of(algorithms, problems=problems))["algorithms"]
    assert [row["method"] for row in rows] == ["NSGA2", "MOEAD", "SPEA2", "ahmed-deb-2013 (preset)", "exact"]
    assert [row["population"] for row in rows] == ["100", "50", "100", "500", NOTHING]
    assert [row["ties by turn"] for row in rows] == ["yes", "yes", "no", "yes", NOTHING]
    assert [row["other settings"] for row in rows] == [NOTHING, "n_neighbors 7", NOTHING, NOTHING, "at most 5 seconds"]
    operators = [row["operators"] for row in rows]
    assert operators[0] == operators[3] == "as in Ahmed and Deb (2013)" and "from random paths" in operators[1]
    assert operators[2] == "as in Ahmed and Deb (2013), but with crossover SpliceCrossover"
    assert not re.search(r"[{}\"]", " ".join(cell for row in rows for cell in row.values()))


def test_default_operators_are_those_of_the_representation(tmp_path):
    rows = tables_of(tmp_path, study_of([AlgorithmSpec(algorithm="NSGA2"), AlgorithmSpec(algorithm="GDE3")]))["algorithms"]
    of_the_paper, aware = "as in Ahmed and Deb (2013)", "path-aware, from scalarized paths"
    assert rows[0]["operators"] == f"on random: {of_the_paper}; on map: {aware}"
    assert rows[1]["operators"] == f"on random: sampling and repair {of_the_paper}; on map: sampling and repair {aware}"


def test_single_operators_are_named_with_the_arguments_that_are_no_defaults(tmp_path):
    splice = {"class": "SpliceCrossover", "reach": 6, "prob": 0.9}
    eta = {"class": "DiscretePolynomialMutation", "eta": 30}
    given = [
        ("NSGA2", {"base": "paper", "crossover": {"class": "PointCrossover", "n_points": 3}, "mutation": eta}),
        ("NSGA2", {"base": "random", "sampling": {"class": "ScalarizedSampling", "noise": 0.25}, "crossover": splice}),
        ("NSGA2", {"base": "scalarized", "mutation": {"class": "PathMutation", "margin": 16}}),
        ("GDE3", {"sampling": "ReachableSampling"}),
        ("GDE3", {"sampling": "ReachableSampling", "repair": "PathRepair"}),
    ]
    algorithms = [AlgorithmSpec(name=f"a{k}", algorithm=name, operators=operators) for k, (name, operators) in enumerate(given)]
    problem = ProblemSpec(random={"size": 8, "p0": 0.2}, representation="integer")
    rows = tables_of(tmp_path, study_of(algorithms, problems=[problem]))["algorithms"]
    assert [row["operators"] for row in rows] == [
        "as in Ahmed and Deb (2013), but with crossover PointCrossover (n_points 3) and "
        "mutation DiscretePolynomialMutation (eta 30)",
        "path-aware, but with sampling ScalarizedSampling (noise 0.25) and crossover SpliceCrossover (reach 6)",
        "path-aware, from scalarized paths",
        "repair as in Ahmed and Deb (2013), sampling ReachableSampling",
        "sampling ReachableSampling, repair PathRepair",
    ]


@pytest.mark.parametrize(("sizes", "shown"), [((91, 91), "91 (given: 100)"), ((100, 100), "100"), ((91, 90), "100")])
def test_the_settings_say_how_many_members_there_were(tmp_path, sizes, shown):
    plan = made.make_plan({"g": 1}, ["a"], 2)
    store = made.fill(tmp_path, plan, n_records=4, n_points=5)
    for run, size in zip([run for run in plan.runs if run.algorithm is not None], sizes, strict=True):
        record = store.read(run.key)
        store.write(run.key, to_bytes(type(record)(**{**vars(record), "n_members": size})))
    tables = {block.name: block for block in settings_blocks(collect(store), times=False) if isinstance(block, Table)}
    assert tables["algorithms"].rows[0][3] == shown
