"""From Results to a trade-off set: what is kept, and what becomes of runs without a legal path."""

import itertools
import json
import math
import pickle

import numpy as np
import pytest
from pymoo.core.population import Population
from pymoo.core.result import Result
from trade_offs import draw, make_problem, result_of, run

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.decision import TradeOffSet
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.objectives import Objective, Vulnerability
from pymoo_gridpath.representations import CellSequence
from pymoo_gridpath.testing import reference

MEASURES = ["length", "vulnerability", "turn", "interfering_cells", "clearance"]

# -- what is kept -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("objectives", [("length", "vulnerability"), ("length", "vulnerability", "turn"), ("length",)])
def test_the_set_is_the_legal_front_with_the_smoothest_path_of_each_point(objectives):
    problem = make_problem(objectives=objectives)
    X = draw(problem)
    trade_off = TradeOffSet.from_genes(problem, X)
    expected = reference.legal_front(problem, X)
    assert trade_off.feasible
    assert len(trade_off) == len(expected)
    assert {tuple(f): turn for f, turn in zip(trade_off.F.tolist(), trade_off.measures["turn"], strict=True)} == expected
    assert trade_off.F[:, 0].tolist() == sorted(trade_off.F[:, 0])


@pytest.mark.parametrize("band", [0.02, 0.3])
def test_with_a_band_the_smoothest_of_each_step_is_kept(band):
    problem = make_problem(objectives=("length", "vulnerability"))
    X = draw(problem)
    every, kept = (TradeOffSet.from_genes(problem, X, band=given) for given in (0.0, band))
    low, step = every.F.min(axis=0), band * np.ptp(every.F, axis=0)
    legal = X[problem.decode(X).interfering_cells == 0]
    F, turn = problem.score(problem.decode(legal)), np.asarray(problem.decode(legal).turn)
    boxes = [tuple(box) for box in np.floor((F - low) / step).astype(int).tolist()]
    front = {b for b in boxes if not any(c != b and c[0] <= b[0] and c[1] <= b[1] for c in boxes)}
    least = {b: min(t for c, t in zip(boxes, turn, strict=True) if c == b) for b in front}
    found = [tuple(box) for box in np.floor((kept.F - low) / step).astype(int).tolist()]
    assert dict(zip(found, kept.measures["turn"], strict=True)) == least and len(found) == len(front)
    assert kept.F[:, 0].tolist() == sorted(kept.F[:, 0]) and kept.feasible
    assert kept.meta["settings"]["band"] == band and "band" not in every.meta["settings"]
    with pytest.raises(GridPathError, match=r"band is 2, expected a share from 0 to 0\.5"):
        TradeOffSet(problem, X, band=2)


def test_of_equal_points_the_smoothest_is_kept():
    # On an empty grid, every path of seven diagonals and seven straight steps is equally long.
    problem = GridPathProblem(OccupancyGrid(np.zeros((4, 8)), corner_cutting=True), (0, 0), (7, 3), "integer")
    X = [[0, 1, 0, 1, 0, 1, 0], [0, 0, 0, 0, 1, 1, 1], [0, 1, 0, 1, 1, 0, 0]]
    turns = [reference.turn(problem.decode(np.array([row])).cells(0).tolist()) for row in X]
    assert len(set(turns)) == 3
    trade_off = TradeOffSet.from_genes(problem, X)
    assert trade_off.X.tolist() == [X[int(np.argmin(turns))]]


def test_of_equally_smooth_equal_points_the_first_genes_are_kept_whatever_the_order():
    problem = GridPathProblem(OccupancyGrid(np.zeros((4, 8)), corner_cutting=True), (0, 0), (7, 3), "integer")
    X = np.array(list(itertools.product([0, 1], repeat=7)))
    X = X[problem.score(problem.decode(X))[:, 0] == 4 + 3 * math.sqrt(2)]
    turns = [reference.turn(problem.decode(X).cells(k).tolist()) for k in range(len(X))]
    smoothest = [row for row, turn in zip(X.tolist(), turns, strict=True) if turn == min(turns)]
    assert len(smoothest) > 1
    for seed in range(4):
        shuffled = np.random.default_rng(seed).permutation(X)
        assert TradeOffSet.from_genes(problem, shuffled).X.tolist() == [min(smoothest)]


def test_measures_agree_with_the_definitions(trade_off):
    grid = trade_off.problem.grid
    occupied = np.argwhere(grid.occupied)[:, ::-1]
    for record in trade_off:
        cells = record.cells.tolist()
        assert tuple(cells[0]) == trade_off.problem.start and tuple(cells[-1]) == trade_off.problem.goal
        assert reference.is_connected(cells)
        assert record.length == pytest.approx(reference.length(cells), rel=1e-12)
        assert record.vulnerability == pytest.approx(reference.vulnerability(cells, grid), abs=1e-7)
        assert record.turn == reference.turn(cells)
        assert record.interfering_cells == 0 == reference.interfering_cells(cells, grid)
        assert record.clearance == pytest.approx(min(np.hypot(*(occupied - cell).T).min() for cell in cells))
        assert record.objectives == {"length": record.length, "vulnerability": record.vulnerability}


