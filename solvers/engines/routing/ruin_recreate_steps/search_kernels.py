"""Ruin and recreate with string removal and annealing, compiled. Imports numba: import it inside functions only.

Source: Christiaens and Vanden Berghe (2020), Slack induction by string removals for vehicle routing problems, Transportation Science 54(2).

Nodes are the sites, and after them two for each slot, a vehicle that may drive a route: the start of route ``r`` is node ``sites + 2 r``,
its end ``sites + 2 r + 1``. Routes are linked lists of nodes. All numbers are whole. Arrays have a row for each site, vehicle type, route
or node, and columns that are named here: few arrays, for a compiled function is handed each one in eight pieces.
"""

from __future__ import annotations

import numpy as np

from .....formulations.kernels import kernel
from .....formulations.stop_kernel import asked

SERVICE, READY, DUE, REQUIRED, LOST, MISSED, AWAY, DEMAND = range(8)
"""Columns of sites. ``LOST`` is what leaving a site out costs in the objective, ``MISSED`` what it counts in the search;
``AWAY`` is the service and the least time of any move that follows; then come what is
delivered of each load and, with ``PICKED``, what is picked up."""

PROFILE, START, END, MAX_DURATION, MAX_DISTANCE, UNIT, FIXED, TIME, OPENS, LEAVES, CLOSES, FIRST, SLOTS, USED, CAPACITY = range(15)
"""Columns of vehicle types: profile of travel, limits and costs, the first slot, how many there are and are used; capacities follow."""

KIND, VISITS, LENGTH, SPENT, COST, SOUND, PUNCTUAL, IN_USE, STAMP, ROOM = range(10)
"""Columns of routes: vehicle type, visits, length, least duration, cost; whether all limits are kept, nobody comes too late, its vehicle is
counted as used; the last step that changed it; what it has room for of each load follows."""

FOLLOWING, PREVIOUS, ROUTE, SITE, AHEAD, FREE, LATEST, PLACE, TOOK, LATE, REST, EARLY, LISTED, NODE_COLUMNS = *range(13), 16
"""Columns of nodes: neighbours on the route; the route, -1 if left out; the site; the length of the move that follows; when a vehicle can
leave at the earliest, and service must begin at the latest; the place among those left out; least duration up to here and the latest
departure for it; least duration from here on and the earliest arrival for it; the last step that listed it. Rows have a width that keeps
what is read most in as few lines of the processor's cache as can be. With ``PICKED`` two more columns follow for each load: what the
vehicle has room for all the way up to the next node, and all the way from here on."""

SEARCHED, OBJECTIVE, ABSENT, STEPS, BETTER = range(5)
"""Entries of ``sums``: cost of routes and what the search misses; the same in the objective; how many are left out; steps done; how many of
them led to a better answer than all before."""

TIMED, SPANNED, PICKED = 1, 2, 4
"""Flags: anybody can come too late; the duration of a route is limited or priced; loads are picked up, too, and brought to the end."""

NONE = 1 << 60
"""Cost of what cannot be done."""

_GOLDEN, _FIRST, _SECOND = np.uint64(0x9E3779B97F4A7C15), np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_30, _27, _31, _11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)

inner = kernel(no_cpython_wrapper=True, _nrt=False)
inlined = kernel(no_cpython_wrapper=True, forceinline=True, _nrt=False)


@inlined
def _word(random):  # type: ignore[no-untyped-def]
    """64 random bits (Steele, Lea and Flood 2014): the same ones on any machine."""
    random[0] += _GOLDEN
    z = random[0]
    z = (z ^ (z >> _30)) * _FIRST
    z = (z ^ (z >> _27)) * _SECOND
    return z ^ (z >> _31)


@inlined
def _share(random):  # type: ignore[no-untyped-def]
    """A number from [0, 1)."""
    return np.float64(_word(random) >> _11) * (1.0 / 9007199254740992.0)


@inlined
def _below(random, n):  # type: ignore[no-untyped-def]
    """A whole number from 0 to ``n - 1``."""
    return np.int64(_share(random) * n)


