"""Measures of fronts against their definitions, written out."""

import itertools
import math

import moocore
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.quality import (
    ReferenceFront,
    hypervolume_ratio,
    igd_plus,
    mean_hypervolume_ratio,
    mean_igd_plus,
    merge_fronts,
    share_found,
)

FRONT = np.array([[10.0, 5.0], [11.0, 3.0], [14.0, 1.0]])


def volume(points, corner):
    """Return the hypervolume by cutting space along all coordinates into boxes."""
    points = np.asarray(points, dtype=float)
    edges = [np.unique(np.append(points[:, k][points[:, k] < corner[k]], corner[k])) for k in range(len(corner))]
    total = 0.0
    for box in itertools.product(*(range(len(edge) - 1) for edge in edges)):
        low = np.array([edge[i] for edge, i in zip(edges, box, strict=True)])
        high = np.array([edge[i + 1] for edge, i in zip(edges, box, strict=True)])
        if (points <= low).all(axis=1).any():
            total += np.prod(high - low)
    return total


def defined_ratio(F, front):
    """Return the hypervolume ratio as the definition has it, in the objectives' own units."""
    low, high = front.min(axis=0), front.max(axis=0)
    corner = high + 0.1 * (high - low)
    return volume(F, corner) / volume(front, corner)


def random_front(rng, n_points, n_obj):
    points = rng.random((n_points, n_obj)).round(2)
    ends = 1.5 * np.eye(n_obj) - 0.4
    return np.unique(np.concatenate([points, ends])[moocore.is_nondominated(np.concatenate([points, ends]))], axis=0)


@pytest.mark.parametrize("n_obj", [2, 3])
@pytest.mark.parametrize("seed", range(4))
def test_ratio_is_that_of_boxes(n_obj, seed):
    rng = np.random.default_rng([seed, n_obj])
    front = random_front(rng, 8, n_obj) * [30.0, 2.0, 400.0][:n_obj]
    F = front + rng.random(front.shape) * np.ptp(front, axis=0) * 0.3
    assert ReferenceFront(front, exact=True).hypervolume_ratio(F) == pytest.approx(defined_ratio(F, front), abs=1e-9)


def test_ratio_of_the_front_itself_is_one_and_of_nothing_zero():
    reference = ReferenceFront(FRONT, exact=True)
    assert reference.hypervolume_ratio(FRONT[::-1]) == 1.0
    assert reference.hypervolume_ratio(np.empty((0, 2))) == 0.0
    assert reference.hypervolume_ratio(np.array([[99.0, 99.0]])) == 0.0
    # (14 - 10) and (5 - 1), plus a tenth: a corner at (14.4, 5.4).
    assert reference.hypervolume_ratio(FRONT[1:2]) == pytest.approx(3.4 * 2.4 / (4.4 * 0.4 + 3.4 * 2 + 0.4 * 2))


def test_a_single_point_is_reached_or_not():
    reference = ReferenceFront(np.array([[10.0, 5.0]]), exact=True)
    assert reference.hypervolume_ratio(np.array([[10.0 + 1e-12, 5.0], [9.0, 7.0]])) == 1.0
    assert reference.hypervolume_ratio(np.array([[10.01, 5.0]])) == 0.0
    spans = np.array([1]), np.array([2])
    assert reference.hypervolume_ratios(np.array([[10.0, 5.0]]), *spans, 4).tolist() == [0.0, 1.0, 1.0, 0.0]
    one = ReferenceFront(np.array([[3.0]]), exact=True)
    assert [one.hypervolume_ratio(np.array([[value]])) for value in (3.0, 3.5)] == [1.0, 0.0]


def test_an_objective_without_range_counts_in_its_own_unit():
    front = np.column_stack([FRONT, np.full(3, 90.0)])
    reference = ReferenceFront(front, exact=True)
    assert reference.hypervolume_ratio(front) == 1.0
    # Half a unit of the 1.1 up to the corner.
    assert reference.hypervolume_ratio(front + np.array([0.0, 0.0, 0.5])) == pytest.approx(0.6 / 1.1)


def test_without_a_front_nothing_is_reached():
    reference = ReferenceFront(np.empty((0, 2)), exact=False)
    assert len(reference) == 0
    assert reference.hypervolume_ratio(FRONT) == 0.0
    assert reference.igd_plus(FRONT) == math.inf
    assert reference.share_found(FRONT) == 0.0
    assert not reference.exceeded_by(FRONT)


@settings(max_examples=40)
@given(st.integers(0, 10_000), st.sampled_from([2, 3]), st.integers(1, 8))
def test_ratios_of_a_history_are_those_of_its_records(seed, n_obj, n_records):
    rng = np.random.default_rng(seed)
    reference = ReferenceFront(random_front(rng, 12, n_obj), exact=True)
    fronts, points, first, last = [], [], [], []
    for k in range(n_records):
        kept = rng.random() < 0.4 and fronts
        front = fronts[-1] if kept else random_front(rng, rng.integers(1, 9), n_obj) * 0.9 + 0.1
        front = front[:0] if rng.random() < 0.2 else front
        fronts.append(front)
        points.append(front)
        first += [k] * len(front)
        last += [k] * len(front)
    spans = np.array(first, dtype=np.int32), np.array(last, dtype=np.int32)
    ratios = reference.hypervolume_ratios(np.concatenate(points), *spans, n_records)
    assert ratios == pytest.approx([reference.hypervolume_ratio(front) for front in fronts], abs=1e-9)


