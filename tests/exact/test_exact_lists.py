"""Lists of what is non-dominated against sets that are compared pair by pair."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pymoo_gridpath.exact.label_lists import BEGIN, N_ROWS, SECOND, SIZE, THIRD, covered, empty_lists, has_room, insert

N_LISTS = 3


def rows_of(lists, rows, number):
    begin, size = lists[number, BEGIN], lists[number, SIZE]
    return rows[begin : begin + size]


def dominates(one, other):
    return all(a <= b for a, b in zip(one, other, strict=True))


def run(entries, n_headings):
    """Insert (list, second, steps, third costs) one by one, into lists and into sets, and compare these after each."""
    lists, rows, taken = empty_lists(N_LISTS, n_headings)
    expected: list[list[set]] = [[set() for _ in range(n_headings)] for _ in range(N_LISTS)]
    for number, second, steps, *third in entries:
        is_new = []
        for h, mine in enumerate(expected[number]):
            entry = second, third[h], steps
            is_new.append(not any(dominates(other, entry) for other in mine))
            assert covered(lists, rows, number, h, *entry) == (not is_new[-1])
            if is_new[-1]:
                mine -= {other for other in mine if dominates(entry, other)}
                mine.add(entry)
        before = rows_of(lists, rows, number).copy()
        insert(lists, rows, taken, number, second, np.array(third), steps)
        if not any(is_new) and n_headings == 1:
            assert np.array_equal(before, rows_of(lists, rows, number))
        for k in range(N_LISTS):
            found = rows_of(lists, rows, k)
            assert (np.diff(found[:, SECOND]) <= 0).all()
            for h in range(n_headings):
                held = {(int(row[SECOND]), int(row[THIRD + h]), int(row[1])) for row in found}
                assert {one for one in held if not any(dominates(two, one) for two in held - {one})} == expected[k][h]
            if n_headings == 1:
                # No row says what another one does.
                rest = [tuple(row) for row in found.tolist()]
                assert not any(dominates(a, b) for i, a in enumerate(rest) for j, b in enumerate(rest) if i != j)
    return lists, rows, taken


def entries(most_second, most_third, n_headings, steps):
    third = [st.integers(0, most_third)] * n_headings
    return st.lists(st.tuples(st.integers(0, N_LISTS - 1), st.integers(0, most_second), steps, *third), max_size=60)


@given(entries(6, 6, 1, st.integers(0, 6)))
def test_lists_of_two_costs_and_steps_hold_what_is_non_dominated(drawn):
    run(drawn, 1)


@given(entries(30, 30, 1, st.just(0)))
def test_lists_of_two_costs_hold_what_is_non_dominated(drawn):
    run(drawn, 1)


@given(entries(12, 6, 3, st.just(0)))
def test_lists_hold_it_for_each_heading(drawn):
    run(drawn, 3)


@given(entries(6, 4, 2, st.integers(0, 3)))
def test_lists_hold_it_for_each_heading_and_number_of_steps(drawn):
    run(drawn, 2)


@pytest.mark.parametrize("most_steps", [0, 5])
def test_lists_grow_apart_and_blocks_are_used_again(most_steps):
    random_state = np.random.default_rng(0)
    n = 240
    second = np.arange(n) + random_state.integers(0, 3, n)
    drawn = np.column_stack(
        [random_state.integers(N_LISTS, size=n), second, random_state.integers(most_steps + 1, size=n), n - second]
    )
    lists, rows, taken = run(random_state.permutation(drawn).tolist(), 1)
    assert lists[:, SIZE].sum() > 100
    # Blocks are less than twice as long as what they hold, and those left behind were not all lost.
    assert taken[N_ROWS] <= 4 * lists[:, SIZE].sum()
    begin, end = lists[:, BEGIN], lists[:, BEGIN] + lists[:, SIZE]
    order = np.argsort(begin)
    assert (end[order][:-1] <= begin[order][1:]).all() and end.max() <= taken[N_ROWS]
    # Room for one more each.
    enough = np.empty((taken[N_ROWS] + 4096, 3), dtype=np.int64)
    assert has_room(enough, taken, N_LISTS) and not has_room(rows[: taken[N_ROWS]], taken, 1)
