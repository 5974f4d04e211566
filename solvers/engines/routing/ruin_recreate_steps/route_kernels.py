"""Routes as linked lists of nodes in flat arrays, and all that is stored about them. Imports numba: import it inside functions only.

Nodes are the sites, and after them two for each slot, a vehicle that may drive a route: the start of route ``r`` is node ``sites + 2 r``,
its end ``sites + 2 r + 1``. Routes are linked lists of nodes. All numbers are whole. Arrays have a row for each site, vehicle type, route
or node, and columns that are named here: few arrays, for a compiled function is handed each one in eight pieces.
"""

from __future__ import annotations

import numpy as np

from .....formulations.kernels import kernel
from .columns import (
    ABSENT,
    AHEAD,
    CAPACITY,
    CHOSEN,
    CLOSES,
    COMMITTED,
    COMPUTED,
    COST,
    COUNTED,
    DEARER,
    DEMAND,
    DRIVEN,
    DUE,
    EARLY,
    FEWEST,
    FIXED,
    FOLLOWING,
    FREE,
    GROUP,
    HAZARD,
    HAZARDS,
    HIGHEST,
    HOME,
    IN_USE,
    KIND,
    LATE,
    LATEST,
    LEAVES,
    LENGTH,
    LOST,
    MANY,
    MAX_DISTANCE,
    MAX_DURATION,
    MISSED,
    MOST_RELOADS,
    NODE_COLUMNS,
    NONE,
    OBJECTIVE,
    OPENS,
    OVERTIME,
    PICKED,
    PLACE,
    PREVIOUS,
    PROFILE,
    PUNCTUAL,
    READY,
    REGULAR,
    RELOADING,
    RELOADS,
    REST,
    ROOM,
    ROUTE,
    SEARCHED,
    SERVICE,
    SHARED,
    SHORT,
    SITE,
    SOUND,
    SPANNED,
    SPENT,
    STAMP,
    TIME,
    TIMED,
    TOOK,
    TOPPED,
    UNIT,
    USED,
    VISITS,
    WALKED,
    WINDOWED,
)
from .walk_kernels import hazard, walk

_GOLDEN, _FIRST, _SECOND = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_30, _27, _31, _11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)

inner = kernel(no_cpython_wrapper=True, _nrt=False)
inlined = kernel(no_cpython_wrapper=True, forceinline=True, _nrt=False)


@inlined
def word(random):  # type: ignore[no-untyped-def]
    """64 random bits (Steele, Lea and Flood 2014): the same ones on any machine."""
    random[0] += _GOLDEN
    z = random[0]
    z = (z ^ (z >> _30)) * _FIRST
    z = (z ^ (z >> _27)) * _SECOND
    return z ^ (z >> _31)


@inlined
def share(random):  # type: ignore[no-untyped-def]
    """A number from [0, 1)."""
    return np.float64(word(random) >> _11) * (1.0 / 9007199254740992.0)


@inlined
def below(random, n):  # type: ignore[no-untyped-def]
    """A whole number from 0 to ``n - 1``."""
    return np.int64(share(random) * n)


@inlined
def opening(site, c, at, flags):  # type: ignore[no-untyped-def]
    """The earliest begin of service at ``c`` from time ``at`` on, which is not before its first window; ``NONE`` after its last one."""
    if flags & WINDOWED:
        first = site.shape[1] - 2 * (flags >> MANY)
        for place in range(first, site.shape[1], 2):
            if at <= site[c, place + 1]:
                return max(at, site[c, place])
        return NONE
    return at


@inlined
def closing(site, c, at, flags):  # type: ignore[no-untyped-def]
    """The latest begin of service at ``c`` up to time ``at``, which is not after its last window; ``-NONE`` before its first one."""
    if flags & WINDOWED:
        first = site.shape[1] - 2 * (flags >> MANY)
        for place in range(site.shape[1] - 2, first - 2, -2):
            if at >= site[c, place]:
                return min(at, site[c, place + 1])
        return -NONE
    return at


