"""Three runs, and what is kept of them."""

import pytest
from trade_offs import make_problem, run

from pymoo_gridpath.decision import TradeOffSet


@pytest.fixture(scope="session")
def results():
    problem = make_problem(12, 3)
    return [run(problem, seed) for seed in (1, 2, 3)]


@pytest.fixture(scope="session")
def trade_off(results):
    return TradeOffSet.from_results(results)
