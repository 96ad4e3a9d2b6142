"""Figures: what the Axes hold, that nothing leaks, and that files are reproducible."""

import itertools
from types import SimpleNamespace

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.colors import to_rgb
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.optimize import minimize
from queries import SPIRAL

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.convergence import ConvergenceRecorder
from pymoo_gridpath.decision import TradeOffSet
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.operators import paper_operators
from pymoo_gridpath.plotting import plot_convergence, plot_front, plot_map, plot_paths, save_figures
from pymoo_gridpath.plotting.maps import figure_size
from pymoo_gridpath.plotting.style import GROWN, NAME_STYLES, OCCUPIED, STYLE, new_axes
from pymoo_gridpath.problems import random_dense_grid

mpl.use("Agg")


def make_problem(resolution=None, **options):
    return GridPathProblem(random_dense_grid(8, 0.25, 5).replace(resolution=resolution), (0, 0), (7, 7), **options)


def make_set(n=3000, **options):
    problem = make_problem(**options)
    return TradeOffSet.from_genes(problem, np.random.default_rng(0).integers(problem.xl, problem.xu + 1, (n, problem.n_var)))


@pytest.fixture(scope="module")
def two():
    return make_set()


@pytest.fixture(scope="module")
def three():
    return make_set(objectives=("length", "vulnerability", "turn"))


@pytest.fixture(scope="module")
def runs():
    problem = make_problem()
    return [
        minimize(problem, NSGA2(40, **paper_operators(problem)), ("n_gen", 8), seed=seed, callback=ConvergenceRecorder())
        for seed in (1, 2, 3)
    ]


@pytest.fixture(autouse=True)
def nothing_leaks():
    before = dict(mpl.rcParams)
    yield
    plt.close("all")
    assert dict(mpl.rcParams) == before


def lines_by_label(ax):
    return {line.get_label(): line for line in ax.lines}


def legend_of(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]


# -- maps -------------------------------------------------------------------------------------------------------------


def test_the_map_is_dark_where_occupied_and_lighter_elsewhere():
    grid = random_dense_grid(8, 0.25, 5)
    image = plot_map(grid).images[0]
    pixels = np.asarray(image.get_array())
    assert image.get_extent() == [-0.5, 7.5, -0.5, 7.5] and image.origin == "lower"
    dark = np.isclose(pixels, to_rgb(OCCUPIED)).all(axis=2)
    assert np.array_equal(dark, grid.occupied)
    assert pixels[~grid.occupied].mean(axis=1).min() > 0.6
    blank = np.asarray(plot_map(grid, potential=False).images[0].get_array())
    assert (blank[~grid.occupied] == 1.0).all()


def test_start_and_goal_are_marked_and_named():
    ax = plot_map(random_dense_grid(8, 0.25, 5), start=(0, 0), goal=(7, 7))
    marks = lines_by_label(ax)
    assert (marks["start"].get_marker(), marks["goal"].get_marker()) == ("o", "*")
    assert marks["goal"].get_xydata().tolist() == [[7, 7]]
    assert legend_of(ax) == ["start", "goal"]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("$x$ [cells]", "$y$ [cells]")
    assert ax.get_aspect() == 1.0


def test_axes_in_metres_follow_origin_and_yaw():
    grid = random_dense_grid(8, 0.25, 5).replace(resolution=0.5, origin=(-1.0, 2.0))
    ax = plot_map(grid, start=(0, 0), units="m")
    assert ax.get_xlim() == (-1.0, 3.0) and ax.get_ylim() == (2.0, 6.0)
    assert lines_by_label(ax)["start"].get_xydata().tolist() == [[-0.75, 2.25]]
    turned = grid.replace(origin=(-1.0, 2.0, np.pi / 2))
    ax = plot_map(turned, start=(1, 0), units="m")
    assert np.allclose([ax.get_xlim(), ax.get_ylim()], [(-5.0, -1.0), (2.0, 6.0)])
    assert np.allclose(lines_by_label(ax)["start"].get_xydata(), turned.to_metres([(1, 0)]))
    # The image is turned with the cells: the centre of a cell lands on its point in metres.
    to_paper = ax.images[0].get_transform()
    assert np.allclose(to_paper.transform([[3, 5]]), ax.transData.transform(turned.to_metres([[3, 5]])))


