"""Ways to cut a tour into routes, compiled. Imports numba: import it inside functions only.

Arrays with the rows ``out``, ``on`` and ``back`` hold, for each customer in the order of the tour, the move from the depot, that to the
next customer (the last entry is not used) and that to the depot.
"""

import math

import numpy as np

from ....formulations.kernels import inner, kernel
from ....formulations.stop_kernel import asked

ROUNDING = 1e-14
"""Part of a limit by which a route may exceed it: far less than the judge lets pass."""

LOOK = 1 << 16
"""Steps between looks at the flag."""


@kernel("(i8[::1], read(f8[::1]), f8, f8, i8, f8[:, ::1])")
def cheapest_cut(flag, demand, segment, capacity, most, costs):  # type: ignore[no-untyped-def]
    """Cut after every ``segment`` of demand, from all places on that make a difference; the cheapest way.

    A customer across a cut belongs to the route before it. Returns whether each customer is the last of its route; of ways with at most
    ``most`` routes, if there are any. Ways with a route above ``capacity`` do not count.
    """
    n = len(demand)
    out, on, back = costs
    until, load = np.empty(n), 0.0
    for k in range(n):
        load += demand[k]
        until[k] = load
    best, best_routes, chosen = math.inf, n + 1, -1.0
    steps = 0
    for candidate in range(n + 1):
        first = until[candidate] % segment if candidate < n else 0.0
        total, routes, load = out[0], 1, 0.0
        cuts = math.floor(-first / segment)
        for k in range(n):
            load += demand[k]
            if load > capacity * (1 + ROUNDING):
                total = math.inf
                break
            passed = math.floor((until[k] - first) / segment)
            if passed > cuts and k < n - 1:
                total += back[k] + out[k + 1]
                routes += 1
                load = 0.0
            elif k < n - 1:
                total += on[k]
            cuts = passed
        total += back[n - 1]
        if total < math.inf and (max(routes - most, 0), total) < (max(best_routes - most, 0), best):
            best, best_routes, chosen = total, routes, first
        steps += n
        if steps > LOOK:
            steps = 0
            if asked(flag):
                break
    last = np.zeros(n, np.bool_)
    if chosen >= 0:
        cuts = math.floor(-chosen / segment)
        for k in range(n):
            passed = math.floor((until[k] - chosen) / segment)
            last[k] = passed > cuts or k == n - 1
            cuts = passed
    return last


@kernel("(i8[::1], read(f8[::1]), read(f8[::1]), read(f8[::1]), read(f8[::1]), f8[:, ::1], f8[:, ::1], f8, UniTuple(f8, 4), f8, f8, i8)")
def best_split(flag, demand, service, ready, due, distance, time, capacity, limits, unit_cost, fixed_cost, most):  # type: ignore[no-untyped-def]
    """The cheapest way to cut a tour into at most ``most`` routes that keep all limits: a shortest path, route by route.

    ``limits`` are the depot's window, the longest duration and the longest distance. Returns whether each customer is the last of its
    route, how many are on a route of their own that breaks a limit, since they fit on no other one, and the cost; all False where there are
    too few routes, or it was asked to stop.
    """
    n = len(demand)
    opening, closing, max_duration, max_distance = limits
    fleet = most < n
    layers = most if fleet else 1
    value = np.full((layers + 1, n + 1), math.inf)
    before = np.full((layers + 1, n + 1), -1)
    value[0, 0] = 0.0
    penalty = 1.0 + n * fixed_cost + 2.0 * unit_cost * (_sum(distance[0]) + _sum(distance[1]) + _sum(distance[2]))
    last = np.zeros(n, np.bool_)
    steps = 0
    for i in range(n):
        load, length, clock, waiting = 0.0, distance[0, i], opening, 0.0
        slack = closing - opening
        reached = opening + time[0, i]
        for j in range(i, n):
            if j > i:
                length += distance[1, j - 1]
                reached = clock + service[j - 1] + time[1, j - 1]
            load += demand[j]
            fits = load <= capacity * (1 + ROUNDING) and reached <= due[j] + ROUNDING * abs(due[j])
            if not fits and j > i:
                break
            begin = max(reached, ready[j])
            waiting += begin - reached
            slack = min(slack, waiting + max(0.0, due[j] - begin))
            clock = begin
            finish = clock + service[j] + time[2, j]
            driven = length + distance[2, j]
            spare = min(waiting, min(slack, waiting + max(0.0, closing - finish)))
            good = (
                fits
                and finish <= closing + ROUNDING * abs(closing)
                and driven <= max_distance * (1 + ROUNDING)
                and finish - opening - spare <= max_duration * (1 + ROUNDING)
            )
            if good or j == i:
                cost = fixed_cost + unit_cost * driven
                if not good:
                    cost += penalty
                for k in range(layers):
                    onward = k + 1 if fleet else 0
                    if value[k, i] + cost < value[onward, j + 1]:
                        value[onward, j + 1] = value[k, i] + cost
                        before[onward, j + 1] = i
            if not fits:
                break
            steps += layers
            if steps > LOOK:
                steps = 0
                if asked(flag):
                    return last, 0, math.inf
    return _walked(value, before, penalty, fleet)


