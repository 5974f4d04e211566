"""Walks of whole routes, for limits of which no sums of parts are kept. Imports numba: import it inside functions only.

Moves that close, uncertain durations, charges of moves, stores that are filled up on the way, time on the move beside other lengths, the
least duration where sites have several windows, and what is on board where shipments stay there while a vehicle reloads. A walk comes last,
for what all other tests let pass.
"""

from __future__ import annotations

import math

import numpy as np

from .....formulations.kernels import kernel
from .columns import (
    CAPACITY,
    CAUTION,
    CHARGE,
    CLOSES,
    CLOSING,
    COMMITTED,
    DEMAND,
    DUE,
    END,
    FILLED,
    FINENESS,
    FIRST,
    FIXED,
    FOLLOWING,
    HOME,
    KIND,
    LEAVES,
    MANY,
    MAX_DURATION,
    NONE,
    OPENS,
    OVERTIME,
    PARTNER,
    PICKED,
    PROFILE,
    READY,
    RECHARGING,
    REGULAR,
    RELOADING,
    RISKY,
    ROOM,
    SERVICE,
    SHIPPED,
    SITE,
    SLOTS,
    SPANNED,
    START,
    STORE,
    TIME,
    TRAVEL,
    UNIT,
    VISITS,
    WINDOWED,
)

CHAIN = -2
"""In place of a node: what follows on the first stop that is put in is linked to it already, up to the last one."""

inner = kernel(no_cpython_wrapper=True, _nrt=False)


@inner
def _onward(node, stop, i, c, at, d):  # type: ignore[no-untyped-def]
    """The node after ``stop``, were ``c`` put after node ``i`` and ``d`` after node ``at``."""
    if at == CHAIN:
        return c if stop == i else node[i if stop == d else stop, FOLLOWING]
    if stop == c:
        return d if at == c else node[i, FOLLOWING]
    if stop == d:
        return node[i, FOLLOWING] if at == c else node[at, FOLLOWING]
    if stop == i:
        return c
    return d if stop == at else node[stop, FOLLOWING]


@inner
def _carries(site, types, route, node, r, i, c, at, d, flags):  # type: ignore[no-untyped-def]
    """Whether all that is on board has room, shipments while the vehicle reloads, too."""
    sites, k, dims = len(site), route[r, KIND], route.shape[1] - ROOM
    head, tail = sites + 2 * r, sites + 2 * r + 1
    for load in range(dims):
        brought, shipped, level, most, stop = 0, 0, 0, 0, head
        while stop != tail:
            stop = _onward(node, stop, i, c, at, d)
            if stop < sites:
                taken = site[stop, DEMAND + dims + load]
                brought += site[stop, DEMAND + load]
                level += taken - site[stop, DEMAND + load]
                shipped += taken if site[stop, PARTNER] >= 0 else 0
                most = max(most, level)
            elif flags & RELOADING or stop == tail:  # what is brought until here was on board all the way
                if most + brought > types[k, CAPACITY + load]:
                    return False
                brought, level, most = 0, shipped, shipped
    return True


@inner
def deviation(types, k, variance):  # type: ignore[no-untyped-def]
    """Deviation of a duration, in units of time, from the sum of what ``ways`` says of its moves."""
    return math.ldexp(math.sqrt(np.float64(variance)), -types[k, FINENESS])


