"""Study files: what is read, and what is refused with which line."""

from __future__ import annotations

import dataclasses
import pickle
import re
import textwrap
import tomllib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pymoo_gridpath import OccupancyGrid
from pymoo_gridpath.errors import StudyError
from pymoo_gridpath.study.planning.expand import plan_study
from pymoo_gridpath.study.specification.problem import QueryRange
from pymoo_gridpath.study.specification.study import AlgorithmSpec, ProblemSpec, RandomFamily, Study
from pymoo_gridpath.study.specification.toml_file import load_study
from pymoo_gridpath.study.specification.toml_lines import KeyLines

PLAIN = """\
seeds = 3
budget = { generations = 2 }

[[problems]]
random = { size = 8, p0 = 0.1, seeds = 2 }

[[algorithms]]
algorithm = "NSGA2"
pop_size = 8

[[algorithms]]
algorithm = "SPEA2"
pop_size = 8
"""


def write(tmp_path, text, name="tiny.toml"):
    path = tmp_path / name
    path.write_text(textwrap.dedent(text), encoding="utf-8")
    return path


def refused(tmp_path, text) -> StudyError:
    with pytest.raises(StudyError) as info:
        plan_study(load_study(write(tmp_path, text)))
    return info.value


# -- lines --------------------------------------------------------------------------------------------------------------

TRICKY = '''\
# [[problems]] in a comment
title = "a # no comment [[problems]]" # a comment
note = """
[[problems]]
fake = 1 \\"""
still in it""""
"quoted # key".'part two' = [ # an array
  "]", ']', # ]
  { a = "}" },
]

[[problems]] # the first
map = "x"
random.size = 5
start = [
  1,
  2,
]
[problems.deep . er]
a = \'\'\'
[[problems]]\'\'\'

  [[ problems ]]
  map = 'y'   # = 3
[last]
x = 1
'''


def test_lines_of_a_tricky_file():
    tomllib.loads(TRICKY)
    lines = KeyLines(TRICKY)
    places = {
        ("title",): 2,
        ("note",): 3,
        ("quoted # key", "part two"): 7,
        ("quoted # key", "part two", 2, "a"): 7,
        ("problems", 0): 12,
        ("problems", 0, "map"): 13,
        ("problems", 0, "random", "size"): 14,
        ("problems", 0, "start", 1): 15,
        ("problems", 0, "deep", "er"): 19,
        ("problems", 0, "deep", "er", "a"): 20,
        ("problems", 1): 23,
        ("problems", 1, "map"): 24,
        ("problems", 1, "goal"): 23,  # not there: where its table begins
        ("last", "x"): 26,
        ("nothing",): None,
        (): None,
    }
    assert {place: lines.line(place) for place in places} == places


def line_by_prefixes(text: str, place) -> int | None:
    """Brute force: the statement begins after the longest part of the file that is whole and does not know the place yet."""
    rows = text.split("\n")
    last_without = 0
    for n in range(len(rows) + 1):
        try:
            value = tomllib.loads("\n".join(rows[:n]))
        except tomllib.TOMLDecodeError:
            continue
        try:
            for part in place:
                value = value[part]
        except (KeyError, IndexError, TypeError):
            last_without = n
            continue
        return last_without + 1
    return None


VALUES = st.sampled_from(
    [
        "1",
        "0.5",
        "true",
        '"# [[t]]"',
        "'[x'",
        '"\\"]"',
        '"""\n[t]\nk0 = 1"""',
        '"""a \\""" """',
        "'''\n'x'\n# '''",
        '""""q""""',
        '""',
        "[\n 1, # ]\n 2,\n]",
        '["]", [\n], "[" ]',
        "{ k0 = 1, k1 = '}' }",
        "[{ k0 = [\n1 ] },\n { k1 = 2 }]",
        "1979-05-27",
    ]
)
NOISE = st.sampled_from(["", "\n", "# k0 = [\n", "   \n\n", "  # [[t]] \"\"\" '''\n"])
KEYS = st.sampled_from(["k0", '"k 1"', "'#'", "k2 . k3", 'a."[".c', "x-y"])


