"""Insertion of both ends of a shipment into one route. Imports numba: import it inside functions only."""

from __future__ import annotations

import numpy as np

from .columns import (
    AHEAD,
    DEMAND,
    DUE,
    EARLY,
    FOLLOWING,
    FREE,
    KIND,
    LATE,
    LATEST,
    LENGTH,
    MAX_DISTANCE,
    MAX_DURATION,
    NODE_COLUMNS,
    PROFILE,
    READY,
    REST,
    ROOM,
    ROUTE,
    SERVICE,
    SITE,
    SPANNED,
    SPENT,
    TIMED,
    TOOK,
    TRIED,
    UNIT,
    WALKED,
)
from .route_kernels import hours, inlined, inner, opening, walked, word


@inlined
def _has_room(site, route, node, at, c):  # type: ignore[no-untyped-def]
    """Whether what is picked up at ``c`` has room on the move after node ``at``."""
    dims, fits = route.shape[1] - ROOM, True
    for d in range(dims):
        fits = fits and node[at, NODE_COLUMNS + 2 * dims + d] >= site[c, DEMAND + dims + d]
    return fits


@inner
def ship_on(ways, at_way, site, types, route, node, c, partner, r, least, random, places, flags):  # type: ignore[no-untyped-def]
    """Least cost, below ``least``, of visits of ``c`` and later ``partner`` on route ``r``, after the nodes that ``places`` receives."""
    k, head, tail = route[r, KIND], len(site) + 2 * r, len(site) + 2 * r + 1
    p, unit, longest = types[k, PROFILE], types[k, UNIT], types[k, MAX_DISTANCE] - route[r, LENGTH]
    i = head
    while i != tail:
        a, j = node[i, SITE], node[i, FOLLOWING]
        b = node[j, SITE]
        comes = ways[p, c, a, at_way[0]]
        free, took, late = 0, 0, 0
        if flags & TIMED:
            if node[i, FREE] > site[c, DUE]:
                break
            drives = ways[p, c, a, at_way[2]]
            free = node[i, FREE] + drives
            if free > site[c, DUE]:
                i = j
                continue
            free = opening(site, c, max(free, site[c, READY]), flags) + site[c, SERVICE]
            if flags & SPANNED:
                on_way = node[i, TOOK] + drives
                took = on_way + max(site[c, READY] - on_way - node[i, LATE], 0) + site[c, SERVICE]
                late = min(site[c, DUE] - on_way, node[i, LATE])
        if _has_room(site, route, node, i, c):
            at, onward = c, j  # the partner comes between these
            detour = comes - node[i, AHEAD]
            while True:
                on = node[onward, SITE]
                whole = detour + ways[p, partner, node[at, SITE], at_way[0]] + ways[p, partner, on, at_way[1]]
                if at != c:
                    whole += ways[p, c, b, at_way[1]] - node[at, AHEAD]
                cost = unit * whole
                if (cost < least or flags & SPANNED) and whole <= longest:
                    able = True
                    if flags & TIMED:
                        drives, goes = ways[p, partner, node[at, SITE], at_way[2]], ways[p, partner, on, at_way[3]]
                        reached = free + drives
                        leaves = opening(site, partner, max(reached, site[partner, READY]), flags) + site[partner, SERVICE]
                        able = reached <= site[partner, DUE] and leaves + goes <= node[onward, LATEST]
                        if flags & SPANNED:
                            on_way = took + drives
                            end = min(site[partner, DUE] - on_way, late)
                            on_way += max(site[partner, READY] - on_way - late, 0) + site[partner, SERVICE] + goes
                            spent = on_way + max(node[onward, EARLY] - on_way - end, 0) + node[onward, REST]
                            able = able and spent <= types[k, MAX_DURATION]
                            cost += hours(types, k, spent) - hours(types, k, route[r, SPENT])
                    if able and cost < least and word(random) & np.uint64(127):
                        if flags & WALKED:
                            cost = walked(ways, at_way, site, types, route, node, r, i, c, at, partner, whole, flags)
                        if cost < least:
                            least, places[0], places[1] = cost, i, at
                # Or one visit later.
                if onward == tail or (at == c and unit * (detour + ways[p, c, b, at_way[1]]) >= least and not flags & SPANNED):
                    break
                if flags & TIMED:
                    drives = ways[p, node[at, SITE], on, at_way[3]]
                    reached = free + drives
                    if reached > node[onward, LATEST] or reached > site[partner, DUE]:
                        break
                    free = opening(site, on, max(reached, site[on, READY]), flags) + site[on, SERVICE]
                    if flags & SPANNED:
                        on_way = took + drives
                        took = on_way + max(site[on, READY] - on_way - late, 0) + site[on, SERVICE]
                        late = min(site[on, DUE] - on_way, late)
                if not _has_room(site, route, node, onward, c):
                    break
                at, onward = onward, node[onward, FOLLOWING]
        i = j
    return least


@inner
def ship(ways, at_way, site, types, allowed, route, node, near, c, partner, least, token, random, places, flags):  # type: ignore[no-untyped-def]
    """Least cost, below ``least``, of visits of ``c`` and later ``partner`` on one route that a customer near to either is on.

    ``places`` receives the nodes after which they come; the second one is ``c`` where they follow on each other. ``token`` marks the routes
    that were looked at, and has not been handed over before.
    """
    for end in (c, partner):
        for q in range(near.shape[1]):
            i = near[end, q]
            if i < 0:
                break
            r = node[i, ROUTE]
            if r < 0 or route[r, TRIED] == token:
                continue
            route[r, TRIED] = token
            k = route[r, KIND]
            if allowed[k, c] and allowed[k, partner]:
                least = ship_on(ways, at_way, site, types, route, node, c, partner, r, least, random, places, flags)
    return least
