"""Exchanges of ends between two routes, compiled. Imports numba: import it inside functions only.

Source: Potvin and Rousseau (1995), An exchange heuristic for routeing problems with time windows, Journal of the Operational Research
Society 46(12), for 2-opt*; Croes (1958), A method for solving traveling-salesman problems, Operations Research 6(6), for 2-opt.
"""

from __future__ import annotations

from .columns import (
    AHEAD,
    CAPACITY,
    CLOSING,
    COUNTED,
    DEMAND,
    END,
    FOLLOWING,
    FREE,
    KIND,
    LATEST,
    PICKED,
    PREVIOUS,
    PROFILE,
    RECHARGING,
    RELOADING,
    ROOM,
    ROUTE,
    SHARED,
    SHIPPED,
    SITE,
    SPANNED,
    START,
    TIMED,
    TOPPED,
    UNIT,
    WALKED,
)
from .route_kernels import below, inner, recount, save

TIED = SPANNED | SHIPPED | RELOADING | COUNTED | WALKED | CLOSING | RECHARGING | SHARED | TOPPED
"""Flags of problems in which the four moves do not tell what it costs."""

TRIED_NEAR = 20
"""Near customers that a visit may be followed by."""


@inner
def carried(site, node, c, d):  # type: ignore[no-untyped-def]
    """The load of dimension ``d`` of all visits of a route up to ``c``, which may be its start."""
    load = 0
    while c < len(site):
        load += site[c, DEMAND + d]
        c = node[c, PREVIOUS]
    return load


@inner
def have_room(site, types, route, node, r, s, c, i, turned):  # type: ignore[no-untyped-def]
    """Whether both routes have room if all up to ``c`` of route ``r`` go with those up to ``i`` of route ``s``, or else with the rest."""
    fits = True
    for d in range(route.shape[1] - ROOM):
        most = types[route[r, KIND], CAPACITY + d]
        rest = most - route[r, ROOM + d] - carried(site, node, c, d)
        comes = carried(site, node, i, d)
        if not turned:
            comes = most - route[s, ROOM + d] - comes
        fits = fits and route[r, ROOM + d] >= comes - rest and route[s, ROOM + d] >= rest - comes
    return fits


@inner
def turn(node, first, last):  # type: ignore[no-untyped-def]
    """Reverse the visits from ``first`` to ``last``; their neighbours on the route are still to be linked to them."""
    at = first
    while True:
        ahead = node[at, FOLLOWING]
        node[at, FOLLOWING], node[at, PREVIOUS] = node[at, PREVIOUS], ahead
        if at == last:
            return
        at = ahead


@inner
def hand(node, first, last, r):  # type: ignore[no-untyped-def]
    """Assign the visits from ``first`` to ``last``, which follow one another, to route ``r``."""
    at = first
    while True:
        node[at, ROUTE] = r
        if at == last:
            return
        at = node[at, FOLLOWING]


@inner
def link(node, a, b):  # type: ignore[no-untyped-def]
    """Make ``b`` the visit right after ``a``."""
    node[a, FOLLOWING], node[b, PREVIOUS] = b, a


@inner
def swap_ends(site, node, r, s, c, i):  # type: ignore[no-untyped-def]
    """Exchange the ends of two routes: after ``c`` of route ``r`` comes ``i`` of route ``s`` with all behind it, and vice versa."""
    end_r, end_s = len(site) + 2 * r + 1, len(site) + 2 * s + 1
    rest, before, last_r, last_s = node[c, FOLLOWING], node[i, PREVIOUS], node[end_r, PREVIOUS], node[end_s, PREVIOUS]
    hand(node, i, last_s, r)
    link(node, c, i)
    link(node, last_s, end_r)
    if rest == end_r:
        link(node, before, end_s)
    else:
        hand(node, rest, last_r, s)
        link(node, before, rest)
        link(node, last_r, end_s)