@st.composite
def documents(draw):
    text = ""
    for _ in range(draw(st.integers(1, 4))):
        header = draw(st.sampled_from(["", "[[t]]", "[[ t ]] # x", "[[t.k0]]", "[t.sub]", "[u]", '["a b".c]']))
        text += draw(NOISE) + (draw(st.sampled_from(["", "  "])) + header + "\n" if header else "")
        for key in draw(st.lists(KEYS, unique=True, max_size=4)):
            text += draw(NOISE) + f"{key} = {draw(VALUES)}{draw(st.sampled_from(['', '  # end', ' ']))}\n"
    return text


def places_of(value, place=()):
    yield place
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        yield from places_of(item, (*place, key))


@settings(max_examples=150, deadline=None)
@given(documents())
def test_lines_agree_with_brute_force(text):
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return  # such as a table twice
    lines = KeyLines(text)
    for place in places_of(data):
        if place:
            assert lines.line(place) == line_by_prefixes(text, place), (place, text)


# -- what is refused ----------------------------------------------------------------------------------------------------

ALGORITHM, FAMILY = 'algorithm = "NSGA2"', "random = { size = 8, p0 = 0.1, seeds = 2 }"
BAD = [
    ("seeds = 3", "seed = 3", 1, "the study has no key 'seed'; did you mean 'seeds'?"),
    ("seeds = 3", "seeds = 0", 1, "seeds is 0, expected how many"),
    ("seeds = 3", "seeds = []", 1, "seeds has 0 entries"),
    ("seeds = 3", "seeds = [1, 2, 1]", 1, "seeds lists 1 twice"),
    ("seeds = 3", "seeds = [1, -2]", 1, "seeds is -2"),
    ("seeds = 3", "seeds = true", 1, "seeds is true"),
    ("seeds = 3", "seeds = { first = 3 }", 1, "seeds has no count"),
    ("seeds = 3", "seeds = { fist = 3, count = 2 }", 1, "did you mean 'first'?"),
    ("generations = 2", "generation = 2", 2, "budget has no key 'generation'; did you mean 'generations'?"),
    ("generations = 2", "generations = 2, evaluations = 5", 2, "budget has 2 entries, expected either"),
    ("generations = 2", "generations = 2.5", 2, "generations is 2.5, expected a whole number"),
    ("{ generations = 2 }", "400", 2, "budget is 400, expected such as { evaluations = 20000 } or { generations = 100 }"),
    ("generations = 2", "generations = true", 2, "generations is true, expected a whole number, 1 to 1000000000"),
    ("generations = 2", "evaluations = -4", 2, "evaluations is -4, expected a whole number, 1 to 1000000000"),
    ("generations = 2", "evaluations = 1_000_000_000_000", 2, "evaluations is 1000000000000, expected a whole number, 1 to 1"),
    ("seeds = 3", "reference = 60\nseeds = 3", 1, "reference is 60, expected such as { max_seconds = 60 }, or false"),
    ("generations = 2", "evaluations = 5", 9, "pop_size is 8, expected at most the 5 evaluations"),
    ("seeds = 3", "target = 1.5\nseeds = 3", 1, "target is 1.5, expected a number, above 0, at most 1"),
    ("seeds = 3", "reference = { seconds = 5 }\nseeds = 3", 1, "reference has no key 'seconds'; did you mean 'max_seconds'?"),
    ("size = 8", "size = 1", 5, "size is 1, expected a whole number, 2 to"),
    ("size = 8", "sise = 8", 5, "a random family has no key 'sise'; did you mean 'size'?"),
    ("size = 8, ", "", 5, "a random family has no size"),
    ("p0 = 0.1", "p0 = 1.1", 5, "p0 is 1.1, expected a number, 0 to 1"),
    ("p0 = 0.1", "p0 = nan", 5, "p0 is nan"),
    ("random =", 'map = "warehouse"\nrandom =', 5, "the problem has random and map, expected one of them"),
    ("random = {", 'objectives = ["lenght"]\nrandom = {', 5, "there is no objective 'lenght'; did you mean 'length'?"),
    ("random = {", "objectives = []\nrandom = {", 5, "objectives are []"),
    ("random = {", 'representation = "cell"\nrandom = {', 5, "did you mean 'cells'?"),
    ("random = {", 'obstacles = "limit"\nrandom = {', 5, "needs potential_limit"),
    ("random = {", "penalty = 0\nrandom = {", 5, "penalty is 0, expected a number, above 0"),
    ("random = {", "start = [0, 0]\nrandom = {", 5, "start is for maps from a file"),
    ("random = {", "queries = [1]\nrandom = {", 5, "queries is for maps from a file"),
    ("random = {", "naem = 'x'\nrandom = {", 5, "a problem has no key 'naem'; did you mean 'name'?"),
    (FAMILY, "name = 'x'", 4, "the problem has no grid"),
    (FAMILY, "map = 'warehous'", 5, "did you mean 'warehouse'?"),
    (FAMILY, "map = 'nix.map'", 5, "nix.map"),
    (FAMILY, "map = 'paper16'\nstart = [99, 0]", 6, "start (99, 0) lies outside"),
    (FAMILY, "map = 'warehouse'\nradius = 9", 6, "robot's radius of 9 m"),
    (FAMILY, "map = 'paper16'\nradius = 3", 6, "is in cells, and a radius in metres needs their size"),
    (FAMILY, "map = 'paper16'\nthreshold = 0.5", 5, "does not take the option"),
    ("p0 = 0.1", "p0 = 0.9, corner_cutting = false", 5, "seed 1: goal (7, 7) cannot be reached"),
    (ALGORITHM, 'algorithm = "NSGA4"', 8, "there is no algorithm 'NSGA4'; did you mean 'NSGA"),
    (ALGORITHM, 'algorithm = "exat"', 8, "did you mean 'exact'?"),
    (ALGORITHM, 'algorithm = "CMOPSO"', 8, "CMOPSO moves particles"),
    (ALGORITHM, 'algorithm = "PINSGA2"', 8, "decision maker"),
    (ALGORITHM, 'algorithm = "GA"', 7, "takes one objective"),
    (ALGORITHM, 'algorithm = "exact"', 9, "exact takes no pop_size"),
    (ALGORITHM, 'preset = "ahmed-deb-2012"', 8, "did you mean 'ahmed-deb-2013'?"),
    (ALGORITHM, ALGORITHM + '\npreset = "ahmed-deb-2013"', 7, "expected one of them"),
    (ALGORITHM, ALGORITHM + "\nmax_seconds = 3", 9, "NSGA2 takes no max_seconds"),
    (ALGORITHM, 'algorithm = "NSGA3"\nobstacles = "constraint"', 7, "another result each time"),
    (ALGORITHM, 'algorithm = "DNSGA2"\nobstacles = "constraint"', 7, "cannot solve problems with constraints"),
    (ALGORITHM, 'algorithm = "NSGA3"\nsmoothness = true', 7, "no smoothness tie-break"),
    (ALGORITHM, 'algorithm = "RNSGA2"', 7, "give ref_points"),
    (ALGORITHM, 'algorithm = "MOEAD"\nparameters = { n_neighbours = 3 }', 9, "did you mean 'n_neighbors'?"),
    (
        ALGORITHM,
        'algorithm = "MOEAD"\nparameters = { n_neighbors = "3" }',
        9,
        "n_neighbors is '3', expected a whole",
    ),
    (ALGORITHM, ALGORITHM + "\nparameters = { seed = 3 }", 9, "seed is set by the seeds of the study"),
    (ALGORITHM, ALGORITHM + "\nparameters = { survival = 3 }", 9, "survival is set by the key operators of the algorithm"),
    (ALGORITHM, ALGORITHM + "\nparameters = { output = 3 }", 9, "object of Python"),
    (
        ALGORITHM,
        ALGORITHM + '\noperators.survival = { class = "RankAndSmoothness", distinct = 1 }',
        9,
        "distinct is 1, exp",
    ),
    (ALGORITHM, ALGORITHM + "\nparameters.verbose = true", 9, "changes no result"),
    (ALGORITHM, ALGORITHM + '\noperators = "papr"', 9, "did you mean 'paper'?"),
    (
        ALGORITHM,
        ALGORITHM + '\noperators = { mutation = "PathMutatoin" }',
        9,
        "did you mean 'PathMutation'?",
    ),
    (
        ALGORITHM,
        ALGORITHM + '\noperators = { mutation = "EdgeFixing" }',
        9,
        "there is no mutation 'EdgeFixing'; expected one of",
    ),
    (ALGORITHM, ALGORITHM + "\noperators.mutation = { margin = 3 }", 9, "mutation has no class"),
    (
        ALGORITHM,
        ALGORITHM + '\n[algorithms.operators]\nmutation = { class = "PathMutation", marign = 3 }\n[algorithms.parameters]',
        10,
        "PathMutation takes no argument 'marign'; did you mean 'margin'?",
    ),
    (ALGORITHM, ALGORITHM + '\noperators.mutation = { class = "PathMutation", margin = -3 }', 9, "margin"),
    (
        ALGORITHM,
        ALGORITHM + '\noperators.mutation = { class = "PathMutation", margin = "x" }',
        9,
        "margin is 'x', expected",
    ),
    (ALGORITHM, 'algorithm = "MOEAD"\noperators = { eliminate_duplicates = "RowDuplicates" }', 9, "takes no elim"),
    (ALGORITHM, ALGORITHM + '\nrepresentation = "cells"\noperators = "paper"', 7, "names no operators"),
    (ALGORITHM, 'algorithm = "NSDE"\noperators = "scalarized"', 9, "expected sampling or repair alone, such as { sampling = "),
    (ALGORITHM, 'algorithm = "NSDE"\noperators = { base = "random" }', 9, "NSDE makes children in a way of its own"),
    (ALGORITHM, 'algorithm = "NSDE"\noperators.mutation = "PathMutation"', 9, "NSDE takes no mutation, only sampling, repair"),
    (ALGORITHM, ALGORITHM + '\nobstacles = "limit"', 9, "obstacles 'limit' needs potential_limit"),
    (
        ALGORITHM,
        ALGORITHM + '\noperators.crossover = { class = "DiscreteSBX", prob = true }',
        9,
        "prob is True, expected",
    ),
    (
        ALGORITHM,
        ALGORITHM + '\noperators.crossover = { class = "DiscreteSBX", prob_var = [1] }',
        9,
        "prob_var is [1], exp",
    ),
    (ALGORITHM, ALGORITHM + '\noperators.crossover = "PointCrossover"', 9, "PointCrossover has no n_points, expected such as"),
    ("pop_size = 8", "pop_size = 0", 9, "pop_size is 0, expected a whole number of at least 1 and at most 100,000"),
    ("pop_size = 8", "pop_size = 10_000_000", 9, "pop_size is 10000000, expected a whole number of at least 1 and at"),
    (
        "pop_size = 8",
        "seeds = 5",
        9,
        "seeds is a key of the study, not of an algorithm; write it above",
    ),
    ("pop_size = 8", "[algorithms.parameters]\nseeds = 5", 10, "seeds is a key of the study, not of the parameters of an algo"),
    (
        "random = {",
        "budget = { generations = 5 }\nrandom = {",
        5,
        "budget is a key of the study, not of a problem",
    ),
    ('algorithm = "SPEA2"', 'algorithm = "NSGA-II"', 11, "is called 'NSGA2' too"),
    ('algorithm = "SPEA2"', 'name = "x"\nalgorithm = "NSGA-II"', 11, "is the same on the problem"),
    ("[[algorithms]]", "[[problems]]\nrandom = { size = 8, p0 = 0.1 }\n[[algorithms]]", 7, "is called 'random-8-0.1' too"),
    (
        "[[algorithms]]",
        "[[problems]]\nname = 'x'\nrandom = { size = 8, p0 = 0.1 }\n[[algorithms]]",
        7,
        "'random-8-0.1/1' (line 4)",
    ),
]