@inlined
def _arrive(ways, at_way, site, types, node, at, ahead, k, p, tail, flags):  # type: ignore[no-untyped-def]
    """The times of node ``ahead`` from those of ``at`` before it: whether it is in time, and whether any is another one than before."""
    b = node[ahead, SITE]
    drives = ways[p, node[at, SITE], b, at_way[3]]
    reached = node[at, FREE] + drives
    opens, closes, service = types[k, OPENS], types[k, CLOSES], 0
    if ahead != tail:
        opens, closes, service = site[b, READY], site[b, DUE], site[b, SERVICE]
    free = max(reached, opens) + service
    other = free != node[ahead, FREE]
    node[ahead, FREE] = free
    if flags & SPANNED:
        on_way = node[at, TOOK] + drives
        took, late = on_way + max(opens - on_way - node[at, LATE], 0) + service, min(closes - on_way, node[at, LATE])
        other = other or took != node[ahead, TOOK] or late != node[ahead, LATE]
        node[ahead, TOOK], node[ahead, LATE] = took, late
    return reached <= closes, other


@inlined
def _go_on(ways, at_way, site, types, node, behind, at, k, p, head, flags):  # type: ignore[no-untyped-def]
    """The times of node ``behind`` from those of ``at`` after it; whether any of them is another one than before."""
    a = node[behind, SITE]
    opens, closes, drives = types[k, OPENS], types[k, LEAVES], ways[p, a, node[at, SITE], at_way[3]]
    if behind != head:
        opens, closes, drives = site[a, READY], site[a, DUE], drives + site[a, SERVICE]
    latest = min(closes, node[at, LATEST] - drives)
    other = latest != node[behind, LATEST]
    node[behind, LATEST] = latest
    if flags & SPANNED:
        waited = max(node[at, EARLY] - drives - closes, 0)
        rest, early = drives + waited + node[at, REST], max(node[at, EARLY] - drives, opens) - waited
        other = other or rest != node[behind, REST] or early != node[behind, EARLY]
        node[behind, REST], node[behind, EARLY] = rest, early
    return other


@inner
def _load(site, types, route, node, r, k, d):  # type: ignore[no-untyped-def]
    """Bring up to date what room route ``r`` has for load ``d`` before and behind each node; returns the least."""
    dims, head, tail = route.shape[1] - ROOM, len(site) + 2 * r, len(site) + 2 * r + 1
    before, behind = NODE_COLUMNS + d, NODE_COLUMNS + dims + d
    room = least = route[r, ROOM + d]
    node[head, before] = node[head, behind] = room
    at = node[head, FOLLOWING]
    while at != tail:
        room += site[at, DEMAND + d] - site[at, DEMAND + dims + d]
        least = min(least, room)
        node[at, before], node[at, behind] = least, room
        at = node[at, FOLLOWING]
    least = room
    while at != head:
        at = node[at, PREVIOUS]
        least = min(least, node[at, behind])
        node[at, behind] = least
    return least


@inner
def _refresh(ways, at_way, site, types, route, node, sums, r, first, last, flags):  # type: ignore[no-untyped-def]
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
            in_time, other = _arrive(ways, at_way, site, types, node, at, ahead, k, p, tail, flags)
            punctual = punctual and in_time
            open_end = open_end and ahead != last
            at = ahead
            if not (other or open_end):
                break
        at, open_end = last, True
        while at != head:
            behind = node[at, PREVIOUS]
            other = _go_on(ways, at_way, site, types, node, behind, at, k, p, head, flags)
            open_end = open_end and behind != first
            at = behind
            if not (other or open_end):
                break
        route[r, PUNCTUAL] = punctual
    length, visits = route[r, LENGTH], route[r, VISITS]
    spent = node[tail, TOOK] if flags & SPANNED else 0
    sound = route[r, PUNCTUAL] != 0 and length <= types[k, MAX_DISTANCE] and spent <= types[k, MAX_DURATION]
    for d in range(route.shape[1] - ROOM):
        sound = sound and route[r, ROOM + d] >= 0
        if flags & PICKED:
            sound = sound and _load(site, types, route, node, r, k, d) >= 0
    cost = 0 if visits == 0 else types[k, UNIT] * length + types[k, FIXED] + types[k, TIME] * spent
    types[k, USED] += (visits > 0) - route[r, IN_USE]
    sums[SEARCHED] += cost - route[r, COST]
    sums[OBJECTIVE] += cost - route[r, COST]
    route[r, IN_USE], route[r, SPENT], route[r, COST], route[r, SOUND] = visits > 0, spent, cost, sound or visits == 0


