"""The exact front of three objectives: a label-setting search in the line of LTMOA*."""

from __future__ import annotations

import dataclasses
from typing import ClassVar

import numpy as np

from pymoo_gridpath.compiled import kernel
from pymoo_gridpath.exact.budget import Meter
from pymoo_gridpath.exact.costs import Costs
from pymoo_gridpath.exact.label_lists import THIRD, covered, empty_lists, has_room, insert
from pymoo_gridpath.exact.labels import (
    DONE,
    LISTS_FULL,
    N_CLOSED,
    N_FOUND,
    N_OPEN,
    N_POPPED,
    PAUSED,
    Front,
    LabelSearch,
    close,
    full,
    is_detour,
    load_of,
)
from pymoo_gridpath.exact.nearness import WHOLE
from pymoo_gridpath.exact.steps import Pace, Steps, last
from pymoo_gridpath.search import UNREACHABLE, Moves, backward_costs
from pymoo_gridpath.search.heap import drop_first_of_four, push_four


def front_of_three(moves: Moves, costs: Costs, start: int, goal: int, meter: Meter, most_steps: int | None = None) -> Front:
    """Return the exact front of three objectives, of all paths or of those that take at most ``most_steps`` steps.

    Of paths with the same costs it holds the one that `smoothest_paths` chooses, as long as memory lasts; any one if a cost
    depends on headings.

    Labels are popped in lexicographic order, so that the first objective needs no comparison: a label is dominated if and only
    if one of the pairs (g2, g3) closed so far at its state is. With headings, a pair counts for the other headings of the
    cell too, by the turn that it takes to get there, where that costs nothing in the first objective. Where steps are limited
    they are counted as well: a label with fewer steps is not dominated before the goal, since what leads on from it may take
    more.

    Parameters
    ----------
    moves : Moves
    costs : Costs
        Of three objectives; those that depend on headings come faster as the last ones.
    start, goal : int
    meter : Meter
        Ends the search when a budget is used up; the part of the front with the least first costs is returned then.
    most_steps : int, optional

    References
    ----------
    C. Hernandez, W. Yeoh, J. A. Baier, A. Felner, O. Salzman, H. Zhang, S.-H. Chan and S. Koenig, "Multi-objective search via
    lazy and efficient dominance checks", IJCAI 2023 (LTMOA*). F.-J. Pulido, L. Mandow and J.-L. Perez-de-la-Cruz,
    "Dimensionality reduction in multiobjective shortest path search", Computers & Operations Research 64, 2015.
    """
    return last(fronts_of_three(moves, costs, start, goal, meter, most_steps))


def fronts_of_three(
    moves: Moves, costs: Costs, start: int, goal: int, meter: Meter, most_steps: int | None = None
) -> Steps[Front, Front]:
    """Search as `front_of_three` does, and hand over the larger and larger parts of the front that have been found."""
    search, pace = _Search(moves, costs, start, goal, meter, most_steps), Pace()
    meter.n_fixed = search.n_fixed
    about = int(moves.n_cells**0.5)
    for popped in () if meter.message else search.steps(meter):
        n_found = int(search.counts[N_FOUND])
        if search.counts[N_OPEN] and n_found and not meter.message and pace.due(popped, n_found, about):
            yield lambda: Front(search.paths(), search.points())
    if meter.message:
        return Front(search.paths(), search.points())
    return Front(search.smoothest_paths(meter), search.points(), WHOLE)


