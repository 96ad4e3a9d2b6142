"""Every claim of the capability table, measured on small problems."""

from __future__ import annotations

import ast
import importlib
import importlib.util
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pymoo.algorithms.moo
import pytest
from pymoo.algorithms.moo.gde3 import GDE32NN
from pymoo.core.repair import Repair
from pymoo.operators.survival.rank_and_crowding.metrics import get_crowding_function
from pymoo.optimize import minimize

from pymoo_gridpath.algorithms import CAPABILITIES, capability_table, make_algorithm, reference_directions
from pymoo_gridpath.algorithms.factory import build
from pymoo_gridpath.algorithms.known import _PACKAGES
from pymoo_gridpath.errors import CapabilityError
from pymoo_gridpath.operators import default_operators, paper_operators, path_operators

ROWS = list(CAPABILITIES.values())
USABLE = [row for row in ROWS if not row.unfit]
POP_SIZE, N_GEN = 20, 5


def named(rows):
    return [pytest.param(row, id=row.name) for row in rows]


def need_package(row):
    package = _PACKAGES.get(row.extra, row.extra)
    if package and importlib.util.find_spec(package) is None:
        pytest.skip(f"{row.extra} is not installed")


def can(row, n_obj, obstacles):
    most = n_obj if row.max_objectives is None else row.max_objectives
    return not row.unfit and row.min_objectives <= n_obj <= most and (row.constraints or obstacles == "penalty")


def solve(problem, algorithm, seed=1, n_gen=N_GEN, **kwargs):
    return minimize(problem, algorithm, ("n_gen", n_gen), seed=seed, **kwargs)


def least_objectives(row):
    return row.max_objectives or 2


@pytest.mark.parametrize("row", named(ROWS))
@pytest.mark.parametrize("n_obj", [1, 2, 3])
@pytest.mark.parametrize("obstacles", ["penalty", "constraint"])
def test_row(row, n_obj, obstacles, make_problem, arguments, fingerprint):
    problem = make_problem(n_obj, obstacles)
    kwargs = arguments(row, n_obj)
    if not can(row, n_obj, obstacles):
        with pytest.raises(CapabilityError) as refusal:
            make_algorithm(row.name, problem, POP_SIZE, **kwargs)
        assert row.name in str(refusal.value)
        assert len(str(refusal.value).split()) > 5
        return
    need_package(row)
    algorithm = make_algorithm(row.name, problem, POP_SIZE, **kwargs)
    problem.evaluate(problem.xl[None])  # fills what the problem computes once
    before = fingerprint(algorithm), fingerprint(problem)
    result = solve(problem, algorithm)
    assert (fingerprint(algorithm), fingerprint(problem)) == before
    assert result.algorithm.evaluator.n_eval >= 15 * (N_GEN - 1)
    check_genes(problem, result.pop)
    if result.opt is not None:
        check_genes(problem, result.opt)
    check_reproducible(row, problem, kwargs, result)
    check_pickles(row, result)
    assert pickle.loads(pickle.dumps(problem)).evaluate(result.pop.get("X"), return_values_of=["F"]).tolist() == (
        result.pop.get("F").tolist()
    )


def check_genes(problem, pop):
    X = pop.get("X")
    assert X.dtype.kind in "ib"
    assert np.array_equal(np.clip(X, problem.xl, problem.xu), X)


def check_reproducible(row, problem, kwargs, result):
    def again(seed):
        return solve(problem, make_algorithm(row.name, problem, POP_SIZE, **kwargs), seed)

    def same(a, b):
        return all(np.array_equal(a.pop.get(key), b.pop.get(key)) for key in ("X", "F"))

    if row.reproducible_constrained if problem.has_constraints() else row.reproducible:
        assert same(result, again(1))
    else:
        # Every run has ties that are broken anew, many of them.
        assert not all(same(again(seed), again(seed)) for seed in range(3))


def check_pickles(row, result):
    if row.pickles:
        copy = pickle.loads(pickle.dumps(result.algorithm))
        assert np.array_equal(copy.pop.get("X"), result.pop.get("X"))
    else:
        with pytest.raises((AttributeError, TypeError, pickle.PicklingError)):
            pickle.dumps(result.algorithm)


@pytest.mark.parametrize(
    "row", named(row for row in USABLE if not row.takes_operators or row.name in ("NSGA3", "CTAEA", "DNSGA2"))
)
def test_bits_stay_bits(row, make_problem, arguments):
    problem = make_problem(2, representation="binary")
    result = solve(problem, make_algorithm(row.name, problem, POP_SIZE, **arguments(row, 2)))
    assert result.pop.get("X").dtype == bool