@pytest.mark.parametrize(("old", "new", "line", "message"), BAD, ids=[str(k) for k in range(len(BAD))])
def test_refused_with_line(tmp_path, old, new, line, message):
    text = PLAIN.replace(old, new, 1)
    error = refused(tmp_path, text)
    assert message in str(error)
    assert str(error).startswith(f"{tmp_path / 'tiny.toml'}, line {line}: "), str(error)
    assert "\n" not in str(error)


@pytest.mark.parametrize("key", ["problems", "algorithms", "seeds", "budget"])
def test_what_a_study_needs(tmp_path, key):
    lines = PLAIN.splitlines()
    kept = {"problems": lines[:3] + lines[6:], "algorithms": lines[:6], "seeds": lines[1:], "budget": lines[:1] + lines[2:]}
    error = refused(tmp_path, "\n".join(kept[key]))
    assert f"the study has no {'[[' + key + ']]' if key.endswith('ms') else key}" in str(error)


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("seeds = 3\nseeds = 4\n", 2, "cannot overwrite a value"),
        ("a = 1\nb = [1,\n", 2, "at the end of the file"),
        ("x = \n", 1, "invalid value"),
        ("[a]\n[a]\n", 2, "cannot declare"),
    ],
)
def test_syntax_errors_are_one_sentence(tmp_path, text, line, message):
    error = refused(tmp_path, text)
    assert error.line == line
    assert message in str(error)
    assert str(error).endswith("expected a TOML file")
    assert "\n" not in str(error)


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(StudyError, match="no such file"):
        load_study(tmp_path / "nothing.toml")
    (tmp_path / "latin.toml").write_bytes(b"seeds = 1\nname = '\xe4'\n")
    with pytest.raises(StudyError, match=r"latin\.toml, line 2: .*UTF-8"):
        load_study(tmp_path / "latin.toml")
    with pytest.raises(StudyError, match="cannot be read"):
        load_study(tmp_path)