@inner
def _recount(ways, at_way, site, types, route, node, sums, r, flags):  # type: ignore[no-untyped-def]
    """Compute all that is stored about route ``r`` from its visits."""
    k, head, tail = route[r, KIND], len(site) + 2 * r, len(site) + 2 * r + 1
    p, dims = types[k, PROFILE], route.shape[1] - ROOM
    route[r, LENGTH], route[r, VISITS], route[r, PUNCTUAL] = 0, -1, not flags & TIMED
    for d in range(dims):
        route[r, ROOM + d] = types[k, CAPACITY + d]
    node[head, FREE], node[head, TOOK], node[head, LATE] = types[k, OPENS], 0, types[k, LEAVES]
    node[tail, LATEST], node[tail, REST], node[tail, EARLY] = types[k, CLOSES], 0, types[k, OPENS]
    at = head
    while at != tail:
        ahead = node[at, FOLLOWING]
        node[at, AHEAD] = ways[p, node[at, SITE], node[ahead, SITE], at_way[1]]
        route[r, LENGTH] += node[at, AHEAD]
        route[r, VISITS] += 1
        for d in range(dims if ahead != tail else 0):
            route[r, ROOM + d] -= site[ahead, DEMAND + d]
        at = ahead
    _refresh(ways, at_way, site, types, route, node, sums, r, head, tail, flags)


@inner
def _leave_out(site, node, absent, sums, c):  # type: ignore[no-untyped-def]
    """``c`` is on no route any more."""
    many = sums[ABSENT]
    node[c, ROUTE], node[c, PLACE], absent[many] = -1, many, c
    sums[ABSENT] = many + 1
    sums[SEARCHED] += site[c, MISSED]
    sums[OBJECTIVE] += site[c, LOST]


@inner
def _take_in(site, node, absent, sums, c):  # type: ignore[no-untyped-def]
    """``c`` is left out no more."""
    many, hole = sums[ABSENT] - 1, node[c, PLACE]
    other = absent[many]
    absent[hole], node[other, PLACE], node[c, PLACE] = other, hole, -1
    sums[ABSENT] = many
    sums[SEARCHED] -= site[c, MISSED]
    sums[OBJECTIVE] -= site[c, LOST]


@inlined
def _fits(site, route, c, r):  # type: ignore[no-untyped-def]
    """Whether route ``r`` has room for ``c``."""
    fits = True
    for d in range(route.shape[1] - ROOM):
        fits = fits and route[r, ROOM + d] >= site[c, DEMAND + d]
    return fits


@inlined
def _longer(ways, at_way, site, types, allowed, route, node, c, i, r, least, flags):  # type: ignore[no-untyped-def]
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
    if (cost >= least and not flags & SPANNED) or route[r, LENGTH] + detour > types[k, MAX_DISTANCE] or not allowed[k, c]:
        return NONE
    if flags & TIMED:
        comes, goes = ways[p, c, a, at_way[2]], ways[p, c, b, at_way[3]]
        arrives = node[i, FREE] + comes
        if arrives > site[c, DUE]:
            return NONE
        if max(arrives, site[c, READY]) + site[c, SERVICE] + goes > node[j, LATEST]:
            return NONE
        if flags & SPANNED:
            on_way = node[i, TOOK] + comes
            late = min(site[c, DUE] - on_way, node[i, LATE])
            on_way += max(site[c, READY] - on_way - node[i, LATE], 0) + site[c, SERVICE] + goes
            spent = on_way + max(node[j, EARLY] - on_way - late, 0) + node[j, REST]
            if spent > types[k, MAX_DURATION]:
                return NONE
            cost += types[k, TIME] * (spent - route[r, SPENT])
    return cost


@inner
def _save(route, node, sites, r, step, log, logged):  # type: ignore[no-untyped-def]
    """Keep the visits of route ``r`` as they are, once a step; returns how much of the log is used."""
    if route[r, STAMP] == step:
        return logged
    route[r, STAMP] = step
    place, c, tail = logged + 2, node[sites + 2 * r, FOLLOWING], sites + 2 * r + 1
    while c != tail:
        log[place] = c
        place += 1
        c = node[c, FOLLOWING]
    log[logged], log[logged + 1] = r, place - logged - 2
    return place