def test_large_maps_are_not_ruled():
    assert len(plot_map(OccupancyGrid(np.zeros((32, 32)))).collections) == 1
    assert len(plot_map(OccupancyGrid(np.zeros((20, 40)))).collections) == 0


@pytest.mark.parametrize(
    ("options", "word"),
    [
        ({"units": "feet"}, "units"),
        ({"units": "m"}, "in cells, and an axis in metres needs"),
        ({"potential": np.zeros((3, 3))}, "shape"),
        ({"start": (9, 9)}, "outside"),
    ],
)
def test_bad_arguments_of_a_map_are_refused(options, word):
    with pytest.raises(GridPathError, match=word):
        plot_map(random_dense_grid(8, 0.25, 5), **options)


# -- paths ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("units", ["cells", "m"])
def test_lines_run_through_the_centres_of_cells(units):
    two = make_set(resolution=None if units == "cells" else 0.5)
    lines = lines_by_label(plot_paths(two, units=units))
    drawn = 0
    for label, line in lines.items():
        if label in ("start", "goal"):
            continue
        record = two[label.split(", ")[0]]
        assert np.array_equal(line.get_xydata(), record.cells if units == "cells" else record.points)
        assert line.get_color() == NAME_STYLES[label.split(", ")[0]].color
        assert set(label.split(", ")) == set(record.names)
        drawn += 1
    assert drawn == len(set(two.named.values()))


def test_paths_that_turn_back_are_drawn(tmp_path):
    problem = GridPathProblem(SPIRAL, (0, 0), (2, 2), "cells")
    ways = np.array([[0, 1, 2, 3, 4, 9, 14, 19, 24, 23, 22, 21, 20, 15, 10, 11, 12]])
    trade_off = TradeOffSet.from_genes(problem, ways)
    line = lines_by_label(plot_paths(trade_off, which=["knee"]))["knee"]
    assert np.array_equal(line.get_xydata(), trade_off.knee.cells) and len(trade_off.knee.cells) == 17
    result = minimize(problem, NSGA2(10), ("n_gen", 3), seed=1, callback=ConvergenceRecorder())
    assert {file.stem for file in save_figures(trade_off, tmp_path, history=result)} == {"map", "front", "convergence"}


def test_lines_on_the_same_cells_are_moved_apart_by_less_than_a_quarter_of_a_cell(two):
    ax = plot_paths(two)
    ax.figure.draw_without_rendering()
    chosen = [line for label, line in lines_by_label(ax).items() if label not in ("start", "goal")]
    assert len(chosen) > 1
    cell = np.diff(ax.transData.transform([(0, 0), (1, 0)])[:, 0])[0]
    starts = [line.get_transform().transform(line.get_xydata()[:1])[0] for line in chosen]
    apart = np.hypot(*(starts[1] - starts[0]))
    assert 0.02 * cell < apart < 0.25 * cell
    styles = {(line.get_color(), line.get_linestyle()) for line in chosen}
    assert len(styles) == len(chosen)


def test_other_paths_are_grey_and_can_be_left_out(three):
    named = set(three.named.values())
    label = "other trade-off paths"
    others = [c for c in plot_paths(three).collections if c.get_label() == label]
    assert len(others[0].get_segments()) == len(three) - len(named)
    one = plot_paths(three, which=["knee"], all_paths=False)
    assert not [c for c in one.collections if c.get_label() == label]
    assert legend_of(one) == ["knee", "start", "goal"]


def test_a_field_of_the_problem_is_drawn(two):
    wide = make_set(objectives=("length", "turn"))
    assert np.array_equal(plot_paths(two).images[0].get_array(), plot_map(wide.problem.grid).images[0].get_array())


def test_the_legend_covers_no_cell(two):
    for trade_off in (two, _wide_set()):
        ax = plot_paths(trade_off)
        ax.figure.draw_without_rendering()
        box = ax.get_legend().get_window_extent()
        assert not box.overlaps(ax.get_window_extent()) and not box.overlaps(ax.xaxis.label.get_window_extent())