@inner
def walk(ways, at_way, site, types, route, node, r, i, c, at, d, flags):  # type: ignore[no-untyped-def]
    """Least duration of route ``r``, were ``c`` put after node ``i`` and ``d`` after node ``at``, which may be ``c``; ``NONE`` if that
    breaks a limit. -1 stands for nothing to be put there.

    What is left when is the later of a time and the departure plus some time, up to a departure from which on another window is met.
    """
    k, head, tail = route[r, KIND], len(site) + 2 * r, len(site) + 2 * r + 1
    p, first = types[k, PROFILE], site.shape[1] - 2 * (flags >> MANY)
    paused = (flags & SHIPPED and flags & RELOADING) or (flags & PICKED and flags & RECHARGING)
    if paused and not _carries(site, types, route, node, r, i, c, at, d, flags):
        return NONE
    departs, least = types[k, OPENS], NONE
    while departs <= types[k, LEAVES]:
        until, left, waits, lasts, moving, charged, variance = types[k, LEAVES], departs, -NONE, 0, 0, 0, 0
        a, stop, service, lacking = node[head, SITE], head, 0, types[k, STORE] - types[k, FILLED]
        while stop != tail:
            stop = _onward(node, stop, i, c, at, d)
            b = node[stop, SITE]
            drives = ways[p, a, b, at_way[3]]
            if flags & CLOSING:
                shut = ways[p, a, b, at_way[5]]
                if left > shut:
                    return least
                until = min(until, shut - lasts)
            charged += ways[p, a, b, at_way[4]] if stop != tail else service + drives
            moving += drives
            variance += ways[p, a, b, at_way[6]]
            if flags & RECHARGING:
                lacking += drives
                if lacking > types[k, STORE]:
                    return NONE
                lacking = 0 if stop >= len(site) and stop != tail else lacking
            left, waits, lasts = left + drives, waits + drives, lasts + drives
            opens, ends, service = types[k, OPENS], types[k, CLOSES], 0
            if stop != tail:
                opens, ends, service = site[b, READY], site[b, DUE], site[b, SERVICE]
                if flags & WINDOWED:
                    place = first
                    while place < site.shape[1] - 2 and left > site[b, place + 1]:
                        place += 2
                    opens, ends = site[b, place], site[b, place + 1]
            if left > ends:
                return least
            until = min(until, ends - lasts)
            if stop != tail:
                left, waits, lasts = max(left, opens) + service, max(waits, opens) + service, lasts + service
            a = b
        margin = np.int64(math.ceil(math.ldexp(types[k, CAUTION] * deviation(types, k, variance), -40))) if flags & RISKY else 0
        if moving + margin > types[k, TRAVEL] or charged > types[k, CHARGE]:
            return NONE
        least = min(least, max(waits - until, lasts))
        if flags & RISKY and least + margin > types[k, MAX_DURATION]:
            return NONE
        if least == lasts or not (flags & WINDOWED and flags & SPANNED):
            return least
        departs = until + 1
    return least


@inner
def hazard(ways, at_way, site, types, route, node, r):  # type: ignore[no-untyped-def]
    """Part of route ``r`` in the risk of the team: ``-log(1 - p)`` times 2**50, for the probability p that it overruns a limit."""
    k, at, tail = route[r, KIND], len(site) + 2 * r, len(site) + 2 * r + 1
    variance, moving, lasts = 0, 0, 0
    if route[r, VISITS] == 0 and not types[k, COMMITTED]:
        return 0
    while at != tail:
        a, at = node[at, SITE], node[at, FOLLOWING]
        b = node[at, SITE]
        variance += ways[types[k, PROFILE], a, b, at_way[6]]
        moving += ways[types[k, PROFILE], a, b, at_way[3]]
        lasts += site[b, SERVICE] if at != tail else 0
    spread = deviation(types, k, variance)
    if spread == 0.0:
        return 0
    left = np.float64(min(types[k, MAX_DURATION] - moving - lasts, types[k, TRAVEL] - moving))
    overrun = min(0.75, 0.5 * math.erfc(left / spread / math.sqrt(2.0)))
    return np.int64(math.ceil(math.ldexp(-math.log1p(-overrun), 50)))


@kernel("(i8[:, :, :, ::1], i8[::1], i8[:, ::1], i8[:, ::1], i8[:, ::1], i8[:, ::1], i8[:, ::1], i8)", _nrt=False)
def walk_alone(ways, at_way, site, types, route, node, alone, flags):  # type: ignore[no-untyped-def]
    """Put right what routes to one site, or of one shipment, cost by ``alone`` where no route visits anybody yet."""
    for k in range(len(types)):
        p, r = types[k, PROFILE], types[k, FIRST]
        head = len(site) + 2 * r
        for c in range(len(site) if types[k, SLOTS] > 0 else 0):
            if alone[k, c] >= NONE:
                continue
            d = site[c, PARTNER]
            spent = walk(ways, at_way, site, types, route, node, r, head, c, c if d >= 0 else -1, d, flags)
            alone[k, c] = NONE
            if spent <= types[k, MAX_DURATION]:
                last = d if d >= 0 else c
                length = ways[p, types[k, START], c, at_way[1]] + ways[p, last, types[k, END], at_way[1]]
                length += ways[p, c, last, at_way[1]] if d >= 0 else 0
                spent = spent if flags & SPANNED else 0
                hours = types[k, TIME] * spent + types[k, OVERTIME] * max(0, spent - types[k, REGULAR])
                alone[k, c] = types[k, UNIT] * length + types[k, FIXED] + hours - types[k, HOME]