@kernel("(i8[::1], read(f8[::1]), f8[:, ::1], f8, f8, f8, i8)")
def linear_split(flag, demand, costs, capacity, unit_cost, fixed_cost, most):  # type: ignore[no-untyped-def]
    """``best_split`` where loads are whole numbers and the only limit, in time that grows with the customers alone (Vidal 2016).

    A route from ``i`` to ``j`` costs what depends on ``i`` and what depends on ``j``: those begins of a route that can still be the best
    one wait in a queue, the cheapest first, until their load is too much.
    """
    out, on, back = costs
    n = len(demand)
    fleet = most < n
    layers = most if fleet else 1
    along, until = np.zeros(n), np.zeros(n + 1)
    for k in range(n):
        along[k] = along[k - 1] + on[k - 1] if k > 0 else 0.0
        until[k + 1] = until[k] + demand[k]
    penalty = 1.0 + n * fixed_cost + 2.0 * unit_cost * (_sum(out) + _sum(on) + _sum(back))
    value, before = np.full((layers + 1, n + 1), math.inf), np.full((layers + 1, n + 1), -1)
    value[0, 0] = 0.0
    queue, begun = np.zeros(n, np.int64), np.zeros(n)
    last = np.zeros(n, np.bool_)
    for layer in range(layers):
        if asked(flag):
            return last, 0, math.inf
        onward = layer + 1 if fleet else 0
        head, tail = 0, 0
        for j in range(n):
            if value[layer, j] < math.inf:
                new = value[layer, j] + fixed_cost + unit_cost * (out[j] - along[j])
                while tail > head and begun[tail - 1] > new:
                    tail -= 1
                queue[tail], begun[tail] = j, new
                tail += 1
            while tail > head and queue[head] < j and until[j + 1] - until[queue[head]] > capacity * (1 + ROUNDING):
                head += 1
            if tail > head:
                heavy = until[j + 1] - until[queue[head]] > capacity * (1 + ROUNDING)
                value[onward, j + 1] = begun[head] + unit_cost * (along[j] + back[j]) + (penalty if heavy else 0.0)
                before[onward, j + 1] = queue[head]
    return _walked(value, before, penalty, fleet)


@inner
def _sum(row):  # type: ignore[no-untyped-def]
    total = 0.0
    for k in range(len(row)):
        total += row[k]
    return total


@inner
def _least(value, column):  # type: ignore[no-untyped-def]
    """The first row of the least value in a column."""
    row = 0
    for k in range(1, len(value)):
        if value[k, column] < value[row, column]:
            row = k
    return row


@inner
def _walked(value, before, penalty, fleet):  # type: ignore[no-untyped-def]
    """The cut at the end of a shortest path, back from its last customer."""
    n = value.shape[1] - 1
    last = np.zeros(n, np.bool_)
    layer = _least(value, n) if fleet else 0
    total, at = value[layer, n], n
    if not total < math.inf:
        return last, 0, math.inf
    broken = int(total / penalty)
    while at > 0:
        last[at - 1] = True
        at = before[layer, at]
        if fleet:
            layer -= 1
    return last, broken, total - broken * penalty


@kernel("(i8[::1], f8[:, ::1], i8)")
def even_split(flag, costs, most):  # type: ignore[no-untyped-def]
    """Cut a tour into at most ``most`` routes, the longest as short as it can be: whether each customer is the last of its route.

    Among those, no attempt is made to keep the others short. All False where it was asked to stop.
    """
    out, on, back = costs
    n = len(out)
    along = np.zeros(n)
    for k in range(1, n):
        along[k] = along[k - 1] + on[k - 1]
    value = np.full((most + 1, n + 1), math.inf)
    before = np.full((most + 1, n + 1), -1)
    value[0, 0] = 0.0
    last = np.zeros(n, np.bool_)
    steps = 0
    for k in range(1, most + 1):
        value[k, 0] = 0.0
        for j in range(1, n + 1):
            best, chosen = math.inf, -1
            for i in range(j - 1, -1, -1):
                driven = along[j - 1] - along[i]
                steps += 1
                if driven >= best:
                    break
                longest = max(value[k - 1, i], out[i] + driven + back[j - 1])
                if longest < best:
                    best, chosen = longest, i
            value[k, j], before[k, j] = best, chosen
            if steps > LOOK:
                steps = 0
                if asked(flag):
                    return last
    k = _least(value, n)
    at = n
    while at > 0:
        last[at - 1] = True
        at = before[k, at]
        k -= 1
    return last
