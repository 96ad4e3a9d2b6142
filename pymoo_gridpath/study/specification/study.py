"""What a comparison study is: problems, algorithms, seeds and a budget.

The classes are the tables of a study file, see `pymoo_gridpath.study.specification.toml_file`, and check themselves what can be
checked without reading a map. `plan_study` checks the rest.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from pymoo_gridpath import checks
from pymoo_gridpath.errors import GridPathError, StudyError
from pymoo_gridpath.study.specification import values
from pymoo_gridpath.study.specification.algorithm import AlgorithmSpec
from pymoo_gridpath.study.specification.base import make_spec, set_fields, to_table
from pymoo_gridpath.study.specification.problem import ProblemSpec, QueryRange, RandomFamily, problem_in
from pymoo_gridpath.study.specification.source import Source
from pymoo_gridpath.study.specification.values import Where

#: Seconds that the exact front which results are measured against may take, unless a study says otherwise.
REFERENCE_SECONDS = 60.0


@dataclass(frozen=True, kw_only=True)
class Study:
    """A comparison study: every algorithm on every problem with every seed.

    Parameters
    ----------
    problems : sequence of ProblemSpec
    algorithms : sequence of AlgorithmSpec
    seeds : int, sequence of int or mapping
        How many (from 1 on), a list, or ``{"first": 100, "count": 11}``.
    budget : mapping
        ``{"evaluations": n}`` or ``{"generations": n}`` of each run; None if the obstacles of all problems move, since runs on
        those end after their epochs.
    name : str, default "study"
    reference : mapping or False, optional
        Budget, ``max_seconds`` (60 by default) and ``max_labels``, of the exact front that results are measured against; False
        for none, so that they are measured against the best of all runs.
    target : float, default 0.95
        Share of the reference's hypervolume that "to target" asks for, above 0, at most 1.
    folder : path-like, default "."
        What the paths of maps, and of the files of objectives in tables, are relative to.

    Raises
    ------
    StudyError
        If a value is of a wrong type or out of its range, two problems or algorithms share a name, or there is none.

    Examples
    --------
    >>> study = Study(
    ...     problems=[ProblemSpec(random={"size": 16, "p0": 0.2, "seeds": 3})],
    ...     algorithms=[AlgorithmSpec(algorithm="NSGA2"), AlgorithmSpec(algorithm="SPEA2")],
    ...     seeds=5,
    ...     budget={"generations": 20},
    ... )
    >>> len(study.problems), len(study.algorithms), study.seeds
    (1, 2, (1, 2, 3, 4, 5))
    """

    problems: Any
    algorithms: Any
    seeds: Any
    budget: Any = None
    name: str = "study"
    reference: Any = field(default_factory=dict)
    target: float = 0.95
    folder: Any = Path()
    source: Source | None = field(default=None, compare=False, repr=False)

    def __post_init__(self):
        folder = Path(checks.file_path("folder", self.folder, StudyError))
        set_fields(
            self,
            name=values.text(self.name, ("name",)),
            problems=_specs(partial(problem_in, folder=folder), self.problems, "problems"),
            algorithms=_specs(partial(make_spec, AlgorithmSpec), self.algorithms, "algorithms"),
            seeds=values.seeds(self.seeds, ("seeds",)),
            budget=_budget(self.budget),
            reference=_reference(self.reference),
            target=values.real(self.target, ("target",), 0.0, 1.0, open_below=True),
            folder=folder,
        )
        moves = all(problem.moving is not None for problem in self.problems)
        if self.budget is None and not moves:
            raise _missing("budget")
        if self.budget is not None and moves:
            raise StudyError(
                "the study has a budget, and the obstacles of all its problems move, so that runs end after their epochs; "
                "expected none",
                ("budget",),
            )

    def error(self, message: str, where: Where) -> StudyError:
        """Return an error that says where in the study, or in its file, something is wrong."""
        message, where = checks.text("message", message), _as_place(where)
        return StudyError(message, where) if self.source is None else self.source.error(message, where)

    def line(self, where: Where) -> str:
        """Return where something stands, in words for a message: its line in the file, or its number in the list."""
        where = _as_place(where, 2)
        line = self.source.line(where) if self.source is not None else None
        return f"{where[0]}[{where[1]}]" if line is None else f"line {line}"

    @classmethod
    def from_dict(cls, data: Mapping[str, Any], **others) -> Study:
        """Return the study that the tables of a study file describe; ``others`` are arguments that no file holds.

        Raises
        ------
        StudyError
            If a key is unknown or missing, or as in the constructor.
        """
        known = [item.name for item in dataclasses.fields(cls) if item.name not in ("folder", "source")]
        data = values.table(data, ())
        values.check_keys(data, known, (), "the study")
        for key in ("problems", "algorithms", "seeds"):
            if key not in data:
                raise _missing(f"[[{key}]]" if key in ("problems", "algorithms") else key)
        return cls(**data, **others)

    def to_dict(self) -> dict[str, Any]:
        """Return the tables of a study file, without what is at its default; the inverse of `from_dict`."""
        return to_table(self)


def _missing(key: str) -> StudyError:
    return StudyError(f"the study has no {key}, expected problems, algorithms, seeds and a budget")


def _as_place(where: Where, least: int = 0) -> Where:
    """Return a place in a study if it is one, of at least so many parts."""
    expected = "a place in a study such as ('problems', 0)"
    place = tuple(checks.items("where", where, expected))
    if len(place) < least or not all(isinstance(part, str | int) for part in place):
        raise GridPathError(f"where is {checks.shown(where)}, expected {expected}")
    return place


def _specs(make: Callable[[Any, Where], Any], items: Any, key: str) -> tuple[Any, ...]:
    """Return one or more dataclasses with different labels."""
    if not isinstance(items, Sequence) or isinstance(items, str):
        raise StudyError(f"{key} is {values.show(items)}, expected one or more tables [[{key}]]", (key,))
    if not items:
        raise StudyError(f"the study has no {key}, expected one or more tables [[{key}]]", (key,))
    made = tuple(make(item, (key, k)) for k, item in enumerate(items))
    labels: dict[str, int] = {}
    for k, spec in enumerate(made):
        label = spec.label
        if label in labels:
            raise StudyError(
                f"{spec.owner} before is called {label!r} too; give one of the two another name",
                (key, k, "name"),
            )
        labels[label] = k
    return made


def _budget(value: Any) -> dict[str, int] | None:
    if value is None:
        return None
    if not isinstance(value, Mapping):
        raise StudyError(
            f"budget is {values.show(value)}, expected such as {{ evaluations = 20000 }} or {{ generations = 100 }}",
            ("budget",),
        )
    given = values.table(value, ("budget",))
    values.check_keys(given, ("evaluations", "generations"), ("budget",), "budget")
    if len(given) != 1:
        raise StudyError(
            f"budget has {len(given)} entries, expected either {{ evaluations = n }} or {{ generations = n }}", ("budget",)
        )
    return {key: values.whole(number, ("budget", key), 1, values.MAX_BUDGET) for key, number in given.items()}


def _reference(value: Any) -> dict[str, float | int | None] | bool:
    """Return the budget of the reference with its defaults, or False."""
    if value is False:
        return False
    if value is not True and not isinstance(value, Mapping):
        raise StudyError(
            f"reference is {values.show(value)}, expected such as {{ max_seconds = 60 }}, or false", ("reference",)
        )
    given = values.table({} if value is True else value, ("reference",))
    values.check_keys(given, ("max_seconds", "max_labels"), ("reference",), "reference")
    seconds, labels = given.get("max_seconds"), given.get("max_labels")
    return {
        "max_seconds": values.real(REFERENCE_SECONDS if seconds is None else seconds, ("reference", "max_seconds")),
        "max_labels": None if labels is None else values.whole(labels, ("reference", "max_labels"), 1),
    }


__all__ = ["AlgorithmSpec", "ProblemSpec", "QueryRange", "RandomFamily", "Study"]
