"""Operators by name: of this package, registered, and of installed packages."""

from __future__ import annotations

from importlib.metadata import EntryPoint

import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.core.crossover import Crossover
from pymoo.core.duplicate import DuplicateElimination
from pymoo.core.mutation import Mutation
from pymoo.core.repair import Repair
from pymoo.core.sampling import Sampling
from pymoo.core.selection import Selection
from pymoo.core.survival import Survival
from pymoo.operators.survival.rank_and_crowding import RankAndCrowding
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid, operators
from pymoo_gridpath.algorithms import StrengthAndSmoothness, StrengthTournament, make_algorithm
from pymoo_gridpath.errors import CapabilityError, GridPathError
from pymoo_gridpath.operators import OPERATORS, SmoothnessTournament, default_operators, paper_operators, path_operators
from pymoo_gridpath.operators.known import BASES, find_operator
from pymoo_gridpath.operators.sets import MEMBERS
from pymoo_gridpath.planners import PLANNERS, Plan, Planner
from pymoo_gridpath.registry import register


class Shuffle(Crossover):
    name = "shuffle"

    def __init__(self, prob=0.8, **kwargs):
        super().__init__(2, 2, prob=prob, **kwargs)

    def _do(self, problem, X, *args, random_state=None, **kwargs):
        return X[::-1].copy()


class Eager(RankAndCrowding):
    pass


@pytest.fixture(autouse=True)
def installed(monkeypatch):
    """Forget what tests register, and fake two entry points, of which one cannot be loaded."""
    monkeypatch.setattr(OPERATORS, "_known", dict(OPERATORS._known))
    monkeypatch.setattr(OPERATORS, "_names", dict(OPERATORS._names))
    points = (
        EntryPoint("eager", f"{__name__}:Eager", OPERATORS.group),
        EntryPoint("gone", "no_such_module:X", OPERATORS.group),
    )
    monkeypatch.setattr(OPERATORS, "_entry_points", {point.name: point for point in points})


@pytest.fixture
def problem():
    return GridPathProblem(OccupancyGrid([[0] * 6] * 6, corner_cutting=True), (0, 0), (5, 5), "integer")


def test_all_public_operators_of_the_package_have_their_names():
    public = [getattr(operators, name) for name in operators.__all__]
    fitting = {cls for cls in public if isinstance(cls, type) and issubclass(cls, tuple(BASES.values()))}
    assert len(fitting) == 28
    assert {cls for name, cls in OPERATORS.registered().items() if name == cls.__name__} == fitting | {
        StrengthAndSmoothness,
        StrengthTournament,
    }


def test_what_an_operator_is_for_follows_from_its_base():
    assert tuple(BASES.values()) == (Sampling, Crossover, Mutation, Repair, DuplicateElimination, Selection, Survival)
    for slot, base in BASES.items():
        for name, cls in OPERATORS.registered().items():
            if issubclass(cls, base):
                assert find_operator(slot, name) is cls
            else:
                with pytest.raises(CapabilityError, match=f"there is no {slot} '{name}'"), pytest.warns(UserWarning):
                    find_operator(slot, name)


@pytest.mark.parametrize("operators_of", [paper_operators, path_operators, default_operators])
def test_a_set_has_its_members(problem, operators_of):
    assert tuple(operators_of(problem)) == MEMBERS
    assert all(isinstance(operator, BASES[slot]) for slot, operator in operators_of(problem).items())


def test_names_stand_for_operators_with_their_defaults(problem):
    register(Shuffle)
    named = {"crossover": "shuffle", "mutation": "BitwiseMutation", "survival": "eager", "sampling": "RandomSampling"}
    algorithm = make_algorithm("NSGA2", problem, 10, operators=named)
    assert type(algorithm.mating.crossover) is Shuffle and algorithm.mating.crossover.prob.value == 0.8
    assert type(algorithm.mating.mutation) is operators.BitwiseMutation
    assert type(algorithm.survival) is Eager
    # A survival of its own leaves the tie-break out.
    assert type(algorithm.mating.selection) is not SmoothnessTournament
    named = {"crossover": "shuffle", "mutation": "DiscretePolynomialMutation"}
    made = {"crossover": Shuffle(), "mutation": operators.DiscretePolynomialMutation()}
    one, other = (
        minimize(problem, make_algorithm("NSGA2", problem, 10, operators=given), ("n_gen", 4), seed=1)
        for given in (named, made)
    )
    assert one.pop.get("X").tolist() == other.pop.get("X").tolist()


def test_planners_that_take_operators_are_given_objects(problem):
    class Sampled(Planner):
        takes_operators = True

        def __init__(self, operators=None, **kwargs):
            self.operators = operators
            super().__init__(**kwargs)

        def plan(self, problem):
            return Plan(self.operators["sampling"].do(problem, 3, random_state=self.random_state).get("X"))

    PLANNERS.register(Sampled)
    try:
        planner = make_algorithm("sampled", problem, operators={"sampling": "ReachableSampling"})
    finally:
        del PLANNERS._known["sampled"], PLANNERS._names["sampled"]
    assert type(planner.operators["sampling"]) is operators.ReachableSampling
    assert len(minimize(problem, planner, seed=1).X) == 3


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"mutation": "PathMutatoin"}, r"there is no mutation 'PathMutatoin'; did you mean 'PathMutation'\?"),
        ({"survival": "eagr"}, r"there is no survival 'eagr'; did you mean 'eager'\?"),
        ({"repair": "PathMutation"}, r"there is no repair 'PathMutation'; expected one of|did you mean 'PathRepair'"),
        (
            {"selection": ""},
            r"there is no selection ''; expected one of RouletteSelection, SmoothnessTournament, StrengthTournament$",
        ),
        ({"crossover": "x" * 10**5}, r"there is no crossover 'x+\.\.\.x+'; expected one of"),
        ({"survival": "gone"}, "the operator 'gone' of the installed package cannot be imported from no_such_module:X"),
        ({"crossover": "PointCrossover"}, "crossover is 'PointCrossover', which needs n_points; expected an object in place"),
        ({"cross": "DiscreteSBX"}, "operators takes no argument 'cross'; did you mean 'crossover'"),
    ],
)
@pytest.mark.filterwarnings("ignore:the operator 'gone'")
def test_what_is_no_name_is_refused_with_the_nearest(problem, given, message):
    with pytest.raises(CapabilityError, match=message) as error:
        make_algorithm("NSGA2", problem, operators=given)
    assert len(str(error.value)) < 1000


def test_names_are_for_the_mapping_alone(problem):
    with pytest.raises(CapabilityError, match=r"crossover is 'DiscreteSBX', expected an object; names stand in operators="):
        make_algorithm("NSGA2", problem, crossover="DiscreteSBX")
    with pytest.raises(CapabilityError, match="MOEAD takes no argument 'survival'"):
        make_algorithm("MOEAD", problem, operators={"survival": "RankAndSmoothness"})


def test_a_name_is_of_one_class():
    with pytest.raises(GridPathError, match=r"the operator 'DiscreteSBX' is .*crossover.DiscreteSBX already"):
        register(type("DiscreteSBX", (Shuffle,), {"name": "DiscreteSBX"}))
    with pytest.raises(GridPathError, match="expected a class derived from one of Sampling, Crossover, Mutation"):
        OPERATORS.register(NSGA2)
