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


@kernel("(f8[::1], f8[::1], f8[::1], f8)")
def step_length(values, direction, correction, weight):  # type: ignore[no-untyped-def]
    """Largest step up to 1 along ``direction + weight * correction`` that leaves no value negative."""
    longest = 1.0
    for k in range(len(values)):
        change = direction[k] + weight * correction[k]
        if values[k] + longest * change < 0.0:
            longest = -values[k] / change
    return longest


@kernel("(f8[::1], f8[::1], f8[::1], f8[::1], f8, f8, f8, f8, f8[::1])")
def outliers(values, slacks, d_values, d_slacks, step, slack_step, least, most, wanted):  # type: ignore[no-untyped-def]
    """What the products of values and slacks lack, after a step, to the range from ``least`` to ``most``; at most ``most`` less."""
    for k in range(len(values)):
        product = (values[k] + step * d_values[k]) * (slacks[k] + slack_step * d_slacks[k])
        wanted[k] = least - product if product < least else max(most - product, -most) if product > most else 0.0


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
