"""Populations that are read and written as arrays; pymoo's look every value up in three places, one individual at a time."""

from __future__ import annotations

from operator import attrgetter
from typing import NamedTuple

import numpy as np
from pymoo.core.individual import default_config
from pymoo.core.population import Population, interleaving_args

from pymoo_gridpath.operators.individual_table import (
    ABSENT,
    LightIndividual,
    Table,
    TableIndividual,
    column_of,
    is_data,
    joined,
    joined_as_objects,
    row_of,
    table_of,
)

_WHOLE = slice(None)


class _Part(NamedTuple):
    """Those of a population that are rows of one table, or of none: where they stand in the population, and in the table."""

    table: Table | None
    places: np.ndarray | slice
    rows: np.ndarray | slice


class ArrayPopulation(Population):
    """A pymoo population whose `get` and `set` mean the same and cost about a fifth, and far less where nobody else asks.

    Its individuals are ordinary ones, so that it can be mixed with pymoo's own populations at will:
    ``pop.view(ArrayPopulation)`` is the same population. All are to have the same attributes. Those of `in_table` keep their
    values in the rows of a table until anything of them is read or set, see `TableIndividual`; only `get` and `set` of this
    class read and write the rows as they are.
    """

    # Where the individuals were found, with what tells whether they still are there; no view or copy has it.
    _found: tuple[list, list[_Part], list[int]] | None = None

    @classmethod
    def of(cls, X: np.ndarray) -> ArrayPopulation:
        """Return a population of new individuals with the genes X, shape (N, n_var)."""
        config = default_config()
        return _population([LightIndividual.of(genes, config) for genes in X], cls)

    @classmethod
    def in_table(cls, X: np.ndarray) -> ArrayPopulation:
        """Return the same with values in a table until somebody asks an individual for one."""
        table = Table(len(X), {"X": X.copy()})
        pop = _population(table.individuals(), cls)
        pop._found = pop.tolist(), [_Part(table, _WHOLE, _WHOLE)], [0]
        return pop

    def get(self, *args, to_numpy: bool = True, **kwargs):
        """Return the values of one or more keys, as `pymoo.core.population.Population.get`."""
        if self.ndim != 1:
            return super().get(*args, to_numpy=to_numpy, **kwargs)
        individuals = self.tolist()
        if not to_numpy:
            values = [_read(individuals, key) for key in args]
        elif not individuals:
            values = [np.array([]) for _ in args]
        else:
            values = [self._array(individuals, key) for key in args]
        return values[0] if len(values) == 1 else tuple(values)

    def set(self, *args, **kwargs):
        """Set values by key, from arrays of one row an individual, as `pymoo.core.population.Population.set`."""
        if self.ndim != 1:
            return super().set(*args, **kwargs)
        individuals = self.tolist()
        if not individuals:
            return None
        given = interleaving_args(*args, kwargs=kwargs)
        columns = {key: column_of(key, values, len(individuals)) for key, values in given.items()}
        chosen: list[int] | None = None
        if all(column is not None for column in columns.values()):
            if self._set_columns(_WHOLE, columns):
                return self
            inside, places = self._in_tables(individuals)
            if inside._set_columns(places, columns):
                chosen = np.flatnonzero(~places).tolist()
        for key, values in given.items():
            _write(individuals, key, _one_each(values, len(individuals)), chosen)
        return self

    def _set_columns(self, places, columns: dict) -> bool:
        """Set values of individuals that are all in tables to those in some places of columns; False if they are not."""
        table = self.own_table(without=frozenset(columns))
        if table is not None:
            table.columns.update((key, column[places]) for key, column in columns.items())
        return table is not None

    def own_table(self, without: frozenset[str] = frozenset()) -> Table | None:
        """Return a table of these individuals alone, row by row, to which they are moved if need be.

        Parameters
        ----------
        without : frozenset of str
            Keys that a new table may leave out, since they are set next.

        Returns
        -------
        Table or None
            None if there are no individuals, if one is in no table, or if not all have been evaluated alike.
        """
        individuals = self.tolist()
        parts = self._parts(individuals)
        tables = [part.table for part in parts if part.table is not None]
        if not tables or len(tables) < len(parts):
            return None
        first = tables[0]
        if len(parts) == 1 and _is_whole(parts[0].rows):
            return first
        if any(table.evaluated != first.evaluated for table in tables):
            return None
        n, places, columns = len(individuals), [part.places for part in parts], {}
        for key in dict.fromkeys(key for table in tables for key in table.columns if key not in without):
            # As they are kept: constraint violations are worked out only when somebody asks.
            found = [table.columns.get(key) for table in tables]
            taken = [None if one is None else one[part.rows] for one, part in zip(found, parts, strict=True)]
            column = joined(n, taken, places)
            column = joined_as_objects(key, n, taken, places) if column is None else column
            if column is None:
                return None
            columns[key] = column
        table = Table(n, columns, first.evaluated)
        table.take(individuals)
        if len(set(individuals)) == n:
            self._found = individuals, [_Part(table, _WHOLE, _WHOLE)], [0]
        return table

    def not_evaluated(self) -> bool:
        """Return whether nothing has been evaluated of any."""
        individuals = self.tolist()
        parts = self._parts(individuals)
        if any(part.table is not None and part.table.evaluated for part in parts):
            return False
        return not any(one.evaluated for one in individuals if type(one) is not TableIndividual)

    def mark_evaluated(self, keys) -> None:
        """Note that the values of these keys have been evaluated of all."""
        table = self.own_table()
        if table is not None:
            table.evaluated = table.evaluated.union(keys)
        else:
            self.apply(lambda individual: individual.evaluated.update(keys))

    def settled(self, members: ArrayPopulation) -> ArrayPopulation:
        """Return these survivors among members of a population, those in tables in one, which nobody else keeps.

        Who keeps one of the others keeps no table of its generation for longer than to the next call.
        """
        survivors = self.tolist()
        inside, parts = self, self._parts(survivors)
        if any(part.table is None for part in parts):
            inside, _ = self._in_tables(survivors)
            parts = inside._parts(inside.tolist())
        if not parts:
            return self
        table = parts[0].table
        if len(parts) > 1 or table is None or table.n > 2 * len(inside):
            table = inside.own_table()
        if table is None:
            # They differ in what has been evaluated, or in shape.
            inside.apply(TableIndividual.become_ordinary)
        else:
            table.forget()
            table.bury(set(members.tolist()) - set(survivors))
        return self

    def _in_tables(self, individuals: list) -> tuple[ArrayPopulation, np.ndarray]:
        """Return those in tables, and which they are, bool."""
        places = np.array([type(one) is TableIndividual for one in individuals], dtype=bool)
        return self[places].view(ArrayPopulation), places

    def _array(self, individuals: list, key: str) -> np.ndarray:
        """Return the values of a key."""
        n, parts = len(individuals), self._parts(individuals)
        places, columns = [part.places for part in parts], []
        for table, place, rows in parts:
            column = None if table is None else table.column(key)
            if column is not None:
                values = column[rows]
            elif table is not None and is_data(key):
                values = [None] * len(individuals[place] if isinstance(place, slice) else place)
            else:
                # Of individuals in no table, or something that no table has: they are asked.
                own = individuals[place] if isinstance(place, slice) else [individuals[k] for k in place.tolist()]
                values = np.array(_read(own, key))
            if isinstance(values, np.ndarray) and values.dtype == object:
                values = [None if value is ABSENT else value for value in values]
            columns.append(values)
        array = joined(n, columns, places)
        if array is not None:
            return array
        listed: list = [None] * n
        for values, place in zip(columns, places, strict=True):
            for k, value in zip(np.arange(n)[place].tolist(), values, strict=True):
                listed[k] = value
        return np.array(listed)

    def _parts(self, individuals: list) -> list[_Part]:
        """Return the individuals by table."""
        found = self._found
        # Lists are compared by identity first, so that this costs next to nothing.
        if found is not None and found[0] == individuals and [_n_left(part.table) for part in found[1]] == found[2]:
            return found[1]
        try:
            tables = list(map(table_of, individuals))
            rows = np.fromiter(map(row_of, individuals), dtype=int, count=len(individuals))
        except AttributeError:
            tables = [one._table if type(one) is TableIndividual else None for one in individuals]
            rows = np.array([one._row if type(one) is TableIndividual else 0 for one in individuals], dtype=int)
        distinct = list(dict.fromkeys(tables))
        places = [_WHOLE] if len(distinct) == 1 else [_places(tables, table) for table in distinct]
        parts = [_Part(table, place, _rows(rows[place], table)) for table, place in zip(distinct, places, strict=True)]
        self._found = individuals, parts, [_n_left(table) for table in distinct]
        return parts