@inlined
def arrive(ways, at_way, site, types, node, at, ahead, k, p, tail, flags):  # type: ignore[no-untyped-def]
    """The times of node ``ahead`` from those of ``at`` before it: whether it is in time, and whether any is another one than before."""
    b = node[ahead, SITE]
    drives = ways[p, node[at, SITE], b, at_way[3]]
    reached = node[at, FREE] + drives
    opens, closes, service = types[k, OPENS], types[k, CLOSES], 0
    if ahead != tail:
        opens, closes, service = site[b, READY], site[b, DUE], site[b, SERVICE]
    free = max(reached, opens)
    if ahead != tail:
        free = opening(site, b, free, flags)
    free += service
    other = free != node[ahead, FREE]
    node[ahead, FREE] = free
    if flags & SPANNED:
        on_way = node[at, TOOK] + drives
        took, late = on_way + max(opens - on_way - node[at, LATE], 0) + service, min(closes - on_way, node[at, LATE])
        other = other or took != node[ahead, TOOK] or late != node[ahead, LATE]
        node[ahead, TOOK], node[ahead, LATE] = took, late
    return reached <= closes, other


@inlined
def go_on(ways, at_way, site, types, node, behind, at, k, p, head, flags):  # type: ignore[no-untyped-def]
    """The times of node ``behind`` from those of ``at`` after it; whether any of them is another one than before."""
    a = node[behind, SITE]
    opens, closes, drives = types[k, OPENS], types[k, LEAVES], ways[p, a, node[at, SITE], at_way[3]]
    if behind != head:
        opens, closes, drives = site[a, READY], site[a, DUE], drives + site[a, SERVICE]
    latest = min(closes, node[at, LATEST] - drives)
    if behind != head:
        latest = closing(site, a, latest, flags)
    other = latest != node[behind, LATEST]
    node[behind, LATEST] = latest
    if flags & SPANNED:
        waited = max(node[at, EARLY] - drives - closes, 0)
        rest, early = drives + waited + node[at, REST], max(node[at, EARLY] - drives, opens) - waited
        other = other or rest != node[behind, REST] or early != node[behind, EARLY]
        node[behind, REST], node[behind, EARLY] = rest, early
    return other


@inner
def load(site, types, route, node, r, k, d):  # type: ignore[no-untyped-def]
    """Bring up to date what room route ``r`` has for load ``d`` on the trip of each node, before and behind it; returns the least."""
    sites, dims, head, tail = len(site), route.shape[1] - ROOM, len(site) + 2 * r, len(site) + 2 * r + 1
    before, behind, onward = NODE_COLUMNS + d, NODE_COLUMNS + dims + d, NODE_COLUMNS + 2 * dims + d
    at, carried, room, least, least_of_all = tail, 0, 0, 0, NONE
    while at != head:
        at = node[at, PREVIOUS]
        if at < sites:
            carried += site[at, DEMAND + d]
        else:
            node[at, onward], carried = types[k, CAPACITY + d] - carried, 0
    while at != tail:
        if at < sites:
            room += site[at, DEMAND + d] - site[at, DEMAND + dims + d]
            least = min(least, room)
            node[at, onward] = room
        else:
            room = least = node[at, onward]
        node[at, before], node[at, behind], least_of_all = least, room, min(least_of_all, least)
        at = node[at, FOLLOWING]
    least = NONE
    while at != head:
        at = node[at, PREVIOUS]
        least = min(least, node[at, behind])
        node[at, behind] = least
        if at >= sites:
            least = NONE
    return least_of_all


@inlined
def hours(types, k, spent):  # type: ignore[no-untyped-def]
    """Cost of a route's duration."""
    return types[k, TIME] * spent + types[k, OVERTIME] * max(0, spent - types[k, REGULAR])


