#!/usr/bin/env bash
# scikit-image 0.26.0: pixel_graph() of a cost map weighs an edge by the difference of its pixels, with a mask too.
#
# Good guess: pixel_graph(costs, mask=free) is the graph of the free pixels with Euclidean lengths (its documentation: the
#   value of an edge when a mask is given is the distance), or something that grows with the costs.
# Behaviour: for an int or float image the weight is |a - b| times the distance, whether or not a mask is given. Level ground
#   of any cost is free of charge: the way through the middle of a plateau of cost 100 is 0 long, the way round is 0 too.
#   Without a mask, zero pixels are nodes as well. Only a bool image gives lengths.
# So: pass the bool mask as the image, or an edge_function(values, neighbour values, distances).
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
python3 -m venv "$tmp/venv"
"$tmp/venv/bin/pip" install --quiet --no-compile --disable-pip-version-check scikit-image==0.26.0 scipy==1.17.1 numpy==2.4.6
cd "$tmp"
venv/bin/python - <<'PY'
import numpy as np
from scipy.sparse.csgraph import dijkstra
from skimage.graph import pixel_graph

costs = np.full((3, 6), 100)
free = np.ones((3, 6), dtype=bool)
free[1, 2] = False


def length(*args, **kwargs):
    graph, nodes = pixel_graph(*args, connectivity=2, **kwargs)
    index = {int(node): i for i, node in enumerate(nodes)}
    return float(dijkstra(graph, indices=index[0])[index[5]]), len(nodes)


masked = length(costs, mask=free)
of_mask = length(free)
given = length(costs, mask=free, edge_function=lambda a, b, d: (a + b) / 2 * d)
print("costs and mask :", masked, "(length, nodes)")
print("the mask itself:", of_mask)
print("own function   :", given)
assert masked == (0.0, 17) and of_mask == (5.0, 17) and given == (500.0, 17)
unmasked = pixel_graph(np.where(free, 1, 0), connectivity=2)
print("0/1 image, no mask: nodes", len(unmasked[1]), "of", free.size)
assert len(unmasked[1]) == free.size
PY