def _n_left(table: Table | None) -> int:
    return 0 if table is None else table.n_left


def _population(individuals, cls: type[ArrayPopulation]) -> ArrayPopulation:
    # Assignment would ask each whether it is an array.
    return np.fromiter(individuals, dtype=object, count=len(individuals)).view(cls)


def _is_whole(rows: np.ndarray | slice) -> bool:
    return isinstance(rows, slice) and rows == _WHOLE


def _places(tables: list, table: Table | None) -> np.ndarray | slice:
    """Return where a table stands in a list of them, as a slice if that is without gaps."""
    first, size = tables.index(table), tables.count(table)
    if tables[first : first + size].count(table) == size:
        return slice(first, first + size)
    return np.array([k for k, one in enumerate(tables) if one is table])


def _rows(rows: np.ndarray, table: Table | None) -> np.ndarray | slice:
    """Return rows of a table, as a slice if they are all of them in their order."""
    return _WHOLE if table is not None and np.array_equal(rows, np.arange(table.n)) else rows


def _read(individuals: list, key: str) -> list:
    if key == "FEAS":
        # Asked for every generation, and slow one by one.
        limits = [individual.config.get("cv_eps", 0.0) for individual in individuals]
        return list(np.array(_read(individuals, "CV")).reshape(-1, 1) <= np.array(limits)[:, None])
    if individuals and hasattr(type(individuals[0]), key):
        return list(map(attrgetter(key), individuals))
    # What others have set on an individual itself goes before what survival and evaluation keep in its data.
    return [own[key] if key in (own := individual.__dict__) else individual.data.get(key) for individual in individuals]


def _write(individuals: list, key: str, values: list, chosen: list[int] | None) -> None:
    """Set the values of a key, one each, to all individuals or those chosen."""
    if chosen is not None:
        individuals, values = [individuals[k] for k in chosen], [values[k] for k in chosen]
    if hasattr(type(individuals[0]), key):
        for individual, value in zip(individuals, values, strict=True):
            setattr(individual, key, value)
    else:
        for individual, value in zip(individuals, values, strict=True):
            own = individual.__dict__
            (own if key in own else individual.data)[key] = value


def _one_each(values, n: int) -> list:
    """Return one value for each of n individuals; none is a view, which would keep the array of a whole generation alive."""
    if isinstance(values, str) or not hasattr(values, "__len__"):
        return [values] * n
    if len(values) != n:
        raise ValueError(f"got {len(values)} values for a population of {n}")
    if isinstance(values, np.ndarray):
        if values.ndim == 1:
            return list(values)
        if values.size == 0:
            return [values[0].copy()] * n  # such as G of a problem without constraints
        return [row.copy() for row in values]
    return [value.copy() if isinstance(value, np.ndarray) and value.base is not None else value for value in values]