@inner
def count(sums, more):  # type: ignore[no-untyped-def]
    """So many routes more visit somebody: what those cost that are missing yet."""
    missing = max(0, sums[FEWEST] - sums[DRIVEN])
    sums[DRIVEN] += more
    change = sums[SHORT] * (max(0, sums[FEWEST] - sums[DRIVEN]) - missing)
    sums[SEARCHED] += change
    sums[OBJECTIVE] += change


@inner
def extent(site, types, route, node, r, what):  # type: ignore[no-untyped-def]
    """Duration, length or return of route ``r``; 0 if nobody drives it."""
    if route[r, VISITS] == 0 and not types[route[r, KIND], COMMITTED]:
        return 0
    return route[r, SPENT] if what == 0 else route[r, LENGTH] if what == 1 else node[len(site) + 2 * r + 1, FREE]


@inner
def crown(site, types, route, node, sums):  # type: ignore[no-untyped-def]
    """Bring the largest of all routes, and what it costs, up to date."""
    for what in range(3):
        largest, dear = 0, types[0, DEARER + what]
        for r in range(len(route) if dear else 0):
            largest = max(largest, extent(site, types, route, node, r, what))
        change = dear * (largest - types[0, HIGHEST + what])
        sums[SEARCHED] += change
        sums[OBJECTIVE] += change
        for k in range(len(types)):
            types[k, HIGHEST + what] = largest


@inlined
def rise(types, k, what, value):  # type: ignore[no-untyped-def]
    """What it costs that a route gets as long as ``value``, beyond the largest one."""
    return types[k, DEARER + what] * max(0, value - types[k, HIGHEST + what])


@inner
def refresh(ways, at_way, site, types, route, node, sums, r, first, last, flags):  # type: ignore[no-untyped-def]
    """Bring times, limits and cost of route ``r`` up to date after a change between its nodes ``first`` and ``last``.

    Its loads, length and number of visits are up to date already.
    """
    k, head, tail = route[r, KIND], len(site) + 2 * r, len(site) + 2 * r + 1
    p = types[k, PROFILE]
    if flags & TIMED:
        whole = not route[r, PUNCTUAL]
        if whole:
            first, last = head, tail
        at, open_end, punctual = first, True, True
        while at != tail:
            ahead = node[at, FOLLOWING]
            in_time, other = arrive(ways, at_way, site, types, node, at, ahead, k, p, tail, flags)
            punctual = punctual and in_time
            open_end = open_end and ahead != last
            at = ahead
            if not (other or open_end):
                break
        at, open_end = last, True
        while at != head:
            behind = node[at, PREVIOUS]
            other = go_on(ways, at_way, site, types, node, behind, at, k, p, head, flags)
            open_end = open_end and behind != first
            at = behind
            if not (other or open_end):
                break
        route[r, PUNCTUAL] = punctual
    length, visits = route[r, LENGTH], route[r, VISITS]
    spent = node[tail, TOOK] if flags & SPANNED else 0
    sound = route[r, PUNCTUAL] != 0 and length <= types[k, MAX_DISTANCE] and spent <= types[k, MAX_DURATION]
    if flags & RELOADING:
        sound = sound and route[r, RELOADS] <= types[k, MOST_RELOADS]
    for d in range(route.shape[1] - ROOM):
        room = load(site, types, route, node, r, k, d) if flags & PICKED else route[r, ROOM + d]
        sound = sound and room >= 0
    if flags & WALKED and sound and visits > 0:
        walked = walk(ways, at_way, site, types, route, node, r, -1, -1, -1, -1, flags)
        sound = walked <= types[k, MAX_DURATION]
        spent = walked if sound and flags & SPANNED else spent
    cost = types[k, HOME] if visits == 0 else types[k, UNIT] * length + types[k, FIXED] + hours(types, k, spent)
    types[k, USED] += (visits > 0) - route[r, IN_USE]
    if flags & COUNTED:
        count(sums, (visits > 0) - route[r, IN_USE])
    sums[SEARCHED] += cost - route[r, COST]
    sums[OBJECTIVE] += cost - route[r, COST]
    route[r, IN_USE], route[r, SPENT], route[r, COST], route[r, SOUND] = visits > 0, spent, cost, sound or visits == 0
    if flags & TOPPED:
        crown(site, types, route, node, sums)
    if flags & SHARED:
        part = hazard(ways, at_way, site, types, route, node, r)
        sums[HAZARDS] += part - route[r, HAZARD]
        route[r, HAZARD] = part


