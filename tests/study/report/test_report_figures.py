"""Figures of reports: what they show, and that nothing in them covers anything else."""

import itertools
import math
import re

import numpy as np
import pytest
import synthetic_study as made
from matplotlib.lines import Line2D
from matplotlib.text import Text

from pymoo_gridpath.study.report.figures.fronts import attainment_surfaces, plot_attainment, plot_fronts
from pymoo_gridpath.study.report.figures.plots import band, plot_convergence, plot_ranks, plot_ratios
from pymoo_gridpath.study.report.figures.stretched_axis import scale_sentence, stretch_unit
from pymoo_gridpath.study.report.figures.style import algorithm_styles, rendered, report_style
from pymoo_gridpath.study.report.results import Curve, collect
from pymoo_gridpath.study.report.statistics.significance import friedman


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


def overlaps(figure, least=8):
    """Return pairs of texts of a figure that cover one another, and texts that leave it."""
    figure.draw_without_rendering()
    boxes = [(text.get_text(), text.get_window_extent()) for text in drawn_texts(figure)]
    small = [(text, box.shrunk(0.98, 0.8)) for text, box in boxes]
    width, height = figure.bbox.width, figure.bbox.height
    outside = [text for text, box in boxes if box.x0 < -1 or box.y0 < -1 or box.x1 > width + 1 or box.y1 > height + 1]
    assert len(boxes) >= least
    return outside + [(a, b) for (a, p), (b, q) in itertools.combinations(small, 2) if p.overlaps(q)]


def test_labels_of_many_algorithms_do_not_overlap(tmp_path):
    names = [f"algorithm with long name {k}, and more of it" for k in range(8)]
    plan = made.make_plan({f"problem-{k} of many": 1 for k in range(9)}, names, 2)
    results = collect(made.fill(tmp_path, plan, n_records=4, n_points=5))
    styles = algorithm_styles(names, [False] * 8)
    assert len({(style.color, style.marker) for style in styles}) == 8
    ranks = friedman(np.random.default_rng(0).random((9, 8)))
    close = friedman(np.tile(np.arange(8.0), (60, 1)))
    with report_style():
        assert overlaps(plot_ratios(results, results.groups, styles)) == []
        assert overlaps(plot_convergence(results, range(9), styles)) == []
        assert overlaps(plot_ranks(ranks, names)) == []
        assert overlaps(plot_ranks(close, names)) == []
        assert overlaps(plot_fronts(results, 0, styles)) == []
        assert overlaps(plot_attainment(results, 0, styles)) == []


def results_of(tmp_path, algorithms, n_seeds=2, **groups):
    """Return the results of made-up runs, which may be changed, and the styles of their algorithms."""
    plan = made.make_plan(groups or {"g": 1}, algorithms, n_seeds)
    results = collect(made.fill(tmp_path, plan, n_records=4, n_points=5))
    return results, algorithm_styles(algorithms, [False] * len(algorithms))


def places(ax, ratios):
    """Return where ratios lie on a horizontal axis, as shares of its length."""
    return ax.transAxes.inverted().transform(ax.transData.transform([(ratio, 0.0) for ratio in ratios]))[:, 0]


def test_ratios_near_one_are_told_apart_though_others_are_far(tmp_path):
    results, styles = results_of(tmp_path, ["bad", "good", "better"])
    for run in results.runs:
        run.ratio = (0.1, 0.998, 0.9995)[run.algorithm]
    with report_style():
        figure = plot_ratios(results, results.groups, styles)
        assert overlaps(figure, least=4) == []
    bad, good, better, one = places(figure.axes[0], [0.1, 0.998, 0.9995, 1.0])
    assert 0.0 < bad < good - 0.3 and better - good > 0.08 and better < min(one, 1.0)
    # On an axis without a stretch, of which they would be but a line.
    assert (0.9995 - 0.998) / (0.9995 - 0.1) < 0.002


def test_the_axis_of_ratios_is_as_it_is_defined(tmp_path):
    results, styles = results_of(tmp_path, ["a", "b", "c"])
    for run in results.runs:
        run.ratio = (0.0, 0.97, 1.0)[run.algorithm]
    unit = stretch_unit(results, [0])
    assert unit == pytest.approx(0.03)
    with report_style():
        ax = plot_ratios(results, results.groups, styles).axes[0]
    ratios = np.array([0.0, 0.3, 0.9, 0.97, 0.99, 1.0])
    expected = -np.arcsinh((1.0 - ratios) / 0.03)
    found = places(ax, ratios)
    assert (found - found[0]) / (found[-1] - found[0]) == pytest.approx((expected - expected[0]) / (expected[-1] - expected[0]))
    low, high = ax.get_xlim()
    assert low < 0.0 and high > 1.0 and {0.0, 0.9, 1.0} <= set(ax.get_xticks().tolist())


