"""Rules that stand in one place: whoever writes one down a second time is named here.

A rule is looked for by what it cannot do without: its numbers, its names, or the shape of its expression. Each search is tried
on a second definition that is planted, so that it can fail. The room `testing` is left out: it holds slow second ways on
purpose, to check the first ones against.
"""

from __future__ import annotations

import ast
import functools
import re
from collections.abc import Iterator
from importlib.resources import files

import pytest
from test_house import MODULES

from pymoo_gridpath.operators.sets import MEMBERS
from pymoo_gridpath.planners import PLANNERS

TREES = {name: ast.parse(path.read_text()) for name, path in MODULES.items() if name.split(".")[0] != "testing"}

Found = Iterator[ast.AST]


@functools.cache
def walked(tree: ast.AST) -> list[ast.AST]:
    return list(ast.walk(tree))


def nodes(tree: ast.AST, *kinds: type) -> Iterator:
    return (node for node in walked(tree) if isinstance(node, kinds))


@functools.cache
def source_of(node: ast.AST) -> str:
    return ast.unparse(node)


def says(node: ast.AST, pattern: str) -> bool:
    return re.search(pattern, source_of(node)) is not None


def is_number(node: ast.AST | None, *values: float) -> bool:
    return isinstance(node, ast.Constant) and type(node.value) in (int, float) and node.value in values


def defines(node: ast.AST, pattern: str) -> bool:
    """Whether a node gives a module or class a name."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return re.fullmatch(pattern, node.name) is not None
    targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
    return any(re.fullmatch(pattern, name.id) for target in targets for name in nodes(target, ast.Name))


# -- what each rule cannot do without -----------------------------------------------------------------------------------------


def default_representation(tree) -> Found:
    """The name of the paper's coding, or a choice of codings by whether corners may be cut."""
    for node in nodes(tree, ast.Constant, ast.IfExp, ast.If):
        if isinstance(node, ast.Constant):
            if node.value == "integer":
                yield node
        elif says(node.test, "corner_cutting") and says(node, r"(Integer|Mixed|Binary|Absolute)Representation|CellSequence"):
            yield node


def query_of_a_map(tree) -> Found:
    """A format asked for the query of a file, or a cell that is taken from there where none is given."""
    for node in nodes(tree, ast.Call, ast.BoolOp):
        if isinstance(node, ast.Call):
            if isinstance(node.func, ast.Attribute) and node.func.attr == "query" and not says(node.func.value, "_tree$"):
                yield node
        elif (
            isinstance(node.op, ast.Or) and isinstance(node.values[0], ast.Name) and says(node.values[-1], r"\w\.(start|goal)$")
        ):
            yield node


def radius_of_a_robot(tree) -> Found:
    """Metres made cells, or a distance compared with it."""
    for node in nodes(tree, ast.BinOp, ast.Compare):
        if says(node, "radius") and says(node, "resolution|clearance|distance"):
            yield node


def penalties(tree) -> Found:
    """A penalty named or worked out, or added to objectives."""
    for node in nodes(tree, ast.FunctionDef, ast.Assign, ast.BinOp):
        if isinstance(node, ast.BinOp):
            if isinstance(node.op, ast.Mult) and says(node, "penalty"):
                yield node
        elif defines(node, "(?!_check).*(PENALTY|_penalty|_treatment)"):
            yield node


def operator_sets(tree) -> Found:
    """Four operators or more that go together."""
    for node in nodes(tree, ast.Dict, ast.Tuple, ast.List, ast.Set):
        parts = node.keys if isinstance(node, ast.Dict) else node.elts
        if sum(isinstance(part, ast.Constant) and part.value in MEMBERS for part in parts) >= 4:
            yield node


def numbers_of_the_paper(tree) -> Found:
    """500 members and generations; rates and indices of its operators, by name or as a default."""
    for node in nodes(tree, ast.Constant, ast.Assign, ast.arguments, ast.keyword):
        if isinstance(node, ast.arguments):
            named = [*node.posonlyargs, *node.args][-len(node.defaults) :] if node.defaults else []
            pairs = [*zip(named, node.defaults, strict=True), *zip(node.kwonlyargs, node.kw_defaults, strict=True)]
            if any(re.match("prob$|eta", arg.arg) and is_number(default, 0.9, 10, 20) for arg, default in pairs):
                yield node
        elif isinstance(node, ast.keyword):
            if node.arg and re.match("prob$|eta", node.arg) and is_number(node.value, 0.9, 10, 20):
                yield node
        elif defines(node, "CROSSOVER_RATE|ETA_.*|POP_SIZE|N_GEN") or (is_number(node, 500) and isinstance(node.value, int)):
            yield node


def headings(tree) -> Found:
    """Steps to neighbours in a list, degrees between them, the turn from one to another, and the way back."""
    for node in nodes(tree, ast.Tuple, ast.List, ast.Set, ast.Constant, ast.BinOp):
        if isinstance(node, ast.BinOp):
            if isinstance(node.op, ast.Sub) and is_number(node.left, 8):
                yield node
            if isinstance(node.op, ast.Mod) and is_number(node.right, 8) and says(node.left, r"\+ 4$"):
                yield node
        elif isinstance(node, ast.Constant):
            if is_number(node, 45):
                yield node
        elif len(node.elts) >= 4 and all(_is_step(part) for part in node.elts):
            yield node


