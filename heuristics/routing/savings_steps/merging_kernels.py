"""Clarke and Wright's merging loop, compiled. Imports numba: import it inside functions only."""

import numpy as np

from ....formulations.kernels import inner, kernel
from ....formulations.stop_kernel import asked

ROUNDING = 1e-14
"""Part of a limit by which a route may exceed it: far less than the judge lets pass."""


@inner
def feasible(route, size, length_to, time_to, limits, out, back, service, ready, due):  # type: ignore[no-untyped-def]
    """Whether a route keeps every window, and the longest duration and distance, leaving as late as it can.

    ``length_to[k]`` and ``time_to[k]`` are those of the move to ``route[k + 1]``; ``out`` and ``back`` hold distances and durations
    between depot and sites, and ``limits`` the depot's window, the longest duration and the longest distance.
    """
    opening, closing, max_duration, max_distance = limits
    clock, length, waiting = opening, out[0, route[0]], 0.0
    slack = closing - opening
    reached = clock + out[1, route[0]]
    for k in range(size + 1):
        latest = due[route[k]] if k < size else closing
        begin = max(reached, ready[route[k]]) if k < size else reached
        if reached > latest + ROUNDING * abs(latest):
            return False
        waiting += begin - reached
        slack = min(slack, waiting + max(0.0, latest - begin))
        clock = begin
        if k < size:
            last = k + 1 == size
            length += back[0, route[k]] if last else length_to[k]
            reached = clock + service[route[k]] + (back[1, route[k]] if last else time_to[k])
    duration = clock - opening - min(waiting, slack)
    return length <= max_distance * (1 + ROUNDING) and duration <= max_duration * (1 + ROUNDING)


@kernel(
    "(i8[::1], i8[::1], i8[::1], f8[::1], f8[::1], i8, i8, i8, "
    "Tuple((i8[::1], i8[::1], i8[::1], i8[::1], i8[::1], f8[::1], i8[::1], f8[::1], f8[::1])), b1, UniTuple(f8, 4), "
    "f8[:, ::1], f8[:, ::1], read(f8[::1]), read(f8[::1]), read(f8[::1]), f8, b1)"
)
def merge(  # type: ignore[no-untyped-def]
    flag, pairs_i, pairs_j, pair_length, pair_time, losing, routes, limit, state, bounded, limits, out, back, service, ready, due, capacity,
    both_ways,
):  # fmt: skip
    """Join route ends in the order of the pairs; ``losing`` is where they begin to cost more than they save. Returns the routes left.

    ``state`` is changed in place: routes are linked lists, whose ends are found in O(1). Where no route is ``bounded`` by windows or
    lengths, only joins that are made cost a walk.
    """
    route_of, following, preceding, first, last, load, size, length_next, time_next = state
    n = len(load)
    buffer = np.empty(n, np.int64)
    lengths, times = np.empty(n), np.empty(n)
    for p in range(len(pairs_i)):
        if asked(flag) or (p >= losing and routes <= limit):
            break
        i, j = pairs_i[p], pairs_j[p]
        a, b = route_of[i], route_of[j]
        if a == b or load[a] + load[b] > capacity * (1 + ROUNDING):
            continue
        flip_a = last[a] != i
        flip_b = first[b] != j
        if (flip_a and (first[a] != i or not both_ways)) or (flip_b and (last[b] != j or not both_ways)):
            continue
        count = 0
        for side, flipped in ((a, flip_a), (b, flip_b)):
            if count > 0:
                lengths[count - 1], times[count - 1] = pair_length[p], pair_time[p]
            node = last[side] if flipped else first[side]
            while node >= 0:
                buffer[count] = node
                onward = preceding[node] if flipped else following[node]
                if onward >= 0:
                    tail = onward if flipped else node
                    lengths[count], times[count] = length_next[tail], time_next[tail]
                count += 1
                node = onward
        if bounded and not feasible(buffer, count, lengths, times, limits, out, back, service, ready, due):
            continue
        for k in range(count):
            route_of[buffer[k]] = a
            following[buffer[k]] = buffer[k + 1] if k + 1 < count else -1
            preceding[buffer[k]] = buffer[k - 1] if k > 0 else -1
            length_next[buffer[k]], time_next[buffer[k]] = lengths[k], times[k]
        first[a], last[a] = buffer[0], buffer[count - 1]
        load[a] += load[b]
        size[a], size[b] = count, 0
        routes -= 1
    return routes
