"""Compiled loops of the interior point and its normal matrix. Imports numba: import it inside functions only."""

from __future__ import annotations

import numpy as np

from .....formulations.kernels import kernel
from .....formulations.stop_kernel import asked
from .layout import LAYOUT, Layout
from .sums_kernels import multiply

_NAMED = (Layout,)
"""The named tuple that these types name."""


@kernel(f"({LAYOUT}, i4[::1], i4[::1], i4[::1], i4[::1], i4[::1], i4[::1])")
def places(graph, sees, seen, starts, columns, local, place):  # type: ignore[no-untyped-def]
    """Where the normal matrix (CSR ``starts`` and ``columns``, ascending) has the entries of each robot.

    The targets of robot i are ``seen[sees[i]:sees[i + 1]]``, ascending: ``local`` tells for each edge which of them it leads to, ``place``
    for each pair of them, robot after robot, the entry of the matrix.
    """
    k = 0
    for robot in range(len(sees) - 1):
        for a in range(sees[robot], sees[robot + 1]):
            e = starts[seen[a]]
            for b in range(sees[robot], sees[robot + 1]):
                while columns[e] != seen[b]:
                    e += 1
                place[k] = e
                k += 1
        for m in range(graph.first[robot], graph.first[robot + 1]):
            action, a = graph.order[m], sees[robot]
            for e in range(graph.starts[action], graph.starts[action + 1]):
                while seen[a] != graph.targets[e]:
                    a += 1
                local[e] = a - sees[robot]


@kernel(f"({LAYOUT}, i4[::1], i4[::1], i4[::1], i4[::1], f8[::1], f8[::1], f8[::1])")
def assemble(graph, sees, seen, local, place, scaling, prices, matrix):  # type: ignore[no-untyped-def]
    """Entries of Y C K C' Y, with Y = diag(``prices``) and K = D - d d' / sum d for the actions of each robot, d their ``scaling``."""
    matrix[:] = 0.0
    most, k = 0, 0
    for robot in range(len(sees) - 1):
        most = max(most, sees[robot + 1] - sees[robot])
    block, mean = np.empty((most, most)), np.empty(most)
    for robot in range(len(sees) - 1):
        size, start = sees[robot + 1] - sees[robot], sees[robot]
        total = 0.0
        mean[:size] = 0.0
        for a in range(size):
            for b in range(size):
                block[a, b] = 0.0
        for m in range(graph.first[robot], graph.first[robot + 1]):
            action = graph.order[m]
            d = scaling[action]
            total += d
            for e in range(graph.starts[action], graph.starts[action + 1]):
                a = local[e]
                gain = d * graph.weights[e] * prices[seen[start + a]]
                mean[a] += gain
                for f in range(graph.starts[action], graph.starts[action + 1]):
                    block[a, local[f]] += gain * graph.weights[f] * prices[seen[start + local[f]]]
        total = max(total, 1e-300)
        for a in range(size):
            for b in range(size):
                matrix[place[k]] += block[a, b] - mean[a] * mean[b] / total
                k += 1


@kernel(f"({LAYOUT}, f8[::1], f8[::1], f8, f8, f8, f8[::1], f8[::1], f8[::1])")
def move_robots(graph, worth, change, aim, reach, kept, shares, slacks, values):  # type: ignore[no-untyped-def]
    """Add ``change`` to the ``shares``, and make ``slacks`` those of the new ``values`` of robots and ``worth`` of actions.

    Robots of which a product would leave the range from ``reach`` to 1 / ``reach`` times the ``aim``, or a share fall below ``kept`` of
    what it was, go part of the way, and have the value at which the products ``aim`` give shares that sum to 1. Returns their number.
    """
    curved = 0
    for robot in range(len(graph.first) - 1):
        first, last = graph.first[robot], graph.first[robot + 1]
        length, value, best, good = 1.0, values[robot], -np.inf, True
        for k in range(first, last):
            m = graph.order[k]
            moved, slack = shares[m] + change[m], value - worth[m]
            product = moved * slack
            if not (moved >= kept * shares[m] and slack > 0.0 and reach * aim <= product <= aim / reach):
                good = False
            if moved < kept * shares[m]:
                length = min(length, (kept - 1.0) * shares[m] / change[m])
            best = max(best, worth[m])
        if not good:
            curved += 1
            above = aim
            for _ in range(60):
                total, slope = 0.0, 0.0
                for k in range(first, last):
                    share = aim / (above + (best - worth[graph.order[k]]))
                    total += share
                    slope += share * share
                if not total > 1.0 + 1e-12:
                    break
                above += total * (total - 1.0) * aim / slope
            value = values[robot] = best + above
        total = 0.0
        for k in range(first, last):
            m = graph.order[k]
            shares[m] += length * change[m]
            slacks[m] = above + (best - worth[m]) if not good else value - worth[m]
            total += shares[m]
        for k in range(first, last):
            shares[graph.order[k]] /= total
    return curved


@kernel("UniTuple(f8, 2)(f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8, f8)")
def improve(inverse, prices, found, rest, way, product, slope, scale):  # type: ignore[no-untyped-def]
    """One iteration of ``conjugate`` but for its ``product``; returns the slope, 0 where rounding leaves none, and the largest residual."""
    curvature = 0.0
    for row in range(len(rest)):
        curvature += product[row] * way[row]
    if not curvature > 0.0:
        return 0.0, np.inf
    length, multiplier = slope / curvature, 0.0
    for row in range(len(rest)):
        found[row] += length * way[row]
        rest[row] -= length * product[row]
        multiplier += prices[row] * inverse[row] * rest[row]
    multiplier /= scale
    fresh, largest = 0.0, 0.0
    for row in range(len(rest)):
        left = rest[row] - multiplier * prices[row]
        rest[row] = left
        fresh += left * left * inverse[row]
        largest = max(largest, abs(left))
    ratio = fresh / slope
    for row in range(len(rest)):
        way[row] = rest[row] * inverse[row] + ratio * way[row]
    return fresh, largest


@kernel("(i8[::1], i4[::1], i4[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8, f8, f8, i8)")
def conjugate(flag, starts, columns, values, inverse, prices, found, rest, way, product, slope, scale, residual, most):  # type: ignore[no-untyped-def]
    """Conjugate gradients with the diagonal as preconditioner, on what is orthogonal to ``prices``, ``most`` iterations or fewer where the
    ``flag`` of a ``Stop`` is set or rounding leaves no slope.

    ``found``, ``rest`` and ``way`` change in place; ``scale`` is the sum of prices^2 ``inverse``. Returns the iterations and the slope.
    """
    count, largest = 0, np.inf
    while count < most and slope > 0.0 and largest > residual and not asked(flag):
        multiply(starts, columns, values, way, product, 0, len(product))
        slope, largest = improve(inverse, prices, found, rest, way, product, slope, scale)
        count += 1
    return count, slope