@inner
def swap_turned(site, node, r, s, c, i):  # type: ignore[no-untyped-def]
    """Exchange the end of route ``r`` after ``c`` for the beginning of route ``s`` up to ``i``, both reversed; both may be starts."""
    end_r, head_s = len(site) + 2 * r + 1, len(site) + 2 * s
    rest, behind, last_r, first_s = node[c, FOLLOWING], node[i, FOLLOWING], node[end_r, PREVIOUS], node[head_s, FOLLOWING]
    if i == head_s:
        link(node, c, end_r)
    else:
        hand(node, first_s, i, r)
        turn(node, first_s, i)
        link(node, c, i)
        link(node, first_s, end_r)
    if rest == end_r:
        link(node, head_s, behind)
    else:
        hand(node, rest, last_r, s)
        turn(node, rest, last_r)
        link(node, head_s, last_r)
        link(node, rest, behind)


@inner
def turn_between(node, c, i, end):  # type: ignore[no-untyped-def]
    """``c`` and ``i`` of one route, whichever comes first, are joined, and those between visited in the opposite order."""
    at = c
    while at != i and at != end:
        at = node[at, FOLLOWING]
    if at == end:
        c, i = i, c
    first, behind = node[c, FOLLOWING], node[i, FOLLOWING]
    turn(node, first, i)
    link(node, c, i)
    link(node, first, behind)


@inner
def two_opt(ways, at_way, site, types, customers, near, route, node, sums, random, log, logged, allowance, step, flags):  # type: ignore[no-untyped-def]
    """Join a visit with a near one of another route, so that each of the two goes on with the other one's end (2-opt*), or, where moves
    are as long both ways and nobody can come too late, with its beginning turned round; of one route a part is turned round (2-opt). The
    first near one is taken with which the moves cost less than ``allowance``; returns how much of the log is used."""
    sites, c = len(site), customers[below(random, len(customers))]
    r = node[c, ROUTE]
    if r < 0:
        return logged
    k, at, side = route[r, KIND], c, FOLLOWING
    p, turned = types[k, PROFILE], False
    if at_way[0] == at_way[1] and not flags & (TIMED | PICKED) and types[k, START] == types[k, END]:
        way = below(random, 3)
        turned = way > 0
        if way == 2:  # what comes behind them is joined, and so are those before
            at, side = node[c, PREVIOUS], PREVIOUS
    elsewhere, saved = node[node[c, side], SITE], node[at, AHEAD]
    for q in range(min(TRIED_NEAR, near.shape[1])):
        i = near[c, q]
        if i < 0:
            break
        s = node[i, ROUTE]
        if s < 0 or route[s, KIND] != k or (s == r and (not turned or node[c, FOLLOWING] == i or node[c, PREVIOUS] == i)):
            continue
        to = i if turned and side == FOLLOWING else node[i, PREVIOUS]
        other = node[i, FOLLOWING] if turned and side == FOLLOWING else to
        longer = ways[p, c, i, at_way[1]] + ways[p, elsewhere, node[other, SITE], at_way[0]] - saved - node[to, AHEAD]
        if types[k, UNIT] * longer >= allowance:
            continue
        if flags & TIMED:
            comes, goes, rest = ways[p, c, i, at_way[3]], ways[p, elsewhere, node[to, SITE], at_way[2]], node[c, FOLLOWING]
            if node[c, FREE] + comes > node[i, LATEST] or node[to, FREE] + goes > node[rest, LATEST]:
                continue
        if s != r and not have_room(site, types, route, node, r, s, at, to, turned):
            continue
        logged = save(route, node, sites, r, step, log, logged, flags)
        logged = save(route, node, sites, s, step, log, logged, flags)
        if s == r:
            turn_between(node, at, to, sites + 2 * r + 1)
        elif turned:
            swap_turned(site, node, r, s, at, to)
        else:
            swap_ends(site, node, r, s, c, i)
        recount(ways, at_way, site, types, route, node, sums, r, flags)
        if s != r:
            recount(ways, at_way, site, types, route, node, sums, s, flags)
        return logged
    return logged
