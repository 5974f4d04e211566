"""Depots at which vehicles reload between two visits. Imports numba: import it inside functions only.

Each depot has nodes of its own, as many as can be used at a time, after those of starts and ends of routes. A row of ``depots`` holds the
depot's site, its first node and how many there are.
"""

from __future__ import annotations

from .columns import (
    AHEAD,
    CAPACITY,
    DEMAND,
    DUE,
    EARLY,
    FOLLOWING,
    FREE,
    KIND,
    LATE,
    LATEST,
    LENGTH,
    LISTED,
    MAX_DISTANCE,
    MAX_DURATION,
    MOST_RELOADS,
    PREVIOUS,
    PROFILE,
    READY,
    RELOADS,
    REST,
    ROOM,
    ROUTE,
    SERVICE,
    SITE,
    SPANNED,
    SPENT,
    TIMED,
    TOOK,
    UNIT,
    WALKED,
)
from .route_kernels import cut_out, hours, inner, load, opening, walked


@inner
def free_node(depots, node, depot):  # type: ignore[no-untyped-def]
    """A node of a depot that is on no route; -1 if there is none."""
    for at in range(depots[depot, 1], depots[depot, 1] + depots[depot, 2]):
        if node[at, ROUTE] < 0:
            return at
    return -1


@inner
def tidy(ways, at_way, site, types, route, node, absent, sums, r):  # type: ignore[no-untyped-def]
    """Do without the reloads of route ``r`` before which, or after which, nobody is visited."""
    sites, head, tail = len(site), len(site) + 2 * r, len(site) + 2 * r + 1
    at = node[tail, PREVIOUS]
    while at >= sites and at != head:
        cut_out(ways, at_way, site, types, route, node, absent, sums, at)
        at = node[tail, PREVIOUS]
    while at != head:
        behind = node[at, PREVIOUS]
        if at >= sites and behind >= sites:
            cut_out(ways, at_way, site, types, route, node, absent, sums, at)
        at = behind


@inner
def join(ways, at_way, site, types, route, node, absent, sums, moved, moves, step, reload):  # type: ignore[no-untyped-def]
    """Do without a reload, and without visits before and after it until the rest has room; returns how many are left out in this step."""
    sites, r, behind, ahead = len(site), node[reload, ROUTE], node[reload, PREVIOUS], node[reload, FOLLOWING]
    cut_out(ways, at_way, site, types, route, node, absent, sums, reload)
    while True:
        full = False
        for d in range(route.shape[1] - ROOM):
            full = full or load(site, types, route, node, r, route[r, KIND], d) < 0
        first = behind < sites and (moves & 1 or ahead >= sites)
        c = behind if first else ahead
        if not full or c >= sites:
            return moves
        behind, ahead = (node[c, PREVIOUS], ahead) if first else (behind, node[c, FOLLOWING])
        cut_out(ways, at_way, site, types, route, node, absent, sums, c)
        node[c, LISTED], moved[moves] = step, c
        moves += 1


@inner
def _has_room(site, types, route, node, c, at, reload_first):  # type: ignore[no-untyped-def]
    """Whether the trip of node ``at`` has room for ``c`` after that node, if the vehicle reloads right before or right after ``c``."""
    sites, dims, k = len(site), route.shape[1] - ROOM, route[node[at, ROUTE], KIND]
    for d in range(dims):
        for half in range(2):  # of the trip: up to the reload, and from there on
            first, last = at, node[at, FOLLOWING]
            here = reload_first == half
            if half == 0:
                while first < sites:
                    first = node[first, PREVIOUS]
                first = node[first, FOLLOWING]
            else:
                first = last
                while last < sites:
                    last = node[last, FOLLOWING]
            carried = site[c, DEMAND + d] if here else 0
            i = first
            while i != last:
                carried += site[i, DEMAND + d]
                i = node[i, FOLLOWING]
            if carried > types[k, CAPACITY + d]:
                return False
            if here and half == 1:
                carried += site[c, DEMAND + dims + d] - site[c, DEMAND + d]
                if carried > types[k, CAPACITY + d]:
                    return False
            i = first
            while i != last:
                carried += site[i, DEMAND + dims + d] - site[i, DEMAND + d]
                if carried > types[k, CAPACITY + d]:
                    return False
                i = node[i, FOLLOWING]
            if here and half == 0 and carried + site[c, DEMAND + dims + d] - site[c, DEMAND + d] > types[k, CAPACITY + d]:
                return False
    return True


@inner
def reload_and_visit(ways, at_way, site, types, allowed, route, node, near, depots, c, least, places, flags):  # type: ignore[no-untyped-def]
    """Least cost, below ``least``, of a visit of ``c`` next to a near customer, with a reload right before or right after it.

    ``places`` receives the node after which both come, the row of the depot, and 1 if the vehicle reloads first.
    """
    sites = len(site)
    for q in range(near.shape[1]):
        neighbour = near[c, q]
        if neighbour < 0:
            break
        r = node[neighbour, ROUTE]
        if r < 0:
            continue
        k = route[r, KIND]
        if route[r, RELOADS] >= types[k, MOST_RELOADS] or not allowed[k, c]:
            continue
        p = types[k, PROFILE]
        for i in (node[neighbour, PREVIOUS], neighbour):
            j = node[i, FOLLOWING]
            a, b = node[i, SITE], node[j, SITE]
            for depot in range(len(depots)):
                if not allowed[k, depots[depot, 0]]:
                    continue
                for reload_first in range(2):
                    if (i if reload_first else j) >= sites:
                        continue  # one reload after another, or right before the end
                    x, y = (depots[depot, 0], c) if reload_first else (c, depots[depot, 0])
                    detour = ways[p, x, a, at_way[0]] + ways[p, x, y, at_way[1]] + ways[p, y, b, at_way[1]] - node[i, AHEAD]
                    cost = types[k, UNIT] * detour
                    if (cost >= least and not flags & SPANNED) or route[r, LENGTH] + detour > types[k, MAX_DISTANCE]:
                        continue
                    if flags & TIMED:
                        comes, between, goes = ways[p, x, a, at_way[2]], ways[p, x, y, at_way[3]], ways[p, y, b, at_way[3]]
                        begins = opening(site, x, max(node[i, FREE] + comes, site[x, READY]), flags)
                        begins_then = opening(site, y, max(begins + site[x, SERVICE] + between, site[y, READY]), flags)
                        if begins > site[x, DUE] or begins_then > site[y, DUE] or begins_then + site[y, SERVICE] + goes > node[j, LATEST]:
                            continue
                        if flags & SPANNED:
                            on_way = node[i, TOOK] + comes
                            late = min(site[x, DUE] - on_way, node[i, LATE])
                            on_way += max(site[x, READY] - on_way - node[i, LATE], 0) + site[x, SERVICE] + between
                            later = min(site[y, DUE] - on_way, late)
                            on_way += max(site[y, READY] - on_way - late, 0) + site[y, SERVICE] + goes
                            spent = on_way + max(node[j, EARLY] - on_way - later, 0) + node[j, REST]
                            if spent > types[k, MAX_DURATION]:
                                continue
                            cost += hours(types, k, spent) - hours(types, k, route[r, SPENT])
                    if cost < least and _has_room(site, types, route, node, c, i, reload_first):
                        stop = free_node(depots, node, depot)
                        if stop < 0:
                            continue
                        if flags & WALKED:
                            one, other = (stop, c) if reload_first else (c, stop)
                            cost = walked(ways, at_way, site, types, route, node, r, i, one, one, other, detour, flags)
                        if cost < least:
                            least, places[0], places[1], places[2] = cost, i, depot, reload_first
    return least
