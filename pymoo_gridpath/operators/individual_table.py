"""Individuals whose values lie in the rows of a table until somebody asks for them."""

from __future__ import annotations

import weakref
from collections import deque
from collections.abc import Iterable, Sequence
from itertools import repeat
from operator import attrgetter
from typing import Any

import numpy as np
from pymoo.core.individual import Individual, calc_cv, default_config

_EMPTY = np.array([])
_EMPTY.flags.writeable = False

# What a pymoo individual keeps of its own; all other keys are data.
_PROPERTIES = ("X", "F", "G", "H", "dF", "dG", "dH", "ddF", "ddG", "ddH", "CV")
_RESERVED = frozenset(vars(Individual()))

# Where a table of objects has no value.
ABSENT = object()

# Weak references that are made at a time.
_AT_A_TIME = 64


class LightIndividual(Individual):
    """A pymoo individual that shares what a constructor would set to the same for all: empty values until they are set."""

    # Those of `TableIndividual`, so that one can become the other.
    __slots__ = ("_row", "_table")

    _F = _G = _H = _dF = _dG = _dH = _ddF = _ddG = _ddH = _EMPTY
    _CV = None

    @classmethod
    def bare(cls) -> LightIndividual:
        """Return one that is still to get what tells it from others."""
        return cls.__new__(cls)

    @classmethod
    def of(cls, genes: np.ndarray, config: dict) -> LightIndividual:
        """Return a new individual, not evaluated, with a copy of these genes."""
        one = cls.bare()
        one._X, one.evaluated, one.data, one.config = genes.copy(), set(), {}, config
        return one


class TableIndividual(Individual):
    """A row of a table, which becomes an ordinary individual, of the same identity, when anything of it is read or set.

    So its values are kept in one place at any time. Only `ArrayPopulation` reads and writes rows as they are. Copies and
    pickles are ordinary individuals.
    """

    __slots__ = ("_row", "_table")

    # Who looks behind the attributes is to find what is there in other individuals.
    @property
    def __dict__(self):  # pyright: ignore
        return vars(self.become_ordinary())

    def __getattr__(self, name):
        if name.startswith("__"):
            # Of a protocol, which asks all objects; pymoo's individuals have none of their own.
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
        return getattr(self.become_ordinary(), name)

    def __setattr__(self, name, value):
        setattr(self.become_ordinary(), name, value)

    def __delattr__(self, name):
        delattr(self.become_ordinary(), name)

    def __reduce_ex__(self, protocol):
        return LightIndividual.bare, (), self._table.row(self._row)

    def __copy__(self):
        # It shares arrays with this one.
        return LightIndividual.copy(self.become_ordinary(), deep=False)

    def new(self):
        return LightIndividual()

    def become_ordinary(self) -> LightIndividual:
        """Leave the table, and return the same individual."""
        table, row = self._table, self._row
        table.n_left += 1
        object.__setattr__(self, "__class__", LightIndividual)
        vars(self).update(table.row(row))
        del self._table, self._row
        return self  # pyright: ignore


# What reads and sets them without asking the individual.
table_of, row_of = attrgetter("_table"), attrgetter("_row")
_set_table, _set_row = TableIndividual._table.__set__, TableIndividual._row.__set__  # pyright: ignore


