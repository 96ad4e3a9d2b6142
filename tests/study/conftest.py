"""A small study that has run."""

from __future__ import annotations

import pytest
from small_studies import make_plan

from pymoo_gridpath.study.planning.plan import Plan
from pymoo_gridpath.study.running.runner import run_study
from pymoo_gridpath.study.running.store import Store


@pytest.fixture(scope="session")
def plan() -> Plan:
    """A plan of 27 runs, each of some milliseconds."""
    return make_plan()


@pytest.fixture(scope="session")
def done(plan, tmp_path_factory) -> Store:
    """The store of the plan, run in this process without disturbance. Not to be changed."""
    folder = tmp_path_factory.mktemp("done")
    outcome = run_study(plan, folder)
    assert (outcome.n_run, outcome.n_failed, outcome.messages) == (len(plan.runs), 0, [])
    return Store(folder)
