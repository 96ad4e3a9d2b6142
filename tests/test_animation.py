"""Animations of searches among obstacles that move: what their pictures hold, and the files."""

from __future__ import annotations

import copy

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.animation import FFMpegWriter, FuncAnimation
from matplotlib.collections import LineCollection, PatchCollection
from PIL import Image
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.algorithms import make_algorithm
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.plotting import animate_moving
from pymoo_gridpath.problems import MovingObstaclesProblem, ObstacleClock

mpl.use("Agg")

# One goes up between two epochs, one stays, one is beyond the edge.
MOVERS = [[(3, 2), (3, 3)], [(5, 1)], [(9, 9)]]


def make_run(name="NSGA2", shape=(6, 8), **options):
    grid = OccupancyGrid(np.zeros(shape), resolution=0.5, origin=(1.0, 2.0, 0.25))
    problem = MovingObstaclesProblem(grid, MOVERS, (0, 2), (7, 2), 2, **options)
    return minimize(problem, make_algorithm(name, problem, 20), ("n_gen", 4), seed=1, callback=ObstacleClock())


@pytest.fixture(scope="module")
def run():
    return make_run()


def frames_of(path):
    with Image.open(path) as image:
        pictures = []
        for k in range(image.n_frames):
            image.seek(k)
            pictures.append(np.asarray(image.convert("RGB")))
        return pictures, image.info


def test_a_gif_has_a_picture_an_epoch(run, tmp_path):
    shown = animate_moving(run, tmp_path / "crossing.gif", fps=2, dpi=50)
    assert isinstance(shown, FuncAnimation)
    pictures, info = frames_of(tmp_path / "crossing.gif")
    # Older matplotlibs cut off the half dot of 4.09 inches.
    assert len(pictures) == 2 and pictures[0].shape in ((205, 400, 3), (204, 400, 3)) and info["duration"] == 500
    # The mover has left its cell.
    assert (pictures[0] != pictures[1]).any(axis=2).sum() > 50
    assert [path.name for path in tmp_path.iterdir()] == ["crossing.gif"]
    before = (tmp_path / "crossing.gif").read_bytes()
    animate_moving(run.algorithm.callback, tmp_path / "crossing.gif", fps=2, dpi=50)
    assert (tmp_path / "crossing.gif").read_bytes() == before


@pytest.mark.parametrize("units", ["cells", "m"])
def test_each_picture_shows_the_map_the_paths_and_the_front_of_its_epoch(run, tmp_path, units):
    clock = run.algorithm.callback
    shown = animate_moving(run, tmp_path / "a.gif", dpi=20, units=units)
    left, right = shown._fig.axes
    limits = []
    for epoch in (0, 1):
        shown._func(epoch)
        problem = run.problem.stills[epoch]
        frame = problem.grid.to_metres if units == "m" else np.asarray
        squares = next(item for item in left.collections if isinstance(item, PatchCollection))
        centres = [path.vertices[:4].mean(axis=0) for path in squares.get_paths()]
        np.testing.assert_allclose(centres, frame([(3, 2 + epoch), (5, 1), (9, 9)]), atol=1e-9)
        lines = [item for item in left.collections if isinstance(item, LineCollection) and item.get_capstyle() == "round"]
        drawn = sorted(segment.tolist() for segment in lines[0].get_segments())
        paths = problem.decode(clock.X[epoch])
        cells, offsets = paths.sequences
        ways = np.split(np.column_stack([cells % 8, cells // 8]), offsets[1:-1])
        np.testing.assert_allclose(np.concatenate(drawn), np.concatenate(sorted(frame(way).tolist() for way in ways)))
        np.testing.assert_allclose(right.collections[0].get_offsets(), clock.F[epoch] * (0.5, 1.0))
        exact = right.lines[1].get_xydata()
        np.testing.assert_array_equal(exact, problem.pareto_front() * (0.5, 1.0))
        assert right.get_xlabel() == "Path length [m]"
        assert left.get_title(loc="left").startswith(f"Epoch {epoch + 1} of 2: {len(clock.F[epoch])} path")
        limits.append([*right.get_xlim(), *right.get_ylim(), *left.get_xlim(), *left.get_ylim(), *left.get_position().bounds])
    assert limits[0] == limits[1]


def test_the_share_of_hypervolume_is_said_and_never_rounded_up(run, tmp_path):
    clock = copy.copy(run.algorithm.callback)
    exact = run.problem.stills[0].pareto_front()
    clock.F, clock.X = [exact, np.add(exact, (1e-6, 0))], [run.problem.stills[0].pareto_set(), clock.X[1][:0]]
    clock.epochs = [0, 0]
    shown = animate_moving(clock, tmp_path / "a.gif", dpi=20)
    for frame, said in enumerate(("1.000", "0.999")):
        shown._func(frame)
        assert shown._fig.axes[0].get_title(loc="left").endswith(f"hypervolume {said} of the exact front's")


def test_wide_maps_more_objectives_and_epochs_without_a_path_are_drawn(tmp_path):
    wide = make_run(shape=(6, 20), objectives=("length", "vulnerability", "turn"))
    clock = wide.algorithm.callback
    clock.F[1], clock.X[1] = clock.F[1][:0], clock.X[1][:0]
    shown = animate_moving(wide, tmp_path / "wide.gif", reference=False, potential=False, dpi=20)
    left, right = shown._fig.axes
    shown._func(1)
    assert left.get_position().y0 > right.get_position().y1
    assert left.get_title(loc="left") == "Epoch 2 of 2: no legal path"
    assert right.get_xlabel() and right.get_ylabel()


def test_nothing_leaks_and_settings_stay(run, tmp_path):
    before, figures = mpl.rcParams.copy(), plt.get_fignums()
    animate_moving(run, tmp_path / "a.gif", dpi=20)
    assert plt.get_fignums() == figures and mpl.rcParams == before


def test_what_cannot_be_drawn_or_written_is_refused(run, tmp_path, monkeypatch):
    still = GridPathProblem(OccupancyGrid(np.zeros((4, 4))), (0, 0), (3, 3))
    plain = minimize(still, make_algorithm("NSGA2", still, 10), ("n_gen", 2), seed=1)
    for bad in (plain, ObstacleClock(), None):
        with pytest.raises(GridPathError, match="expected a Result of minimize"):
            animate_moving(bad)
    with pytest.raises(GridPathError, match="a front of one objective cannot be drawn"):
        animate_moving(make_run("GA", objectives=("length",)))
    with pytest.raises(GridPathError, match=r"a\.avi: there is no animation of that format, .* \.gif or \.mp4"):
        animate_moving(run, tmp_path / "a.avi")
    monkeypatch.setattr(FFMpegWriter, "isAvailable", classmethod(lambda cls: False))
    with pytest.raises(GridPathError, match=r"a\.mp4: matplotlib finds no ffmpeg, .* or a \.gif"):
        animate_moving(run, tmp_path / "a.mp4")
    with pytest.raises(GridPathError, match="the file cannot be written"):
        animate_moving(run, tmp_path / "missing" / "a.gif", dpi=20)
    for options in ({"fps": 0}, {"dpi": 1}, {"units": "miles"}, {"reference": 2}, {"potential": "yes"}):
        with pytest.raises(GridPathError):
            animate_moving(run, **options)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not FFMpegWriter.isAvailable(), reason="ffmpeg is not installed")
def test_an_mp4_is_written_where_there_is_ffmpeg(run, tmp_path):
    animate_moving(run, tmp_path / "a.mp4", dpi=50)
    assert (tmp_path / "a.mp4").read_bytes()[4:8] == b"ftyp"