def test_metres_follow_resolution_and_origin():
    grid = make_problem().grid.replace(resolution=0.25, origin=(-3.0, 2.0))
    problem = GridPathProblem(grid, (0, 0), (7, 7))
    found = TradeOffSet.from_genes(problem, draw(problem))
    record = found.shortest
    assert list(found.measures)[:2] == ["length", "length_m"]
    in_cells = TradeOffSet.from_genes(make_problem(), draw(problem))[0]
    assert in_cells.length_m is None and in_cells.points is None and " m" not in in_cells._repr_html_()
    assert record.length_m == pytest.approx(0.25 * record.length)
    assert record.points[0] == pytest.approx([-2.875, 2.125])
    assert np.allclose(record.points, (record.cells + 0.5) * 0.25 + [-3.0, 2.0])


@pytest.mark.parametrize("variance", [None, 2.0])
def test_vulnerability_is_that_of_the_problem_or_of_the_default(variance):
    given = ("length", "turn") if variance is None else ("turn", Vulnerability(variance))
    problem = make_problem(objectives=given)
    trade_off = TradeOffSet.from_genes(problem, draw(problem, 500))
    for record in trade_off:
        expected = reference.vulnerability(record.cells.tolist(), problem.grid, variance or 0.5)
        assert record.vulnerability == pytest.approx(expected, abs=1e-7)


def test_objectives_of_the_user_are_measures_too():
    class Height(Objective):
        name = "height"
        label = "Sum of rows"

        def field(self, grid):
            return np.repeat(np.arange(grid.height)[:, None], grid.width, axis=1).astype(float)

    problem = make_problem(objectives=("length", Height()))
    trade_off = TradeOffSet.from_genes(problem, draw(problem))
    assert list(trade_off.measures) == [*MEASURES, "height"]
    assert [record.objectives["height"] for record in trade_off] == [record.cells[:, 1].sum() for record in trade_off]


def test_real_genes_are_rounded_as_the_decoder_does():
    problem = make_problem()
    X = draw(problem, 500)
    noisy = X + np.random.default_rng(1).uniform(-0.4, 0.4, X.shape)
    assert np.array_equal(TradeOffSet.from_genes(problem, noisy).X, TradeOffSet.from_genes(problem, X).X)


@pytest.mark.parametrize("representation", ["binary", "mixed", "absolute"])
def test_every_representation_is_decoded(representation):
    problem = make_problem(representation=representation)
    trade_off = TradeOffSet.from_results(run(problem, generations=15))
    assert trade_off.feasible
    assert np.array_equal(problem.score(problem.decode(trade_off.X)), trade_off.F)


def in_cells(problem, X):
    """The same paths coded by their cells: the problem and its genes."""
    coding = CellSequence(problem.grid, problem.start, problem.goal, max_cells=problem.grid.occupied.size)
    other = GridPathProblem(problem.grid, problem.start, problem.goal, coding, problem.objectives)
    return other, coding.encode(problem.decode(np.asarray(X)))


@pytest.mark.parametrize("corner_cutting", [True, False])
def test_paths_by_cells_make_the_same_set(corner_cutting, tmp_path):
    problem = make_problem(corner_cutting=corner_cutting, objectives=("length", "vulnerability", "turn"))
    X = draw(problem)
    expected = TradeOffSet.from_genes(problem, X)
    found = TradeOffSet.from_genes(*in_cells(problem, X))
    assert expected.feasible and found.feasible and found.named == expected.named
    for name, values in expected.measures.items():
        assert np.array_equal(found.measures[name], values), name
    assert expected.to_csv(tmp_path / "a.csv").read_bytes() == found.to_csv(tmp_path / "b.csv").read_bytes()
    content = json.loads(found.to_json(tmp_path / "b.json").read_text())
    settings = content["settings"]
    assert (settings["representation"], settings["axis"], settings["max_cells"]) == ("cells", None, 64)
    again = TradeOffSet.from_genes(found.problem, [record["genes"] for record in content["paths"]])
    assert np.array_equal(again.F, expected.F)
    for record in again:
        assert reference.interfering_cells(record.cells.tolist(), problem.grid) == 0
        assert record.length == pytest.approx(reference.length(record.cells.tolist()))
        assert record.turn == reference.turn(record.cells.tolist())


def test_rows_of_other_lengths_are_refused():
    problem = make_problem()
    runs = []
    for max_cells in (30, 40):
        coding = CellSequence(problem.grid, problem.start, problem.goal, max_cells)
        other = GridPathProblem(problem.grid, problem.start, problem.goal, coding)
        runs.append(result_of(other, coding.repair(draw(other, 5), np.random.default_rng(0))))
    with pytest.raises(GridPathError, match="max_cells"):
        TradeOffSet.from_results(runs)


