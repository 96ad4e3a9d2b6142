#!/usr/bin/env bash
# jMetalPy 1.9.0: IntegerSBXCrossover cuts off fractions, so that genes drift to zero without any selection.
#
# Good guess: like SBX for real numbers it keeps the mean of the parents, but for rounding to the nearest whole number.
# Behaviour: int() of the children, which rounds towards zero, from above and from below. A population of 0..9 that is only
#   mated has a mean of 4.6 at first, 2.8 after ten generations and 0.2 after forty; one of -10..-1 goes from -5.4 to -1.2.
#   What lies near zero is found without selection.
# So: round children in a crossover of your own, or take another one for whole numbers.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check jmetalpy==1.9.0 numpy==2.4.6
cd "$tmp"
venv/bin/python - <<'PY' 2> /dev/null
import random

import numpy as np
from jmetal.core.solution import IntegerSolution
from jmetal.operator.crossover import IntegerSBXCrossover

N = 10


def drift(low, high):
    """Return the mean gene of a population before, after 10 and after 40 generations of crossover alone."""
    random.seed(1)
    population = []
    for _ in range(200):
        one = IntegerSolution([low] * N, [high] * N, 2)
        one.variables = [random.randint(low, high) for _ in range(N)]
        population.append(one)
    crossover = IntegerSBXCrossover(1.0, 10.0)
    means = [np.mean([one.variables for one in population])]
    for generation in range(1, 41):
        random.shuffle(population)
        pairs = zip(population[::2], population[1::2])
        population = [child for pair in pairs for child in crossover.execute(list(pair))]
        if generation in (10, 40):
            means.append(np.mean([one.variables for one in population]))
    return means


positive, negative = drift(0, 9), drift(-10, -1)
print("means of genes at first, after 10 and 40 generations without selection")
print("   0 .. 9 :", *(f"{mean:.2f}" for mean in positive))
print(" -10 .. -1:", *(f"{mean:.2f}" for mean in negative))
assert positive[0] > 4.2 and positive[1] < 3.2 and positive[2] < 0.6
assert negative[0] < -5.2 and negative[1] > -4.2 and negative[2] > -1.6
PY