@kernel(
    "(i8[:, :, :, ::1], i8[::1], i8[:, ::1], i8[:, ::1], i8[:, ::1], i8[:, ::1], i8[::1], i8[::1], i8)",
    _nrt=False,
)
def settle(ways, at_way, site, types, route, node, absent, sums, flags):  # type: ignore[no-untyped-def]
    """Compute all that is stored about routes that were put in from outside, and dissolve those that break a limit."""
    for r in range(len(route)):
        head, tail = len(site) + 2 * r, len(site) + 2 * r + 1
        at = node[head, FOLLOWING]
        while at != tail:
            _take_in(site, node, absent, sums, at)
            at = node[at, FOLLOWING]
        _recount(ways, at_way, site, types, route, node, sums, r, flags)
        if route[r, SOUND]:
            continue
        at = node[head, FOLLOWING]
        while at != tail:
            after = node[at, FOLLOWING]
            _leave_out(site, node, absent, sums, at)
            at = after
        node[head, FOLLOWING], node[tail, PREVIOUS] = tail, head
        _recount(ways, at_way, site, types, route, node, sums, r, flags)


@kernel(
    "(i8[::1], i8[:, :, :, ::1], i8[::1], i8[:, ::1], i8[:, ::1], b1[:, ::1], i8[:, ::1], i8[::1], i8[:, ::1], i8[:, ::1], i8[:, ::1], "
    "i8[:, ::1], i8[:, ::1], i8[::1], i8[::1], u8[::1], i8[::1], i8[:, ::1], f8[::1], i8[::1], f8[::1], i8, f8, i8)",
    _nrt=False,
)
def anneal(  # type: ignore[no-untyped-def]
    flag,
    ways,
    way_columns,
    site,
    types,
    allowed,
    alone,
    customers,
    near,
    reach,
    drive,
    route,
    node,
    absent,
    sums,
    random,
    log,
    lists,
    keys,
    best,
    sizes,
    steps,
    warmth,
    flags,
):
    """Some steps of ruin and recreate, accepted by annealing at temperature ``warmth``.

    ``ways[p, c, a]`` has the length of the move from a to c and back, and the time that these take, in the entries ``way_columns``.
    ``alone[k, c]`` is the cost of a route of a vehicle of type k that visits c alone. ``near`` has for each site the customers next to it,
    nearest first; -1 ends a row. ``reach`` has what the two moves of a visit right after each of them are long at least, and ``drive`` what
    the first of them takes; who can only follow has -1 less the length of those before it, and service and the time of the second.
    ``best`` receives the cost and the successor of each node of the best answer. ``sizes`` are the longest string and how many visits are
    removed on the mean. ``log``, ``lists`` and ``keys`` are room for work: what is compiled without memory of its own counts no references
    to arrays, which took half of its time.
    """
    sites, slots, kinds = len(site), len(route), len(types)
    n, dims = len(customers), route.shape[1] - ROOM
    moved, todo = lists[0], lists[1]
    longest, removed_on_mean = sizes[0], sizes[1]
    at_way = (way_columns[0], way_columns[1], way_columns[2], way_columns[3])
    untimed = 0 if flags & TIMED else NONE
    least_unit = types[0, UNIT]
    for k in range(kinds):
        least_unit = min(least_unit, types[k, UNIT]) if types[k, TIME] == 0 else 0
    for _ in range(steps):
        if sums[STEPS] & 255 == 0 and asked(flag):
            break
        sums[STEPS] += 1
        step, before = sums[STEPS], sums[SEARCHED]
        logged, moves = 0, 0
        # Ruin: strings of visits on routes that are near to each other.
        routes = 0
        for k in range(kinds):
            routes += types[k, USED]
        if kinds > 1 and routes > 0 and _below(random, 32) == 0:
            # Or another vehicle takes a whole route over.
            r, k = node[customers[_below(random, n)], ROUTE], _below(random, kinds)
            if r >= 0 and k != route[r, KIND] and types[k, USED] < types[k, SLOTS]:
                other = types[k, FIRST]
                while route[other, VISITS] > 0:
                    other += 1
                logged = _save(route, node, sites, r, step, log, logged)
                logged = _save(route, node, sites, other, step, log, logged)
                head, tail = sites + 2 * r, sites + 2 * other
                at, last = node[head, FOLLOWING], node[head + 1, PREVIOUS]
                node[tail, FOLLOWING], node[at, PREVIOUS], node[tail + 1, PREVIOUS], node[last, FOLLOWING] = at, tail, last, tail + 1
                node[head, FOLLOWING], node[head + 1, PREVIOUS] = head + 1, head
                able = True
                while at != tail + 1:
                    node[at, ROUTE] = other
                    able = able and allowed[k, at]
                    at = node[at, FOLLOWING]
                _recount(ways, at_way, site, types, route, node, sums, r, flags)
                _recount(ways, at_way, site, types, route, node, sums, other, flags)
                if not able:
                    route[other, SOUND] = 0
        elif routes > 0:
            most = min(longest, (n - sums[ABSENT]) / routes)
            wanted = np.int64(_share(random) * (4.0 * removed_on_mean / (1.0 + most) - 1.0) + 1.0)
            seed = customers[_below(random, n)]
            for q in range(-1, near.shape[1]):
                c = seed if q < 0 else near[seed, q]
                if c < 0 or wanted <= 0:
                    break
                r = node[c, ROUTE]
                if r < 0 or route[r, STAMP] == step:
                    continue
                logged = _save(route, node, sites, r, step, log, logged)
                wanted -= 1
                size = route[r, VISITS]
                cut = min(np.int64(_share(random) * min(most, size) + 1.0), size)
                kept = 0
                if cut > 1 and cut < size and _share(random) < 0.5:
                    kept = 1
                    while cut + kept < size and _share(random) < 0.01:
                        kept += 1
                span = cut + kept
                back, ahead, at = 0, 0, c
                while back < span - 1 and node[at, PREVIOUS] < sites:
                    at = node[at, PREVIOUS]
                    back += 1
                at = c
                while ahead < span - 1 and node[at, FOLLOWING] < sites:
                    at = node[at, FOLLOWING]
                    ahead += 1
                low = max(0, span - 1 - ahead)
                at = c
                for _step in range(low + _below(random, back - low + 1)):
                    at = node[at, PREVIOUS]
                gap = 1 + _below(random, cut - 1) if kept else span
                first, p = node[at, PREVIOUS], types[route[r, KIND], PROFILE]
                for place in range(span):
                    after = node[at, FOLLOWING]
                    if place < gap or place >= gap + kept:
                        behind = node[at, PREVIOUS]
                        way = ways[p, node[behind, SITE], node[after, SITE], at_way[1]]
                        route[r, LENGTH] += way - node[behind, AHEAD] - node[at, AHEAD]
                        route[r, VISITS] -= 1
                        for d in range(dims):
                            route[r, ROOM + d] += site[at, DEMAND + d]
                        node[behind, FOLLOWING], node[behind, AHEAD], node[after, PREVIOUS] = after, way, behind
                        _leave_out(site, node, absent, sums, at)
                        node[at, LISTED] = step
                        moved[moves] = todo[moves] = at
                        moves += 1
                    at = after
                _refresh(ways, at_way, site, types, route, node, sums, r, first, at, flags)
        for _try in range(min(sums[ABSENT] - moves, 10)):
            c = absent[_below(random, sums[ABSENT])]
            if node[c, LISTED] != step:
                node[c, LISTED] = step
                moved[moves] = todo[moves] = c
                moves += 1
        # Recreate: in some order, each where it costs least.
        draw = _below(random, 15 if flags & TIMED else 11)
        for m in range(moves):
            c = todo[m]
            if draw >= 4 and draw < 8:
                keys[m] = -np.float64(site[c, DEMAND] if dims > 0 and site[c, REQUIRED] else site[c, MISSED])
            elif draw < 8:
                keys[m] = _share(random)
            elif draw < 11:
                keys[m] = np.float64(ways[0, c, types[0, START], 0]) * (-1.0 if draw < 10 else 1.0)
            elif draw < 13:
                keys[m] = np.float64(site[c, DUE] - site[c, READY])
            else:
                keys[m] = np.float64(site[c, READY] if draw == 13 else -site[c, DUE])
        for m in range(1, moves):
            key, c, place = keys[m], todo[m], m - 1
            while place >= 0 and keys[place] > key:
                keys[place + 1], todo[place + 1] = keys[place], todo[place]
                place -= 1
            keys[place + 1], todo[place + 1] = key, c
        for m in range(moves):
            c = todo[m]
            opens, due, away = site[c, READY], site[c, DUE], site[c, AWAY]
            chance, least, after, opened = _below(random, 128), site[c, MISSED], -1, -1
            apart, lone = chance < 2, _below(random, kinds) if chance < 2 else -1  # on a route of its own, by any vehicle
            if not site[c, REQUIRED]:
                if chance == 2:
                    continue
                least -= np.int64(warmth * np.log(_share(random) + 1e-300))
            for k in range(kinds):
                if types[k, USED] < types[k, SLOTS] and (not apart or k == lone) and alone[k, c] < least:
                    least, opened = alone[k, c], k
            for q in range(0 if apart else near.shape[1]):
                i = near[c, q]
                if i < 0:
                    break
                r = node[i, ROUTE]
                if r < 0 or not _fits(site, route, c, r):
                    continue
                behind, far = node[i, PREVIOUS], reach[c, q]
                begins, latest = max(node[behind, FREE], opens), node[i, LATEST] + untimed
                if far < 0:
                    in_time = begins <= due and begins + drive[c, q] <= latest
                    i = behind if in_time and least_unit * (-1 - far - node[behind, AHEAD]) < least else -1
                    behind = -1
                else:
                    if behind < sites or begins + away > latest:
                        behind = -1
                    begins = max(node[i, FREE] + drive[c, q], opens)
                    in_time = begins <= due and begins + away <= node[node[i, FOLLOWING], LATEST] + untimed
                    if not in_time or least_unit * (far - node[i, AHEAD]) >= least:
                        i, behind = behind, -1
                while i >= 0:
                    cost = _longer(ways, at_way, site, types, allowed, route, node, c, i, r, least, flags)
                    if cost < least and _word(random) & np.uint64(127):
                        least, after = cost, i
                    i, behind = behind, -1
            if after < 0 and opened < 0 and site[c, REQUIRED]:
                for r in range(slots):
                    i, tail = sites + 2 * r, sites + 2 * r + 1
                    while i != tail and route[r, VISITS] > 0 and _fits(site, route, c, r):
                        cost = _longer(ways, at_way, site, types, allowed, route, node, c, i, r, least, flags)
                        if cost < least:
                            least, after = cost, i
                        i = node[i, FOLLOWING]
            if after < 0:
                if opened < 0:
                    continue
                r = types[opened, FIRST]
                while route[r, VISITS] > 0:
                    r += 1
                after = sites + 2 * r
            r, onward = node[after, ROUTE], node[after, FOLLOWING]
            logged = _save(route, node, sites, r, step, log, logged)
            p = types[route[r, KIND], PROFILE]
            comes, goes = ways[p, c, node[after, SITE], at_way[0]], ways[p, c, node[onward, SITE], at_way[1]]
            route[r, LENGTH] += comes + goes - node[after, AHEAD]
            route[r, VISITS] += 1
            for d in range(dims):
                route[r, ROOM + d] -= site[c, DEMAND + d]
            node[after, FOLLOWING], node[after, AHEAD], node[onward, PREVIOUS] = c, comes, c
            node[c, PREVIOUS], node[c, FOLLOWING], node[c, AHEAD], node[c, ROUTE] = after, onward, goes, r
            _take_in(site, node, absent, sums, c)
            _refresh(ways, at_way, site, types, route, node, sums, r, after, onward, flags)
        # Accept, or put everything back.
        sound, at = True, 0
        while at < logged:
            sound = sound and route[log[at], SOUND] != 0
            at += 2 + log[at + 1]
        if not sound or sums[SEARCHED] >= before - warmth * np.log(_share(random) + 1e-300):
            for m in range(moves):
                if node[moved[m], ROUTE] >= 0:
                    _leave_out(site, node, absent, sums, moved[m])
            at = 0
            while at < logged:
                r, many = log[at], log[at + 1]
                last, tail = sites + 2 * r, sites + 2 * r + 1
                for place in range(at + 2, at + 2 + many):
                    c = log[place]
                    node[last, FOLLOWING], node[c, PREVIOUS], node[c, ROUTE] = c, last, r
                    last = c
                node[last, FOLLOWING], node[tail, PREVIOUS] = tail, last
                _recount(ways, at_way, site, types, route, node, sums, r, flags)
                at += 2 + many
            for m in range(moves):
                if node[moved[m], ROUTE] >= 0:
                    _take_in(site, node, absent, sums, moved[m])
        elif sums[OBJECTIVE] < best[0]:
            sums[BETTER] += 1
            best[0] = sums[OBJECTIVE]
            for i in range(len(node)):
                best[1 + i] = node[i, FOLLOWING] if node[i, ROUTE] >= 0 else -1
