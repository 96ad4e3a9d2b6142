"""What operators need beside them, and what they refuse: real variables, problems without turns, wrong parameters."""

from __future__ import annotations

import inspect
import math
import warnings
from fractions import Fraction

import numpy as np
import pytest
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.algorithms.moo.spea2 import SPEA2
from pymoo.core.problem import Problem
from pymoo.core.variable import Real
from pymoo.operators.repair.rounding import RoundingRepair
from pymoo.operators.sampling.rnd import FloatRandomSampling
from pymoo.optimize import minimize

from pymoo_gridpath import GridPathProblem, OccupancyGrid, operators
from pymoo_gridpath.algorithms import (
    SmoothMOEAD,
    StrengthAndSmoothness,
    StrengthTournament,
    make_algorithm,
    reference_directions,
)
from pymoo_gridpath.errors import GridPathError
from pymoo_gridpath.operators import (
    ArrayMating,
    BitwiseMutation,
    DiscretePolynomialMutation,
    DiscreteSBX,
    EdgeFixing,
    MixedCrossover,
    MixedMutation,
    PathMutation,
    PathRepair,
    PointCrossover,
    RandomSampling,
    RankAndSmoothness,
    ReachableSampling,
    ScalarizedSampling,
    SinglePointCrossover,
    SmoothnessTournament,
    SpliceCrossover,
    TwoPointCrossover,
    default_operators,
)

RNG = np.random.default_rng


class Plain(Problem):
    """A problem of pymoo's that knows no turns."""

    def __init__(self, vtype=int, **bounds):
        super().__init__(n_var=4, n_obj=2, vtype=vtype, **({"xl": 0, "xu": 6} | bounds))

    def _evaluate(self, x, out, *args, **kwargs):
        x = x.astype(float)
        out["F"] = np.column_stack([x.sum(axis=1), ((x - 5) ** 2).sum(axis=1)])


REAL_CROSSOVER, REAL_ROWS = RNG(0).random((2, 6, 4)), RNG(0).random((6, 4))


@pytest.mark.parametrize(
    ("operator", "X", "instead"),
    [
        (DiscreteSBX(), REAL_CROSSOVER, "SBX"),
        (DiscreteSBX(), np.ones((2, 6, 4)), "SBX"),
        (DiscreteSBX(), REAL_CROSSOVER.astype(object), "SBX"),
        (DiscretePolynomialMutation(), REAL_ROWS, "PM"),
        (BitwiseMutation(), REAL_ROWS, "PM"),
    ],
)
def test_real_variables_are_refused(operator, X, instead):
    sentence = (
        f"{type(operator).__name__} is for whole numbers and the rows are of the type .*RandomSampling.* pymoo's {instead}$"
    )
    with pytest.raises(GridPathError, match=sentence):
        operator._do(Plain(), X, random_state=RNG(0))


def test_real_variables_are_refused_in_a_run():
    with pytest.raises(GridPathError, match="DiscreteSBX is for whole numbers"):
        minimize(Plain(float), NSGA2(10, sampling=FloatRandomSampling(), crossover=DiscreteSBX()), ("n_gen", 2), seed=1)


@pytest.mark.parametrize("problem", [Plain(float), Plain(None), Plain(int, xl=None, xu=None)])
def test_sampling_refuses_what_is_not_whole_or_has_no_bounds(problem):
    with pytest.raises(GridPathError, match=r"RandomSampling draws whole numbers .* pymoo's FloatRandomSampling"):
        RandomSampling()._do(problem, 3, random_state=RNG(0))


@pytest.mark.parametrize("operator", [DiscreteSBX(), DiscretePolynomialMutation()])
def test_operators_that_draw_within_bounds_need_them(operator):
    X = np.zeros((2, 3, 4) if isinstance(operator, DiscreteSBX) else (3, 4), dtype=int)
    with pytest.raises(GridPathError, match="draws within bounds and the problem has none, expected xl and xu"):
        operator._do(Plain(int, xl=None, xu=None), X, random_state=RNG(0))


def test_bits_are_bits():
    with pytest.raises(GridPathError, match=r"flips bits and genes go from 0 to 6, .*DiscretePolynomialMutation"):
        BitwiseMutation()._do(Plain(), np.zeros((3, 4), dtype=int), random_state=RNG(0))
    assert BitwiseMutation(1.0)._do(Plain(xu=1), np.zeros((3, 4), dtype=int), random_state=RNG(0)).all()


def test_point_crossover_is_for_any_genes():
    children = TwoPointCrossover()._do(Plain(float), REAL_CROSSOVER, random_state=RNG(0))
    assert np.array_equal(np.sort(children, axis=0), np.sort(REAL_CROSSOVER, axis=0))


@pytest.mark.parametrize("operator", [EdgeFixing(), PathRepair(), MixedMutation(), MixedCrossover()])
def test_operators_of_paths_need_a_path_problem(operator):
    X = np.zeros((2, 3, 4) if isinstance(operator, MixedCrossover) else (3, 4), dtype=int)
    with pytest.raises(GridPathError, match="the problem is of the class Plain, expected a path problem: GridPathProblem"):
        operator._do(Plain(), X, random_state=RNG(0))


def integer_parts():
    return {"sampling": RandomSampling(), "crossover": DiscreteSBX(), "mutation": DiscretePolynomialMutation()}


SMOOTH = [
    ("RankAndSmoothness", lambda: NSGA2(12, selection=SmoothnessTournament(), survival=RankAndSmoothness(), **integer_parts())),
    ("RankAndSmoothness", lambda: NSGA2(12, survival=RankAndSmoothness(distinct=True), **integer_parts())),
    (
        "StrengthAndSmoothness",
        lambda: SPEA2(12, selection=StrengthTournament(), survival=StrengthAndSmoothness(), **integer_parts()),
    ),
    ("SmoothMOEAD", lambda: SmoothMOEAD(reference_directions(2, 12), n_neighbors=4, **integer_parts())),
]


