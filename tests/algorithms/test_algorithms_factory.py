"""Names, arguments and refusals of make_algorithm."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pymoo.algorithms.moo.moead import ParallelMOEAD
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.mating import Mating
from pymoo.operators.crossover import pntx
from pymoo.operators.crossover.sbx import SBX
from pymoo.operators.mutation.nom import NoMutation
from pymoo.operators.mutation.pm import PM
from pymoo.operators.repair.rounding import RoundingRepair
from pymoo.operators.sampling.rnd import IntegerRandomSampling
from pymoo.operators.survival.rank_and_crowding import RankAndCrowding
from pymoo.optimize import minimize

from pymoo_gridpath.algorithms import CAPABILITIES, StrengthAndSmoothness, make_algorithm, reference_directions
from pymoo_gridpath.algorithms.arguments import parameters
from pymoo_gridpath.algorithms.known import class_of
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.operators import (
    ArrayMating,
    DiscreteSBX,
    RankAndSmoothness,
    RowDuplicates,
    SmoothnessTournament,
    TwoPointCrossover,
)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("NSGA-II", "NSGA2"),
        ("nsga2", "NSGA2"),
        ("NSGA-III", "NSGA3"),
        ("U-NSGA-III", "UNSGA3"),
        ("R-NSGA-II", "RNSGA2"),
        ("MOEA/D", "SmoothMOEAD"),
        ("moead", "SmoothMOEAD"),
        ("SMS-EMOA", "SMSEMOA"),
        ("C-TAEA", "CTAEA"),
        ("Omni-Optimizer", "OmniOptimizer"),
        ("gde3_mnn", "GDE3MNN"),
        ("NSDE-R", "NSDER"),
    ],
)
def test_names(name, expected, make_problem):
    kwargs = {"ref_points": [[10.0, 1.0]]} if name.startswith("R-") else {}
    assert type(make_algorithm(name, make_problem(), **kwargs)).__name__ == expected


@pytest.mark.parametrize(("name", "near"), [("NSGA-4", "NSGA"), ("SPEA", "SPEA2"), ("moeadd", "MOEAD")])
def test_unknown_name(name, near, make_problem):
    with pytest.raises(CapabilityError, match=f"no algorithm '{name}'; did you mean '{near}"):
        make_algorithm(name, make_problem())


@pytest.mark.parametrize(
    ("name", "kwargs", "message"),
    [
        ("NSGA2", {"n_offspring": 5}, "NSGA2 takes no argument 'n_offspring'; did you mean 'n_offsprings'"),
        ("NSGA2", {"ref_dirs": None}, "NSGA2 takes no argument 'ref_dirs'"),
        ("MOEAD", {"survival": RankAndCrowding()}, "MOEAD takes no argument 'survival'"),
        ("RNSGA2", {"survival": RankAndCrowding(), "ref_points": [[1, 1]]}, "RNSGA2 takes no argument 'survival'"),
        ("NSDE", {"mutation": None}, "NSDE takes no argument 'mutation'"),
        ("MOEAD", {"n_neighbours": 5}, "did you mean 'n_neighbors'"),
        ("NSGA2", {"progress_bar": True}, "NSGA2 takes no argument 'progress_bar'"),
        ("NSGA2", {"operators": {"cross": None}}, "operators takes no argument 'cross'; did you mean 'crossover'"),
        ("NSGA2", {"pop_size": 0}, "pop_size is 0"),
        ("NSGA2", {"pop_size": 2.5}, "pop_size is 2.5, expected a whole number of at least 1 and at most 100,000 for NSGA2"),
        ("SPEA2", {"pop_size": "20"}, "pop_size is '20', expected a whole number"),
        ("NSGA2", {"n_offsprings": 0}, "n_offsprings is 0, expected a whole number of at least 1"),
        ("MOEAD", {"popsize": 3}, "did you mean 'pop_size'"),
        ("NSGA2", {"smoothness": True, "survival": RankAndCrowding()}, "leave out one of the two"),
        ("RNSGA2", {"ref_points": [[1, 2, 3]]}, "ref_points has shape"),
        ("RNSGA3", {"ref_points": [[1, 2], [2, 1]], "pop_size": 5}, "RNSGA3 needs pop_size 6 or more"),
        ("NSGA3", {"pop_size": 1}, "2 objectives need at least 2 reference directions"),
        ("NSGA3", {"ref_dirs": np.eye(3)}, "ref_dirs has shape"),
        ("NSGA3", {"ref_dirs": np.eye(2), "pop_size": 1}, "ref_dirs has 2 rows, expected 2 to pop_size = 1"),
        ("CTAEA", {"crossover": DiscreteSBX()}, "CTAEA needs a crossover that gives one child"),
        ("GA", {}, "GA takes one objective, the problem has 2"),
        ("NSGA2", {"smoothness": "yes"}, "smoothness is 'yes', expected True, False or None"),
        ("NSGA2", {"operators": 5}, "operators is 5, expected a mapping such as path_operators returns"),
        ("MOEAD", {"n_neighbors": -3}, "n_neighbors is -3, expected a whole number of at least 2"),
        ("MOEAD", {"n_replace": 2.5}, "n_replace is 2.5, expected a whole number of at least 1"),
        ("MOEAD", {"batch_size": 0}, "batch_size is 0, expected a whole number of at least 1"),
        (None, {}, "there is no algorithm None; expected one of"),
        ("MOEAD", {"n_neighbors": math.inf}, "n_neighbors is inf, expected a whole number of at least 2"),
        ("MOEAD", {"prob_neighbor_mating": math.nan}, "prob_neighbor_mating is nan, expected a number from 0 to 1 for MOEAD"),
        ("NSGA2", {"pop_size": True}, "pop_size is True, expected a whole number"),
        ("NSGA2", {"pop_size": np.True_}, "pop_size is True, expected a whole number"),
        ("exact", {"pop_size": 20}, "ExactFront takes no argument 'pop_size'"),
        ("exact", {"smoothness": False}, "ExactFront takes no argument 'smoothness'"),
        ("exact", {"operators": {}}, "ExactFront takes no argument 'operators'"),
        ("NSGA2", {"pop_size": 10**400}, "pop_size is a whole number of about 401 digits, expected a whole number of"),
        ("NSGA2", {"n_offsprings": math.inf}, "n_offsprings is inf, expected a whole number"),
        ("NSGA2", {"eliminate_duplicates": 3}, "eliminate_duplicates is 3, expected True, False or a Dup"),
        ("RVEA", {"alpha": math.nan}, "alpha is nan, expected a finite number of 0 or more for RVEA"),
        ("RVEA", {"adapt_freq": 0}, "adapt_freq is 0, expected a number above 0, at most 1 for RVEA"),
        (
            "RVEA",
            {"ref_dirs": [[math.nan, 1], [1, 0]]},
            "ref_dirs holds values that are not finite, expected rows of val",
        ),
        ("NSGA3", {"ref_dirs": "many"}, "ref_dirs is 'many', expected rows of values, one an objective"),
        ("NSDE", {"CR": "high"}, "CR is 'high', expected a number from 0 to 1"),
        ("NSDE", {"CR": True}, "CR is True, expected a number from 0 to 1"),
        ("NSDE", {"F": (0.8, 0.2)}, r"F is \(0.8, 0.2\), expected a number above 0, at most 2, or a range"),
        ("NSDE", {"F": math.nan}, "F is nan, expected a number above 0"),
        ("NSDE", {"F": [0.1, 0.2, 0.3]}, r"F is \[0.1, 0.2, 0.3\], expected a number above 0"),
        ("NSDE", {"variant": None}, "variant is None; expected one of DE/rand/1/bin, DE/rand/1/exp, "),
        ("NSDE", {"variant": "DE/rand/0/bin"}, "variant is 'DE/rand/0/bin'; did you mean 'DE/rand/1/bin'"),
        ("NSDE", {"de_repair": "bounce"}, "de_repair is 'bounce'; did you mean 'bounce-back'"),
        ("DNSGA2", {"version": "C"}, "version is 'C'; expected one of A, B"),
        ("CMOPSO", {}, "CMOPSO moves particles in a continuous space, and grid codings are discrete"),
    ],
)
def test_refusals(name, kwargs, message, make_problem):
    with pytest.raises(CapabilityError, match=message):
        make_algorithm(name, make_problem(), **kwargs)


@pytest.mark.parametrize(
    ("name", "kwargs"),
    [
        ("NSGA2", {"pop_size": np.int64(10), "n_offsprings": np.int32(4)}),
        ("MOEAD", {"prob_neighbor_mating": np.float64(0.5), "n_neighbors": np.int8(3)}),
        ("NSDE", {"F": np.float32(0.5), "CR": np.array(0.5)}),
        ("NSDE", {"F": np.array([0.1, 0.5])}),
        ("RVEA", {"adapt_freq": None}),
    ],
)
def test_numbers_may_be_numpys(name, kwargs, make_problem):
    assert make_algorithm(name, make_problem(), **kwargs) is not None


@pytest.mark.parametrize(
    ("n_obj", "n_points"),
    [
        (0, 5),
        (-1, 5),
        (2, math.inf),
        (2, math.nan),
        (2, 10**400),
        (101, 200),
        (2, 10**6),
        (True, 4),
        (2, "3"),
        (None, 3),
        (2.0, 3),
    ],
)
def test_reference_directions_that_would_not_end_are_refused(n_obj, n_points):
    with pytest.raises(CapabilityError, match="expected a whole number of at least 1 and at most 100"):
        reference_directions(n_obj, n_points)


def test_the_hint_names_what_suits_the_number_of_objectives(make_problem):
    with pytest.raises(
        CapabilityError, match=r"no algorithm 'DE'; expected one of OmniOptimizer, GA, .*exact, qsa.* for 1 objective$"
    ):
        make_algorithm("DE", make_problem(1))
    with pytest.raises(CapabilityError, match=r"no algorithm 'DE'; did you mean 'NSDE'\?"):
        make_algorithm("DE", make_problem(2))
    # What is refused on every grid is no hint.
    with pytest.raises(CapabilityError, match=r"no algorithm 'GDE3PCDX'; did you mean 'GDE3"):
        make_algorithm("GDE3PCDX", make_problem())


def test_what_is_no_problem_is_refused():
    with pytest.raises(CapabilityError, match="the problem is of the class str, expected one of pymoo"):
        make_algorithm("NSGA2", "office")


def test_three_objectives_need_room_for_three_directions(make_problem):
    with pytest.raises(CapabilityError, match="3 objectives need at least 3"):
        make_algorithm("MOEAD", make_problem(3), pop_size=2)
    assert len(make_algorithm("MOEAD", make_problem(3), pop_size=5).ref_dirs) == 3


@pytest.mark.parametrize("n_obj", [2, 3, 4])
@pytest.mark.parametrize("n_points", [4, 20, 91, 100])
def test_reference_directions(n_obj, n_points):
    directions = reference_directions(n_obj, n_points)
    assert np.allclose(directions.sum(axis=1), 1.0) and (directions >= 0).all()
    assert len(np.unique(directions.round(9), axis=0)) == len(directions) <= n_points
    if n_obj == 2:
        assert len(directions) == n_points
    # The objectives themselves are among the directions, so the ends of the front are searched.
    assert all((np.abs(directions - end).sum(axis=1) < 1e-12).any() for end in np.eye(n_obj))


def test_smoothness_is_on_unless_turn_is_an_objective(make_problem):
    nsga2 = make_algorithm("NSGA2", make_problem())
    assert isinstance(nsga2.survival, RankAndSmoothness) and isinstance(nsga2.mating.selection, SmoothnessTournament)
    assert isinstance(make_algorithm("NSGA2", make_problem(3)).survival, RankAndCrowding)
    assert isinstance(make_algorithm("NSGA2", make_problem(3), smoothness=True).survival, RankAndSmoothness)
    assert isinstance(make_algorithm("SPEA2", make_problem()).survival, StrengthAndSmoothness)
    assert make_algorithm("MOEAD", make_problem()).smoothness
    assert not make_algorithm("MOEAD", make_problem(3)).smoothness
    given = RankAndCrowding()
    assert make_algorithm("NSGA2", make_problem(), survival=given).survival is given


def shared(a, b, seen):
    """Return the objects of pymoo and of this package that two objects both reach."""
    found = []
    for key, value in vars(a).items():
        other = getattr(b, key, None)
        ours = type(value).__module__.split(".")[0] in ("pymoo", "pymoo_gridpath")
        if ours and id(value) not in seen:
            seen.add(id(value))
            if value is other:
                found.append(key)
            elif hasattr(value, "__dict__") and type(value) is type(other):
                found += shared(value, other, seen)
    return found


@pytest.mark.parametrize("name", [name for name, row in CAPABILITIES.items() if not row.unfit and not row.extra])
def test_nothing_is_shared_between_two_of_a_kind(name, make_problem, arguments):
    row = CAPABILITIES[name]
    n_obj = row.max_objectives or 2
    problem, kwargs = make_problem(n_obj), arguments(row, n_obj)
    kwargs.pop("automated_dm", None)
    if row.needs == "automated_dm":
        first, second = (make_algorithm(name, problem, **arguments(row, n_obj)) for _ in range(2))
    else:
        first, second = (make_algorithm(name, problem, **kwargs) for _ in range(2))
    assert shared(first, second, set()) == []


def test_pymoos_own_constructor_shares_its_defaults():
    """The test above can fail: it does for pymoo's constructors."""
    assert "output" in shared(NSGA2(), NSGA2(), set())


