"""What each of pymoo 0.6.2's multi-objective algorithms can do on a grid.

``tests/algorithms/test_algorithms_conformance.py`` checks the claims on small grids; of the algorithms that are
refused on every grid, only the reason for it.
"""

from __future__ import annotations

from dataclasses import dataclass

from pymoo_gridpath import checks


@dataclass(frozen=True)
class Capability:
    """What one algorithm can do on `GridPathProblem`.

    Attributes
    ----------
    name : str
        Its class in pymoo, and what `make_algorithm` calls it.
    module : str
        pymoo's module of the class.
    min_objectives : int
    max_objectives : int or None
        None: any number.
    constraints : bool
        Takes problems with constraints, ``obstacles="constraint"`` and ``"limit"``.
    takes_operators : bool
        Takes a crossover and a mutation. The others make children by differential evolution or swarm rules of their own.
    repair : bool
        Takes the paper's edge fixing as repair.
    needs : str
        "ref_dirs" (supplied by `make_algorithm` unless given), "ref_points" or "automated_dm" (the caller's); "" for nothing.
    dynamic : bool
        Made for problems that change with time; on a still one it spends evaluations on looking for a change.
    moving : bool
        Goes on where obstacles move, see `MovingObstaclesProblem`: all values that it keeps can be renewed.
    whole_numbers : bool
        Genes stay whole numbers, or bits, within their bounds.
    reproducible, reproducible_constrained : bool
        The same seed gives the same result without and with constraints.
    pickles : bool
        An algorithm that has run can be pickled.
    smoothness : bool
        Has a tie-break by total turn.
    extra : str
        A package that pymoo does not install but the algorithm imports; "" for none.
    one_child : bool
        The crossover must give one child of each mating.
    unpacks : bool
        pymoo's own constructor takes all that `path_operators` and `default_operators` return,
        ``cls(**path_operators(problem))``, and the run heeds it. Where it is False, `make_algorithm` fits them; see the note.
    unfit : str
        Why `make_algorithm` refuses it for every grid problem, a sentence without its subject; "" if it does not.
    note : str
        A sentence for the table.
    deterministic : bool
        Draws no random number, so that one run is enough.
    reference : bool
        Its result is the truth that others are measured against.
    takes_pop_size : bool
        `make_algorithm` takes a population size for it.
    takes_generations : bool
        It goes on for as many generations as it is given.
    cls : type or None
        The class, of an algorithm that is none of pymoo's; None: that of ``path``.
    """

    name: str
    module: str
    min_objectives: int = 2
    max_objectives: int | None = None
    constraints: bool = True
    takes_operators: bool = True
    repair: bool = True
    needs: str = ""
    dynamic: bool = False
    moving: bool = True
    whole_numbers: bool = True
    reproducible: bool = True
    reproducible_constrained: bool = True
    pickles: bool = True
    smoothness: bool = False
    extra: str = ""
    one_child: bool = False
    unpacks: bool = True
    unfit: str = ""
    note: str = ""
    deterministic: bool = False
    reference: bool = False
    takes_pop_size: bool = True
    takes_generations: bool = True
    cls: type | None = None

    @property
    def path(self) -> str:
        """Import path of pymoo's class."""
        return f"{self.module}.{self.name}"

    def takes(self, n_obj: int) -> bool:
        """Whether it takes problems of so many objectives."""
        n_obj = checks.whole("n_obj", n_obj, 1)
        return self.min_objectives <= n_obj and (self.max_objectives is None or n_obj <= self.max_objectives)


_MOO = "pymoo.algorithms.moo."
_LOCAL_FUNCTION = "Its tournament is a local function, which pickle refuses."
_UNSEEDED = (
    "Its tournament draws ties of the constraint violation from an unseeded generator and, a local function, does not pickle."
)
_DE = (
    "Children by differential evolution; genes are rounded by our mating and repair, since pymoo's cuts off fractions. "
    "pymoo's constructor takes no `eliminate_duplicates`."
)
_CONSTANT = "A constant objective counts as of the range 1, where pymoo's {}."
_PLAIN = "pymoo's constructor takes no `eliminate_duplicates`."
_SWARM = "moves particles in a continuous space, and grid codings are discrete"