@pytest.mark.parametrize("height", [60, 150])
def test_many_names_make_the_legend_taller_and_not_the_map_smaller(height):
    trade_off = _wide_set(height)
    ax = new_axes(figure_size(trade_off.problem.grid))
    for name in ("unknown, taken as occupied", "too near for the robot", "safest", "smoothest", "widest", "steadiest"):
        ax.plot([], [], label=name)
    plot_paths(trade_off, ax=ax)
    figure = ax.figure
    figure.draw_without_rendering()
    legend, cells, label = (part.get_window_extent() for part in (ax.get_legend(), ax, ax.xaxis.label))
    assert not legend.overlaps(cells) and not legend.overlaps(label)
    assert cells.width > 0.65 * figure.bbox.width  # of a flat map the legend takes height
    assert legend.x0 >= 0 and legend.x1 <= figure.bbox.width and legend.y0 >= 0


def _wide_set(height=60):
    problem = GridPathProblem(OccupancyGrid(np.zeros((height, 240))), (3, 3), (230, 50), "integer")
    return TradeOffSet.from_genes(problem, np.ones((1, problem.n_var), dtype=int))


def test_unknown_names_are_refused(two):
    with pytest.raises(GridPathError, match="fastest"):
        plot_paths(two, which=["fastest"])
    with pytest.raises(GridPathError, match="fastest"):
        plot_front(two, which=["fastest"])


def test_paths_that_are_not_legal_are_said_to_be_so():
    bad = make_set(n=5)
    assert not bad.feasible
    for ax in (plot_paths(bad), plot_front(bad)):
        assert ax.get_title().startswith("Not feasible")
    assert plot_paths(make_set()).get_title() == ""


# -- fronts -----------------------------------------------------------------------------------------------------------


def test_the_front_shows_all_points_and_marks_the_named(two):
    ax = plot_front(two)
    assert np.array_equal(np.asarray(ax.collections[0].get_offsets()), two.F)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("Path length [cells]", "Path vulnerability")
    for name in ("shortest", "safest", "knee"):
        line = next(line for line in ax.lines if name in str(line.get_label()).split(", "))
        assert line.get_xydata().tolist() == [two.F[two.index(name)].tolist()]
    shown = ", ".join(text.get_text() for text in ax.texts)
    assert all(name in shown for name in two.named)


def test_labels_of_a_front_do_not_overlap(two):
    ax = plot_front(two)
    ax.figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in ax.texts if text.get_text()]
    assert len(boxes) == len(set(two.named.values()))
    for k, box in enumerate(boxes):
        assert not any(box.overlaps(other) for other in boxes[:k])


def test_the_stairs_bound_what_the_front_dominates(two):
    stairs = plot_front(two).lines[0].get_xydata()
    assert np.array_equal(stairs[::2], two.F)
    for corner, left, right in zip(stairs[1::2], two.F[:-1], two.F[1:], strict=True):
        assert corner.tolist() == [right[0], left[1]]


def set_of(F, objectives=("length", "vulnerability")):
    """What a front is drawn from, with given points."""
    return SimpleNamespace(
        F=np.array(F, dtype=float),
        problem=make_problem(objectives=objectives),
        objective_names=list(objectives),
        feasible=True,
        index=lambda name: 0 if name in ("shortest", "smoothest") else len(F) - 1,
    )


def limits(ax):
    return [getattr(ax, f"get_{name}lim")() for name in ("x", "y", "z") if hasattr(ax, f"get_{name}lim")]


def shown_ticks(ax):
    """Ticks of both axes in view, whose labels are whole numbers, not what to add to another at the axis's end."""
    ax.figure.draw_without_rendering()
    assert [axis.get_offset_text().get_text() for axis in (ax.xaxis, ax.yaxis)] == ["", ""]
    places = zip(limits(ax), (ax.get_xticks(), ax.get_yticks()), strict=True)
    return [[tick for tick in ticks if low <= tick <= high] for (low, high), ticks in places]


@pytest.mark.parametrize("point", [(9.9, 0.0), (9.9, 12.67), (4321.5, 1e-9), (3.0, 45.0)])
def test_a_front_of_one_point_stands_well_within_axes_that_do_not_zoom_in_on_it(point):
    ax = plot_front(set_of([point]))
    for value, (low, high) in zip(point, limits(ax), strict=True):
        margin = (value - low) / (high - low)
        assert 0.05 < margin < 0.95
        assert 0.15 * value < high - low < max(0.3 * value, 2.0)
    assert min(tick for ticks in shown_ticks(ax) for tick in ticks) >= 0
    text = next(text for text in ax.texts if text.get_text())
    box, dot = text.get_window_extent(), ax.transData.transform(point)
    assert not box.contains(*dot) and ax.get_window_extent().contains(*box.min) and ax.get_window_extent().contains(*box.max)