@inner
def recount(ways, at_way, site, types, route, node, sums, r, flags):  # type: ignore[no-untyped-def]
    """Compute all that is stored about route ``r`` from its visits."""
    k, head, tail = route[r, KIND], len(site) + 2 * r, len(site) + 2 * r + 1
    p, dims = types[k, PROFILE], route.shape[1] - ROOM
    route[r, LENGTH], route[r, VISITS], route[r, RELOADS], route[r, PUNCTUAL] = 0, 0, 0, not flags & TIMED
    for d in range(dims):
        route[r, ROOM + d] = types[k, CAPACITY + d]
    node[head, FREE], node[head, TOOK], node[head, LATE] = types[k, OPENS], 0, types[k, LEAVES]
    node[tail, LATEST], node[tail, REST], node[tail, EARLY] = types[k, CLOSES], 0, types[k, OPENS]
    at = head
    while at != tail:
        ahead = node[at, FOLLOWING]
        node[at, AHEAD] = ways[p, node[at, SITE], node[ahead, SITE], at_way[1]]
        route[r, LENGTH] += node[at, AHEAD]
        route[r, VISITS] += ahead < len(site)
        route[r, RELOADS] += ahead >= len(site) and ahead != tail
        for d in range(dims if ahead < len(site) else 0):
            route[r, ROOM + d] -= site[ahead, DEMAND + d]
        at = ahead
    refresh(ways, at_way, site, types, route, node, sums, r, head, tail, flags)


@inner
def leave_out(site, node, absent, sums, c):  # type: ignore[no-untyped-def]
    """``c`` is on no route any more."""
    many = sums[ABSENT]
    node[c, ROUTE], node[c, PLACE], absent[many] = -1, many, c
    sums[ABSENT] = many + 1
    if site[c, GROUP] >= 0:
        node[site[c, GROUP], CHOSEN] -= 1
    sums[SEARCHED] += site[c, MISSED]
    sums[OBJECTIVE] += site[c, LOST]


@inner
def take_in(site, node, absent, sums, c):  # type: ignore[no-untyped-def]
    """``c`` is left out no more."""
    many, hole = sums[ABSENT] - 1, node[c, PLACE]
    other = absent[many]
    absent[hole], node[other, PLACE], node[c, PLACE] = other, hole, -1
    sums[ABSENT] = many
    if site[c, GROUP] >= 0:
        node[site[c, GROUP], CHOSEN] += 1
    sums[SEARCHED] -= site[c, MISSED]
    sums[OBJECTIVE] -= site[c, LOST]


@inner
def dissolve(ways, at_way, site, types, route, node, absent, sums, r, flags):  # type: ignore[no-untyped-def]
    """Leave out all that route ``r`` visits."""
    head, tail = len(site) + 2 * r, len(site) + 2 * r + 1
    at = node[head, FOLLOWING]
    while at != tail:
        after = node[at, FOLLOWING]
        if at < len(site):
            leave_out(site, node, absent, sums, at)
        else:
            node[at, ROUTE] = -1
        at = after
    node[head, FOLLOWING], node[tail, PREVIOUS] = tail, head
    recount(ways, at_way, site, types, route, node, sums, r, flags)