def _is_step(node: ast.AST) -> bool:
    try:
        step = ast.literal_eval(node)
    except ValueError:
        return False
    return isinstance(step, tuple) and len(step) == 2 and set(step) <= {-1, 0, 1}


def legality(tree) -> Found:
    """Paths told apart by the cells that they cross."""
    for node in nodes(tree, ast.Compare):
        if says(node, "interfering") and any(is_number(one, 0) for one in node.comparators):
            yield node


def corners(tree) -> Found:
    """What asks whether corners may be cut, but for words; what puts together the cells beside a diagonal step; the rule."""
    for node in nodes(tree, ast.If, ast.IfExp, ast.BoolOp, ast.BinOp, ast.UnaryOp, ast.Compare, ast.FunctionDef):
        if isinstance(node, ast.FunctionDef):
            if defines(node, "may_pass|crossings"):
                yield node
            continue
        operands = [getattr(node, name) for name in ("test", "left", "right", "operand") if hasattr(node, name)]
        operands += getattr(node, "values", [])
        asks = any(isinstance(one, ast.Attribute) and says(one, "[.]_?corner_cutting$") for one in operands)
        if (asks and not says(node, "be cut")) or {"across", "up"} <= {_beside(one) for one in operands}:
            yield node


def _beside(node: ast.AST) -> str | None:
    """Return in which direction from the start of a step a field is looked at, if it is one of the two alone."""
    while isinstance(node, ast.UnaryOp):
        node = node.operand
    if not isinstance(node, ast.Subscript | ast.Call):
        return None
    across, up = says(node, r"\bdx\b|\[:-1, 1:\]"), says(node, r"\bdy\b|\[1:, :-1\]")
    return None if across == up else "across" if across else "up"


def exit_codes(tree) -> Found:
    """A status by its name or number."""
    for node in nodes(tree, ast.Assign, ast.Call):
        if isinstance(node, ast.Call):
            if says(node.func, r"(^|\.)(exit|_exit|SystemExit)$") and any(isinstance(one, ast.Constant) for one in node.args):
                yield node
        elif defines(node, "EXIT_.*"):
            yield node


def exit_codes_returned(tree) -> Found:
    return (node for node in nodes(tree, ast.Return) if is_number(node.value, 0, 1, 2, 130))


def digest_of_a_grid(tree) -> Found:
    """A hash of cells."""
    for node in nodes(tree, ast.FunctionDef):
        if (says(node, r"hashlib|sha\d+\(|md5\(|blake") and says(node, "occupied")) or defines(node, "(.*_)?digest"):
            yield node


def records_of_convergence(tree) -> Found:
    """Legal members of a population and the front of these, or what is recorded of both."""
    recorded = (
        r"interfering|nondominated|NonDominated|[.]F\[\w+[.]front\(\)|(?s:evaluator.n_eval.*n_legal|n_legal.*evaluator.n_eval)"
    )
    for node in nodes(tree, ast.ClassDef):
        follows = any(says(base, "Callback|Output|Termination") for base in node.bases)
        if defines(node, "Members|Snapshot") or (follows and says(node, recorded)):
            yield node


# Where each stands: the rule, and what is no second one of it.
RULES = {
    # The name of the coding, which is taken, and which the paper's planner takes.
    default_representation: {"representations.integer", "representations.factory", "algorithms.paper"},
    query_of_a_map: {"maps.queries"},
    radius_of_a_robot: {"grid.grown"},
    # That of a problem, and that of the paper's planner.
    penalties: {"problems.grid_path", "algorithms.paper"},
    # What each derives from, by which it is registered; and what a file says of a run, by where pymoo's algorithms hold it.
    operator_sets: {"operators.sets", "registry", "decision.provenance"},
    # Of the planner, and of the operators. Luminance is rounded by half of 1000, and a map has 500 cells a side.
    numbers_of_the_paper: {"algorithms.paper", "operators.parameters", "maps.image", "problems.scenarios"},
    # Names of paths are written beside their ends, at angles.
    headings: {"neighbourhood", "plotting.labels"},
    # And whether a path of cells has to be mended, which is no question of limits.
    legality: {"problems.members", "representations.cell_sequence"},
    corners: {"neighbourhood"},
    # A worker that nobody waits for any more ends itself.
    exit_codes: {"cli.arguments", "study.running.processes"},
    digest_of_a_grid: {"grid.cells"},
    records_of_convergence: {"problems.members"},
}