@pytest.mark.parametrize(("owner", "make"), SMOOTH)
def test_a_problem_without_turns_is_warned_of(owner, make):
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("default")
        result = minimize(Plain(), make(), ("n_gen", 8), seed=1)
    sentences = [str(one.message) for one in said if "total turn" in str(one.message)]
    assert sentences == [
        f"{owner} breaks ties by total turn and the problem gives none, so that it breaks none; expected one that sets 'turn' "
        f"in each evaluation, such as GridPathProblem"
    ]
    # And the search goes on without.
    assert len(np.unique(result.F, axis=0)) > 3


@pytest.mark.parametrize("name", ["NSGA2", "SPEA2", "MOEAD"])
def test_a_problem_with_turns_is_not_warned_of(name):
    problem = GridPathProblem(OccupancyGrid(np.zeros((5, 5))), (0, 0), (4, 2), obstacles="constraint")
    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        minimize(problem, make_algorithm(name, problem, 12), ("n_gen", 3), seed=1)


@pytest.mark.parametrize(
    ("cls", "beside"),
    [
        (RankAndSmoothness, "SmoothnessTournament"),
        (SmoothnessTournament, "RankAndSmoothness"),
        (StrengthAndSmoothness, "StrengthTournament"),
        (StrengthTournament, "StrengthAndSmoothness"),
        (DiscreteSBX, "EdgeFixing"),
        (DiscretePolynomialMutation, "EdgeFixing"),
        (BitwiseMutation, "EdgeFixing"),
        (PointCrossover, "EdgeFixing"),
        (MixedCrossover, "EdgeFixing"),
        (MixedMutation, "EdgeFixing"),
    ],
)
def test_docstrings_say_what_is_needed_beside(cls, beside):
    assert f"`{beside}`" in (inspect.getdoc(cls) or "")


WRONG = [
    math.nan,
    math.inf,
    -math.inf,
    None,
    "0.5",
    b"0.5",
    -0.5,
    True,
    np.True_,
    10**400,
    [0.5],
    {},
    1j,
    np.array([0.5]),
    object(),
]
PARAMETERS = [
    (cls, name)
    for cls, names in {
        DiscreteSBX: ("eta", "prob", "prob_var", "n_offsprings"),
        MixedCrossover: ("eta", "prob", "prob_var", "n_offsprings"),
        SinglePointCrossover: ("prob", "n_offsprings"),
        TwoPointCrossover: ("prob", "n_offsprings"),
        SpliceCrossover: ("reach", "prob", "n_offsprings"),
        DiscretePolynomialMutation: ("eta", "prob", "prob_var"),
        BitwiseMutation: ("prob", "prob_var", "final"),
        MixedMutation: ("eta", "prob", "prob_var", "final"),
        PathMutation: ("prob", "margin", "max_expansions", "ways"),
        ReachableSampling: ("roughness", "detour"),
        ScalarizedSampling: ("noise",),
        RankAndSmoothness: ("distinct", "band"),
    }.items()
    for name in names
]


@pytest.mark.parametrize(("cls", "name"), PARAMETERS)
def test_wrong_parameters_are_refused_at_once(cls, name):
    for value in WRONG:
        optional = value is None and name in ("prob_var", "ways") and inspect.signature(cls).parameters[name].default is None
        if optional or (name == "detour" and value == math.inf) or (name == "distinct" and isinstance(value, bool | np.bool_)):
            cls(**{name: value})
            continue
        with pytest.raises(GridPathError, match=rf"^{name} (is|holds) |^ways is .*, expected (a mapping|shares)"):
            cls(**{name: value})


@pytest.mark.parametrize("value", [0, -1, 1.5, math.nan, math.inf, "2", None, True])
def test_numbers_of_cuts(value):
    with pytest.raises(GridPathError, match=r"n_points is .*, expected a whole number from 1 to"):
        PointCrossover(value)


def test_numbers_may_be_numpys_or_pymoos():
    for value in (np.float32(0.5), np.float64(0.5), Fraction(1, 2), np.array(0.5), Real(0.5, bounds=(0, 1)), 1, 0):
        DiscreteSBX(prob=value, prob_var=value)
        BitwiseMutation(prob=value, prob_var=value, final=value)
    assert PointCrossover(np.int64(3)).n_points == SpliceCrossover(reach=np.int8(3)).reach == 3
    assert DiscreteSBX(n_offsprings=np.int64(1)).n_offsprings == 1


@pytest.mark.parametrize("tournament", [SmoothnessTournament, StrengthTournament])
def test_tournaments_are_between_two(tournament):
    with pytest.raises(TypeError, match="pressure"):
        tournament(pressure=4)


def test_options_that_nobody_takes():
    for name in operators.__all__:
        thing = getattr(operators, name)
        if inspect.isclass(thing) and thing not in (ArrayMating, PointCrossover):
            with pytest.raises(TypeError, match="unheard_of"):
                thing(unheard_of=1)


def test_a_repair_of_an_operators_own_is_heeded():
    """Mating on arrays does not call it."""
    problem = GridPathProblem(OccupancyGrid(np.zeros((5, 5))), (0, 0), (4, 2))
    given = default_operators(problem) | {"crossover": DiscreteSBX(repair=RoundingRepair())}
    assert not isinstance(make_algorithm("NSGA2", problem, operators=given).mating, ArrayMating)
    assert isinstance(make_algorithm("NSGA2", problem, operators=default_operators(problem)).mating, ArrayMating)
