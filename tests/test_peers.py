"""What `benchmarks/peers.py` measures with: corner rules, our optimum, tables; libraries that are absent are skipped."""

import logging
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.algorithms import ahmed_deb_2013
from pymoo_gridpath.problems import random_dense_grid
from pymoo_gridpath.search.moves import Moves

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "benchmarks"))

from peer_libraries.agreement import counts, judge, measured_rule, optimum
from peer_libraries.base import Peer, markdown
from peer_libraries.measure import cases_of, dense_case, measure_paths, measure_searches, split
from peer_libraries.paths import OurAStar, Scipy, edges, path_peers
from peer_libraries.searches import search_peers
from peer_libraries.tables import agreement_table, library_table, path_times, search_table

RULES = (False, "one side", True)


def a_grid(rule, seed=3):
    occupied = np.random.default_rng(seed).random((14, 17)) < 0.3
    occupied[0, 0] = occupied[-1, -1] = False
    return OccupancyGrid(occupied, corner_cutting=rule)


def joined(grid):
    """Return cells that a path joins with a first one, the farthest first, with the lengths of the shortest paths."""
    lengths = grid.shortest_lengths((0, 0))
    found = np.argwhere(np.isfinite(lengths))
    order = np.argsort(-lengths[tuple(found.T)], kind="stable")
    return [((0, 0), (int(x), int(y)), float(lengths[y, x])) for y, x in found[order]]


def there(peer):
    if peer.missing():
        pytest.skip(peer.missing())
    return peer


class Absent(OurAStar):
    package, module, label = "surely-not-there", "surely_not_there", "absent"


class Wrong(OurAStar):
    label = "wrong"

    def query(self, start, goal):
        raise RuntimeError("not today")


@pytest.mark.parametrize("rule", RULES)
def test_the_steps_of_a_graph_are_those_of_a_grid(rule):
    grid = a_grid(rule)
    tails, heads, lengths = edges(grid)
    size = grid.occupied.size
    both = csr_array((np.tile(lengths, 2), (np.r_[tails, heads], np.r_[heads, tails])), shape=(size, size))
    assert len(lengths) > 100
    np.testing.assert_array_equal(both.toarray(), grid.move_graph().toarray())


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("diagonal", [1.0, 1.41, 2**0.5, 1.5])
def test_our_optimum_is_that_of_scipy_at_any_cost_of_a_diagonal(rule, diagonal):
    grid = a_grid(rule)
    tails, heads, lengths = edges(grid)
    costs = np.where(lengths > 1, diagonal, 1.0)
    # Undirected searches of older versions take no other indices.
    ends = tails.astype(np.int32), heads.astype(np.int32)
    graph = csr_array((costs, ends), shape=(grid.occupied.size,) * 2)
    expected = dijkstra(graph, directed=False, indices=0).reshape(grid.shape)
    ours = [optimum(Moves(grid), (0, 0), (x, y), diagonal) for y, x in np.argwhere(~grid.occupied)]
    np.testing.assert_allclose(ours, expected[~grid.occupied], rtol=1e-9)


@pytest.mark.parametrize("peer", list(path_peers()), ids=lambda peer: f"{type(peer).__name__}-{peer.rule}")
def test_a_library_follows_its_rule_and_is_cheapest_at_its_costs(peer):
    assert measured_rule(there(peer)) == peer.rule
    grid = a_grid(peer.rule)
    peer.set_up(grid)
    queries = joined(grid)[:-1:20]
    assert len(queries) >= 5
    for start, goal, length in queries:
        found = judge(peer, Moves(grid), peer.query(start, goal), start, goal, length)
        assert found.legal and (found.optimal or not peer.exact)


def test_no_path_is_an_empty_one():
    grid = OccupancyGrid([[0, 1, 0]])
    for peer in path_peers():
        if peer.missing() is None:
            peer.set_up(grid.replace(corner_cutting=peer.rule))
            assert len(peer.query((0, 0), (2, 0))) == 0, peer.label


def test_a_path_is_held_against_the_rule_and_the_optimum():
    grid = OccupancyGrid([[0, 0, 0], [0, 1, 0], [0, 0, 0]])
    cut, round_it = np.array([(1, 0), (2, 1)]), np.array([(1, 0), (2, 0), (2, 1)])
    moves, freely = Moves(grid), Moves(grid.replace(corner_cutting=True))
    assert not counts(moves, cut, (1, 0), (2, 1)).legal and counts(freely, cut, (1, 0), (2, 1)).legal
    assert not counts(freely, cut, (1, 0), (2, 2)).legal and not counts(freely, cut[:0], (1, 0), (2, 1)).legal
    assert not counts(freely, round_it[::2], (1, 0), (2, 2)).legal
    found = judge(OurAStar(False), moves, round_it, (1, 0), (2, 1), 2.0)
    assert found.legal and found.optimal and found.shortest and found.over_published == 0.0
    found = judge(OurAStar(True), freely, round_it, (1, 0), (2, 1), 2.0)
    assert found.legal and not found.optimal and not found.shortest
    assert found.excess == pytest.approx(100 * (2**0.5 - 1))
    assert judge(OurAStar(True), freely, cut, (1, 0), (2, 1), 2.0).over_published == pytest.approx(-100 * (1 - 2**-0.5))