@inlined
def settled(site, node, c):  # type: ignore[no-untyped-def]
    """Whether another one of the group of ``c``, which is left out, is visited."""
    return site[c, GROUP] >= 0 and node[site[c, GROUP], CHOSEN] > 0


@inlined
def fits(site, route, c, r, flags):  # type: ignore[no-untyped-def]
    """Whether route ``r`` has room for ``c``; where vehicles reload, that is looked at trip by trip, in ``longer``."""
    fits = True
    for d in range(0 if flags & RELOADING else route.shape[1] - ROOM):
        fits = fits and route[r, ROOM + d] >= site[c, DEMAND + d]
    return fits


@inner
def walked(ways, at_way, site, types, route, node, r, i, c, at, d, detour, flags):  # type: ignore[no-untyped-def]
    """Cost of a ``walk``, which makes route ``r`` so much longer; ``NONE`` if it breaks a limit."""
    k = route[r, KIND]
    spent = walk(ways, at_way, site, types, route, node, r, i, c, at, d, flags)
    if spent > types[k, MAX_DURATION]:
        return NONE
    more = hours(types, k, spent) - hours(types, k, route[r, SPENT]) if flags & SPANNED else 0
    if flags & TOPPED:
        more += rise(types, k, 0, spent) + rise(types, k, 1, route[r, LENGTH] + detour)
    return types[k, UNIT] * detour + more


@inlined
def longer(ways, at_way, site, types, allowed, route, node, c, i, r, least, flags):  # type: ignore[no-untyped-def]
    """Cost of visiting ``c`` after node ``i`` of route ``r``, which has room for it; ``NONE`` if that breaks a limit or costs ``least``."""
    k = route[r, KIND]
    j, p = node[i, FOLLOWING], types[k, PROFILE]
    a, b = node[i, SITE], node[j, SITE]
    if flags & PICKED:
        dims = route.shape[1] - ROOM
        for d in range(dims):
            before, behind = node[i, NODE_COLUMNS + d], node[i, NODE_COLUMNS + dims + d]
            if before < site[c, DEMAND + d] or behind < site[c, DEMAND + dims + d]:
                return NONE
    detour = ways[p, c, a, at_way[0]] + ways[p, c, b, at_way[1]] - node[i, AHEAD]
    cost = types[k, UNIT] * detour
    if flags & TOPPED:
        cost += rise(types, k, 1, route[r, LENGTH] + detour)
    if (cost >= least and not flags & SPANNED) or route[r, LENGTH] + detour > types[k, MAX_DISTANCE] or not allowed[k, c]:
        return NONE
    if flags & TIMED:
        comes, goes = ways[p, c, a, at_way[2]], ways[p, c, b, at_way[3]]
        arrives = node[i, FREE] + comes
        if arrives > site[c, DUE]:
            return NONE
        if opening(site, c, max(arrives, site[c, READY]), flags) + site[c, SERVICE] + goes > node[j, LATEST]:
            return NONE
        if flags & SPANNED:
            on_way = node[i, TOOK] + comes
            late = min(site[c, DUE] - on_way, node[i, LATE])
            on_way += max(site[c, READY] - on_way - node[i, LATE], 0) + site[c, SERVICE] + goes
            spent = on_way + max(node[j, EARLY] - on_way - late, 0) + node[j, REST]
            if spent > types[k, MAX_DURATION]:
                return NONE
            cost += hours(types, k, spent) - hours(types, k, route[r, SPENT])
            if flags & TOPPED:
                cost += rise(types, k, 0, spent)
        if flags & WALKED and cost < least:
            return walked(ways, at_way, site, types, route, node, r, i, c, -1, -1, detour, flags)
    return cost


