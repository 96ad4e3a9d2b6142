#!/usr/bin/env bash
# pygmo 2.20.0: moead and nspso evaluate and return fractions for a problem whose variables are all integers.
#
# Good guess: a problem with get_nix() is solved in integers by every algorithm that accepts it; the rest refuse it.
# Behaviour: nsga2 and maco keep integers; moead, moead_gen and nspso (and pso, de, simulated_annealing for one objective)
#   accept the problem without a word and treat it as continuous. Nearly every evaluation is of fractions, and so is the
#   population. A comparison of algorithms on an integer encoding then compares two different problems.
# So: round inside fitness() and again when reading the population, or stay with algorithms that keep integers.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check pygmo==2.20.0 numpy==2.4.6
cd "$tmp"
venv/bin/python - <<'PY'
import numpy as np
import pygmo as pg

seen = []


class Integers:
    def fitness(self, x):
        seen.append(np.array(x))
        return [float(sum(x)), float(sum((8 - v) ** 2 for v in x))]

    def get_bounds(self):
        return [0] * 4, [8] * 4

    def get_nobj(self):
        return 2

    def get_nix(self):
        return 4


def share_of_fractions(algorithm):
    seen.clear()
    population = pg.population(pg.problem(Integers()), 40, seed=2)
    population = pg.algorithm(algorithm).evolve(population)
    x = population.get_x()
    calls = np.array(seen)
    return float((calls != np.rint(calls)).any(axis=1).mean()), bool((x != np.rint(x)).any())


for algorithm, whole in (
    (pg.nsga2(gen=30, seed=1), True),
    (pg.maco(gen=30, ker=20, seed=1), True),
    (pg.moead(gen=30, seed=1), False),
    (pg.moead_gen(gen=30, seed=1), False),
    (pg.nspso(gen=30, seed=1), False),
):
    share, returned = share_of_fractions(algorithm)
    print(f"{type(algorithm).__name__:10} evaluations with fractions {share:.0%}, fractions returned: {returned}")
    assert (share == 0 and not returned) if whole else (share > 0.9 and returned)
PY