class _Search(LabelSearch):
    """The search, with a list of what is non-dominated for each cell."""

    growing: ClassVar[dict[int, str]] = LabelSearch.growing | {LISTS_FULL: "rows"}
    pops_at_a_time = 2**17

    def __init__(self, moves: Moves, costs: Costs, start: int, goal: int, meter: Meter, most_steps: int | None):
        super().__init__(moves, costs, start, goal, n_keys=4)
        self.n_headings = 8 if costs.with_heading else 1
        # Where any number of steps will do, none are counted.
        self.per_step, self.most_steps = (0, 0) if most_steps is None else (1, most_steps)
        self.bounds = np.zeros((moves.n_cells, self.n_headings, 4), dtype=np.int64)
        for k in range(3):
            self.bounds[..., k] = self._bound(costs.take([k, k]), meter)
        if most_steps is not None:
            self.bounds[..., 3] = self._bound(_steps_alone(costs), meter)
        self.bounds = self.bounds.reshape(-1, 4)
        # The last list is that of the paths found.
        self.lists, self.rows, self.taken = empty_lists(moves.n_cells + 1, self.n_headings)
        self.begin()

    def _bound(self, costs: Costs, meter: Meter) -> np.ndarray:
        """Return the least cost from every cell, by the heading if that matters, where two costs are the same."""
        with_heading = costs.with_heading
        found = backward_costs(self.moves, costs.step, costs.field, self.goal, with_heading, stop=meter.stop, enter=costs.enter)
        return found[0][0].reshape(self.moves.n_cells, -1)

    def open_first(self, cell: int, heading: int, state: int) -> bool:
        f = self.costs.step[:, 8, heading] + self.costs.field[:, cell] + self.bounds[state, :3]
        f += 0 if self.costs.enter is None else self.costs.enter[:, cell, heading]
        steps = self.per_step + self.bounds[state, 3]
        if f.max() >= UNREACHABLE or steps > self.most_steps:
            return False
        load = load_of(cell, heading, 0)
        push_four(self.heap, self.counts[N_OPEN], f[0], f[1], 2 * f[2] + (cell == self.goal), steps, load)
        return True

    def search(self, max_pops: int) -> int:
        return search_three(
            self.moves.legal,
            self.moves.offsets,
            self.costs.step,
            self.costs.field,
            self.costs.enter,
            self.costs.with_heading,
            self.costs.on_the_spot,
            self.costs.direct,
            self.bounds,
            self.per_step,
            self.most_steps,
            self.start,
            self.goal,
            self.lists,
            self.rows,
            self.taken,
            self.heap,
            self.closed,
            self.found,
            self.counts,
            max_pops,
        )

    @property
    def n_fixed(self) -> int:
        """Bytes of the arrays whose size is that of the grid."""
        return self.bounds.nbytes + self.lists.nbytes + self.costs.nbytes


def _steps_alone(costs: Costs) -> Costs:
    """Return two costs that are the number of steps."""
    one = costs.take([0, 0])
    return dataclasses.replace(one, step=np.ones_like(one.step), field=np.zeros_like(one.field), enter=None)