@pytest.mark.parametrize("F", [[(1000.2, 5.0), (1000.8, 4.9)], [(5000.0, 5.0001), (5000.03, 5.0)]])
def test_a_front_of_two_near_points_has_whole_numbers_at_its_ticks_that_do_not_overlap(F):
    ax = plot_front(set_of(F))
    x, y = shown_ticks(ax)
    assert len(x) > 2 and len(y) > 2
    for label, following in itertools.pairwise(ax.get_xticklabels()):
        assert label.get_window_extent().x1 < following.get_window_extent().x0
    low, high = ax.get_xlim()
    assert low < F[0][0] and F[1][0] < high < F[1][0] + 0.2 * (F[1][0] - F[0][0])


def test_points_that_differ_by_rounding_are_drawn_as_one():
    (x_low, x_high), (y_low, y_high) = limits(plot_front(set_of([(9.9, 12.5 + 1e-12), (9.9 + 1e-12, 12.5)])))
    assert x_high - x_low > 1.0 and y_high - y_low > 1.0


def test_a_value_that_all_points_share_is_not_zoomed_in_on_in_space_or_colour():
    one = set_of([(9.9, 0.0, 0.0)], ("length", "vulnerability", "turn"))
    for value, (low, high) in zip(one.F[0], limits(plot_front(one)), strict=True):
        assert low < value < high and high - low > 1.0 and low > -0.1
    plane = plot_front(one, objectives=("length", "vulnerability"))
    assert plane.collections[0].get_clim() == (0.0, 1.0)


def test_later_fronts_in_the_same_axes_are_in_view_too():
    ax = plot_front(set_of([(9.9, 12.5)]))
    plot_front(set_of([(20.0, 40.0), (30.0, 30.0)]), ax=ax)
    (x_low, x_high), (y_low, y_high) = limits(ax)
    assert x_low < 9.9 and x_high > 30.0 and y_low < 12.5 and y_high > 40.0


def test_three_objectives_are_drawn_in_space_or_projected(three):
    ax = plot_front(three)
    assert ax.name == "3d"
    assert ax.get_zlabel() == "Total turn [degrees]"
    plane = plot_front(three, objectives=("length", "turn"))
    assert plane.name != "3d"
    assert np.array_equal(np.asarray(plane.collections[0].get_offsets()), three.F[:, [0, 2]])
    assert np.array_equal(plane.collections[0].get_array(), three.F[:, 1])
    assert plane.figure.axes[1].get_ylabel() == "Path vulnerability"


@pytest.mark.parametrize("objectives", [None, ("length", "turn")])
def test_a_reference_is_drawn_under_the_front(three, objectives):
    for given in (three, three.F, three.F.tolist()):
        ax = plot_front(three, reference=given, objectives=objectives, reference_label="true front")
        assert "true front" in legend_of(ax)


def test_fronts_that_cannot_be_drawn_are_refused(two, three):
    with pytest.raises(GridPathError, match="front of 1"):
        plot_front(make_set(objectives=("length",)))
    with pytest.raises(GridPathError, match="'turn'"):
        plot_front(two, objectives=("length", "turn"))
    with pytest.raises(GridPathError, match="front of 2"):
        plot_front(three, objectives=("length", "length"))
    with pytest.raises(GridPathError, match="columns"):
        plot_front(two, reference=three)
    with pytest.raises(GridPathError, match="3d"):
        plot_front(three, ax=plt.figure().add_subplot())
    with pytest.raises(GridPathError, match="plane"):
        plot_front(two, ax=plt.figure().add_subplot(projection="3d"))


# -- convergence ------------------------------------------------------------------------------------------------------


def recorder_of(evaluations, lengths):
    recorder = ConvergenceRecorder()
    recorder.evaluations = list(evaluations)
    recorder.generations = list(range(1, len(recorder.evaluations) + 1))
    recorder.best_length = list(lengths)
    recorder.n_feasible = [int(np.isfinite(value)) for value in lengths]
    recorder.fronts = [np.array([[v, 0.0]]) if np.isfinite(v) else np.empty((0, 2)) for v in lengths]
    return recorder


