#!/usr/bin/env bash
# NiaPy 2.7.1: onlookers of its bee colony go to the worst sources where values are negative, so in most maximisation.
#
# Good guess: the better a source, the likelier an onlooker goes there, as in Karaboga and Basturk (2007), who turn values into
#   a fitness that is positive whatever their sign.
# Behaviour: the probability is 1 / (value + 0.01) over the sum, without a case for negative values. Of values -4, -2 and -1 the
#   least, the best, gets 0.14 and the worst 0.57. NiaPy maximises by minimising the negative, so that maximising 4, 2 and 1 does
#   the same. With both signs probabilities are negative or above 1.
# So: add a number that keeps all values positive; to maximise, minimise a bound minus the objective.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check niapy==2.7.1 numpy==2.4.6
cd "$tmp"
venv/bin/python - <<'PY' 2> /dev/null
import numpy as np
from niapy.algorithms.basic import ArtificialBeeColonyAlgorithm
from niapy.problems import Problem
from niapy.task import OptimizationType, Task


class Given(Problem):
    """Gives the values of a list, one after the other."""

    def __init__(self, values):
        super().__init__(1, 0.0, 1.0)
        self.values = iter(values)

    def _evaluate(self, x):
        return next(self.values)


def probabilities(values, kind):
    """Return the values that the colony minimises, and the probabilities of their sources."""
    task = Task(Given(values), max_evals=100, optimization_type=kind)
    colony = ArtificialBeeColonyAlgorithm(population_size=6, seed=1)
    # The colony has half as many sources as it has bees; the rest is not looked at.
    foods, minimised, _ = colony.init_population(task)
    return minimised[:3], colony.calculate_probabilities(foods)


shares = {}
for name, kind, values in (
    ("minimise 1, 2, 4", OptimizationType.MINIMIZATION, [1.0, 2.0, 4.0]),
    ("minimise -4, -2, -1", OptimizationType.MINIMIZATION, [-4.0, -2.0, -1.0]),
    ("maximise 4, 2, 1", OptimizationType.MAXIMIZATION, [4.0, 2.0, 1.0]),
    ("minimise -1, 1, 2", OptimizationType.MINIMIZATION, [-1.0, 1.0, 2.0]),
):
    minimised, shares[name] = probabilities([*values, *values], kind)
    assert np.argmin(minimised) == 0
    print(f"{name:20} best first:", *(f"{share:.2f}" for share in shares[name]))
assert np.argmax(shares["minimise 1, 2, 4"]) == 0
assert np.argmax(shares["minimise -4, -2, -1"]) == np.argmax(shares["maximise 4, 2, 1"]) == 2
assert shares["minimise -1, 1, 2"].min() < 0 < 1 < shares["minimise -1, 1, 2"].max()
PY