# -- paths that are not legal -----------------------------------------------------------------------------------------


def test_without_a_legal_path_the_least_interfering_are_kept_and_said_to_be_so():
    problem = make_problem(20, 4)
    X = draw(problem, 200)
    trade_off = TradeOffSet.from_genes(problem, X)
    crossed = [reference.interfering_cells(problem.decode(X).cells(k).tolist(), problem.grid) for k in range(len(X))]
    assert min(crossed) > 0
    assert not trade_off.feasible
    assert set(trade_off.measures["interfering_cells"]) == {min(crossed)}
    assert f"cross {min(crossed)} occupied" in trade_off.infeasibility
    assert "NOT FEASIBLE" in trade_off.table() and "NOT feasible" in repr(trade_off)
    assert all(record.names == () for record in trade_off), "a path across obstacles must not be offered by name"


def test_a_run_without_a_feasible_member_falls_back_on_its_population():
    problem = make_problem(20, 4, obstacles="constraint")
    result = run(problem, generations=1)
    assert result.opt is None
    trade_off = TradeOffSet.from_results(result)
    assert not trade_off.feasible and len(trade_off) >= 1


def test_legal_paths_of_the_population_are_found_where_the_optimum_has_none():
    problem = make_problem(penalty=1e-6)
    X = draw(problem)
    legal = problem.decode(X).interfering_cells == 0
    result = result_of(problem, X)
    result.opt = Population.new(X=X[~legal])
    assert np.array_equal(TradeOffSet.from_results(result).X, TradeOffSet.from_genes(problem, X[legal]).X)


def test_the_potential_limit_decides_too():
    free = make_problem()
    X = draw(free)
    F = TradeOffSet.from_genes(free, X).F
    limit = float(np.median(F[:, 1]))
    limited = make_problem(obstacles="limit", potential_limit=limit)
    assert TradeOffSet.from_genes(limited, X).F.tolist() == F[F[:, 1] <= limit].tolist()
    hopeless = TradeOffSet.from_genes(make_problem(obstacles="limit", potential_limit=1e-6), X)
    assert not hopeless.feasible
    assert "potential limit" in hopeless.infeasibility


# -- merging ----------------------------------------------------------------------------------------------------------


def test_runs_are_merged_into_one_front(results, trade_off):
    X = np.concatenate([result.opt.get("X") for result in results])
    expected = reference.legal_front(trade_off.problem, X)
    assert {tuple(f) for f in trade_off.F.tolist()} == set(expected)
    assert trade_off.meta["seed"] == [1, 2, 3]
    assert [entry["seed"] for entry in trade_off.meta["settings"]["runs"]] == [1, 2, 3]


def test_the_order_of_runs_does_not_matter(results, trade_off):
    turned = TradeOffSet.from_results(results[::-1])
    assert np.array_equal(turned.X, trade_off.X)


def test_runs_of_pickled_copies_of_the_problem_merge(results, trade_off):
    copies = [pickle.loads(pickle.dumps(result)) for result in results]
    assert np.array_equal(TradeOffSet.from_results(copies).X, trade_off.X)


@pytest.mark.parametrize(
    ("other", "word"),
    [
        (make_problem(seed=6), "map"),
        (make_problem(representation="binary"), "representation"),
        (make_problem(objectives=("length", Vulnerability(2.0))), "objectives"),
        (GridPathProblem(make_problem().grid, (7, 7), (0, 0)), "start"),
    ],
)
def test_runs_of_different_problems_are_refused(other, word):
    mine = make_problem()
    with pytest.raises(GridPathError, match=word):
        TradeOffSet.from_results([result_of(mine, draw(mine, 5)), result_of(other, draw(other, 5))])


def test_an_empty_result_is_refused():
    problem = make_problem()
    with pytest.raises(GridPathError, match="Result 0 holds no paths"):
        TradeOffSet.from_results(_empty(problem))
    with pytest.raises(GridPathError, match="no Results"):
        TradeOffSet.from_results([])
    with pytest.raises(GridPathError, match="no paths"):
        TradeOffSet.from_genes(problem, np.empty((0, problem.n_var)))
    with pytest.raises(GridPathError, match="path problem"):
        TradeOffSet.from_results(Result())


def _empty(problem):
    result = Result()
    result.problem = problem
    return result


@pytest.mark.parametrize("band", [np.full((2, 2), 0.1), "wide", -0.1, 0.6, np.nan])
def test_a_band_that_is_none_is_said_wherever_it_is_given(band):
    problem = make_problem()
    X = draw(problem, 20)
    result = result_of(problem, X)
    for make in (
        lambda: TradeOffSet(problem, X, band=band),
        lambda: TradeOffSet.from_genes(problem, X, band=band),
        lambda: TradeOffSet.from_results(result, band=band),
    ):
        with pytest.raises(GridPathError, match=r"band is [^\n]*expected a share from 0 to 0\.5"):
            make()
