"""Stations at which stores are filled up between two visits. Imports numba: import it inside functions only.

Stations have nodes as depots do where vehicles reload (``reload_kernels``), and a row of ``depots``.
"""

from __future__ import annotations

import numpy as np

from .columns import (
    AHEAD,
    COUNTED,
    DRIVEN,
    FEWEST,
    FIRST,
    FIXED,
    FOLLOWING,
    HOME,
    KIND,
    LENGTH,
    MAX_DISTANCE,
    MAX_DURATION,
    NONE,
    PREVIOUS,
    PROFILE,
    ROUTE,
    SHORT,
    SITE,
    SLOTS,
    SPANNED,
    SPENT,
    UNIT,
    USED,
    VISITS,
)
from .route_kernels import below, cut_out, fits, hours, inner, word
from .walk_kernels import CHAIN, walk

TRIED = 3
"""Stations up to which one place in four is also tried with two of them, one after the other, before and after a visit; of more, so many
are drawn for each place."""


PLACES = 8
"""Entry of ``places`` from which on they are room for work."""


@inner
def unplug(ways, at_way, site, types, route, node, absent, sums, r, flags):  # type: ignore[no-untyped-def]
    """Do without the stations of route ``r`` that it can do without, all of them where nobody is visited."""
    p, tail = types[route[r, KIND], PROFILE], len(site) + 2 * r + 1
    at = node[tail - 1, FOLLOWING]
    while at != tail:
        behind, ahead = node[at, PREVIOUS], node[at, FOLLOWING]
        if at >= len(site):
            way = ways[p, node[behind, SITE], node[ahead, SITE], at_way[1]]
            if route[r, VISITS] == 0 or (
                way <= node[behind, AHEAD] + node[at, AHEAD]
                and walk(ways, at_way, site, types, route, node, r, behind, ahead, CHAIN, -1, flags) < NONE
            ):
                cut_out(ways, at_way, site, types, route, node, absent, sums, at)
        at = ahead


@inner
def _between(ways, at_way, site, types, allowed, route, node, depots, sums, random, c, i, r, least, places, flags):  # type: ignore[no-untyped-def]
    """Least cost, below ``least``, of a visit of ``c`` after node ``i`` of route ``r`` with stations before or after it.

    ``places`` receives ``i``, the number of stops, and these, -1 less their row for stations. The last four nodes stand for these here.
    """
    k, j, visits = route[r, KIND], node[i, FOLLOWING], route[r, VISITS]
    p, b, ghosts = types[k, PROFILE], node[j, SITE], len(node) - 4
    drawn, many = below(random, len(depots)), min(TRIED, len(depots))
    paths = 1 + many + (many * many if len(depots) <= TRIED and below(random, 4) == 0 else 0)
    base = types[k, FIXED] + types[k, UNIT] * route[r, LENGTH] - types[k, HOME] if visits == 0 else -hours(types, k, route[r, SPENT])
    base -= sums[SHORT] if visits == 0 and flags & COUNTED and sums[DRIVEN] < sums[FEWEST] else 0
    for pair in range(1, paths * paths):
        last, first, detour, able, stops = i, -1, -node[i, AHEAD], True, PLACES
        for place in range(5):
            path, stop = pair // paths if place < 2 else pair % paths, c
            if place == 2:
                places[stops] = c
            else:
                number = path - 1
                if path > many:
                    number = (path - 1 - many) // many if place == 0 or place == 3 else (path - 1 - many) % many
                elif place == 0 or place == 3:
                    number = -1
                if number < 0:
                    continue
                row = (drawn + number) % len(depots)
                stop = ghosts + (place if place < 2 else place - 1)
                node[stop, SITE], places[stops] = depots[row, 0], -1 - row
                able = able and allowed[k, depots[row, 0]]
            detour += ways[p, node[last, SITE], node[stop, SITE], at_way[1]]
            able = able and (last == i or node[last, SITE] != node[stop, SITE])
            if last == i:
                first = stop
            else:
                node[last, FOLLOWING] = stop
            last = stop
            stops += 1
        detour += ways[p, node[last, SITE], b, at_way[1]]
        cost = types[k, UNIT] * detour + base
        if not able or route[r, LENGTH] + detour > types[k, MAX_DISTANCE] or (cost >= least and not flags & SPANNED):
            continue
        spent = walk(ways, at_way, site, types, route, node, r, i, first, CHAIN, last, flags)
        cost += hours(types, k, spent) if spent <= types[k, MAX_DURATION] else NONE
        if cost < least and word(random) & np.uint64(127):
            least, places[0], places[1] = cost, i, stops - PLACES
            for place in range(stops - PLACES):
                places[2 + place] = places[PLACES + place]
    return least


@inner
def recharge_and_visit(  # type: ignore[no-untyped-def]
    ways, at_way, site, types, allowed, route, node, near, depots, sums, random, c, least, places, flags
):  # fmt: skip
    """Least cost, below ``least``, of a visit of ``c`` with stations before or after it: next to a near customer, or on a new route."""
    for q in range(-len(types), 2 * near.shape[1]):
        r, i = -1, -1
        if q < 0:
            k = -1 - q
            if types[k, USED] < types[k, SLOTS]:
                r = types[k, FIRST]
                while route[r, VISITS] > 0:
                    r += 1
                i = len(site) + 2 * r
        else:
            i = near[c, q // 2]
            if i < 0:
                break
            r = node[i, ROUTE]
            i = node[i, PREVIOUS] if q & 1 else i
        if r >= 0 and allowed[route[r, KIND], c] and fits(site, route, c, r, flags):
            least = _between(ways, at_way, site, types, allowed, route, node, depots, sums, random, c, i, r, least, places, flags)
    return least