@pytest.mark.parametrize("row", named(USABLE))
def test_operators_that_the_table_names_are_called(row, make_problem, arguments):
    need_package(row)
    n_obj = least_objectives(row)
    problem = make_problem(n_obj)
    operators = paper_operators(problem)
    called = set()

    def spy(name, operator):
        original = operator._do

        def do(*args, **kwargs):
            called.add(name)
            return original(*args, **kwargs)

        operator._do = do
        return operator

    names = ["repair"] + (["crossover", "mutation"] if row.takes_operators else [])
    if row.one_child:
        operators["crossover"].n_offsprings = 1
    spies = {name: spy(name, operators[name]) for name in names}
    algorithm = make_algorithm(row.name, problem, POP_SIZE, operators=spies, **arguments(row, n_obj))
    solve(problem, algorithm, copy_algorithm=False)
    assert called == set(names)


@pytest.mark.parametrize("make", [path_operators, default_operators])
@pytest.mark.parametrize("row", named(USABLE))
def test_pymoos_own_constructors_unpack_operators_where_the_table_says(row, make, make_problem, arguments):
    need_package(row)
    n_obj = least_objectives(row)
    problem, kwargs = make_problem(n_obj), arguments(row, n_obj)
    cls = getattr(importlib.import_module(row.module), row.name)
    operators = make(problem)
    if row.needs == "ref_dirs":
        kwargs["ref_dirs"] = reference_directions(n_obj, POP_SIZE)
    if row.name == "RNSGA3":
        kwargs["pop_per_ref_point"] = POP_SIZE // 2
    if row.unpacks:
        algorithm = cls(**operators, **kwargs)
        held = [algorithm, algorithm.mating, algorithm.initialization]
        assert all(any(getattr(one, key, None) is value for one in held) for key, value in operators.items())
        X = solve(problem, algorithm, n_gen=2, copy_algorithm=False).pop.get("X")
        assert X.dtype.kind in "ib" and np.array_equal(np.clip(X, problem.xl, problem.xu), X)
    elif row.name == "CTAEA":
        # It builds one, which pairs children wrongly or waits for a first population without duplicates.
        assert row.one_child and operators["crossover"].n_offsprings == 2
    else:
        with pytest.raises(TypeError, match="eliminate_duplicates"):
            cls(**operators, **kwargs)
    if row.takes_operators:
        # As the documentation of the operators says.
        assert make_algorithm(row.name, problem, operators=make(problem), **arguments(row, n_obj)) is not None


@pytest.mark.parametrize("row", named(row for row in USABLE if not row.takes_operators))
def test_operators_that_an_algorithm_would_ignore_are_refused(row, make_problem):
    problem = make_problem()
    with pytest.raises(CapabilityError, match=f"{row.name} takes no argument 'crossover', since it makes"):
        make_algorithm(row.name, problem, operators={"crossover": paper_operators(problem)["crossover"]})


@pytest.mark.parametrize("row", named(row for row in USABLE if not row.constraints))
def test_algorithms_without_constraints_cannot_do_them(row, make_problem, arguments):
    need_package(row)
    # A grid on which no path of the first populations is feasible.
    problem = make_problem(2, "constraint", p0=0.3)
    with pytest.raises((AssertionError, ValueError)):
        solve(problem, build(row, problem, POP_SIZE, **arguments(row, 2)), seed=5)


def test_pinsga2_cannot_fit_three_objectives(make_problem, arguments):
    row = CAPABILITIES["PINSGA2"]
    problem = make_problem(3)
    with pytest.raises(ValueError, match="broadcast"):
        solve(problem, build(row, problem, POP_SIZE, **arguments(row, 3)))


@pytest.mark.parametrize("name", ["CMOPSO", "MOPSO_CD"])
def test_swarms_leave_the_whole_numbers(name, make_problem):
    problem = make_problem()
    X = solve(problem, build(CAPABILITIES[name], problem, POP_SIZE)).pop.get("X")
    assert not np.array_equal(np.rint(X), X)


def test_cmopso_is_not_reproducible(make_problem):
    problem = make_problem(3)

    def run(seed):
        algorithm = build(CAPABILITIES["CMOPSO"], problem, pop_size=6, elite_size=3)
        return solve(problem, algorithm, seed, n_gen=20).pop.get("X").tolist()

    assert not all(run(seed) == run(seed) for seed in range(3))