class Table:
    """Values of individuals: an array a key, a row an individual, all keys for all rows.

    Arrays are replaced and never written to. Those of type object hold values of any type, and `ABSENT` where an individual
    has none.

    Parameters
    ----------
    n : int
        Number of rows.
    columns : dict of str to numpy.ndarray, shape (n, ...)
    evaluated : frozenset of str
        What has been evaluated of each individual.

    Attributes
    ----------
    n_left : int
        How many individuals have left the table for another one, or have become ordinary.
    """

    def __init__(self, n: int, columns: dict[str, np.ndarray], evaluated: frozenset[str] = frozenset()):
        self.n, self.columns, self.evaluated = n, columns, evaluated
        self.n_left = 0
        self._config = default_config()
        self._dead: list[Individual] = []

    def individuals(self) -> list[TableIndividual]:
        """Return new individuals, one a row."""
        made = list(map(TableIndividual.__new__, repeat(TableIndividual, self.n)))
        self._seat(made)
        return made

    def take(self, individuals: list[TableIndividual]) -> None:
        """Have individuals of other tables, one a row; who is there twice has the last."""
        for table in set(map(table_of, individuals)):
            table.n_left += 1
            self._dead += table._dead
            table._dead = []
        self._seat(individuals)

    def _seat(self, individuals: list[TableIndividual]) -> None:
        deque(map(_set_table, individuals, repeat(self)), maxlen=0)
        deque(map(_set_row, individuals, range(self.n)), maxlen=0)

    def row(self, row: int) -> dict[str, Any]:
        """Return the attributes of the ordinary individual that a row becomes."""
        data: dict[str, Any] = {}
        own = {"evaluated": set(self.evaluated), "data": data, "config": self._config}
        for key, column in self.columns.items():
            value = column[row]
            if value is ABSENT:
                continue
            if column.ndim > 1:
                value = value.copy()
            if key in _PROPERTIES:
                own[f"_{key}"] = value
            else:
                data[key] = value
        return own

    def column(self, key: str) -> np.ndarray | None:
        """Return the values of a key as far as they are of a number type, not to be written to; else None."""
        if key in ("CV", "FEAS", "cv", "feas"):
            cv = self._violation()
            cv = cv if key.lower() == "cv" else cv <= 0.0
            return cv[:, 0] if key.islower() else cv
        if key in ("x", "f"):
            column = self.columns.get(key.upper())
            return column if key == "x" or column is None else column[:, 0]
        column = self.columns.get(key)
        return np.empty((self.n, 0)) if column is None and key in _PROPERTIES else column

    def _violation(self) -> np.ndarray:
        """Return the constraint violations, worked out if they have not been yet, as each individual would."""
        if "CV" not in self.columns:
            G, H = (self.column(key) for key in "GH")
            assert G is not None and H is not None
            if G.shape[1] == 1 and H.shape[1] == 0:
                cv = np.maximum(0.0, G) + 0.0
            else:
                cv = np.array([calc_cv(g, h, self._config) for g, h in zip(G, H, strict=True)]).reshape(-1, 1)
            self.columns["CV"] = cv
        return self.columns["CV"]

    def bury(self, individuals: Iterable[Individual]) -> None:
        """Note who has not survived, see `forget`."""
        self._dead += individuals

    def forget(self) -> None:
        """Make ordinary individuals of those who have not survived but are kept by somebody, who is to keep no whole table."""
        while self._dead:
            # Few at a time: many new objects call Python's garbage collector, which would take a tenth of a run.
            references = list(map(weakref.ref, self._dead[-_AT_A_TIME:]))
            del self._dead[-_AT_A_TIME:]
            for one in [one for reference in references if (one := reference()) is not None]:
                if type(one) is TableIndividual:
                    one.become_ordinary()


def is_data(key: str) -> bool:
    """Return whether individuals keep the values of a key with their data, and not as an attribute."""
    return key not in _RESERVED and not hasattr(Individual, key)


def column_of(key: str, values, n: int) -> np.ndarray | None:
    """Return values that are set to a key of n individuals as a column of a table, or None if they do not fit in."""
    if key not in _PROPERTIES and not is_data(key):
        return None
    if isinstance(values, np.ndarray) and values.dtype.kind in "biuf" and values.ndim and len(values) == n:
        return values.copy() if values.ndim == 2 or key not in _PROPERTIES else None
    if key in _PROPERTIES or (hasattr(values, "__len__") and not isinstance(values, str)):
        return None
    column = np.empty(n, dtype=object)
    column.fill(values)
    return column


def joined(n: int, columns: Sequence[np.ndarray | list | None], places: list) -> np.ndarray | None:
    """Return n values from where they stand in arrays, if those are of the same type and shape, else None."""
    first = columns[0]
    for column in columns:
        if not isinstance(column, np.ndarray) or not isinstance(first, np.ndarray):
            return None
        if column.dtype != first.dtype or column.shape[1:] != first.shape[1:]:
            return None
    assert isinstance(first, np.ndarray)
    if len(columns) == 1:
        # No view, which somebody might write to.
        return first.copy() if first.base is not None else first
    values = np.empty((n, *first.shape[1:]), dtype=first.dtype)
    for column, place in zip(columns, places, strict=True):
        values[place] = column
    return values


def joined_as_objects(key: str, n: int, columns: list[np.ndarray | None], places: list) -> np.ndarray | None:
    """Return n values of different types as a column, with nothing where a table has none; None if it cannot be."""
    if key in _PROPERTIES or any(column is not None and column.ndim > 1 for column in columns):
        return None
    values = np.full(n, ABSENT, dtype=object)
    for column, place in zip(columns, places, strict=True):
        if column is not None:
            values[place] = list(column)
    return values
