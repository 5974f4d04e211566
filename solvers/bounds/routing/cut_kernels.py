"""Violated cuts of a point, compiled: least ones between the depot and each customer, and those around sets with too much load."""

import math

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked


@kernel("i8(i8[::1], i8[::1], i8[::1], i8[::1], f8[::1], f8[::1], i8[::1], f8, b1[:, ::1])")
def cuts_below(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, starts, heads, twins, capacity, need, order, least, inside
):
    """Sets of customers whose cuts from the depot, node 0, have less capacity than one of them needs, by ``least``; returns their number.

    Edges of node ``i`` are those from ``starts[i]`` up to ``starts[i + 1]``; each stands there at both of its ends, which are twins.
    ``order`` lists the nodes to be asked about, each of which is in one set at most. ``inside``, shape (cuts, nodes), receives the sets.

    Source: Edmonds and Karp (1972) for shortest augmenting paths.
    """
    nodes = len(starts) - 1
    covered, seen = np.zeros(nodes, np.bool_), np.zeros(nodes, np.bool_)
    queue, by = np.empty(nodes, np.int64), np.empty(nodes, np.int64)
    left = np.empty(len(capacity))
    found = 0
    for node in order:
        if found == len(inside) or asked(flag):
            break
        if covered[node]:
            continue
        flow = 0.0
        for e in range(len(capacity)):
            left[e] = capacity[e]
        while flow < need[node] - least:
            seen[:] = False
            seen[0], queue[0] = True, 0
            begin, end = 0, 1
            while begin < end and not seen[node]:
                i = queue[begin]
                begin += 1
                for e in range(starts[i], starts[i + 1]):
                    j = heads[e]
                    if left[e] > 1e-9 and not seen[j]:
                        seen[j], by[j], queue[end] = True, e, j
                        end += 1
            if not seen[node]:
                break
            most, j = need[node], node
            while j != 0:
                most = min(most, left[by[j]])
                j = heads[twins[by[j]]]
            j = node
            while j != 0:
                left[by[j]] -= most
                left[twins[by[j]]] += most
                j = heads[twins[by[j]]]
            flow += most
        if flow >= need[node] - least:
            continue
        # All that the depot does not reach is a least cut, and all that reaches the node another one: the smaller of both.
        outside = nodes - end
        for j in range(nodes):
            inside[found, j] = not seen[j]
            seen[j] = False
        seen[node], queue[0] = True, node
        begin, end = 0, 1
        while begin < end:
            j = queue[begin]
            begin += 1
            for e in range(starts[j], starts[j + 1]):
                i = heads[e]
                if left[twins[e]] > 1e-9 and not seen[i]:
                    seen[i], queue[end] = True, i
                    end += 1
        for j in range(nodes):
            if end < outside:
                inside[found, j] = seen[j]
            covered[j] = covered[j] or inside[found, j]
        found += 1
    return found


@kernel("i8(i8[::1], i8[::1], i8[::1], f8[::1], f8[::1], f8[::1], f8, f8, i8, b1[:, ::1])")
def overloaded_sets(  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    flag, starts, heads, capacity, demand, keys, largest, least, size, inside
):
    """Sets of customers with fewer edges to others, by ``least``, than the vehicles for their loads need; returns their number.

    They are grown from each customer, up to ``size``, by whoever is joined to the set most. Edges and ``inside`` are as for ``cuts_below``;
    sums of ``keys``, shape (nodes,), tell sets apart; ``largest`` is the load of a vehicle.

    Source: Augerat, Belenguer, Benavent, Corberán, Naddef, Rinaldi (1995), "Computational results with a branch and cut code for the
    capacitated vehicle routing problem": greedy shrinking.
    """
    nodes = len(starts) - 1
    degree = np.zeros(nodes)
    for i in range(nodes):
        for e in range(starts[i], starts[i + 1]):
            degree[i] += capacity[e]
    joined, taken = np.zeros(nodes), np.zeros(nodes, np.bool_)
    members, touched = np.empty(nodes, np.int64), np.empty(nodes, np.int64)
    found, known = 0, np.zeros(len(inside))
    for seed in range(1, nodes):
        if found == len(inside) or asked(flag):
            break
        joined[:] = 0.0
        taken[:] = False
        count, near, node = 0, 0, seed
        load, around, most, best, key, best_key = 0.0, 0.0, least, 0, 0.0, 0.0
        while count < size:
            taken[node] = True
            members[count] = node
            count += 1
            load += demand[node]
            around += degree[node] - 2.0 * joined[node]
            key += keys[node]
            lack = 2.0 * math.ceil(load / largest - 1e-9) - around
            if lack > most:
                most, best, best_key = lack, count, key
            for e in range(starts[node], starts[node + 1]):
                j = heads[e]
                if j != 0 and not taken[j]:
                    if joined[j] == 0.0:
                        touched[near] = j
                        near += 1
                    joined[j] += capacity[e]
            node, left = 0, 0
            for k in range(near):
                j = touched[k]
                if not taken[j]:
                    touched[left] = j
                    left += 1
                    if node == 0 or joined[j] > joined[node]:
                        node = j
            near = left
            if node == 0:
                break
        if best == 0:
            continue
        fresh = True
        for k in range(found):
            if abs(known[k] - best_key) < 1e-9:
                fresh = False
        if fresh:
            known[found] = best_key
            for k in range(best):
                inside[found, members[k]] = True
            found += 1
    return found
