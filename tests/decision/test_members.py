"""The members of a trade-off set: named ones, indices, the knee."""

import numpy as np
import pytest
from trade_offs import make_problem, run

from pymoo_gridpath import GridPathProblem, OccupancyGrid
from pymoo_gridpath.decision import NAMES, TradeOffSet, knee_point
from pymoo_gridpath.errors import GridPathError


def test_named_members_have_the_least_of_their_measure(trade_off):
    assert trade_off.shortest.length == trade_off.measures["length"].min()
    assert trade_off.safest.vulnerability == trade_off.measures["vulnerability"].min()
    assert trade_off.smoothest.turn == trade_off.measures["turn"].min()
    for name in NAMES:
        assert name in trade_off[name].names
        assert trade_off[name].index == trade_off.index(name)
        assert np.array_equal(getattr(trade_off, name).cells, trade_off[name].cells)
    with pytest.raises(GridPathError, match="fastest"):
        trade_off["fastest"]


def test_a_tie_goes_to_the_path_better_in_the_first_objective():
    problem = make_problem(16, 2, objectives=("length", "vulnerability"))
    trade_off = TradeOffSet.from_results([run(problem, seed, 40) for seed in (1, 2)])
    smoothest = [record for record in trade_off if record.turn == trade_off.smoothest.turn]
    assert trade_off.smoothest.length == min(record.length for record in smoothest)


def test_indices_behave_like_those_of_a_list(trade_off):
    assert trade_off[-1].index == len(trade_off) - 1
    assert [record.index for record in trade_off] == list(range(len(trade_off)))
    with pytest.raises(IndexError):
        trade_off[len(trade_off)]
    with pytest.raises(AttributeError):
        trade_off[0].length = 3.0  # pyright: ignore[reportAttributeAccessIssue]


def knee_by_definition(F):
    """Signed distance from the line through the extreme points of a front of two, after scaling."""
    F = np.asarray(F, dtype=float)
    scaled = (F - F.min(axis=0)) / (F.max(axis=0) - F.min(axis=0))
    (ax, ay), (bx, by) = scaled[np.argmin(scaled[:, 0])], scaled[np.argmin(scaled[:, 1])]
    away = [((bx - ax) * (ay - y) - (ax - x) * (by - ay)) / np.hypot(bx - ax, by - ay) for x, y in scaled]
    return int(np.argmax(away))


def test_the_knee_of_two_objectives_is_furthest_from_the_line_of_extremes():
    rng = np.random.default_rng(0)
    for _ in range(50):
        x = np.sort(rng.random(12))
        F = np.column_stack([100 * x, 3 * np.sort(rng.random(12))[::-1]])
        assert knee_point(F) == knee_by_definition(F)


@pytest.mark.parametrize(
    ("F", "expected"),
    [
        ([[3, 7]], 0),
        ([[1, 9], [2, 3]], 0),
        ([[0, 4], [3, 3], [4, 0]], 0),  # bulges away: the first extreme
        ([[0, 4], [1, 2], [2, 1], [4, 0]], 1),  # a tie
        ([[0, 10, 5], [10, 0, 5], [1, 1, 5]], 2),  # one objective does not vary
        ([[0, 1, 1], [1, 0, 1], [1, 1, 0], [0.4, 0.4, 0.4], [0.5, 0.5, 0.5]], 3),
        ([[0, 1, 1], [1, 0, 1], [1, 1, 0], [0.1, 0.2, 0.3], [0.3, 0.2, 0.1]], 3),  # a tie but for rounding
        ([[5], [5]], 0),
    ],
)
def test_knees_made_by_hand(F, expected):
    assert knee_point(np.array(F)) == expected


def test_a_set_of_one_goes_by_all_names():
    problem = GridPathProblem(OccupancyGrid(np.zeros((5, 5)), corner_cutting=True), (0, 0), (4, 4))
    trade_off = TradeOffSet.from_genes(problem, [[0, 1, 1, 1]])
    assert trade_off[0].names == NAMES
    assert trade_off[0].clearance == np.inf
