"""Sampling, crossover, mutation, repair and duplicates against what their distributions and rules promise."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymoo.core.algorithm import Algorithm
from pymoo.core.duplicate import DefaultDuplicateElimination
from pymoo.core.population import Population

from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.operators import (
    ArrayMating,
    BitwiseMutation,
    DiscretePolynomialMutation,
    DiscreteSBX,
    EdgeFixing,
    MixedCrossover,
    MixedMutation,
    PointCrossover,
    RandomSampling,
    RowDuplicates,
    SinglePointCrossover,
    SmoothnessTournament,
    TwoPointCrossover,
    duplicates,
    paper_operators,
)
from pymoo_gridpath.problems import GridPathProblem

seeds = st.integers(0, 2**32 - 1)


def problem(name="integer", size=8, **options):
    return GridPathProblem(OccupancyGrid(np.zeros((size, size))), (0, 0), (size - 1, size - 1), name, **options)


@pytest.mark.parametrize("name", ["integer", "binary", "mixed", "absolute"])
def test_sampling_is_uniform_over_the_bounds(name):
    p = problem(name)
    X = RandomSampling().do(p, 4000, random_state=np.random.default_rng(1)).get("X")
    assert X.dtype == np.dtype(p.vtype)
    for gene in range(p.n_var):
        values, counts = np.unique(X[:, gene].astype(int), return_counts=True)
        assert values.tolist() == list(range(int(p.xl[gene]), int(p.xu[gene]) + 1))
        assert counts.max() < 1.6 * counts.min() + 60


# -- discrete SBX -------------------------------------------------------------------------------------------------------


def sbx_children_density(low, high, xl, xu, eta, n=400_001):
    """Probability of each whole-number child by integrating the bounded SBX density over unit cells, numerically."""
    u = (np.arange(n) + 0.5) / n
    half, middle = (high - low) / 2, (high + low) / 2

    def spread(bound):
        alpha = 2 - bound ** -(eta + 1)
        return np.where(u <= 1 / alpha, (u * alpha) ** (1 / (eta + 1)), (1 / (2 - u * alpha)) ** (1 / (eta + 1)))

    first = middle - half * spread(1 + (low - xl) / half)
    second = middle + half * spread(1 + (xu - high) / half)
    cells = np.arange(xl, xu + 1)
    return [np.array([((c >= k - 0.5) & (c < k + 0.5)).mean() for k in cells]) for c in (first, second)]


@pytest.mark.parametrize(("a", "b", "eta"), [(-3, 4, 2.0), (2, 3, 2.0), (6, -7, 10.0), (7, -7, 2.0)])
def test_sbx_draws_the_discretised_distribution(a, b, eta):
    xl, xu, n = np.array([-7.0]), np.array([7.0]), 100_000
    X = np.array([np.full((n, 1), a), np.full((n, 1), b)])
    children = DiscreteSBX(eta, prob_var=1.0).cross(X, xl, xu, np.random.default_rng(0))
    first, second = sbx_children_density(min(a, b), max(a, b), -7, 7, eta)
    counts = [[np.mean(children[k] == v) for v in range(-7, 8)] for k in (0, 1)]
    # The two children change places with probability one half.
    for k in (0, 1):
        assert counts[k] == pytest.approx((first + second) / 2, abs=0.008)


@given(seeds)
def test_sbx_stays_within_bounds_and_leaves_equal_genes_alone(seed):
    rng = np.random.default_rng(seed)
    xl, xu = -rng.integers(0, 9, 6).astype(float), rng.integers(0, 9, 6).astype(float)
    X = rng.integers(xl, xu, size=(2, 30, 6), endpoint=True)
    X[1, :, 2] = X[0, :, 2]
    before = X.copy()
    children = DiscreteSBX(eta=2.0, prob_var=0.7).cross(X, xl, xu, rng)
    assert np.array_equal(X, before)
    assert children.dtype.kind == "i" and (children >= xl).all() and (children <= xu).all()
    assert np.array_equal(children[:, :, 2], X[:, :, 2])


def test_sbx_keeps_one_random_child_where_one_is_wanted():
    p = problem()
    X = np.array([np.zeros((500, 7), dtype=int), np.full((500, 7), 3)])
    one = DiscreteSBX(prob_var=0.0, n_offsprings=1)._do(p, X, random_state=np.random.default_rng(0))
    assert one.shape == (1, 500, 7)
    assert 0.4 < (one[0, :, 0] == 0).mean() < 0.6


# -- point crossover ----------------------------------------------------------------------------------------------------


@given(seeds, st.integers(1, 4), st.integers(1, 9))
def test_point_crossover_exchanges_alternate_stretches(seed, n_points, n_var):
    rng = np.random.default_rng(seed)
    X = np.array([np.zeros((40, n_var), dtype=int), np.ones((40, n_var), dtype=int)])
    children = PointCrossover(n_points).cross(X, rng)
    assert np.array_equal(children[0] + children[1], np.ones((40, n_var)))
    assert (children[0][:, 0] == 0).all(), "the first stretch stays"
    assert (np.abs(np.diff(children[0], axis=1)).sum(axis=1) == min(n_points, n_var - 1)).all()


@pytest.mark.parametrize(("operator", "n_points"), [(SinglePointCrossover(), 1), (TwoPointCrossover(), 2)])
def test_cuts_are_uniform(operator, n_points):
    X = np.array([np.zeros((30_000, 6), dtype=bool), np.ones((30_000, 6), dtype=bool)])
    children = operator.cross(X, np.random.default_rng(0))
    cuts = children[0][:, 1:] ^ children[0][:, :-1]
    assert cuts.mean(axis=0) == pytest.approx(n_points / 5, abs=0.02)


# -- polynomial mutation ------------------------------------------------------------------------------------------------


def step_distribution(value, xl, xu, eta):
    """Probability of each new value: the polynomial density over the unit cell around each step, by direction."""
    span = xu - xl + 0.5
    probability = np.zeros(xu - xl + 1)
    sides = [side for side in (-1, 1) if (xu - value if side > 0 else value - xl) > 0]
    for side in sides:
        room = xu - value if side > 0 else value - xl
        z = np.linspace(0.5, room + 0.5, 20_001)
        density = (1 - z / span).clip(0) ** eta
        cell = np.clip(np.rint((z[1:] + z[:-1]) / 2), 1, room).astype(int)
        mass = (density[1:] + density[:-1]) / 2
        for k in range(1, room + 1):
            probability[value + side * k - xl] = mass[cell == k].sum() / mass.sum() / len(sides)
    return probability


@pytest.mark.parametrize(("value", "eta"), [(0, 20.0), (-7, 20.0), (7, 2.0), (5, 5.0)])
def test_mutation_draws_the_discretised_polynomial_and_never_stands_still(value, eta):
    n = 100_000
    X = np.full((n, 1), value)
    mutated = DiscretePolynomialMutation(eta).mutate(X, np.array([-7.0]), np.array([7.0]), 1.0, np.random.default_rng(0))
    assert (mutated != value).all()
    counts = [np.mean(mutated == v) for v in range(-7, 8)]
    assert counts == pytest.approx(step_distribution(value, -7, 7, eta), abs=0.008)


def test_mutation_rate_is_one_over_the_number_of_genes_by_default():
    p = problem(size=11)
    rng = np.random.default_rng(0)
    X = rng.integers(p.xl, p.xu, size=(20_000, p.n_var), endpoint=True)
    changed = DiscretePolynomialMutation()._do(p, X, random_state=rng) != X
    assert changed.mean() == pytest.approx(1 / p.n_var, rel=0.05)


@given(seeds)
def test_mutation_keeps_bounds_and_fixed_genes(seed):
    rng = np.random.default_rng(seed)
    xl, xu = -rng.integers(0, 5, 6).astype(float), rng.integers(0, 5, 6).astype(float)
    X = rng.integers(xl, xu, size=(30, 6), endpoint=True)
    before = X.copy()
    mutated = DiscretePolynomialMutation(eta=3.0).mutate(X, xl, xu, 0.8, rng)
    assert np.array_equal(X, before)
    assert (mutated >= xl).all() and (mutated <= xu).all() and mutated.dtype.kind == "i"


# -- bitwise and mixed --------------------------------------------------------------------------------------------------


class Run(Algorithm):
    """As much of an algorithm as a rate schedule sees."""

    def __init__(self, perc):
        super().__init__()
        self.termination = type("Termination", (), {"perc": perc})()


@pytest.mark.parametrize(("perc", "share"), [(0.0, 1.0), (0.5, 0.6), (1.0, 0.2)])
def test_bitwise_rate_falls_linearly_to_a_fifth(perc, share):
    p = problem("binary")
    X = np.zeros((20_000, p.n_var), dtype=bool)
    flipped = BitwiseMutation(prob_var=0.2)._do(p, X, random_state=np.random.default_rng(0), algorithm=Run(perc))
    assert flipped.dtype == bool
    assert flipped.mean() == pytest.approx(0.2 * share, rel=0.03)


def test_bitwise_rate_falls_over_a_real_run():
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.optimize import minimize

    rates = []

    class Spy(BitwiseMutation):
        def flip(self, X, rate, random_state):
            rates.append(rate)
            return super().flip(X, rate, random_state)

    p = problem("binary")
    operators = paper_operators(p) | {"mutation": Spy(prob_var=0.1), "eliminate_duplicates": False}
    minimize(p, NSGA2(pop_size=10, **operators), ("n_gen", 11), seed=1)
    assert rates == pytest.approx([0.1 * (1 - 0.8 * k / 11) for k in range(1, 11)])


def test_mixed_operators_treat_bits_and_integers_apart():
    p = problem("mixed", size=9)
    n = p.representation.n_bits
    rng = np.random.default_rng(0)
    X = RandomSampling().do(p, 2000, random_state=rng).get("X")
    mutated = MixedMutation(prob_var=0.3)._do(p, X, random_state=rng)
    assert set(np.unique(mutated[:, :n])) == {0, 1}
    assert (mutated[:, n:] >= p.xl[n:]).all() and (mutated[:, n:] <= p.xu[n:]).all()
    assert (mutated != X)[:, :n].mean() == pytest.approx(0.3, abs=0.02)
    assert (mutated != X)[:, n:].mean() == pytest.approx(0.3, abs=0.02)
    children = MixedCrossover()._do(p, X.reshape(2, 1000, -1), random_state=rng)
    assert children.shape == (2, 1000, p.n_var) and set(np.unique(children[:, :, :n])) == {0, 1}
    with pytest.raises(GridPathError, match="mixed representation"):
        MixedMutation()._do(problem(), X, random_state=rng)


# -- repair and duplicates ----------------------------------------------------------------------------------------------


def test_edge_fixing_rounds_real_genes():
    p = problem()
    pop = Population.new("X", np.array([[0.4, 1.2, -0.6, 0, 0, 0, 0], [9.7, -3.0, 0, 0, 0, 0, 0]]))
    X = EdgeFixing().do(p, pop, random_state=np.random.default_rng(0)).get("X")
    assert X.dtype.kind == "i"
    assert X[0].tolist() == [0, 1, -1, 0, 0, 0, 0]
    assert X[1, 0] == 7 and (p.xl <= X).all() and (p.xu >= X).all()


@given(seeds, st.sampled_from([3, 2100]), st.sampled_from([int, float]))
def test_row_duplicates_keeps_what_the_default_elimination_keeps(seed, n_var, kind):
    rng = np.random.default_rng(seed)
    few = np.repeat(rng.integers(0, 2, size=(30, 3)), n_var // 3, axis=1).astype(kind)
    a, b, c = (Population.new("X", rows) for rows in np.split(few, (20, 25)))
    for others in ((), (b,), (b, c)):
        ours, theirs = RowDuplicates().do(a, *others), DefaultDuplicateElimination().do(a, *others)
        assert sorted(map(tuple, ours.get("X"))) == sorted(map(tuple, theirs.get("X"))) if len(theirs) else len(ours) == 0


def test_long_rows_of_equal_sums_are_told_apart(monkeypatch):
    monkeypatch.setattr(duplicates, "_factors", lambda n: np.ones(n, dtype=np.uint64))
    X = np.zeros((6, 2100), dtype=int)
    X[np.arange(6), [0, 1, 0, 5, 1, 7]] = 1
    kept = RowDuplicates().do(Population.new("X", X)).get("X")
    assert np.argmax(kept, axis=1).tolist() == [0, 1, 5, 7]


def test_array_mating_returns_new_unique_children_and_changes_nothing():
    p = problem()
    operators = paper_operators(p)
    rng = np.random.default_rng(3)
    pop = operators["repair"].do(p, operators["sampling"].do(p, 40, random_state=rng), random_state=rng)
    pop.set("F", np.ones((40, 2)), "G", np.zeros((40, 0)), "H", np.zeros((40, 0)))
    pop.set("turn", np.arange(40), "rank", np.zeros(40, dtype=int), "crowding", np.ones(40))
    before = pop.get("X").copy()
    mating = ArrayMating(SmoothnessTournament(), operators["crossover"], operators["mutation"], operators["repair"])
    children = mating.do(p, pop, 101, random_state=rng).get("X")
    assert np.array_equal(pop.get("X"), before)
    assert len(children) == 101
    rows = set(map(tuple, children))
    assert len(rows) == 101 and rows.isdisjoint(map(tuple, before))
    same = ArrayMating(SmoothnessTournament(), operators["crossover"], operators["mutation"], operators["repair"])
    a, b = (same.do(p, pop, 30, random_state=np.random.default_rng(8)).get("X") for _ in range(2))
    assert np.array_equal(a, b)


def test_array_mating_gives_up_where_nothing_new_can_be_made():
    grid = OccupancyGrid(np.zeros((1, 4)))  # a single row: every gene is 0
    p = GridPathProblem(grid, (0, 0), (3, 0), "integer")
    pop = Population.new("X", np.zeros((4, 3), dtype=int))
    pop.set(
        "F",
        np.ones((4, 2)),
        "G",
        np.zeros((4, 0)),
        "H",
        np.zeros((4, 0)),
        "turn",
        np.zeros(4),
        "rank",
        np.zeros(4),
        "crowding",
        np.ones(4),
    )
    o = paper_operators(p)
    mating = ArrayMating(SmoothnessTournament(), o["crossover"], o["mutation"], o["repair"], n_max_iterations=5)
    assert len(mating.do(p, pop, 4, random_state=np.random.default_rng(0))) == 0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: DiscreteSBX(eta=-2), "eta is -2"),
        (lambda: DiscreteSBX(prob_var=2), "prob_var is 2"),
        (lambda: DiscreteSBX(n_offsprings=3), "n_offsprings is 3, expected 1 or 2"),
        (lambda: TwoPointCrossover(prob=-1), "prob is -1"),
        (lambda: PointCrossover(0), "n_points is 0"),
        (lambda: DiscretePolynomialMutation(eta=1e5), "eta is 100000"),
        (lambda: BitwiseMutation(prob_var=2), "prob_var is 2"),
        (lambda: MixedMutation(final=-1), "final is -1"),
    ],
)
def test_parameters_out_of_range_are_refused(make, message):
    with pytest.raises(GridPathError, match=message):
        make()