def test_points_that_stay_count_in_all_their_records():
    reference = ReferenceFront(FRONT, exact=True)
    spans = np.array([0, 1, 1]), np.array([3, 1, 3])
    ratios = reference.hypervolume_ratios(FRONT, *spans, 5)
    records = [FRONT[:1], FRONT, FRONT[[0, 2]], FRONT[[0, 2]], FRONT[:0]]
    assert ratios == pytest.approx([reference.hypervolume_ratio(front) for front in records])


@pytest.mark.parametrize("n_obj", [2, 3])
def test_igd_plus_is_the_mean_of_what_points_are_missed_by(n_obj):
    rng = np.random.default_rng(n_obj)
    front, F = random_front(rng, 12, n_obj), rng.random((5, n_obj)) + 0.1
    span = np.ptp(front, axis=0)
    missed = [min(np.linalg.norm(np.maximum(f - z, 0.0) / span) for f in F) for z in front]
    reference = ReferenceFront(front, exact=True)
    assert reference.igd_plus(F) == pytest.approx(np.mean(missed))
    assert reference.igd_plus(front) == 0.0
    assert reference.igd_plus(F[:0]) == math.inf


def test_share_found_allows_for_rounding_only():
    reference = ReferenceFront(FRONT, exact=True)
    near, far = FRONT[:2] * (1 + 1e-11), FRONT[2:] * (1 + 1e-7)
    assert reference.share_found(np.concatenate([near, near, far])) == pytest.approx(2 / 3)
    assert reference.share_found(FRONT[:0]) == 0.0


def test_points_beyond_the_front_are_noticed():
    reference = ReferenceFront(FRONT, exact=True)
    assert not reference.exceeded_by(FRONT * (1 - 1e-12))
    assert not reference.exceeded_by(FRONT + 0.5)
    assert reference.exceeded_by(np.array([[12.0, 2.0]]))
    assert reference.exceeded_by(np.array([[9.0, 9.0]]))


def test_merged_fronts_hold_each_point_once_whatever_the_rounding():
    noisy = FRONT + np.array([[0.0, 1e-13], [1e-13, 0.0], [-1e-13, 1e-13]])
    merged = merge_fronts([FRONT, noisy, np.array([[12.0, 3.0], [20.0, 0.5]]), np.empty((0, 2))])
    assert merged == pytest.approx(np.array([[10, 5], [11, 3], [14, 1], [20, 0.5]]))
    assert merge_fronts([np.empty((0, 2))]).shape == (0, 2)


def test_an_objective_that_is_zero_throughout_does_not_overflow():
    reference = ReferenceFront(np.array([[5.0, 0.0], [6.0, 0.0]]))
    assert reference.share_found(np.array([[5.0, 0.0], [7.0, 900.0]])) == 1.0
    assert not reference.exceeded_by(np.array([[7.0, 900.0]]))


@pytest.mark.parametrize("n_obj", [2, 3])
def test_the_functions_are_the_definitions(n_obj):
    rng = np.random.default_rng(n_obj)
    front = random_front(rng, 9, n_obj)
    F = np.concatenate([front[::2], front[1:2] + 0.1])
    span = np.ptp(front, axis=0)
    missed = [min(np.linalg.norm(np.maximum(f - z, 0.0) / span) for f in F) for z in front]
    assert hypervolume_ratio(F.tolist(), front) == pytest.approx(defined_ratio(F, front), abs=1e-9)
    assert igd_plus(F, front) == pytest.approx(np.mean(missed))
    assert share_found(F, front) == pytest.approx(sum((f == z).all() for z in front for f in F) / len(front))


def test_the_functions_take_what_pymoo_returns_and_refuse_what_is_no_front():
    assert (hypervolume_ratio(None, FRONT), igd_plus(None, FRONT), share_found([], FRONT)) == (0.0, math.inf, 0.0)
    assert share_found(FRONT[0], FRONT) == pytest.approx(1 / 3)
    for measure in (hypervolume_ratio, igd_plus, share_found):
        for F, front, message in (
            (FRONT, [], "front"),
            (FRONT, None, "front"),
            (FRONT, FRONT[0], "front"),
            (FRONT[:, :1], FRONT, "F has shape"),
            ([[math.nan, 1.0]], FRONT, "F "),
            ("x", FRONT, "F is 'x'"),
        ):
            with pytest.raises(GridPathError, match=message):
                measure(F, front)


def test_means_over_epochs_are_each_against_its_own_front():
    rng = np.random.default_rng(1)
    fronts = [random_front(rng, n, 2) for n in (5, 7, 3)]
    found = [fronts[0], fronts[1] + 0.1, None]
    span = np.ptp(fronts[1], axis=0)
    missed = np.mean([min(np.linalg.norm(np.maximum(f - z, 0.0) / span) for f in found[1]) for z in fronts[1]])
    assert mean_hypervolume_ratio(found, fronts) == pytest.approx((1 + defined_ratio(found[1], fronts[1])) / 3)
    assert mean_igd_plus(found[:2], fronts[:2]) == pytest.approx(missed / 2)
    assert mean_igd_plus(found, fronts) == math.inf
    for measure in (mean_hypervolume_ratio, mean_igd_plus):
        for F, references, message in (
            (found, fronts[:2], "F is of 3 epochs and fronts of 2"),
            ([], [], "at least one"),
            (3, fronts, "F is 3"),
            (found, [FRONT, FRONT, FRONT[0]], "front "),
        ):
            with pytest.raises(GridPathError, match=message):
                measure(F, references)
