"""Greedy assignment, compiled. Imports numba: import it inside functions only."""

import math

import numpy as np

from ....formulations.kernels import kernel
from ....formulations.stop_kernel import asked

ROUNDING = 1e-14
"""Part of a limit by which a route may exceed it: far less than the judge lets pass."""


@kernel(
    "(i8[::1], Tuple((b1[::1], read(f8[::1]), read(f8[::1]), read(f8[::1]), read(f8[::1]), read(f8[::1]))), "
    "Tuple((i8[::1], i8[::1], f8[::1], f8[::1], f8[::1])), f8[:, ::1], f8[:, ::1], f8)"
)
def earliest_finisher(flag, sites, vehicles, distance, time, weight):  # type: ignore[no-untyped-def]
    """The vehicle that is free first takes the best customer that it can still bring home, until no vehicle can take any.

    The best is the nearest, or, where ``weight`` is a number, that of the largest reward less ``weight`` times the distance. ``sites`` are
    ``customer, demand, service, ready, due, reward``, ``vehicles`` are ``start, end, capacity, max_duration, max_distance``; all leave when
    their depot opens. Returns the vehicle of each site, -1 for none, and its place among the visits.
    """
    customer, demand, service, ready, due, reward = sites
    start, end, capacity, max_duration, max_distance = vehicles
    n, fleet = len(demand), len(start)
    vehicle_of, place = np.full(n, -1), np.zeros(n, np.int64)
    left, active, at, visits = np.empty(n, np.bool_), np.empty(fleet, np.bool_), np.empty(fleet, np.int64), np.zeros(fleet, np.int64)
    clock, driven, load = np.empty(fleet), np.zeros(fleet), np.zeros(fleet)
    for u in range(n):
        left[u] = customer[u]
    for v in range(fleet):
        clock[v], at[v], active[v] = ready[start[v]], start[v], True
    while not asked(flag):
        v = -1
        for k in range(fleet):
            if active[k] and (v < 0 or clock[k] < clock[v]):
                v = k
        if v < 0:
            break
        opening, closing = ready[start[v]], due[end[v]]
        chosen, best = -1, -math.inf
        for u in range(n):
            if not left[u] or load[v] + demand[u] > capacity[v] * (1 + ROUNDING):
                continue
            reached = clock[v] + time[at[v], u]
            if reached > due[u] + ROUNDING * abs(due[u]):
                continue
            finish = max(reached, ready[u]) + service[u] + time[u, end[v]]
            length = driven[v] + distance[at[v], u] + distance[u, end[v]]
            if finish > closing + ROUNDING * abs(closing) or finish - opening > max_duration[v] * (1 + ROUNDING):
                continue
            if length > max_distance[v] * (1 + ROUNDING):
                continue
            worth = -distance[at[v], u] if math.isnan(weight) else reward[u] - weight * distance[at[v], u]
            if worth > best:
                chosen, best = u, worth
        if chosen < 0:
            active[v] = False
            continue
        clock[v] = max(clock[v] + time[at[v], chosen], ready[chosen]) + service[chosen]
        driven[v] += distance[at[v], chosen]
        load[v] += demand[chosen]
        at[v] = chosen
        vehicle_of[chosen], place[chosen] = v, visits[v]
        visits[v] += 1
        left[chosen] = False
    return vehicle_of, place