def test_byte_order_mark_and_windows_lines(tmp_path):
    path = tmp_path / "windows.toml"
    path.write_bytes(b"\xef\xbb\xbf" + PLAIN.replace("\n", "\r\n").encode())
    assert load_study(path).seeds == (1, 2, 3)
    path.write_bytes(b"\xef\xbb\xbf" + PLAIN.replace("p0 = 0.1", "p0 = 2").replace("\n", "\r\n").encode())
    with pytest.raises(StudyError, match="line 5"):
        load_study(path)


def test_error_pickles():
    for error in (StudyError("no"), StudyError("no", ("problems", 0, "map")), StudyError("no", (), "x.toml", 3)):
        copy = pickle.loads(pickle.dumps(error))
        assert (str(copy), copy.where, copy.path, copy.line) == (str(error), error.where, error.path, error.line)
    assert str(StudyError("no", ("problems", 0, "map"))) == "problems[0].map: no"


# -- Python objects -----------------------------------------------------------------------------------------------------


def test_python_objects_make_the_same_study(tmp_path):
    study = Study(
        name="tiny",
        problems=[ProblemSpec(random=RandomFamily(size=8, p0=0.1, seeds=2))],
        algorithms=[AlgorithmSpec(algorithm="nsga-ii", pop_size=8), AlgorithmSpec(algorithm="SPEA2", pop_size=8)],
        seeds=range(1, 4),
        budget={"generations": np.int64(2)},
        folder=tmp_path,
    )
    loaded = load_study(write(tmp_path, PLAIN))
    assert study == loaded
    assert plan_study(study) == plan_study(loaded)