@pytest.mark.parametrize("name", [name for name, row in CAPABILITIES.items() if not row.unfit and not row.extra])
def test_every_accepted_argument_is_taken(name, make_problem, arguments):
    row = CAPABILITIES[name]
    n_obj = row.max_objectives or 2
    problem, kwargs = make_problem(n_obj), arguments(row, n_obj)
    model = make_algorithm(name, problem, 20, **kwargs)
    for key, default in parameters(class_of(row), name).items():
        if key in ("pop_size", "smoothness", *kwargs) or isinstance(default, type):
            continue
        value = {"ref_dirs": np.eye(n_obj), "crossover": getattr(model.mating, "crossover", None)}.get(key, default)
        make_algorithm(name, problem, 20, **{key: value}, **kwargs)


def test_termination_and_seed_reach_the_run(make_problem):
    algorithm = make_algorithm("SPEA2", make_problem(), 20, termination=("n_gen", 3), seed=4)
    result = minimize(make_problem(), algorithm)
    assert result.algorithm.evaluator.n_eval == 60
    again = minimize(make_problem(), make_algorithm("SPEA2", make_problem(), 20), ("n_gen", 3), seed=4)
    assert np.array_equal(result.pop.get("X"), again.pop.get("X"))


class Derived(DiscreteSBX):
    """What another package might make of an operator of this one."""


