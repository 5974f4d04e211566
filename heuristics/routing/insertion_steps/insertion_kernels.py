"""Insertion of one customer after the other, compiled. Imports numba: import it inside functions only.

Nodes are the start of a route, 0, the customers ``1..n``, and its end, ``n + 1``. ``limits`` are the earliest departure, the latest
return, the longest duration and the longest distance; ``timed`` tells whether anybody can have to wait or come too late.
"""

from __future__ import annotations

import math

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked

ROUNDING = 1e-14
"""Part of a limit by which a route may exceed it: far less than the judge lets pass."""


@kernel()
def sequential_insertion(flag, data, capacity, limits, timed, mu, lamda, alpha1, by_due):  # type: ignore[no-untyped-def]
    """Solomon's I1: route by route, each from a seed, the customer that is worth most at its best place.

    Returns the customers in the order of their routes, and whether each is the last of its route. Who fits on no route has one alone, as
    have all that are left where it was asked to stop.
    """
    demand, _, _, due, distance, _ = data
    n = len(demand) - 2
    order, last = np.zeros(n, np.int64), np.zeros(n, np.bool_)
    left = np.ones(n + 2, np.bool_)
    left[0] = left[n + 1] = False
    route, begin, latest = np.zeros(n + 2, np.int64), np.zeros(n + 2), np.zeros(n + 2)
    count, size, load = 0, 0, 0.0
    while count + size < n:
        stopped = asked(flag)
        if size == 0:
            seed = -1
            for u in range(1, n + 1):
                if left[u] and (seed < 0 or (due[u] < due[seed] if by_due else distance[0, u] > distance[0, seed])):
                    seed = u
            route[0], size, load = seed, 1, demand[seed]
            left[seed] = False
        else:
            chosen, place, worth = -1, 0, -math.inf
            if not stopped:
                length, busy = _schedule(route, size, data, limits, begin, latest)
                for u in range(1, n + 1):
                    if asked(flag):
                        break
                    if not left[u] or load + demand[u] > capacity * (1 + ROUNDING):
                        continue
                    least, at = math.inf, -1
                    for k in range(size + 1):
                        extra, push = _inserted(u, k, route, size, data, limits, timed, begin, latest, length, busy)
                        if extra < math.inf:
                            i = route[k - 1] if k > 0 else 0
                            j = route[k] if k < size else n + 1
                            price = alpha1 * (extra + (1.0 - mu) * distance[i, j]) + (1.0 - alpha1) * push
                            if price < least:
                                least, at = price, k
                    if at >= 0 and lamda * distance[0, u] - least > worth:
                        chosen, place, worth = u, at, lamda * distance[0, u] - least
            if chosen >= 0:
                _put(route, size, chosen, place)
                size += 1
                load += demand[chosen]
                left[chosen] = False
                continue
            for k in range(size):
                order[count + k] = route[k]
            count += size
            last[count - 1] = True
            size = 0
    for k in range(size):
        order[count + k] = route[k]
    if n > 0:
        last[n - 1] = True
    return order, last


@kernel()
def best_insertion(flag, data, reward, fleet, capacity, limits, timed, density):  # type: ignore[no-untyped-def]
    """Add the customer of the largest reward, or reward for the distance that it adds, where it adds least, while any fits.

    Returns the route of each customer, -1 for those left out, and its place on it.
    """
    demand = data[0]
    n = len(demand) - 2
    routes, size = np.zeros((fleet, n + 2), np.int64), np.zeros(fleet, np.int64)
    begin, latest = np.zeros((fleet, n + 2)), np.zeros((fleet, n + 2))
    length, busy, load = np.zeros(fleet), np.zeros(fleet), np.zeros(fleet)
    extra_of, place_of = np.full((fleet, n + 2), math.inf), np.zeros((fleet, n + 2), np.int64)
    left = np.ones(n + 2, np.bool_)
    left[0] = left[n + 1] = False
    fresh = np.ones(fleet, np.bool_)
    open_ = 1  # routes with a customer, and the next one
    while not asked(flag):
        for r in range(open_):
            if not fresh[r]:
                continue
            fresh[r] = False
            length[r], busy[r] = _schedule(routes[r], size[r], data, limits, begin[r], latest[r])
            for u in range(1, n + 1):
                extra_of[r, u] = math.inf
                if asked(flag):
                    break
                if not left[u] or load[r] + demand[u] > capacity * (1 + ROUNDING):
                    continue
                for k in range(size[r] + 1):
                    extra, _ = _inserted(u, k, routes[r], size[r], data, limits, timed, begin[r], latest[r], length[r], busy[r])
                    if extra < extra_of[r, u]:
                        extra_of[r, u], place_of[r, u] = extra, k
        chosen, to, best, least = -1, -1, -math.inf, math.inf
        for u in range(1, n + 1):
            if not left[u]:
                continue
            for r in range(open_):
                extra = extra_of[r, u]
                if not extra < math.inf:
                    continue
                worth = reward[u] if not density else reward[u] / extra if extra > 0 else math.inf if reward[u] > 0 else 0.0
                if worth > best or (worth == best and extra < least):
                    chosen, to, best, least = u, r, worth, extra
        if chosen < 0:
            break
        _put(routes[to], size[to], chosen, place_of[to, chosen])
        size[to] += 1
        load[to] += demand[chosen]
        left[chosen] = False
        fresh[to] = True
        if to == open_ - 1 and open_ < fleet:
            open_ += 1
    route_of, at = np.full(n + 2, -1), np.zeros(n + 2, np.int64)
    for r in range(fleet):
        for k in range(size[r]):
            route_of[routes[r, k]], at[routes[r, k]] = r, k
    return route_of, at