def test_one_run_is_a_line_with_its_first_legal_path():
    ax = plot_convergence(recorder_of([10, 20, 30], [np.inf, 9.0, 8.0]))
    curve, first = ax.lines
    assert curve.get_xdata().tolist() == [10, 20, 30]
    assert np.array_equal(curve.get_ydata(), [np.nan, 9.0, 8.0], equal_nan=True)
    assert list(first.get_xdata()) == [20, 20]
    assert legend_of(ax) == ["first legal path (generation 2)"]
    assert not ax.collections


def test_several_runs_are_a_median_in_a_band():
    lengths = [[np.inf, 9.0, 8.0], [12.0, 10.0, 6.0], [np.inf, np.inf, 7.0]]
    ax = plot_convergence([recorder_of([10, 20, 30], row) for row in lengths])
    assert np.array_equal(ax.lines[0].get_ydata(), [np.nan, 10.0, 7.0], equal_nan=True)
    assert list(ax.lines[1].get_xdata()) == [20, 20]
    assert legend_of(ax) == ["median", "quartiles", "first legal path (generation 2)"]


def test_runs_with_other_evaluations_keep_their_latest_value():
    ax = plot_convergence([recorder_of([10, 30], [9.0, 5.0]), recorder_of([20, 40], [7.0, 3.0])])
    assert ax.lines[0].get_xdata().tolist() == [20, 30, 40]
    assert ax.lines[0].get_ydata().tolist() == [8.0, 6.0, 4.0]


def test_a_run_that_stands_still_or_ends_at_once_is_seen():
    still = recorder_of([10, 20], [9.0, 9.0])
    still.best_vulnerability = [0.0, 0.0]
    low, high = plot_convergence(still, "vulnerability").get_ylim()
    assert -0.1 < low < 0.0 and high > 1.0
    ax = plot_convergence(recorder_of([10], [9.0]))
    assert ax.lines[0].get_marker() == "." and 8.0 < ax.get_ylim()[0] < 9.0 < ax.get_ylim()[1] < 10.0


def test_no_first_legal_path_is_claimed_where_most_runs_have_none():
    lengths = [[np.inf, np.inf], [np.inf, np.inf], [np.inf, 5.0]]
    assert len(plot_convergence([recorder_of([10, 20], row) for row in lengths]).lines) == 1


def test_algorithms_are_compared_on_the_same_axes_in_one_style():
    ax = plot_convergence(recorder_of([10, 20], [np.inf, np.inf]), label="A")
    assert legend_of(ax) == ["A: no legal path"] and not len(ax.get_yticks())
    assert plot_convergence([recorder_of([10, 40], [9.0, 7.0])] * 2, label="B", color="#D55E00", ax=ax) is ax
    assert legend_of(ax) == ["A: no legal path", "B", "first legal (gen. 1)"]
    assert len(ax.get_yticks()) and ax.get_xlim()[1] > 40
    assert {text.get_fontsize() for text in ax.get_legend().get_texts()} == {STYLE["legend.fontsize"]}


def test_hypervolume_and_vulnerability_of_results(runs):
    ax = plot_convergence(runs[0], "hypervolume", reference_point=(40, 40))
    assert np.array_equal(ax.lines[0].get_ydata(), runs[0].algorithm.callback.hypervolume((40, 40)))
    assert plot_convergence(runs, "vulnerability").get_ylabel() == "Least vulnerability"
    with pytest.raises(GridPathError, match="quantity"):
        plot_convergence(runs, "speed")  # pyright: ignore[reportArgumentType]


def test_runs_without_a_record_are_refused():
    problem = make_problem()
    result = minimize(problem, NSGA2(10, **paper_operators(problem)), ("n_gen", 1), seed=1)
    for history in (result, [], [ConvergenceRecorder()]):
        with pytest.raises(GridPathError, match="recorded"):
            plot_convergence(history)


# -- files ------------------------------------------------------------------------------------------------------------