class OwnDo(DiscreteSBX):
    def do(self, problem, pop, parents=None, *args, **kwargs):
        return super().do(problem, pop, parents, *args, **kwargs)


class Closest(RowDuplicates):
    def _do(self, pop, other, is_duplicate):
        return super()._do(pop, other, is_duplicate)


def test_operators_that_override_pymoos_do_get_pymoos_mating(make_problem):
    problem = make_problem()
    for given in ({}, {"crossover": Derived(5.0)}, {"crossover": SBX()}, {"sampling": IntegerRandomSampling()}):
        assert isinstance(make_algorithm("NSGA2", problem, **given).mating, ArrayMating)
    for given in (
        {"crossover": OwnDo(5.0)},
        {"crossover": Derived(5.0, repair=RoundingRepair())},
        {"mutation": PM(vtype=float)},
        {"mutation": NoMutation()},
        {"eliminate_duplicates": Closest()},
        {"eliminate_duplicates": False},
    ):
        mating = make_algorithm("NSGA2", problem, **given).mating
        assert type(mating) is Mating
        assert all(getattr(mating, key) is value for key, value in given.items() if value)


@pytest.mark.parametrize("name", ["NSGA2", "SPEA2", "MOEAD"])
def test_a_derived_operator_gives_the_same_bits(name, make_problem):
    problem = make_problem()
    own, derived = (
        minimize(problem, make_algorithm(name, problem, 20, crossover=cls(5.0)), ("n_gen", 5), seed=1).pop.get("X")
        for cls in (DiscreteSBX, Derived)
    )
    assert np.array_equal(own, derived)