def test_to_dict_and_back(tmp_path):
    text = PLAIN + textwrap.dedent("""
        [[problems]]
        scen = "a.map.scen"
        queries = { first = 2, step = 3 }
        radius = 0.5
        obstacles = "limit"
        potential_limit = 3

        [[algorithms]]
        name = "own"
        algorithm = "MOEA/D"
        operators = { base = "random", crossover = { class = "SpliceCrossover", reach = 2 } }
        parameters = { n_neighbors = 7 }

        [[algorithms]]
        algorithm = "exact"
    """)
    study = load_study(write(tmp_path, text))
    tables = study.to_dict()
    assert Study.from_dict(tables, folder=tmp_path) == study
    assert tables["problems"][1]["queries"] == {"first": 2, "step": 3}
    assert "axis" not in tables["problems"][1]  # at its default


def test_errors_of_objects_name_the_place():
    with pytest.raises(StudyError, match=re.escape("random.p0: p0 is 2")):
        ProblemSpec(random={"size": 8, "p0": 2})
    with pytest.raises(StudyError, match=re.escape("operators.mutation: there is no mutation 'No'")):
        AlgorithmSpec(algorithm="NSGA2", operators={"mutation": "No"})
    with pytest.raises(StudyError, match=re.escape("problems[0].start: start is 3")):
        Study(problems=[{"map": "x", "start": 3}], algorithms=[{"algorithm": "exact"}], seeds=1, budget={"generations": 1})
    with pytest.raises(StudyError, match="before first"):
        QueryRange(first=3, last=2)
    grid = OccupancyGrid(np.zeros((4, 4)))
    with pytest.raises(StudyError, match="resolution is for maps from a file"):
        ProblemSpec(grid=grid, start=(0, 0), goal=(3, 3), resolution=0.5)
    study = Study(
        problems=[ProblemSpec(grid=grid, start=(0, 0), goal=(4, 4))],
        algorithms=[AlgorithmSpec(algorithm="exact")],
        seeds=1,
        budget={"generations": 1},
    )
    with pytest.raises(StudyError, match=re.escape("problems[0].start: goal (4, 4) lies outside")):
        plan_study(study)
    with pytest.raises(StudyError, match="no place in a study file"):
        study.to_dict()