@pytest.mark.parametrize(("medians", "unit"), [((0.2, 0.4), 0.6), ((0.0, 0.0), 1.0), ((0.5, 1.0), 0.5), ((0.9, 0.99998), 1e-4)])
def test_the_stretch_follows_the_best_median_below_one(tmp_path, medians, unit):
    results, styles = results_of(tmp_path, ["a", "b"])
    for run in results.runs:
        run.ratio = medians[run.algorithm]
    assert stretch_unit(results, [0]) == pytest.approx(unit)
    with report_style():
        ax = plot_ratios(results, results.groups, styles).axes[0]
    low, high = ax.get_xlim()
    assert low < min(medians) and high > max(medians) and all(low <= tick <= high for tick in ax.get_xticks())


def test_ratios_of_no_runs_are_drawn(tmp_path):
    results, styles = results_of(tmp_path, ["a", "b"])
    for run in results.runs:
        run.status = "missing"
    with report_style():
        words = [text.get_text() for text in plot_ratios(results, results.groups, styles).findobj(Text)]
    assert words.count("no finished run") == 2


def test_a_target_beyond_the_axis_is_in_no_legend(tmp_path):
    results, styles = results_of(tmp_path, ["a", "b"])
    for run in results.runs:
        run.curve = Curve(np.array([10.0, 20.0]), np.zeros(2), np.full(2, np.inf), np.zeros(2))
        run.ratio = 0.0
    with report_style():
        for ratios, shown in (([0.0, 0.0], False), ([0.5, 1.0], True)):
            for run in results.finished(0, [0]):
                run.curve = Curve(np.array([10.0, 20.0]), np.array(ratios), np.full(2, np.inf), np.zeros(2))
            figure = plot_convergence(results, [0], styles)
            labels = [text.get_text() for text in figure.legends[0].get_texts()]
            low, high = figure.axes[0].get_ylim()
            assert ("target 0.9" in labels, low <= 0.9 <= high) == (shown, shown)


def test_the_legend_of_many_algorithms_takes_no_room_from_panels(tmp_path):
    names = [f"algorithm with a name {k}" for k in range(25)]
    results, styles = results_of(tmp_path, names)
    heights = []
    with report_style():
        for count in (3, 25):
            some = [run for run in results.runs if run.algorithm < count]
            shown = type(results)(results.plan, results.target, some, results.references)
            figure = plot_convergence(shown, [0], styles)
            assert overlaps(figure) == []
            heights.append(figure.axes[0].get_window_extent().height)
            legend = figure.legends[0].get_window_extent()
            assert legend.y0 >= figure.axes[0].get_window_extent().y1 and legend.x0 >= 0 and legend.x1 <= figure.bbox.width
    assert heights[1] == pytest.approx(heights[0], rel=0.1)


def test_no_text_lies_in_a_panel_of_fronts(tmp_path):
    results, styles = results_of(tmp_path, ["a", "b", "c"])
    reference = results.references[0].front
    with report_style():
        figure = plot_fronts(results, 0, styles)
    figure.draw_without_rendering()
    assert not [text for ax in figure.axes for text in ax.texts]
    for k, ax in enumerate(figure.axes):
        fronts = np.concatenate([run.F for run in results.finished(k, [0])])
        found = sum(np.isclose(fronts, z, rtol=1e-9, atol=0).all(axis=1).any() for z in reference.points)
        assert ax.get_title(loc="left") == f"{styles[k].label}\n{found} of {len(reference)} points"


