"""Violated rows of any weights over whole routes, compiled. Imports numba: import it inside functions only."""

import numpy as np

from ....formulations.kernels import kernel


@kernel("i8(b1[:, ::1], f8[::1], i8[::1], i8, f8, i8[:, ::1], f8[::1])")
def violated_weights(visits, values, weights, parts, least, members, excess):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Sets of customers whose rows a point violates by more than ``least``: from each customer on others are taken in, then exchanged as
    long as the violation grows; returns their number.

    ``visits``, shape (nodes, routes), tells whom a route visits, ``values`` how often it is driven; ``members`` (sets, size), in order of
    ``weights`` (size,), and ``excess`` receive the sets, of which some may be the same.

    Source: Pecin, Pessoa, Poggi, Uchoa, Santos (2017), "Limited memory rank-1 cuts for vehicle routing problems".
    """
    nodes, routes, size, number, right = len(visits), len(values), len(weights), 0, 0
    load, gain = np.zeros(routes, np.int64), np.zeros(routes)
    inside, chosen = np.zeros(nodes, np.bool_), np.zeros(size, np.int64)
    for p in range(size):
        right += weights[p]
    right //= parts
    for first in range(1, nodes):
        inside[:] = False
        load[:] = 0
        for p in range(size):
            best, most = first, -1.0
            if p > 0:
                for j in range(1, nodes):
                    if inside[j]:
                        continue
                    shared = 0.0
                    for r in range(routes):
                        if visits[j, r]:
                            shared += values[r] * load[r]
                    if shared > most:
                        best, most = j, shared
            inside[best], chosen[p] = True, best
            for r in range(routes):
                if visits[best, r]:
                    load[r] += weights[p]
        total, better = 0.0, True
        for r in range(routes):
            total += values[r] * (load[r] // parts)
        while better:
            better = False
            for p in range(size):
                old, base = chosen[p], 0.0
                for r in range(routes):
                    if visits[old, r]:
                        load[r] -= weights[p]
                    without = load[r] // parts
                    base += values[r] * without
                    gain[r] = values[r] * ((load[r] + weights[p]) // parts - without)
                best, most = old, total + 1e-9
                for j in range(1, nodes):
                    if inside[j]:
                        continue
                    value = base
                    for r in range(routes):
                        if visits[j, r]:
                            value += gain[r]
                    if value > most:
                        best, most = j, value
                if best != old:
                    inside[old], inside[best], chosen[p], total, better = False, True, best, most, True
                for r in range(routes):
                    if visits[best, r]:
                        load[r] += weights[p]
        if total > right + least and number < len(excess):
            for p in range(size):
                members[number, p] = chosen[p]
            excess[number] = total - right
            number += 1
    return number