# -- anything at all ----------------------------------------------------------------------------------------------------

WORDS = ["NSGA2", "exact", "cells", "penalty", "limit", "constraint", "paper", "warehouse", "x", "auto", "length", "", "a\nb"]
JUNK = st.recursive(
    st.one_of(st.none(), st.booleans(), st.integers(-3, 40), st.floats(), st.sampled_from(WORDS)),
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.dictionaries(st.sampled_from(["size", "p0", "seeds", "first", "last", "class", "mutation", "base", "x"]), inner),
    ),
    max_leaves=4,
)


@settings(max_examples=300, deadline=None)
@given(data=st.data())
def test_whatever_stands_in_a_study_it_is_taken_or_refused_in_words(data):
    tables = tomllib.loads(PLAIN)
    tables["problems"].append({"name": "shipped", "map": "paper16"})
    place = data.draw(st.sampled_from([tables, *tables["problems"], *tables["algorithms"]]))
    cls = Study if place is tables else AlgorithmSpec if place in tables["algorithms"] else ProblemSpec
    key = data.draw(st.sampled_from([item.name for item in dataclasses.fields(cls) if item.name not in ("folder", "source")]))
    place[key] = data.draw(JUNK)
    try:
        study = Study.from_dict(tables)
        assert Study.from_dict(study.to_dict()) == study
        plan_study(study)
    except StudyError as error:
        assert "\n" not in str(error)
        assert len(str(error)) < 600
