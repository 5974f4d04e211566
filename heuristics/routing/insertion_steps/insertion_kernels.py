"""Insertion of one customer after the other, compiled. Imports numba: import it inside functions only.

Nodes are the start of a route, 0, the customers ``1..n``, and its end, ``n + 1``. ``limits`` are the earliest departure, the latest
return, the longest duration and the longest distance; ``timed`` tells whether anybody can have to wait or come too late.
"""

import math

import numpy as np

from ....formulations.kernels import inner, kernel
from ....formulations.stop_kernel import asked

ROUNDING = 1e-14
"""Part of a limit by which a route may exceed it: far less than the judge lets pass."""

_DATA = "Tuple((f8[::1], f8[::1], f8[::1], f8[::1], f8[:, ::1], f8[:, ::1]))"


@kernel(f"(i8[::1], {_DATA}, f8, UniTuple(f8, 4), b1, f8, f8, f8, b1)")
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


@kernel(f"(i8[::1], {_DATA}, f8[:, ::1], read(f8[::1]), i8, f8, UniTuple(f8, 4), b1, b1, b1)")
def best_insertion(flag, data, inward, reward, fleet, capacity, limits, timed, kept, density):  # type: ignore[no-untyped-def]
    """Add the customer of the largest reward, or reward for the distance that it adds, where it adds least, while any fits.

    ``inward`` are distances by where they lead, then by where they begin; ``kept`` says that limits ask for nothing but the distance that
    is added: then a customer's best place on a route stays it until somebody is put there, and is only compared with the two places beside
    the newcomer. Returns the route of each customer, -1 for those left out, and its place on it.
    """
    demand = data[0]
    n = len(demand) - 2
    # Rows of routes that are never opened are never written, and take no memory.
    routes, place_of = np.empty((fleet, n + 2), np.int64), np.empty((fleet, n + 2), np.int64)
    least_of, extra_of = np.empty((fleet, n + 2)), np.empty((fleet, n + 2))
    size, load, begin, latest = np.zeros(fleet, np.int64), np.zeros(fleet), np.zeros(n + 2), np.zeros(n + 2)
    extra, route_of = np.full(n + 2, math.inf), np.full(n + 2, -1)  # on the best route of each customer
    left = np.ones(n + 2, np.bool_)
    left[0] = left[n + 1] = False
    begun, open_, to, at = 0, 1, 0, -1  # routes with a customer, and the next one; where the last customer was put
    fresh = False  # whether nobody has looked at the next one yet
    while not asked(flag):
        if begun < min(open_, fleet):
            for u in range(n + 2):
                place_of[begun, u], least_of[begun, u], extra_of[begun, u] = 0, math.inf, math.inf
            begun += 1
        for step in range(1 + fresh):
            r = to if step == 0 else open_ - 1
            length, busy = _schedule(routes[r], size[r], data, limits, begin, latest)
            for u in range(1, n + 1):
                if asked(flag):
                    break
                if not left[u]:
                    continue
                if load[r] + demand[u] > capacity * (1 + ROUNDING):
                    least_of[r, u] = math.inf
                elif not kept or size[r] < 2 or place_of[r, u] == at:
                    found = _best_place(u, routes[r], size[r], data, inward, limits, timed, kept, begin, latest, length, busy)
                    least_of[r, u], place_of[r, u] = found
                elif least_of[r, u] < math.inf:
                    found = _beside(u, at, routes[r], size[r], data, inward, least_of[r, u], place_of[r, u])
                    least_of[r, u], place_of[r, u] = found
                extra_of[r, u] = least_of[r, u]
                if kept and least_of[r, u] < math.inf:
                    k = place_of[r, u]
                    extra_of[r, u], _ = _inserted(u, k, routes[r], size[r], data, limits, timed, begin, latest, length, busy)
                if route_of[u] == r:
                    extra[u] = math.inf
                    for other in range(open_):
                        if extra_of[other, u] < extra[u]:
                            extra[u], route_of[u] = extra_of[other, u], other
                elif extra_of[r, u] < extra[u] or (extra_of[r, u] == extra[u] and r < route_of[u]):
                    extra[u], route_of[u] = extra_of[r, u], r
        chosen, best, least = -1, -math.inf, math.inf
        for u in range(1, n + 1):
            if left[u] and extra[u] < math.inf:
                worth = reward[u] if not density else reward[u] / extra[u] if extra[u] > 0 else math.inf if reward[u] > 0 else 0.0
                if worth > best or (worth == best and extra[u] < least):
                    chosen, best, least = u, worth, extra[u]
        if chosen < 0:
            break
        to = route_of[chosen]
        at = place_of[to, chosen]
        _put(routes[to], size[to], chosen, at)
        size[to] += 1
        load[to] += demand[chosen]
        left[chosen] = False
        fresh = to == open_ - 1 and open_ < fleet
        open_ += fresh
    route_of, place = np.full(n + 2, -1), np.zeros(n + 2, np.int64)
    for r in range(open_):
        for k in range(size[r]):
            route_of[routes[r, k]], place[routes[r, k]] = r, k
    return route_of, place


@inner
def _best_place(u, route, size, data, inward, limits, timed, kept, begin, latest, length, busy):  # type: ignore[no-untyped-def]
    """Place on a route at which visiting ``u`` adds the least distance, the first of several; whatever limits say, if ``kept``."""
    _, service, ready, due, distance, _ = data
    least, place = math.inf, 0
    end = len(service) - 1
    for k in range(size + 1):
        i, j = route[k - 1] if k > 0 else 0, route[k] if k < size else end
        if timed:
            # Both rise along the route, so that none later, or none so far, has a place for the window.
            if k > 0 and begin[k - 1] > due[u] + ROUNDING * abs(due[u]):
                break
            if ready[u] + service[u] > latest[k] + ROUNDING * abs(latest[k]):
                continue
        extra = inward[u, i] + distance[u, j] - (distance[i, j] if size > 0 else 0.0)
        if extra < least:
            if not kept:
                extra, _ = _inserted(u, k, route, size, data, limits, timed, begin, latest, length, busy)
            if extra < least:
                least, place = extra, k
    return least, place


@inner
def _beside(u, at, route, size, data, inward, least, place):  # type: ignore[no-untyped-def]
    """The best place of ``u`` and what it adds, where somebody was put at another place, ``at``."""
    distance, end = data[4], len(data[0]) - 1
    i, x, j = route[at - 1] if at > 0 else 0, route[at], route[at + 1] if at + 1 < size else end
    place += place > at
    before = distance[i, u] + inward[x, u] - distance[i, x]
    if before < least or (before == least and at < place):
        least, place = before, at
    after = distance[x, u] + inward[j, u] - distance[x, j]
    if after < least or (after == least and at + 1 < place):
        least, place = after, at + 1
    return least, place


@inner
def _put(route, size, u, place):  # type: ignore[no-untyped-def]
    for k in range(size, place, -1):
        route[k] = route[k - 1]
    route[place] = u


@inner
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


@inner
def _inserted(u, k, route, size, data, limits, timed, begin, latest, length, busy):  # type: ignore[no-untyped-def]
    """Added distance of visiting ``u`` before the ``k``-th stop, and the delay of that stop.

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


@inner
def _duration(u, k, route, size, data, limits):  # type: ignore[no-untyped-def]
    """Shortest duration of the route with ``u`` before its ``k``-th stop, leaving as late as delays nothing."""
    _, service, ready, due, _, time = data
    opening, closing, _, _ = limits
    end = len(service) - 1
    clock, waiting, slack, at = opening, 0.0, max(0.0, due[0] - opening), 0
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