@kernel()
def _put(route, size, u, place):  # type: ignore[no-untyped-def]
    for k in range(size, place, -1):
        route[k] = route[k - 1]
    route[place] = u


@kernel()
def _schedule(route, size, data, limits, begin, latest):  # type: ignore[no-untyped-def]
    """Earliest and latest begin at each visit; returns distance driven, and time driven and served."""
    _, service, ready, due, distance, time = data
    opening, closing, _, _ = limits
    end = len(service) - 1
    at, clock, length, busy = 0, opening, 0.0, 0.0
    for k in range(size):
        u = route[k]
        busy += time[at, u] + service[u]
        length += distance[at, u]
        clock = max(clock + (service[at] if k > 0 else 0.0) + time[at, u], ready[u])
        begin[k] = clock
        at = u
    begin[size] = clock + (service[at] if size > 0 else 0.0) + time[at, end]
    allowed = closing
    latest[size] = closing
    for k in range(size - 1, -1, -1):
        u, onward = route[k], route[k + 1] if k + 1 < size else end
        allowed = min(due[u], allowed - time[u, onward] - service[u])
        latest[k] = allowed
    return length + distance[at, end], busy + time[at, end]


@kernel()
def _inserted(u, k, route, size, data, limits, timed, begin, latest, length, busy):  # type: ignore[no-untyped-def]
    """What it adds to the distance to visit ``u`` before the ``k``-th stop, and how much later that stop is begun.

    Infinite where a limit is exceeded.
    """
    _, service, ready, due, distance, time = data
    opening, _, max_duration, max_distance = limits
    end = len(service) - 1
    i = route[k - 1] if k > 0 else 0
    j = route[k] if k < size else end
    extra = distance[i, u] + distance[u, j] - (distance[i, j] if size > 0 else 0.0)
    if (length if size > 0 else 0.0) + extra > max_distance * (1 + ROUNDING):
        return math.inf, 0.0
    longer = time[i, u] + service[u] + time[u, j] - (time[i, j] if size > 0 else 0.0)
    if not timed:
        return (extra if (busy if size > 0 else 0.0) + longer <= max_duration * (1 + ROUNDING) else math.inf), longer
    reached = (begin[k - 1] + service[i] if k > 0 else opening) + time[i, u]
    if reached > due[u] + ROUNDING * abs(due[u]):
        return math.inf, 0.0
    after = max(reached, ready[u]) + service[u] + time[u, j]
    if j != end:
        after = max(after, ready[j])
    if after > latest[k] + ROUNDING * abs(latest[k]):
        return math.inf, 0.0
    if max_duration < math.inf and _duration(u, k, route, size, data, limits) > max_duration * (1 + ROUNDING):
        return math.inf, 0.0
    return extra, after - begin[k]


@kernel()
def _duration(u, k, route, size, data, limits):  # type: ignore[no-untyped-def]
    """Shortest duration of the route with ``u`` before its ``k``-th stop, leaving as late as delays nothing."""
    _, service, ready, due, _, time = data
    opening, closing, _, _ = limits
    end = len(service) - 1
    clock, waiting, slack, at = opening, 0.0, closing - opening, 0
    for step in range(size + 1):
        node = route[step] if step < k else u if step == k else route[step - 1]
        reached = clock + (service[at] if step > 0 else 0.0) + time[at, node]
        clock = max(reached, ready[node])
        waiting += clock - reached
        slack = min(slack, waiting + max(0.0, due[node] - clock))
        at = node
    clock += service[at] + time[at, end]
    slack = min(slack, waiting + max(0.0, closing - clock))
    return clock - opening - min(waiting, slack)
