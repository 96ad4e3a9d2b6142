"""Lists of what is non-dominated against sets that are compared pair by pair."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pymoo_gridpath.exact.label_lists import BEGIN, N_ROWS, SIZE, covered, empty_lists, has_room, insert

N_LISTS = 3


def rows_of(lists, rows, number):
    begin, size = lists[number, BEGIN], lists[number, SIZE]
    return rows[begin : begin + size]


def run(entries):
    """Insert (list, second, third, steps) one by one, into lists and into sets, and compare these after each."""
    lists, rows, taken = empty_lists(N_LISTS)
    expected: list[set] = [set() for _ in range(N_LISTS)]
    for number, *entry in entries:
        entry, mine = tuple(entry), expected[number]
        is_covered = any(all(a <= b for a, b in zip(other, entry, strict=True)) for other in mine)
        assert covered(lists, rows, number, *entry) == is_covered
        insert(lists, rows, taken, number, *entry)
        if not is_covered:
            mine -= {other for other in mine if all(a <= b for a, b in zip(entry, other, strict=True))}
            mine.add(entry)
        for k in range(N_LISTS):
            found = rows_of(lists, rows, k)
            assert sorted(map(tuple, found.tolist())) == sorted(expected[k])
            assert (np.diff(found[:, 1]) >= 0).all()
    return lists, rows, taken


@given(st.lists(st.tuples(st.integers(0, N_LISTS - 1), st.integers(0, 6), st.integers(0, 6), st.integers(0, 6)), max_size=60))
def test_lists_of_two_costs_and_steps_hold_what_is_non_dominated(entries):
    run(entries)


@given(st.lists(st.tuples(st.integers(0, N_LISTS - 1), st.integers(0, 30), st.integers(0, 30), st.just(0)), max_size=60))
def test_lists_of_two_costs_hold_what_is_non_dominated(entries):
    run(entries)


@pytest.mark.parametrize("most_steps", [0, 5])
def test_lists_grow_apart_and_blocks_are_used_again(most_steps):
    random_state = np.random.default_rng(0)
    n = 240
    second = np.arange(n) + random_state.integers(0, 3, n)
    entries = np.column_stack(
        [random_state.integers(N_LISTS, size=n), second, n - second, random_state.integers(most_steps + 1, size=n)]
    )
    lists, rows, taken = run(random_state.permutation(entries).tolist())
    assert lists[:, SIZE].sum() > 100
    # Blocks are less than twice as long as what they hold, and those left behind were not all lost.
    assert taken[N_ROWS] <= 4 * lists[:, SIZE].sum()
    begin, end = lists[:, BEGIN], lists[:, BEGIN] + lists[:, SIZE]
    order = np.argsort(begin)
    assert (end[order][:-1] <= begin[order][1:]).all() and end.max() <= taken[N_ROWS]
    # Room for one more each.
    assert has_room(rows, taken, N_LISTS) and not has_room(rows[: taken[N_ROWS]], taken, 1)
