"""The algorithms of a study, as its file describes them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from pymoo.core.algorithm import Algorithm

from pymoo_gridpath.algorithms import CAPABILITIES
from pymoo_gridpath.algorithms.arguments import check_pop_size
from pymoo_gridpath.algorithms.known import registered_name
from pymoo_gridpath.errors import StudyError
from pymoo_gridpath.planners import Planner
from pymoo_gridpath.problems import OBSTACLES
from pymoo_gridpath.registry import SLOTS
from pymoo_gridpath.study.specification import made, own, values
from pymoo_gridpath.study.specification import operators as _operators
from pymoo_gridpath.study.specification.base import check_problem_settings, set_fields, set_given
from pymoo_gridpath.study.specification.kinds import ALGORITHM, operator_slots, takes_pop_size
from pymoo_gridpath.study.specification.parameters import accepted_parameters, parameters

PRESETS = ("ahmed-deb-2013",)


@dataclass(frozen=True, kw_only=True)
class AlgorithmSpec:
    """One table ``[[algorithms]]``: an algorithm of the capability table, a planner, or a preset.

    Parameters
    ----------
    algorithm : str, type, mapping or pymoo.core.algorithm.Algorithm, optional
        What `make_algorithm` takes; or an algorithm of your own: the path of its class,
        ``"package.module:Class"``, or the class. It is given those of ``pop_size`` and ``operators`` that its constructor
        takes. One that is registered is known by its name. An algorithm that is made already is taken as it is, as
        `make_algorithm` does; in a file it is a table of its ``class`` and all arguments, objects within it likewise. A planner
        means the same as its class with its arguments.
    preset : {"ahmed-deb-2013"}, optional
        In place of ``algorithm``: the planner of the paper, see `ahmed_deb_2013`, with its penalty of 1; it keeps the
        representation of a problem if that is one of the paper's, and takes "integer" otherwise.
    name : str, optional
        What tables call it; by default the algorithm's name: the one that it is registered by, or that of its class. Unique in
        a study.
    pop_size : int, optional
        By default 100, the preset's 500.
    smoothness : bool, optional
        Whether ties are broken by total turn, see `make_algorithm`.
    operators : str or mapping, default "default"
        "default", "paper", "scalarized", "random" (the last two are `path_operators`), or a mapping of ``sampling``,
        ``crossover``, ``mutation``, ``repair``, ``eliminate_duplicates``, ``selection`` and ``survival``, each the name of one
        of `pymoo_gridpath.operators.OPERATORS`, the path of a class, a mapping of ``class`` and its arguments, a class or an
        object; ``base`` says where the others come from.
    parameters : mapping, optional
        Further arguments of the algorithm or planner, such as ``n_neighbors``.
    max_seconds, max_labels : optional
        Budget of a planner that takes one; by default that of the study's reference if it is its planner.
    representation, obstacles, penalty, potential_limit, axis : optional
        Changes to the problems that it solves.

    Raises
    ------
    StudyError
        If a value is of a wrong type or out of its range, or they do not go together.
    """

    owner: ClassVar[str] = "an algorithm"

    algorithm: Any = None
    preset: str | None = None
    name: str | None = None
    pop_size: int | None = None
    smoothness: bool | None = None
    operators: Any = "default"
    parameters: Any = None
    max_seconds: float | None = None
    max_labels: int | None = None
    representation: Any = None
    obstacles: str | None = None
    penalty: float | None = None
    potential_limit: float | None = None
    axis: str | None = None

    def __post_init__(self):
        if (self.algorithm is None) == (self.preset is None):
            raise StudyError("the algorithm has no key algorithm and no preset, or both; expected one of them")
        set_given(self, "name", check=values.text)
        set_given(self, "preset", check=lambda value, where: values.choice(value, PRESETS, where))
        set_given(self, "pop_size", check=lambda value, where: values.told(where, check_pop_size, "an algorithm", value))
        set_given(self, "max_labels", check=lambda value, where: values.whole(value, where, 1))
        set_given(self, "smoothness", check=values.flag)
        set_given(self, "max_seconds", check=values.real)
        set_given(self, "obstacles", check=lambda value, where: values.choice(value, OBSTACLES, where))
        check_problem_settings(self)
        if isinstance(self.algorithm, Planner):
            self._take_planner(self.algorithm)
        elif isinstance(self.algorithm, Algorithm):
            set_fields(self, algorithm=made.table_of(self.algorithm, ("algorithm",)))
        elif isinstance(self.algorithm, Mapping):
            set_fields(self, algorithm=made.checked(self.algorithm, ("algorithm",)))
        elif self.algorithm is not None:
            set_fields(self, algorithm=_operators.read_algorithm(self.algorithm, ("algorithm",)))
        takes = self._takes()
        for key in ("pop_size", "smoothness", "operators", "parameters", "max_seconds", "max_labels"):
            value = getattr(self, key)
            given = value is not None and not (isinstance(value, str) and value == "default")
            if given and key not in takes:
                owner = "an algorithm that is made already" if self.is_made else self.algorithm or "the preset"
                raise StudyError(f"{owner} takes no {key}, only {' and '.join(takes) or 'a name'}", (key,))
        if "operators" in takes:
            set_fields(self, operators=_operators.operators(self.operators, ("operators",)))
            self._check_slots()
        if "parameters" in takes:
            found = parameters(str(self.algorithm), {} if self.parameters is None else self.parameters, ("parameters",))
            set_fields(self, parameters=found)
            self._gather_budget()

    def _takes(self) -> tuple[str, ...]:
        """Return the keys that say how the algorithm works."""
        if self.preset is not None:
            return ("pop_size",)
        if self.is_made:
            return ()
        planner = _operators.planner_of(self.algorithm)
        if planner is None and not own.is_path(self.algorithm):
            return ("pop_size", "smoothness", "operators", "parameters")
        cls = planner or own.read(self.algorithm, ALGORITHM, ("algorithm",)).cls
        return (
            *(_operators.own_budget(cls) if issubclass(cls, Planner) else ()),
            *["pop_size"] * takes_pop_size(cls),
            *["operators"] * bool(operator_slots(cls)),
            "parameters",
        )

    def _take_planner(self, planner: Planner) -> None:
        """Read a planner that is made already as its class with arguments: it means the same runs."""
        given = {key: value for key in ("pop_size", "operators", "parameters") if (value := getattr(self, key)) is not None}
        for key, value in given.items():
            if value != "default":
                raise StudyError(f"an algorithm that is made already takes no {key}, only a name", (key,))
        arguments = {key: value for key, value in made.table_of(planner, ("algorithm",)).items() if key != "class"}
        set_fields(self, algorithm=_operators.read_algorithm(type(planner), ("algorithm",)))
        # Budgets of what is none of this package stand among its other arguments.
        budgets = ("max_seconds", "max_labels") if _operators.planner_of(self.algorithm) is not None else ()
        for key in ("pop_size", *budgets):
            if key in arguments:
                value = arguments.pop(key)
                set_fields(self, **{key: float(value) if key == "max_seconds" else value})
        set_fields(self, parameters=arguments)

    def _gather_budget(self) -> None:
        """Put budgets of a planner that is none of this package among its other arguments."""
        if not own.is_path(self.algorithm):
            return
        for key in ("max_seconds", "max_labels"):
            value = getattr(self, key)
            if value is None:
                continue
            if key in self.parameters:
                raise StudyError(f"{key} stands among the parameters, too; expected it once", (key,))
            found = parameters(str(self.algorithm), {**self.parameters, key: value}, ("parameters",))
            set_fields(self, **{key: None, "parameters": found})

    def _check_slots(self) -> None:
        algorithm = str(self.algorithm)
        cls = own.read(algorithm, ALGORITHM, ("algorithm",)).cls if own.is_path(algorithm) else _operators.planner_of(algorithm)
        slots = list(SLOTS) if cls is not None and issubclass(cls, Planner) else list(accepted_parameters(algorithm))
        whole = bool({"crossover", "mutation"} & set(slots)) if cls is not None else CAPABILITIES[algorithm].takes_operators
        if not whole and self.operators["base"] != "default":
            raise StudyError(
                f"{algorithm} makes children in a way of its own, so that there is no set of operators for it; "
                f"expected sampling or repair alone, such as {{ sampling = 'ScalarizedSampling' }}",
                ("operators",),
            )
        for slot in self.operators:
            if slot != "base" and slot not in slots:
                takes = ", ".join(known for known in SLOTS if known in slots)
                raise StudyError(f"{algorithm} takes no {slot}, only {takes}", ("operators", slot))

    @property
    def label(self) -> str:
        """What tables call it."""
        algorithm = self.algorithm["class"] if self.is_made else self.algorithm
        if self.name or self.preset or not own.is_path(algorithm):
            return self.name or self.preset or str(algorithm)
        return registered_name(own.read(algorithm, ALGORITHM, ("algorithm",)).cls) or algorithm.rpartition(":")[2]

    @property
    def is_made(self) -> bool:
        """Whether it is an algorithm that is made already, and is taken as it is."""
        return isinstance(self.algorithm, Mapping)

    @property
    def overrides(self) -> dict[str, Any]:
        """What it changes in the problems that it solves."""
        keys = ("representation", "obstacles", "penalty", "potential_limit", "axis")
        return {key: getattr(self, key) for key in keys if getattr(self, key) is not None}
