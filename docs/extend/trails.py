"""Things for walkers in the hills, one of each kind: none of them stands in pymoo_gridpath itself."""

import numpy as np
from pymoo.core.mutation import Mutation
from scipy import sparse

from pymoo_gridpath import register
from pymoo_gridpath.algorithms import reference_directions
from pymoo_gridpath.errors import GridPathError, MapError
from pymoo_gridpath.grid import OccupancyGrid
from pymoo_gridpath.maps import MapFormat, check_size, make_grid, read_string
from pymoo_gridpath.neighbourhood import HEADINGS
from pymoo_gridpath.objectives import Length, Objective
from pymoo_gridpath.paths import SequencePaths, Sequences
from pymoo_gridpath.planners import Planner, settled
from pymoo_gridpath.problems import Suite
from pymoo_gridpath.representations import Representation


@register
class WalkingTime(Objective):
    """Minutes on foot over a hill in the middle of the map, by Tobler's function of the slope."""

    name, label = "walking_time", "Walking time [min]"

    def __init__(self, summit=120.0):
        self.summit = summit  # metres

    def height(self, grid):
        x, y = np.linspace(-2, 2, grid.width), np.linspace(-2, 2, grid.height)
        return self.summit * np.exp(-np.add.outer(y**2, x**2))

    def moves(self, grid):
        height, minutes = self.height(grid), np.zeros((8, *grid.shape))
        for heading, (dx, dy) in enumerate(HEADINGS):
            # On a map in cells, one is taken for a metre.
            metres = np.hypot(dx, dy) * (grid.resolution or 1.0)
            # Rolled, each cell has the height of the cell that the step comes from.
            slope = (height - np.roll(height, (dy, dx), axis=(0, 1))) / metres
            # 6 km/h, which is 100 metres a minute, where it goes down a little; slower up and down.
            minutes[heading] = metres / 100 * np.exp(3.5 * np.abs(slope + 0.05))
        return minutes


@register
class Stops(Representation):
    """The genes are the cells at which a path changes its heading, and the goal to the end of the row."""

    name = "stops"

    def __init__(self, grid, start, goal):
        super().__init__(grid, start, goal)
        self.n_var = self.max_cells = self.moves.n_cells
        self.xl = np.zeros(self.n_var, dtype=int)
        self.xu = np.full(self.n_var, grid.width * grid.height - 1)
        self.xl[0] = self.xu[0] = start[1] * grid.width + start[0]
        self.xl[-1] = self.xu[-1] = goal[1] * grid.width + goal[0]

    def decode(self, X):
        y, x = np.divmod(self.genes(X), self.grid.width)
        stops = np.stack([x, y], axis=2)
        way = np.diff(stops, axis=1)
        n_steps = np.abs(way).max(axis=2)
        # From stop to stop, diagonally first: cell k of a leg is k steps along each axis, or all there are.
        leg = np.repeat(np.arange(n_steps.size), n_steps.ravel())
        k = 1 + np.arange(len(leg)) - np.repeat(n_steps.cumsum() - n_steps.ravel(), n_steps.ravel())
        way = way.reshape(-1, 2)[leg]
        passed = stops[:, :-1].reshape(-1, 2)[leg] + np.sign(way) * np.minimum(np.abs(way), k[:, None])
        offsets = np.concatenate([[0], n_steps.sum(axis=1).cumsum()])
        cells = np.insert(passed @ [1, self.grid.width], offsets[:-1], self.xl[0])
        return SequencePaths(self.grid, Sequences(cells, offsets + np.arange(len(offsets))))

    def from_sequences(self, sequences):
        X = np.full((len(sequences.lengths), self.n_var), self.xu[-1])
        for row, first, end in zip(X, sequences.offsets, sequences.offsets[1:], strict=False):
            cells = sequences.cells[first:end]
            steps = np.diff(self.moves.cells(cells), axis=0)
            stops = np.append(0, 1 + np.flatnonzero((steps[1:] != steps[:-1]).any(axis=1)))
            row[: len(stops)] = self.moves.to_grid(cells[stops])
        return X


@register
class Nudge(Mutation):
    """Moves one stop of each path by up to ``reach`` cells along each axis."""

    def __init__(self, reach=2, **kwargs):
        super().__init__(**kwargs)
        self.reach = reach

    def _do(self, problem, X, random_state=None, **kwargs):
        grid, goal, rows = problem.grid, problem.xu[-1], np.arange(len(X))
        # Any but the start; a straight path gets a stop.
        chosen = random_state.integers(1, np.maximum((goal != X).sum(axis=1), 2))
        y, x = np.divmod(X[rows, chosen], grid.width)
        dx, dy = random_state.integers(-self.reach, self.reach, size=(2, len(X)), endpoint=True)
        x, y = np.clip(x + dx, 0, grid.width - 1), np.clip(y + dy, 0, grid.height - 1)
        moved = X.copy()
        moved[rows, chosen] = y * grid.width + x
        return np.clip(moved, problem.xl, problem.xu)


