"""Problems of suites on the command line."""

from __future__ import annotations

import json

import pytest

from pymoo_gridpath.cli import main
from pymoo_gridpath.problems import SUITES, make_suite

FORWARD = "ASLETISMAC_CH_X8_Y8_PM_K3_BF"
TABLE = f'{{ class = "asletismac", instance = "{FORWARD}" }}'


def test_suites_are_listed_with_what_they_follow(capsys):
    assert main(["suites"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    for name, suite in SUITES.items():
        assert f"{name}: " in said and suite.follows in said


def test_a_problem_of_a_suite_is_planned(tmp_path, capsys):
    given = ["plan", "--suite", TABLE, "--objectives", "length,ascent", "-o", str(tmp_path)]
    assert main([*given, "--algorithm", "exact"]) == 0
    content = json.loads((tmp_path / "paths.json").read_text())
    assert content["map"]["name"] == FORWARD and content["settings"]["backtracking"] is False
    expected = make_suite("asletismac", instance=FORWARD).problem(["length", "ascent"]).pareto_front()
    assert len(content["paths"]) == len(expected)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--suite", "asletismak"], "suite is 'asletismak'; did you mean 'asletismac'?"),
        (["--suite", "asletismac"], "'asletismac' cannot be made: missing a required argument: 'instance'"),
        (["--suite", "{ class = "], "--suite is { class = , expected a name, or a table such as"),
        (["--suite", '{ class = "asletismac" }\nother = 1'], "expected a name, or a table such as"),
        (["--suite", TABLE, "--radius", "0.4"], "--radius is not for --suite, which says what is planned on"),
        (["--suite", TABLE, "--representation", "cells"], "--representation is not for --suite"),
        (["--suite", TABLE, "--axis", "x"], "--axis is not for --suite"),
        (["warehouse", "--suite", TABLE], "MAP is not for --suite"),
        (["--suite", TABLE, "--resume", "gridpath-out"], "--suite is not for --resume"),
        (["--suite", TABLE, "--objectives", "delays"], "there is no objective 'delays'"),
        (["--suite", TABLE, "--units", "m"], "--units m"),
    ],
)
def test_what_means_nothing_is_refused(options, message, capsys):
    assert main(["plan", *options]) == 2
    error = capsys.readouterr().err
    assert message in error and error.count("\n") == 1