_ROWS = (
    Capability(
        "NSGA2",
        _MOO + "nsga2",
        smoothness=True,
        note="The paper's; with smoothness: `SmoothnessTournament`, `RankAndSmoothness`.",
    ),
    Capability(
        "SPEA2",
        _MOO + "spea2",
        smoothness=True,
        note="With smoothness: `StrengthTournament` and `StrengthAndSmoothness`. "
        + _CONSTANT.format("compares what is no number"),
    ),
    Capability(
        "MOEAD",
        _MOO + "moead",
        needs="ref_dirs",
        smoothness=True,
        unpacks=False,
        note="pymoo's own refuses constraints; `make_algorithm` builds `SmoothMOEAD`, which compares the violation first. "
        + _PLAIN,
    ),
    Capability(
        "ParallelMOEAD",
        _MOO + "moead",
        constraints=False,
        needs="ref_dirs",
        one_child=True,
        unpacks=False,
        note="All children of a generation at once; with two children a mating it would mix those of different matings. "
        + _PLAIN,
    ),
    Capability("NSGA3", _MOO + "nsga3", needs="ref_dirs", reproducible_constrained=False, pickles=False, note=_UNSEEDED),
    Capability("UNSGA3", _MOO + "unsga3", needs="ref_dirs", reproducible_constrained=False, pickles=False, note=_UNSEEDED),
    Capability("RNSGA2", _MOO + "rnsga2", needs="ref_points", note="Searches near the given reference points."),
    Capability("RNSGA3", _MOO + "rnsga3", needs="ref_points", reproducible_constrained=False, pickles=False, note=_UNSEEDED),
    Capability(
        "DNSGA2",
        _MOO + "dnsga2",
        constraints=False,
        dynamic=True,
        smoothness=True,
        note="Asserts that there are no constraints.",
    ),
    Capability(
        "KGB",
        _MOO + "kgb",
        constraints=False,
        dynamic=True,
        smoothness=True,
        extra="scikit-learn",
        note="Asserts that there are no constraints. Members that it makes between others are rounded.",
    ),
    Capability(
        "PINSGA2",
        _MOO + "pinsga2",
        max_objectives=2,
        constraints=False,
        needs="automated_dm",
        pickles=False,
        note="Stops with an error while no path is feasible, and with three objectives when it fits a value function.",
    ),
    Capability("SMSEMOA", _MOO + "sms", pickles=False, note=_LOCAL_FUNCTION),
    Capability(
        "AGEMOEA",
        _MOO + "age",
        extra="numba",
        note=_CONSTANT.format("counts rounding as a range, or compares what is no number"),
    ),
    Capability(
        "AGEMOEA2",
        _MOO + "age2",
        extra="numba",
        note=_CONSTANT.format("counts rounding as a range, and stops with an error at a front of one point"),
    ),
    Capability(
        "CTAEA",
        _MOO + "ctaea",
        needs="ref_dirs",
        moving=False,
        one_child=True,
        pickles=False,
        unpacks=False,
        note=_LOCAL_FUNCTION
        + " The operators' crossover gives two children, and a first population with duplicates never ends. "
        "Refuses obstacles that move, since the values in its second archive cannot be renewed.",
    ),
    Capability(
        "RVEA",
        _MOO + "rvea",
        needs="ref_dirs",
        note="Needs a termination by generations or evaluations; keeps one path a direction, so the population shrinks. "
        + _CONSTANT.format("makes directions that are no numbers, and stands still"),
    ),
    Capability("OmniOptimizer", _MOO + "omni", min_objectives=1, note="Keeps paths that differ in genes alone."),
    Capability("NSDE", _MOO + "nsde", takes_operators=False, unpacks=False, note=_DE),
    Capability("NSDER", _MOO + "nsder", takes_operators=False, unpacks=False, needs="ref_dirs", note=_DE),
    Capability("GDE3", _MOO + "gde3", takes_operators=False, unpacks=False, note=_DE),
    Capability("GDE3MNN", _MOO + "gde3", takes_operators=False, unpacks=False, note=_DE),
    Capability(
        "GDE32NN",
        _MOO + "gde3",
        takes_operators=False,
        unpacks=False,
        unfit="stops with an error when a front has only one or two distinct members, as fronts on grids have",
        note="GDE3 or GDE3MNN do instead.",
    ),
    Capability(
        "GDE3PCD",
        _MOO + "gde3",
        takes_operators=False,
        unpacks=False,
        unfit="crashes Python (in its compiled crowding) when a front has few distinct members, as fronts on grids have",
        note="GDE3 or GDE3MNN do instead.",
    ),
    Capability(
        "CMOPSO",
        _MOO + "cmopso",
        takes_operators=False,
        unpacks=False,
        repair=False,
        whole_numbers=False,
        reproducible=False,
        reproducible_constrained=False,
        unfit=_SWARM,
        note="Truncates its archive without the seed, and calls a repair without the random state that edge fixing needs.",
    ),
    Capability(
        "MOPSO_CD",
        _MOO + "mopso_cd",
        takes_operators=False,
        unpacks=False,
        repair=False,
        whole_numbers=False,
        unfit=_SWARM,
        note="Takes no repair.",
    ),
    Capability(
        "GA",
        "pymoo.algorithms.soo.nonconvex.ga",
        min_objectives=1,
        max_objectives=1,
        pickles=False,
        note="For one objective, as in the paper's single-objective runs. " + _LOCAL_FUNCTION,
    ),
)

#: The capability of each algorithm by name.
CAPABILITIES: dict[str, Capability] = {row.name: row for row in _ROWS}

_HEAD = (
    "Algorithm",
    "Objectives",
    "Constraints",
    "Operators",
    "Unpacks",
    "Repair",
    "Needs",
    "Whole numbers",
    "Same seed, same result",
    "Pickles",
    "Smoothness",
    "Usable on grids",
    "Note",
)


def capability_table() -> str:
    """Return the capability table as Markdown, one row an algorithm.

    Returns
    -------
    str

    Examples
    --------
    >>> print(capability_table().splitlines()[0][:40])
    | Algorithm | Objectives | Constraints |
    """
    rows = [_HEAD, ("---",) * len(_HEAD), *(_cells(row) for row in _ROWS)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in rows)


def _cells(row: Capability) -> tuple[str, ...]:
    if row.max_objectives == row.min_objectives:
        objectives = str(row.min_objectives)
    else:
        objectives = (
            f"{row.min_objectives} or more" if row.max_objectives is None else f"{row.min_objectives} to {row.max_objectives}"
        )
    needs = [f"`{row.needs}`"] if row.needs else []
    if row.extra:
        needs.append(f"package {row.extra}")
    if row.dynamic:
        needs.append("a changing problem to be of use")
    same = "without constraints" if row.reproducible and not row.reproducible_constrained else _yes(row.reproducible)
    return (
        row.name,
        objectives,
        _yes(row.constraints),
        _yes(row.takes_operators),
        _yes(row.unpacks),
        _yes(row.repair),
        ", ".join(needs) or "nothing",
        _yes(row.whole_numbers),
        same,
        _yes(row.pickles),
        _yes(row.smoothness),
        f"no: {row.unfit}" if row.unfit else "yes",
        row.note,
    )


def _yes(value: bool) -> str:
    return "yes" if value else "no"