def test_tables_say_what_was_measured(tmp_path):
    name = "small"
    (tmp_path / f"{name}.map").write_text("type octile\nheight 2\nwidth 3\nmap\n...\n.@.\n")
    entries = [f"0\t{name}.map\t3\t2\t{x}\t1\t2\t1\t{length}" for x, length in ((2, 0), (0, 4))]
    (tmp_path / f"{name}.map.scen").write_text("\n".join(["version 1", *entries]))
    cases = cases_of(tmp_path, [name], 1)
    assert [case.queries for case in cases] == [[((0, 0), (2, 0), 4.0)]]
    cases.append(dense_case(3))
    present, missing = split([OurAStar(False), OurAStar(True), Scipy(False), Absent()])
    assert missing == {"surely-not-there": "surely-not-there is not installed"}
    rows, failed = measure_paths([*present, Wrong()], cases, 1)
    assert failed == {"wrong": "RuntimeError: not today"}
    kept, cut, scipy = agreement_table(rows).splitlines()[2:]
    assert "| never cut | √2 | 4 of 4 | 4 of 4 | 4 of 4 | 0.00 | 1 of 1 | 0.00 to 0.00 |" in kept
    assert "| cut | √2 | 4 of 4 | 4 of 4 | 4 of 4 | 0.00 | 0 of 1 | -29.29 to -29.29 |" in cut
    assert "| never cut, as built |" in scipy
    assert path_times(rows, cases).count("\n") == 2 + len(rows)
    table = library_table([*present, Absent()], missing)
    assert "| surely-not-there | - | Apache-2.0 | surely-not-there is not installed |" in table
    assert "| scipy |" in table and "| yes |" in table


def test_a_table_has_as_many_cells_in_each_row():
    assert markdown(("a", "b"), [("x|y", 1)]) == "| a | b |\n| --- | ---: |\n| x\\|y | 1 |\n"
    with pytest.raises(ValueError, match="expected 2 each"):
        markdown(("a", "b"), [("x",)])


@pytest.fixture
def problem():
    return ahmed_deb_2013(random_dense_grid(8, 0.1, 1), (0, 0), (7, 7)).problem


@pytest.mark.filterwarnings("ignore::pymoo_gridpath.errors.GridPathWarning")
@pytest.mark.parametrize("peer", search_peers(), ids=lambda peer: type(peer).__name__)
def test_a_search_evaluates_whole_numbers_within_bounds(peer, problem, monkeypatch):
    there(peer)
    monkeypatch.setattr(logging.root.manager, "disable", logging.INFO)
    evaluated = []

    def counting(X, *args, inner=problem.evaluate, **kwargs):
        evaluated.append(np.array(X))
        return inner(X, *args, **kwargs)

    monkeypatch.setattr(problem, "evaluate", counting)
    X = peer.run(problem, 20, 10, 1)
    assert X.shape == (20, 7) and len(evaluated) <= 11
    rows = np.concatenate(evaluated)
    # One of them counts a child that is a copy of its parent without evaluating it.
    assert (
        120 < len(rows) <= 200 and (rows == np.rint(rows)).all() and (rows >= problem.xl).all() and (rows <= problem.xu).all()
    )


@pytest.mark.filterwarnings("ignore::pymoo_gridpath.errors.GridPathWarning")
def test_searches_are_measured_until_patience_ends(problem):
    ours, stock = search_peers()[:2]
    assert issubclass(type(ours), Peer)
    rows = measure_searches([ours, stock], problem, 20, 20, 2, np.inf)
    assert [len(row.runs) for row in rows] == [2, 2]
    assert all(seconds > 0 and 0 <= ratio <= 1 and 0 <= legal <= 1 for row in rows for seconds, ratio, legal in row.runs)
    assert rows[0].runs[0][1] > 0.5
    assert [len(row.runs) for row in measure_searches([ours, stock], problem, 20, 2, 2, 0.0)] == [1, 1]
    assert search_table(rows).splitlines()[2].split(" | ")[3:6:2] == ["2", "1.0"]