@inner
def save(route, node, sites, r, step, log, logged, flags):  # type: ignore[no-untyped-def]
    """Keep the visits of route ``r`` as they are, once a step; returns how much of the log is used.

    Where ``flags & COMPUTED`` is 0, what is stored about them is kept, too: computing it again reads lengths from all over the memory.
    """
    if route[r, STAMP] == step:
        return logged
    place, c, tail = logged + 2, node[sites + 2 * r, FOLLOWING], sites + 2 * r + 1
    if flags & COMPUTED:
        while c != tail:
            log[place] = c
            place += 1
            c = node[c, FOLLOWING]
        log[logged + 1] = place - logged - 2
    else:
        for column in range(route.shape[1]):
            log[place + column] = route[r, column]
        place += route.shape[1]
        c = sites + 2 * r
        while True:
            log[place], log[place + 1], log[place + 2], log[place + 3] = c, node[c, AHEAD], node[c, FREE], node[c, LATEST]
            place += 4
            if c == tail:
                break
            c = node[c, FOLLOWING]
        log[logged + 1] = place - logged - 2
    log[logged], route[r, STAMP] = r, step
    return place


@inner
def restore(types, route, node, sums, log, at):  # type: ignore[no-untyped-def]
    """Make a route what the log has from ``at`` on; returns where the next one begins."""
    r, ends = log[at], at + 2 + log[at + 1]
    place = at + 2 + route.shape[1]
    change = log[at + 2 + COST] - route[r, COST]
    sums[SEARCHED] += change
    sums[OBJECTIVE] += change
    types[route[r, KIND], USED] += log[at + 2 + IN_USE] - route[r, IN_USE]
    for column in range(route.shape[1]):
        route[r, column] = log[at + 2 + column]
    last = log[place]
    while True:
        c = log[place]
        node[c, AHEAD], node[c, FREE], node[c, LATEST], node[c, ROUTE] = log[place + 1], log[place + 2], log[place + 3], r
        if c != last:
            node[last, FOLLOWING], node[c, PREVIOUS] = c, last
        last = c
        place += 4
        if place == ends:
            return ends


@inlined
def put(ways, at_way, site, types, route, node, absent, sums, c, after, r):  # type: ignore[no-untyped-def]
    """Stop at ``c``, which is on no route, after node ``after`` of route ``r``; its times and its cost are not up to date then."""
    p, onward, itself = types[route[r, KIND], PROFILE], node[after, FOLLOWING], node[c, SITE]
    comes, goes = ways[p, itself, node[after, SITE], at_way[0]], ways[p, itself, node[onward, SITE], at_way[1]]
    route[r, LENGTH] += comes + goes - node[after, AHEAD]
    if c < len(site):
        route[r, VISITS] += 1
        for d in range(route.shape[1] - ROOM):
            route[r, ROOM + d] -= site[c, DEMAND + d]
        take_in(site, node, absent, sums, c)
    else:
        route[r, RELOADS] += 1
    node[after, FOLLOWING], node[after, AHEAD], node[onward, PREVIOUS] = c, comes, c
    node[c, PREVIOUS], node[c, FOLLOWING], node[c, AHEAD], node[c, ROUTE] = after, onward, goes, r


@inlined
def cut_out(ways, at_way, site, types, route, node, absent, sums, c):  # type: ignore[no-untyped-def]
    """Stop at ``c`` no more; the times and the cost of its route are not up to date then."""
    r, behind, after = node[c, ROUTE], node[c, PREVIOUS], node[c, FOLLOWING]
    way = ways[types[route[r, KIND], PROFILE], node[behind, SITE], node[after, SITE], at_way[1]]
    route[r, LENGTH] += way - node[behind, AHEAD] - node[c, AHEAD]
    node[behind, FOLLOWING], node[behind, AHEAD], node[after, PREVIOUS] = after, way, behind
    if c < len(site):
        route[r, VISITS] -= 1
        for d in range(route.shape[1] - ROOM):
            route[r, ROOM + d] += site[c, DEMAND + d]
        leave_out(site, node, absent, sums, c)
    else:
        route[r, RELOADS] -= 1
        node[c, ROUTE] = -1