def test_fronts_of_a_map_that_has_metres_are_in_metres(tmp_path):
    results, styles = results_of(tmp_path, ["a", "b"])
    spec = results.plan.problems[0].spec
    said = []
    with report_style():
        for resolution in ({}, {"resolution": 0.05}):
            grid = {**spec["grid"], **resolution}
            spec["grid"] = grid
            figure = plot_fronts(results, 0, styles)
            figure.draw_without_rendering()
            ax = figure.axes[0]
            said.append((figure.get_supxlabel(), [float(tick.get_text()) for tick in ax.get_xticklabels()], ax.get_xticks()))
            assert figure.get_supylabel() == "Path vulnerability"
    (cells, ticks, places), (metres, ticks_m, places_m) = said
    assert (cells, metres) == ("Path length [cells]", "Path length [m]")
    assert ticks == pytest.approx(places) and ticks_m == pytest.approx(0.05 * places_m)


def test_panels_of_attainment_say_in_how_many_runs_there_is_a_legal_path(tmp_path):
    results, styles = results_of(tmp_path, ["a", "b"], n_seeds=5)
    for run in results.finished(1, [0])[:3]:
        run.F = np.empty((0, 2))
    with report_style():
        figure = plot_attainment(results, 0, styles)
    assert [ax.get_title(loc="left") for ax in figure.axes] == ["a", "b\nlegal in 2 of 5 runs"]
    assert overlaps(figure) == [] and not [text for ax in figure.axes for text in ax.texts]


def test_equal_lengths_lie_at_the_foot_of_their_axis(tmp_path):
    results, styles = results_of(tmp_path, ["a", "b"])
    for run in results.runs:
        run.curve = Curve(np.array([10.0, 20.0]), np.ones(2), np.ones(2), np.ones(2))
    with report_style():
        low, high = plot_convergence(results, [0], styles).axes[1].get_ylim()
    assert 0.99 <= low < 1.0 < high and 1.0 - low < 0.1 * (high - low)


def test_names_with_dollar_signs_are_drawn_as_they_are(tmp_path):
    names = ["costs $5 or $6", "x" * 18 + "$" * 20, "$\\frac{1}$"]
    results, styles = results_of(tmp_path, names)
    assert styles[0].label == names[0] and styles[1].label == "x" * 18 + "$…" + "$" * 10
    with report_style():
        figure = plot_fronts(results, 0, styles)
        rendered(figure, "png")
    assert figure.axes[0].get_title(loc="left").startswith("costs $5 or $6\n")
    assert not any(text.get_parse_math() for text in figure.findobj(Text))


def test_captions_name_the_unit_of_each_panel(tmp_path):
    results, _ = results_of(tmp_path, ["a", "b"], g=1, h=1)
    for run in results.runs:
        run.ratio = (0.97, 0.6)[run.problem]
    groups = list(results.groups.values())
    assert "u = 0.03)" in scale_sentence(results, groups[:1])
    assert "u = 0.03, 0.4 from panel to panel)" in scale_sentence(results, groups)


def test_lines_of_attainment_differ_without_colour(tmp_path):
    results, styles = results_of(tmp_path, ["a", "b"], n_seeds=5)
    with report_style():
        figure = plot_attainment(results, 0, styles)
    handles = dict(
        zip((text.get_text() for text in figure.legends[0].get_texts()), figure.legends[0].legend_handles, strict=True)
    )
    lines = {name: handle for name, handle in handles.items() if isinstance(handle, Line2D)}
    looks = {name: (line.get_linewidth(), line._unscaled_dash_pattern) for name, line in lines.items()}
    assert set(lines) == {"exact front", "attained by any run", "by half of the runs", "by all runs"}
    assert len(set(map(str, looks.values()))) == 4
    # What the legend shows is what is drawn.
    drawn = {str((line.get_linewidth(), line._unscaled_dash_pattern)) for line in figure.axes[0].get_lines()}
    assert drawn == set(map(str, looks.values()))


@pytest.mark.parametrize("form", ["png", "pdf", "svg"])
def test_equal_figures_have_equal_bytes(form):
    ranks = friedman(np.arange(12.0).reshape(4, 3) % 5)
    with report_style():
        files = {rendered(plot_ranks(ranks, ["a", "b", "c"]), form) for _ in range(2)}
    assert len(files) == 1
    assert not re.search(rb"20\d\d-\d\d-\d\d|D:20\d\d", files.pop())


def test_algorithms_keep_their_look():
    labels = [f"a{k}" for k in range(20)]
    styles = algorithm_styles(labels, [k == 3 for k in range(20)])
    assert len({(style.color, style.marker) for style in styles}) == 20
    assert len({style.label for style in algorithm_styles(["x" * 40 + "y" * 40, "x" * 40 + "z" + "y" * 40], [False] * 2)}) == 2