PLANTED = {
    default_representation: ["kind = 'integer' if axis else None", "c = CellSequence if not grid.corner_cutting else Mine"],
    query_of_a_map: ["known = some_format.query(path)", "start = given or known.start"],
    radius_of_a_robot: ["cells = radius / grid.resolution", "free = clearance(grid) > arguments.radius"],
    penalties: ["DEFAULT_PENALTY = 3.0", "def default_penalty(): ...", "F += problem.penalty * crossed[:, None]"],
    operator_sets: ["s = {'sampling': A(), 'crossover': B(), 'mutation': C(), 'repair': D()}"],
    numbers_of_the_paper: ["run(pop_size=500)", "def f(self, prob=0.9): ...", "SBX(eta=10.0)", "N_GEN = 400"],
    headings: ["STEPS = ((1, 0), (0, 1), (-1, 0), (0, -1))", "turn = 45 * n", "t = min(d, 8 - d)", "b = (m + 4) % 8"],
    legality: [
        "legal = pop.get('interfering_cells') == 0",
        "ok = not paths.interfering_cells > 0",
    ],
    exit_codes: ["sys.exit(3)", "raise SystemExit(1)", "EXIT_FAILED = 4"],
    digest_of_a_grid: ["def name(grid):\n    return hashlib.sha256(grid.occupied.tobytes())", "def grid_digest(grid): ..."],
    corners: [
        "if not grid.corner_cutting:\n    diagonal = diagonal & free",
        "legal = free | (beside & ~self._grid.corner_cutting)",
        "rising = free[:-1, 1:] & free[1:, :-1]",
        "def open(free, x, y, dx, dy):\n    return free[y, x + dx] and free[y + dy, x]",
        "count += occupied.take(cell + dx) + occupied.take(cell + dy * width)",
        "cut = ~(shifted(free, dx, 0) & shifted(free, 0, dy))",
    ],
    records_of_convergence: [
        "class R(Callback):\n    def _update(self, a):\n        m = Members(a)\n        self.fronts.append(m.F[m.front()])",
        "class R(Callback):\n    def _update(self, a):\n        self.rows += [(a.evaluator.n_eval, Members(a).n_legal)]",
        "class R(Callback):\n    def notify(self, a):\n        self.n = (a.pop.get('interfering_cells') == 0).sum()",
        "class Mine(callback.Callback):\n    def _update(self, a):\n        keep = moocore.is_nondominated(F)",
    ],
}


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_a_rule_stands_in_one_place(rule):
    places = {name: [node.lineno for node in rule(tree) if hasattr(node, "lineno")] for name, tree in TREES.items()}
    assert {name: lines for name, lines in places.items() if lines and name not in RULES[rule]} == {}
    # Else it would be found nowhere, once the rule is written in another way.
    assert all(any(rule(TREES[name])) for name in RULES[rule])


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_a_second_definition_is_found(rule):
    for source in PLANTED[rule]:
        assert any(rule(ast.parse(source))), source


def test_commands_return_exit_codes_by_name():
    for name, tree in TREES.items():
        if name.split(".")[0] == "cli":
            assert not [node.lineno for node in exit_codes_returned(tree)], name
    assert any(exit_codes_returned(ast.parse("def run():\n    return 2")))


def test_twelve_rules_are_counted():
    assert len(RULES) == len(PLANTED) == 12


# -- planners ---------------------------------------------------------------------------------------------------------


def knows_a_planner(tree: ast.AST, name: str, cls: str) -> Found:
    """A planner's name as a value, or its class."""
    for node in nodes(tree, ast.Constant, ast.Name, ast.Attribute, ast.alias):
        if isinstance(node, ast.Constant):
            if isinstance(node.value, str) and node.value.lower() in (name.lower(), cls.lower()):
                yield node
        elif isinstance(node, ast.alias):
            if cls in (node.name.rpartition(".")[2], node.asname):
                yield node
        elif cls == (node.id if isinstance(node, ast.Name) else node.attr):
            yield node


def test_no_place_but_its_own_knows_a_planner():
    """Not by its name, not by its class: what it can do stands on it."""
    for name in PLANNERS:
        planner = PLANNERS[name]
        if not planner.__module__.startswith("pymoo_gridpath."):
            continue
        home = planner.__module__.removeprefix("pymoo_gridpath.")
        known = {place for place, tree in TREES.items() if any(knows_a_planner(tree, name, planner.__name__))}
        # Lists of public names say which there are.
        known -= {place for place in known if MODULES[place].name == "__init__.py"}
        # A report calls a front so, whoever found it: the whole truth, or the best of all runs.
        # And a map format goes by the same three letters as a planner.
        assert known - {home, "study.report.references", "maps.ros"} == set()
        assert home in known


def test_a_place_that_knows_a_planner_is_found():
    for source in ("if name == 'exact': ...", "isinstance(a, ExactFront)", "from x import ExactFront", "p.ExactFront()"):
        assert any(knows_a_planner(ast.parse(source), "exact", "ExactFront")), source


def test_the_starting_study_names_a_planner_as_its_author_would():
    """It is a file for users to change, and names one that there is in a comment, as it names algorithms."""
    text = files("pymoo_gridpath.study.specification").joinpath("starter.toml").read_text(encoding="utf-8")
    named = set(re.findall(r'^#? ?algorithm = "([^":]+)"', text, re.MULTILINE))
    assert {name for name in named if name in PLANNERS} == {"exact"}