@register
class WeightedPaths(Planner):
    """The cheapest paths for weighted sums of the costs of cells and moves, by Dijkstra's method."""

    name = "weighted"

    def __init__(self, n_weights=10, **kwargs):
        super().__init__(**kwargs)
        self.n_weights = n_weights

    def plan(self, problem):
        moves = problem.representation.moves
        tail, heading = np.nonzero(moves.legal[:, None] >> np.arange(8) & 1)
        head = tail + moves.offsets[heading]
        cells = moves.to_grid(head)
        costs = np.stack([self._costs(one, problem.grid, heading, cells) for one in problem.objectives])
        costs /= costs.mean(axis=1, keepdims=True) + 1e-9
        ends = np.array([tail, head], dtype=np.int32)  # what scipy before 1.15 takes
        start, goal = moves.index(problem.start), moves.index(problem.goal)
        found = {}
        for weights in reference_directions(problem.n_obj, self.n_weights):
            steps = sparse.csr_array((weights @ costs, tuple(ends)), shape=2 * (moves.n_cells,))
            _, before = sparse.csgraph.dijkstra(steps, indices=start, return_predecessors=True)
            path = [goal]
            while path[-1] != start:
                path.append(before[path[-1]])
            found[tuple(path)] = path[::-1]
        paths = Sequences(np.concatenate(list(found.values())), np.cumsum([0, *map(len, found)]))
        return settled(problem, paths, f"found {len(found)} paths for {self.n_weights} weights")

    @staticmethod
    def _costs(objective, grid, heading, cell):
        field, steps = objective.field(grid), objective.moves(grid)
        cost = np.zeros(len(cell)) if field is None else np.ravel(field)[cell]
        if steps is not None:
            steps = np.asarray(steps)
            steps = steps[heading % 2] if steps.ndim == 1 else steps.reshape(8, -1)[heading, cell]
            cost = cost + steps
        return cost


@register
class Boxes(MapFormat):
    """Width and height on the first line, and "x y width height" of an obstacle on each other."""

    name, suffixes = "boxes", (".boxes",)

    def read(self, path, corner_cutting=False, resolution=None):
        lines = read_string(path, 10**7).splitlines() or [""]
        width, height = self._numbers(path, 1, lines[0], ["width", "height"])
        check_size(path, width, height)
        occupied = np.zeros((height, width), dtype=bool)
        for number, line in enumerate(lines[1:], 2):
            x, y, w, h = self._numbers(path, number, line, ["x", "y", "width", "height"])
            if x + w > width or y + h > height:
                box = f"a box within {width} x {height} cells"
                raise MapError(path, f"line {number} is {line[:40]!r}, expected {box}")
            occupied[y : y + h, x : x + w] = True
        return make_grid(path, occupied, corner_cutting=corner_cutting, resolution=resolution)

    @staticmethod
    def _numbers(path, number, line, names):
        words = line.split()
        if len(words) != len(names) or not all(word.isdecimal() and len(word) < 9 for word in words):
            numbers = f"whole numbers: {', '.join(names)}"
            raise MapError(path, f"line {number} is {line[:40]!r}, expected {numbers}")
        return map(int, words)


@register
class Ponds(Suite):
    """A hill with ponds that are drawn at random, from its foot to its foot on the other side."""

    name = "ponds"
    follows = "follows the definition in the package trails"

    def __init__(self, size=30, seed=1):
        for key, value, least in (("size", size, 3), ("seed", seed, 0)):
            if type(value) is not int or not least <= value < 1000:
                raise GridPathError(f"{key} is {value!r}, expected a whole number from {least} to 999")
        self.size, self.seed = size, seed

    @property
    def label(self):
        return f"ponds-{self.size}-{self.seed}"

    @property
    def query(self):
        ponds = np.random.default_rng(self.seed).random((self.size, self.size)) < 0.2
        # One way is always dry.
        ponds[0] = ponds[:, -1] = False
        return OccupancyGrid(ponds, name=self.label), (0, 0), (self.size - 1, self.size - 1)

    @property
    def objectives(self):
        return Length(), WalkingTime(20.0)
