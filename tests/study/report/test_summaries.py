"""Quartiles, and the first record that reaches a target."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pymoo_gridpath.study.report.statistics.summaries import first_reaching, quartiles


@given(st.lists(st.floats(-1e6, 1e6), min_size=1, max_size=12))
def test_quartiles_are_those_of_numpy(values):
    expected = np.quantile(values, [0.25, 0.5, 0.75])
    assert quartiles(np.array(values)) == pytest.approx(expected, rel=1e-9, abs=1e-6)


def test_quartiles_of_infinite_values_are_no_nan():
    inf = math.inf
    assert quartiles(np.array([1.0, inf, 2.0, 3.0, inf])).tolist() == [2.0, 3.0, inf]
    assert quartiles(np.array([1.0, inf])).tolist() == [inf, inf, inf]
    assert quartiles(np.array([1.0, 1.0, 1.0, inf])).tolist()[:2] == [1.0, 1.0]
    assert quartiles(np.full(4, inf)).tolist() == [inf] * 3
    assert np.isnan(quartiles(np.empty(0))).all()
    table = quartiles(np.array([[1.0, inf], [3.0, inf]]))
    assert table[1].tolist() == [2.0, inf]


def test_the_first_record_that_reaches_the_target_counts():
    assert first_reaching(np.array([0.1, 0.6, 0.4, 0.9]), 0.5) == 1
    assert first_reaching(np.array([0.1, 0.5]), 0.5) == 1
    assert first_reaching(np.array([0.1]), 0.5) is None