def test_figures_are_written_and_unknown_to_pyplot(three, runs, tmp_path):
    before = plt.get_fignums()
    written = save_figures(three, tmp_path / "new" / "folder", history=runs, formats=("png",))
    assert [path.name for path in written] == ["map.png", "front.png", "front_plane.png", "convergence.png"]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in written)
    assert sorted(path.name for path in written[0].parent.iterdir()) == sorted(path.name for path in written)
    assert plt.get_fignums() == before


def test_the_same_set_gives_the_same_bytes(two, tmp_path):
    formats = ("png", "pdf", "svg")
    first, second = (save_figures(two, tmp_path / name, formats=formats) for name in ("a", "b"))
    assert [path.name for path in first] == [f"{name}.{form}" for name in ("map", "front") for form in formats]
    for a, b in zip(first, second, strict=True):
        assert a.read_bytes() == b.read_bytes()


def test_one_objective_has_no_front(tmp_path):
    written = save_figures(make_set(objectives=("length",)), tmp_path, formats="png")
    assert [path.name for path in written] == ["map.png"]


def test_runs_without_a_legal_path_have_a_figure_too(two, tmp_path):
    history = recorder_of([10, 20], [np.inf, np.inf])
    assert save_figures(two, tmp_path, history=history, formats="png")[-1].name == "convergence.png"


def test_bad_formats_and_folders_are_refused(two, tmp_path):
    with pytest.raises(GridPathError, match="'gif'"):
        save_figures(two, tmp_path, formats=("gif",))
    (tmp_path / "file").write_text("")
    with pytest.raises(GridPathError, match="cannot be made"):
        save_figures(two, tmp_path / "file", formats="png")


def test_given_axes_are_used_and_returned(two, three, runs):
    figure, axes = plt.subplots(1, 3)
    assert plot_paths(two, ax=axes[0]) is axes[0]
    assert plot_front(two, ax=axes[1]) is axes[1]
    assert plot_convergence(runs, ax=axes[2]) is axes[2]
    space = figure.add_subplot(projection="3d")
    assert plot_front(three, ax=space) is space
    assert plt.get_fignums() == [figure.number]


# -- metres, and what grew ------------------------------------------------------------------------------------------------


def test_obstacles_are_told_from_what_is_too_near_to_them():
    occupied = np.zeros((6, 9), dtype=bool)
    occupied[2, 4] = True
    grid = OccupancyGrid(occupied, 0.5).inflate(0.6)
    problem = GridPathProblem(grid, (0, 0), (8, 5))
    found = TradeOffSet.from_genes(problem, problem.pareto_set(max_seconds=60))
    for ax in (plot_map(grid, potential=False), plot_paths(found, potential=False)):
        image = np.asarray(ax.images[0].get_array())
        assert np.allclose(image[occupied], to_rgb(OCCUPIED))
        assert np.allclose(image[grid.occupied & ~occupied], to_rgb(GROWN)) and np.allclose(image[~grid.occupied], 1.0)
        assert "too near for the robot" in [text.get_text() for text in ax.get_legend().get_texts()]
    assert plot_map(OccupancyGrid(occupied, 0.5)).get_legend() is None


def test_figures_are_in_metres_where_the_map_has_them(runs):
    found, in_cells = make_set(resolution=0.5, representation="integer"), make_set(representation="integer")
    assert plot_paths(found).get_xlabel() == plot_map(found.problem.grid).get_xlabel() == "$x$ [m]"
    assert plot_paths(in_cells).get_xlabel() == "$x$ [cells]" and plot_paths(found, units="cells").get_xlabel() == "$x$ [cells]"
    for one, label, scale in ((found, "Path length [m]", 0.5), (in_cells, "Path length [cells]", 1.0)):
        ax = plot_front(one, reference=one)
        assert ax.get_xlabel() == label
        for dots in ax.collections:
            np.testing.assert_allclose(np.sort(dots.get_offsets()[:, 0]), np.sort(one.F[:, 0]) * scale)
    assert plot_convergence(runs).get_ylabel() == "Least length [cells]"
    lengths = plot_convergence(runs[0]).lines[0].get_ydata()
    for run in runs:
        run.algorithm.callback.resolution = 0.5
    ax = plot_convergence(runs[0])
    np.testing.assert_allclose(ax.lines[0].get_ydata(), 0.5 * lengths)
    assert ax.get_ylabel() == "Least length [m]"
    for run in runs:
        run.algorithm.callback.resolution = None