def test_mopso_cd_is_reproducible(make_problem):
    problem = make_problem(3)
    first, second = (solve(problem, build(CAPABILITIES["MOPSO_CD"], problem, POP_SIZE)) for _ in range(2))
    assert np.array_equal(first.pop.get("X"), second.pop.get("X"))


def test_cmopso_gives_repairs_no_random_state(make_problem):
    class Draws(Repair):
        def _do(self, problem, X, random_state=None, **kwargs):
            return X + 0 * random_state.random(X.shape)

    problem = make_problem()
    with pytest.raises(AttributeError, match="NoneType"):
        solve(problem, build(CAPABILITIES["CMOPSO"], problem, POP_SIZE, repair=Draws()))


def test_the_2nn_crowding_fails_on_two_distinct_members():
    front = np.array([[0.0, 1.0], [1.0, 0.0], [1.0, 0.0]])
    with pytest.raises(ValueError, match="kth"):
        GDE32NN().survival.crowding_func.do(front, n_remove=1)
    assert np.isfinite(get_crowding_function("mnn").do(front, n_remove=1)).any()


def test_the_pcd_crowding_crashes():
    if "compiled" not in get_crowding_function("pcd").function.__module__:
        pytest.skip("pymoo's compiled functions are not installed")
    script = (
        "import numpy as np\n"
        "from pymoo.operators.survival.rank_and_crowding.metrics import get_crowding_function\n"
        "pcd, rng = get_crowding_function('pcd'), np.random.default_rng(1)\n"
        "for _ in range(1000):\n"
        "    n = int(rng.integers(1, 25))\n"
        "    pcd.do(rng.integers(0, 6, (n, 2)).astype(float), n_remove=int(rng.integers(0, n + 1)))\n"
    )
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, check=False).returncode != 0


@pytest.mark.parametrize("row", named(row for row in USABLE if row.needs in ("ref_points", "automated_dm")))
def test_what_the_caller_must_give(row, make_problem):
    with pytest.raises(CapabilityError, match=row.needs):
        make_algorithm(row.name, make_problem())


@pytest.mark.parametrize("row", named(row for row in ROWS if row.dynamic))
def test_dynamic_algorithms_spend_evaluations_on_changes(row, make_problem):
    need_package(row)
    problem = make_problem()
    assert solve(problem, make_algorithm(row.name, problem, POP_SIZE)).algorithm.evaluator.n_eval > POP_SIZE * N_GEN


@pytest.mark.parametrize("row", named(row for row in ROWS if row.extra))
def test_a_missing_package_is_named(row, make_problem, monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(CapabilityError, match=f"{row.name} needs the package {row.extra}, .* pip install {row.extra}"):
        make_algorithm(row.name, make_problem())


@pytest.mark.parametrize("row", named(USABLE))
def test_smoothness_where_the_table_says(row, make_problem, arguments):
    need_package(row)
    n_obj = least_objectives(row)
    # On an empty grid vulnerability is nought, so that paths of equal length tie.
    problem = make_problem(n_obj, p0=0.0)
    kwargs = arguments(row, n_obj)
    if not row.smoothness:
        with pytest.raises(CapabilityError, match=f"{row.name} has no smoothness tie-break"):
            make_algorithm(row.name, problem, smoothness=True, **kwargs)
        return
    smooth, plain = (
        solve(problem, make_algorithm(row.name, problem, POP_SIZE, smoothness=smoothness, **kwargs), n_gen=15)
        for smoothness in (True, False)
    )
    assert smooth.pop.get("turn").mean() < plain.pop.get("turn").mean()


def test_the_table_holds_all_of_pymoos_multi_objective_algorithms():
    bases = {}
    for path in Path(pymoo.algorithms.moo.__path__[0]).glob("*.py"):
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.ClassDef):
                bases[node.name] = {base.id for base in node.bases if isinstance(base, ast.Name)}
    algorithms = {"Algorithm", "GeneticAlgorithm"}
    while grown := {name for name, parents in bases.items() if parents & algorithms} - algorithms:
        algorithms |= grown
    assert set(CAPABILITIES) == algorithms - {"Algorithm", "GeneticAlgorithm"} | {"GA"}
    for row in ROWS:
        assert importlib.util.find_spec(row.module) is not None


def test_markdown_has_a_row_an_algorithm():
    lines = capability_table().splitlines()
    assert [line.split("|")[1].strip() for line in lines[2:]] == list(CAPABILITIES)
    assert len({line.count("|") for line in lines}) == 1
