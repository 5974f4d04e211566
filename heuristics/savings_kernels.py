"""Clarke and Wright's merging loop, compiled. Imports numba: import it inside functions only."""

from __future__ import annotations

import numpy as np

from ..formulations.compiled import kernel


@kernel()
def feasible(route, size, depot, time, distance, service, ready, due, max_duration, max_distance):  # type: ignore[no-untyped-def]
    """Whether a route keeps every window, and the longest duration and distance, leaving as late as it can."""
    clock, length, waiting = ready[depot], 0.0, 0.0
    slack = due[depot] - ready[depot]
    at, stay = depot, 0.0
    for k in range(size + 1):
        to = route[k] if k < size else depot
        length += distance[at, to]
        reached = clock + stay + time[at, to]
        begin = max(reached, ready[to]) if k < size else reached
        if reached > due[to] + 1e-9 * (1.0 + abs(due[to])):
            return False
        waiting += begin - reached
        slack = min(slack, waiting + max(0.0, due[to] - begin))
        clock, at = begin, to
        stay = service[to] if k < size else 0.0
    duration = clock - ready[depot] - min(waiting, slack)
    return length <= max_distance * (1 + 1e-9) and duration <= max_duration * (1 + 1e-9)


@kernel()
def merge(  # type: ignore[no-untyped-def]
    pairs_i, pairs_j, losing, routes, limit, depot, time, distance, service, ready, due, demand, capacity, max_duration,
    max_distance, both_ways,
):  # fmt: skip
    """Join route ends in the order of the pairs; ``losing`` is where they begin to cost more than they save."""
    n = len(demand)
    route_of = np.arange(n)
    # Routes are linked lists (next/previous); ends are found in O(1), walks cost the length of a route.
    following, preceding = np.full(n, -1), np.full(n, -1)
    first, last = np.arange(n), np.arange(n)
    load = demand.copy()
    size = np.ones(n, dtype=np.int64)
    buffer = np.empty(n, dtype=np.int64)
    for p in range(len(pairs_i)):
        if p >= losing and routes <= limit:
            break
        i, j = pairs_i[p], pairs_j[p]
        a, b = route_of[i], route_of[j]
        if a == b or load[a] + load[b] > capacity * (1 + 1e-12):
            continue
        flip_a = last[a] != i
        flip_b = first[b] != j
        if (flip_a and (first[a] != i or not both_ways)) or (flip_b and (last[b] != j or not both_ways)):
            continue
        count = 0
        node = first[a] if not flip_a else last[a]
        while node >= 0:
            buffer[count] = node
            count += 1
            node = following[node] if not flip_a else preceding[node]
        node = first[b] if not flip_b else last[b]
        while node >= 0:
            buffer[count] = node
            count += 1
            node = following[node] if not flip_b else preceding[node]
        if not feasible(buffer, count, depot, time, distance, service, ready, due, max_duration, max_distance):
            continue
        for k in range(count):
            route_of[buffer[k]] = a
            following[buffer[k]] = buffer[k + 1] if k + 1 < count else -1
            preceding[buffer[k]] = buffer[k - 1] if k > 0 else -1
        first[a], last[a] = buffer[0], buffer[count - 1]
        load[a] += load[b]
        size[a], size[b] = count, 0
        routes -= 1
    return route_of, first, following, size