def test_only_crossovers_that_can_are_told_to_give_one_child(make_problem):
    problem = make_problem()
    for crossover in (DiscreteSBX(), Derived(), TwoPointCrossover(), SBX()):
        algorithm = make_algorithm("CTAEA", problem, operators={"crossover": crossover})
        assert algorithm.mating.crossover.n_offsprings == 1 and crossover.n_offsprings == 2
    with pytest.raises(CapabilityError, match="CTAEA needs a crossover that gives one child"):
        make_algorithm("CTAEA", problem, operators={"crossover": pntx.TwoPointCrossover()})


def test_differential_evolution_keeps_its_settings(make_problem):
    mating = make_algorithm("NSDE", make_problem(), CR=0.3, variant="DE/rand/2/exp").mating
    assert (mating.CR, mating.crossover_variant, mating.n_diffs) == (0.3, "exp", 2)


def test_differential_evolution_does_not_drift_to_zero(make_problem):
    """Cutting fractions off would pull the mean of the children towards zero."""
    problem = make_problem(representation="absolute")
    algorithm = make_algorithm("NSDE", problem, pop_size=400)
    algorithm.setup(problem, termination=("n_gen", 2), seed=1)
    algorithm.next()
    parents, children = algorithm.pop.get("X"), algorithm.ask().get("X")
    # The standard error of the mean of 400 x 7 genes in 0..7 is about 0.05.
    assert abs(children.mean() - parents.mean()) < 0.2


def test_two_children_a_mating_would_be_mixed_by_parallel_moead():
    """Why the table asks for one child: children of mating k are k and k + n, but pymoo pairs 2 k and 2 k + 1."""
    n = 4
    off = np.tile(np.arange(n), 2)  # the mating of each child, in the order in which pymoo's crossover lays them out
    pools = np.reshape(off, (n, -1))
    assert not (pools[:, 0] == pools[:, 1]).any()
    assert CAPABILITIES["ParallelMOEAD"].one_child and ParallelMOEAD.__name__ in CAPABILITIES