@kernel
def search_three(
    legal,
    offsets,
    step,
    field,
    enter,
    with_heading,
    on_the_spot,
    direct,
    bounds,
    per_step,
    most_steps,
    start,
    goal,
    lists,
    rows,
    taken,
    heap,
    closed,
    found,
    counts,
    max_pops,
):
    """Pop labels in lexicographic order until none is left, an array is full, or ``max_pops`` have been popped.

    Parameters
    ----------
    legal, offsets
        See `Moves`.
    step, field, enter, with_heading, on_the_spot, direct
        See `Costs`.
    bounds : int64, shape (n_states, 4)
        Lower bounds of the rest: three objectives, and steps.
    per_step, most_steps : int
        1 and how many steps a path may take, or 0 and 0 if they are not counted.
    start, goal : int
    lists, rows, taken
        Of (g2, g3, steps) closed at each cell and, the last list, of (f2, f3, 0) of the paths found; see `empty_lists`.
    heap, closed, found
        See `LabelSearch`; keys are f1, f2, ``2 * f3`` (plus 1 at the goal, which so comes after all that is equal, see
        `smoothest_paths`), and the least steps of the whole path.
    counts : int64, shape (4,)
        State of the search, changed in place like all arrays from ``lists`` on.
    max_pops : int
    """
    n, n_closed = counts[N_OPEN], counts[N_CLOSED]
    ends = len(lists) - 1
    third = np.empty(rows.shape[1] - THIRD, dtype=np.int64)
    status = DONE
    pops = 0
    while n > 0:
        status = full(n, n_closed, counts[N_FOUND], heap, closed, found)
        if status != DONE:
            break
        # Of the cell, for each heading at most.
        if not has_room(rows, taken, 8):
            status = LISTS_FULL
            break
        if pops >= max_pops:
            status = PAUSED
            break
        pops += 1
        f1, f2, f3, load = heap[0, 0], heap[0, 1], heap[0, 2] >> 1, heap[0, 4]
        all_steps = heap[0, 3]
        drop_first_of_four(heap, n)
        n -= 1
        heading = (load >> 32) & 7
        cell = load >> 35
        state = load >> 32 if with_heading else cell
        g2 = f2 - bounds[state, 1]
        g3 = f3 - bounds[state, 2]
        steps = all_steps - bounds[state, 3]
        here = heading if with_heading else 0
        if covered(lists, rows, cell, here, g2, g3, steps) or covered(lists, rows, ends, 0, f2, f3, 0):
            continue
        close(closed, n_closed, load)
        if cell == goal:
            third[:] = f3
            insert(lists, rows, taken, ends, f2, third, 0)
            found[counts[N_FOUND], 0] = n_closed
            found[counts[N_FOUND], 1] = f1
            found[counts[N_FOUND], 2] = f2
            found[counts[N_FOUND], 3] = f3
            counts[N_FOUND] += 1
            n_closed += 1
            continue
        third[:] = g3
        if with_heading:
            # Whoever turns on the spot from this heading to another is no worse than who came with that one and higher costs;
            # those who come later have no lower first cost if turning costs nothing in it.
            for h in range(8):
                at_once = on_the_spot[0, heading, h] == 0 and on_the_spot[1, heading, h] == 0
                third[h] = g3 + on_the_spot[2, heading, h] if at_once else UNREACHABLE
        insert(lists, rows, taken, cell, g2, third, steps)
        if with_heading:
            for h in range(8):
                if on_the_spot[0, heading, h] == 0 and on_the_spot[1, heading, h] > 0:
                    third[:] = UNREACHABLE
                    third[h] = g3 + on_the_spot[2, heading, h]
                    insert(lists, rows, taken, cell, g2 + on_the_spot[1, heading, h], third, steps)
        g1 = f1 - bounds[state, 0]
        from_before = legal[cell - offsets[heading]]
        last = heading if with_heading else 8
        for m in range(8):
            if not (legal[cell] >> m) & 1:
                continue
            if is_detour(direct, heading, m, from_before):
                continue
            next_cell = cell + offsets[m]
            if next_cell == start:
                continue
            next_state = 8 * next_cell + m if with_heading else next_cell
            next_f1 = g1 + step[0, last, m] + field[0, next_cell] + bounds[next_state, 0]
            if enter is not None:
                next_f1 += enter[0, next_cell, m]
            next_steps = steps + per_step
            next_all = next_steps + bounds[next_state, 3]
            if next_f1 >= 2**61 or next_all > most_steps:
                continue
            next2 = g2 + step[1, last, m] + field[1, next_cell]
            next3 = g3 + step[2, last, m] + field[2, next_cell]
            if enter is not None:
                next2 += enter[1, next_cell, m]
                next3 += enter[2, next_cell, m]
            if covered(lists, rows, next_cell, m if with_heading else 0, next2, next3, next_steps):
                continue
            next_f2 = next2 + bounds[next_state, 1]
            next_f3 = next3 + bounds[next_state, 2]
            if covered(lists, rows, ends, 0, next_f2, next_f3, 0):
                continue
            load = load_of(next_cell, m, n_closed)
            push_four(heap, n, next_f1, next_f2, 2 * next_f3 + (next_cell == goal), next_all, load)
            n += 1
        n_closed += 1
    counts[N_OPEN], counts[N_CLOSED] = n, n_closed
    counts[N_POPPED] += pops
    return status
