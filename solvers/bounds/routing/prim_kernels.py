"""Prim's minimum spanning tree on a dense matrix, compiled."""

import math

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked


@kernel("Tuple((f8, i8[::1]))(i8[::1], f8[:, ::1], f8[::1])")
def spanning_tree_degrees(flag, edges, price):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Weight and node degrees of the minimum spanning tree for ``edges[i, j] + price[i] + price[j]``.

    ``edges``, shape (nodes, nodes), is symmetric, infinite where there is no edge. The weight is infinite if the edges do not join all
    nodes, NaN where ``flag`` asked to stop.
    """
    n = len(price)
    degree = np.zeros(n, np.int64)
    nearest = np.full(n, math.inf)
    parent = np.zeros(n, np.int64)
    left = np.empty(n - 1, np.int64)
    for k in range(n - 1):
        left[k] = k + 1
    count, node, total = n - 1, 0, 0.0
    while count > 0:
        if asked(flag):
            return math.nan, degree
        best, chosen = math.inf, -1
        for k in range(count):
            j = left[k]
            w = edges[node, j] + price[node] + price[j]
            if w < nearest[j]:
                nearest[j] = w
                parent[j] = node
            if nearest[j] < best:
                best = nearest[j]
                chosen = k
        if chosen < 0:
            return math.inf, degree
        node = left[chosen]
        count -= 1
        left[chosen] = left[count]
        total += best
        degree[node] += 1
        degree[parent[node]] += 1
    return total, degree
