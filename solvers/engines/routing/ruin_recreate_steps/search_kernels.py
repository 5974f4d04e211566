"""Ruin and recreate with string removal and annealing, compiled. Imports numba: import it inside functions only.

Source: Christiaens and Vanden Berghe (2020), Slack induction by string removals for vehicle routing problems, Transportation Science 54(2).
"""

from __future__ import annotations

import numpy as np

from .....formulations.kernels import kernel
from .....formulations.stop_kernel import asked
from .columns import (
    ABSENT,
    AHEAD,
    ALTERNATIVE,
    AWAY,
    BETTER,
    COMPUTED,
    COUNTED,
    DEMAND,
    DRIVEN,
    DUE,
    FEWEST,
    FIRST,
    FOLLOWING,
    FREE,
    GROUPED,
    HAZARDS,
    KIND,
    LATEST,
    LENGTHENED,
    LISTED,
    MISSED,
    MOST_HAZARDS,
    NONE,
    OBJECTIVE,
    PARTNER,
    PREVIOUS,
    READY,
    RECHARGING,
    RELOADING,
    REQUIRED,
    ROOM,
    ROUTE,
    SEARCHED,
    SECOND,
    SHARED,
    SHIPPED,
    SHORT,
    SITE,
    SLOTS,
    SOUND,
    STAMP,
    START,
    STEPS,
    TIME,
    TIMED,
    TRIED,
    UNIT,
    USED,
    VISITS,
)
from .recharge_kernels import recharge_and_visit, unplug
from .reload_kernels import free_node, join, reload_and_visit, tidy
from .route_kernels import (
    below,
    cut_out,
    dissolve,
    fits,
    inlined,
    inner,
    leave_out,
    longer,
    put,
    recount,
    refresh,
    restore,
    save,
    settled,
    share,
    take_in,
    word,
)
from .shipment_kernels import ship, ship_on
from .two_opt_kernels import TIED, two_opt

EXCHANGES = 8
"""One step in so many looks for an exchange of ends first."""

OVERLOOKED = 8
"""One alternative in so many is overlooked."""


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
            if at < len(site):
                take_in(site, node, absent, sums, at)
            at = node[at, FOLLOWING]
        recount(ways, at_way, site, types, route, node, sums, r, flags)
        if not route[r, SOUND]:
            dissolve(ways, at_way, site, types, route, node, absent, sums, r, flags)
    for r in range(len(route) if flags & SHARED else 0):
        if sums[HAZARDS] > sums[MOST_HAZARDS] and route[r, VISITS] > 0:
            dissolve(ways, at_way, site, types, route, node, absent, sums, r, flags)


@inner
def hand_over(ways, at_way, types, allowed, customers, route, node, site, sums, random, log, logged, step, flags):  # type: ignore[no-untyped-def]
    """Have a vehicle of another type drive a route; returns how much of the log is used."""
    sites, r, k = len(site), node[customers[below(random, len(customers))], ROUTE], below(random, len(types))
    if r < 0 or k == route[r, KIND] or types[k, USED] >= types[k, SLOTS]:
        return logged
    head = sites + 2 * r
    at = node[head, FOLLOWING]
    while at != head + 1:
        if not allowed[k, node[at, SITE]]:
            return logged
        at = node[at, FOLLOWING]
    other = types[k, FIRST]
    while route[other, VISITS] > 0:
        other += 1
    logged = save(route, node, sites, r, step, log, logged, flags)
    logged = save(route, node, sites, other, step, log, logged, flags)
    tail = sites + 2 * other
    at, last = node[head, FOLLOWING], node[head + 1, PREVIOUS]
    node[tail, FOLLOWING], node[at, PREVIOUS], node[tail + 1, PREVIOUS], node[last, FOLLOWING] = at, tail, last, tail + 1
    node[head, FOLLOWING], node[head + 1, PREVIOUS] = head + 1, head
    while at != tail + 1:
        node[at, ROUTE] = other
        at = node[at, FOLLOWING]
    recount(ways, at_way, site, types, route, node, sums, r, flags)
    recount(ways, at_way, site, types, route, node, sums, other, flags)
    return logged


@inner
def ruin(ways, at_way, site, types, customers, near, route, node, absent, sums, random, log, moved, sizes, routes, step, flags):  # type: ignore[no-untyped-def]
    """Leave out strings of visits on routes near to each other; returns how much of the log is used, and how many were left out."""
    sites, n, logged, moves = len(site), len(customers), 0, 0
    most = min(sizes[0], (n - sums[ABSENT]) / routes)
    wanted = np.int64(share(random) * (4.0 * sizes[1] / (1.0 + most) - 1.0) + 1.0)
    seed = customers[below(random, n)]
    for q in range(-1, near.shape[1]):
        c = seed if q < 0 else near[seed, q]
        if c < 0 or wanted <= 0:
            break
        r = node[c, ROUTE]
        if r < 0 or route[r, STAMP] == step:
            continue
        logged = save(route, node, sites, r, step, log, logged, flags)
        wanted -= 1
        size = route[r, VISITS]
        cut = min(np.int64(share(random) * min(most, size) + 1.0), size)
        kept = 0
        if cut > 1 and cut < size and share(random) < 0.5:
            kept = 1
            while cut + kept < size and share(random) < 0.01:
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
        span = min(span, back + 1 + ahead)  # of one trip
        cut = min(cut, span)
        kept = span - cut
        low = max(0, span - 1 - ahead)
        at = c
        for _step in range(low + below(random, back - low + 1)):
            at = node[at, PREVIOUS]
        gap = 1 + below(random, cut - 1) if kept else span
        first, begun = node[at, PREVIOUS], moves
        for place in range(span):
            after = node[at, FOLLOWING]
            if place < gap or place >= gap + kept:
                cut_out(ways, at_way, site, types, route, node, absent, sums, at)
                node[at, LISTED] = step
                moved[moves] = at
                moves += 1
            at = after
        if flags & RELOADING and at >= sites and at != sites + 2 * r + 1 and below(random, 4) == 0:
            moves = join(ways, at_way, site, types, route, node, absent, sums, moved, moves, step, at)
        if flags & SHIPPED:
            for m in range(begun, moves):
                partner = site[moved[m], PARTNER]
                if partner >= 0 and node[partner, ROUTE] >= 0:
                    cut_out(ways, at_way, site, types, route, node, absent, sums, partner)
                    node[partner, LISTED] = step
                    moved[moves] = partner
                    moves += 1
        if flags & RELOADING:
            tidy(ways, at_way, site, types, route, node, absent, sums, r)
        if flags & RECHARGING:
            unplug(ways, at_way, site, types, route, node, absent, sums, r, flags)
        if flags & (SHIPPED | RELOADING | RECHARGING):
            first, at = sites + 2 * r, sites + 2 * r + 1
        refresh(ways, at_way, site, types, route, node, sums, r, first, at, flags)
    return logged, moves


@inner
def list_alternatives(site, node, moved, moves, step):  # type: ignore[no-untyped-def]
    """Add all who are left out of the groups of those to be inserted; returns how many there are."""
    for m in range(moves):
        c = site[moved[m], ALTERNATIVE]
        while c >= 0 and node[c, LISTED] != step:
            node[c, LISTED] = step
            if node[c, ROUTE] < 0:
                moved[moves] = c
                moves += 1
            c = site[c, ALTERNATIVE]
    return moves


@inlined
def list_others(site, node, absent, sums, random, moved, moves, step):  # type: ignore[no-untyped-def]
    """Add some of those that were left out before to what is to be inserted; returns how many there are."""
    for _try in range(min(sums[ABSENT] - moves, 10)):
        c = absent[below(random, sums[ABSENT])]
        if node[c, LISTED] != step and not settled(site, node, c):
            node[c, LISTED] = step
            moved[moves] = c
            moves += 1
            partner = site[c, PARTNER]
            if partner >= 0:
                node[partner, LISTED] = step
                moved[moves] = partner
                moves += 1
    return moves


@inlined
def sort(ways, site, types, random, moved, todo, keys, moves, dims, flags):  # type: ignore[no-untyped-def]
    """Put what is to be inserted into an order that is drawn; returns how many there are, a shipment counting as its pickup."""
    draw, many = below(random, 15 if flags & TIMED else 11), 0
    for m in range(moves):
        c = moved[m]
        if site[c, SECOND]:
            continue
        key = 0.0
        if draw >= 4 and draw < 8:
            key = -np.float64(site[c, DEMAND] if dims > 0 and site[c, REQUIRED] else site[c, MISSED])
        elif draw < 8:
            key = share(random)
        elif draw < 11:
            key = np.float64(ways[0, c, types[0, START], 0]) * (-1.0 if draw < 10 else 1.0)
        elif draw < 13:
            key = np.float64(site[c, DUE] - site[c, READY])
        else:
            key = np.float64(site[c, READY] if draw == 13 else -site[c, DUE])
        place = many - 1
        while place >= 0 and keys[place] > key:
            keys[place + 1], todo[place + 1] = keys[place], todo[place]
            place -= 1
        keys[place + 1], todo[place + 1] = key, c
        many += 1
    return many


@inlined
def next_to(  # type: ignore[no-untyped-def]
    ways, at_way, site, types, allowed, near, reach, drive, route, node, random, c, many, least, least_unit, flags
):  # fmt: skip
    """Look where ``c`` costs less than ``least`` next to so many of its neighbours; one place in 128 is overlooked. Returns what it costs
    there and the visit before it, or ``least`` and -1."""
    sites, opens, due, away, after = len(site), site[c, READY], site[c, DUE], site[c, AWAY], -1
    for q in range(many):
        i = near[c, q]
        if i < 0:
            break
        r, behind, far = node[i, ROUTE], node[i, PREVIOUS], reach[c, q]
        if r < 0:
            continue
        short = least_unit * (far - node[i, AHEAD]) < least
        if not flags & TIMED:
            if behind < sites:
                behind = -1
            if not short:
                i, behind = behind, -1
        elif far < 0:
            begins = max(node[behind, FREE], opens)
            in_time = begins <= due and begins + drive[c, q] <= node[i, LATEST]
            i = behind if in_time and least_unit * (-1 - far - node[behind, AHEAD]) < least else -1
            behind = -1
        else:
            if behind < sites or max(node[behind, FREE], opens) + away > node[i, LATEST]:
                behind = -1
            begins = max(node[i, FREE] + drive[c, q], opens)
            if not short or begins > due or begins + away > node[node[i, FOLLOWING], LATEST]:
                i, behind = behind, -1
        if i < 0 or not fits(site, route, c, r, flags):
            continue
        while i >= 0:
            cost = longer(ways, at_way, site, types, allowed, route, node, c, i, r, least, flags)
            if cost < least and word(random) & np.uint64(127):
                least, after = cost, i
            i, behind = behind, -1
    return least, after


@inner
def cheapest(  # type: ignore[no-untyped-def]
    ways, at_way, site, types, allowed, alone, near, reach, drive, route, node, c, random, least_unit, price, flags
):  # fmt: skip
    """Choose one site of the group of ``c`` to be visited: the cheapest to insert next to its neighbours, a unit of the first load being
    taken for ``price``."""
    chosen, least, one = c, NONE, c
    while True:
        if below(random, OVERLOOKED):
            load = site[one, DEMAND] if price > 0.0 else 0  # no column where loads limit nothing
            extra = np.int64(min(price * load, 1e16)) - site[one, MISSED]
            most = NONE if least == NONE else least - extra
            cost = most
            for k in range(len(types)):
                cost = min(cost, alone[k, one]) if types[k, USED] < types[k, SLOTS] else cost
            cost, _after = next_to(
                ways, at_way, site, types, allowed, near, reach, drive, route, node, random, one, near.shape[1], cost, least_unit, flags
            )
            if cost < most:
                chosen, least = one, cost + extra
        one = site[one, ALTERNATIVE]
        if one == c:
            return chosen


@inlined
def insert(  # type: ignore[no-untyped-def]
    ways, at_way, site, types, allowed, alone, near, reach, drive, depots, route, node, absent, sums, random, log, logged, places,
    c, token, step, least_unit, warmth, flags,
):  # fmt: skip
    """Visit ``c``, with a shipment both of its ends, where that costs least; returns how much of the log is used."""
    if settled(site, node, c):
        return logged
    sites, kinds, partner = len(site), len(types), site[c, PARTNER]
    chance, least, after, opened = below(random, 128), site[c, MISSED], -1, -1
    if partner >= 0:
        least += site[partner, MISSED]
    apart, lone = chance < 2, below(random, kinds) if chance < 2 else -1  # on a route of its own, by any vehicle
    if site[c, REQUIRED]:
        least = NONE
    else:
        if chance == 2:
            return logged
        least -= np.int64(warmth * np.log(share(random) + 1e-300))
    gain = sums[SHORT] if flags & COUNTED and sums[DRIVEN] < sums[FEWEST] else 0
    for k in range(kinds):
        if types[k, USED] < types[k, SLOTS] and (not apart or k == lone) and alone[k, c] < NONE and alone[k, c] - gain < least:
            least, opened = alone[k, c] - gain, k
    if partner >= 0:
        if not apart or opened < 0:
            places[0] = -1
            least = ship(ways, at_way, site, types, allowed, route, node, near, c, partner, least, token, random, places, flags)
            after = places[0]
    else:
        many = 0 if apart else near.shape[1]
        least, after = next_to(
            ways, at_way, site, types, allowed, near, reach, drive, route, node, random, c, many, least, least_unit, flags
        )
    reload, stops = -1, 0
    if flags & RECHARGING and not apart and (after < 0 or below(random, 4) == 0):
        cost = recharge_and_visit(ways, at_way, site, types, allowed, route, node, near, depots, sums, random, c, least, places, flags)
        if cost < least:
            least, after, stops = cost, places[0], places[1]
    if flags & RELOADING and not apart and partner < 0 and (after < 0 or below(random, 4) == 0):
        cost = reload_and_visit(ways, at_way, site, types, allowed, route, node, near, depots, c, least, places, flags)
        if cost < least:
            least, after, reload = cost, places[0], free_node(depots, node, places[1])
    if after < 0 and opened < 0 and site[c, REQUIRED]:
        for r in range(len(route)):
            if route[r, VISITS] == 0:
                continue
            if partner >= 0:
                if route[r, TRIED] != token and allowed[route[r, KIND], c] and allowed[route[r, KIND], partner]:
                    least = ship_on(ways, at_way, site, types, route, node, c, partner, r, least, random, places, flags)
                    after = places[0]
                continue
            i, tail = sites + 2 * r, sites + 2 * r + 1
            while i != tail and fits(site, route, c, r, flags):
                cost = longer(ways, at_way, site, types, allowed, route, node, c, i, r, least, flags)
                if cost < least:
                    least, after = cost, i
                i = node[i, FOLLOWING]
    if after < 0:
        if opened < 0:
            return logged
        r = types[opened, FIRST]
        while route[r, VISITS] > 0:
            r += 1
        after = sites + 2 * r
        places[1] = c
    r, onward = node[after, ROUTE], node[after, FOLLOWING]
    logged = save(route, node, sites, r, step, log, logged, flags)
    last, begin = after, 2
    if stops == 0:
        begin, stops, places[7] = 7, 1, c
    for place in range(begin, begin + stops):
        stop = places[place] if places[place] >= 0 else free_node(depots, node, -1 - places[place])
        if stop >= 0:
            put(ways, at_way, site, types, route, node, absent, sums, stop, last, r)
            last = stop
    if reload >= 0:
        put(ways, at_way, site, types, route, node, absent, sums, reload, after if places[2] else c, r)
    if partner >= 0:
        put(ways, at_way, site, types, route, node, absent, sums, partner, places[1], r)
        onward = node[partner, FOLLOWING]
    refresh(ways, at_way, site, types, route, node, sums, r, after, onward, flags)
    if flags & SHARED and sums[HAZARDS] > sums[MOST_HAZARDS]:
        cut_out(ways, at_way, site, types, route, node, absent, sums, c)
        if partner >= 0:
            cut_out(ways, at_way, site, types, route, node, absent, sums, partner)
        if flags & RELOADING:
            tidy(ways, at_way, site, types, route, node, absent, sums, r)
        refresh(ways, at_way, site, types, route, node, sums, r, sites + 2 * r, sites + 2 * r + 1, flags)
    return logged


@inner
def put_back(ways, at_way, site, types, route, node, absent, sums, log, logged, moved, moves, flags):  # type: ignore[no-untyped-def]
    """Make all routes those that the log holds."""
    sites = len(site)
    for m in range(moves):
        if node[moved[m], ROUTE] >= 0:
            leave_out(site, node, absent, sums, moved[m])
    at = 0
    while at < logged and not flags & COMPUTED:
        at = restore(types, route, node, sums, log, at)
    before, at = at, 0
    while at < logged and flags & (RELOADING | RECHARGING):
        i = node[sites + 2 * log[at], FOLLOWING]
        while i != sites + 2 * log[at] + 1:
            if i >= sites:
                node[i, ROUTE] = -1
            i = node[i, FOLLOWING]
        at += 2 + log[at + 1]
    at = before
    while at < logged:
        r, many = log[at], log[at + 1]
        last, tail = sites + 2 * r, sites + 2 * r + 1
        for place in range(at + 2, at + 2 + many):
            c = log[place]
            node[last, FOLLOWING], node[c, PREVIOUS], node[c, ROUTE] = c, last, r
            last = c
        node[last, FOLLOWING], node[tail, PREVIOUS] = tail, last
        recount(ways, at_way, site, types, route, node, sums, r, flags)
        at += 2 + many
    for m in range(moves):
        if node[moved[m], ROUTE] >= 0:
            take_in(site, node, absent, sums, moved[m])


@kernel(
    "(i8[::1], i8[:, :, :, ::1], i8[::1], i8[:, ::1], i8[:, ::1], b1[:, ::1], i8[:, ::1], i8[::1], i8[:, ::1], i8[:, ::1], i8[:, ::1], "
    "i8[:, ::1], i8[:, ::1], i8[:, ::1], i8[::1], i8[::1], u8[::1], i8[::1], i8[:, ::1], f8[::1], i8[::1], f8[::1], i8, f8, i8)",
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
    depots,
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

    ``ways[p, c, a]`` has the length of the move from a to c and back, and the time that these take, in the entries ``way_columns``; with
    ``WALKED`` what the move back is charged, and when it closes.
    ``alone[k, c]`` is the cost of a route of a vehicle of type k that visits c alone. ``near`` has for each site the customers next to it,
    nearest first; -1 ends a row. ``reach`` has what the two moves of a visit right after each of them are long at least, and ``drive`` what
    the first of them takes; who can only follow has -1 less the length of those before it, and service and the time of the second.
    ``best`` receives the cost and the successor of each node of the best answer. ``sizes`` are the longest string, how many visits are
    removed on the mean, by how much the price of a visit left out grows with each step (0 but where the fleet is to become smaller; steps
    end then once none is left out), and the mean cost of a unit of the first load. ``log``, ``lists`` and ``keys`` are room for work: what
    is compiled without memory of its own counts no references to arrays, which took half of its time.
    """
    kinds, dims = len(types), route.shape[1] - ROOM
    moved, todo, places = lists[0], lists[1], lists[2]
    at_way = (way_columns[0], way_columns[1], way_columns[2], way_columns[3], way_columns[4], way_columns[5], way_columns[6])
    growth, least_unit = np.int64(sizes[2]), types[0, UNIT]
    for k in range(kinds):
        least_unit = min(least_unit, types[k, UNIT]) if types[k, TIME] == 0 else 0
    for _ in range(steps):
        if sums[STEPS] & 255 == 0 and asked(flag):
            break
        sums[STEPS] += 1
        step, before = sums[STEPS], sums[SEARCHED]
        most, owed = before - warmth * np.log(share(random) + 1e-300), 0
        logged, moves, routes = 0, 0, 0
        for k in range(kinds):
            routes += types[k, USED]
        if kinds > 1 and routes > 0 and below(random, 32) == 0:
            logged = hand_over(ways, at_way, types, allowed, customers, route, node, site, sums, random, log, logged, step, flags)
        elif routes > 0 and not flags & TIED and below(random, EXCHANGES) == 0:
            logged = two_opt(ways, at_way, site, types, customers, near, route, node, sums, random, log, logged, most - before, step, flags)
        if logged == 0 and routes > 0:
            logged, moves = ruin(
                ways, at_way, site, types, customers, near, route, node, absent, sums, random, log, moved, sizes, routes, step, flags
            )
        moves = list_others(site, node, absent, sums, random, moved, moves, step)
        for m in range(moves if flags & LENGTHENED else 0):
            owed += site[moved[m], MISSED]
        if flags & GROUPED:  # after all others: any of a group may take the place of the one that was listed, and must be put back then
            moves = list_alternatives(site, node, moved, moves, step)
        hopeless = False
        price = 0.0
        if flags & GROUPED:
            chance = share(random)  # a load that is worth nothing leads to a vehicle too many, one that is always worth much to detours
            price = sizes[3] * max(0.0, 2.0 * chance - 1.0) / (1.0 - chance)
        for m in range(sort(ways, site, types, random, moved, todo, keys, moves, dims, flags)):
            if flags & LENGTHENED and sums[SEARCHED] - owed >= most:
                hopeless = True
                break
            c = todo[m]
            if flags & GROUPED and settled(site, node, c):
                continue
            if flags & GROUPED and site[c, ALTERNATIVE] >= 0:
                c = cheapest(
                    ways, at_way, site, types, allowed, alone, near, reach, drive, route, node, c, random, least_unit,
                    price if site[c, REQUIRED] else 0.0, flags,
                )  # fmt: skip
            logged = insert(
                ways, at_way, site, types, allowed, alone, near, reach, drive, depots, route, node, absent, sums, random, log, logged,
                places, c, (step << 20) + m, step, least_unit, warmth, flags,
            )  # fmt: skip
            if not flags & GROUPED or node[c, ROUTE] >= 0:
                owed -= site[c, MISSED]
        sound, at = not hopeless and (not flags & SHARED or sums[HAZARDS] <= sums[MOST_HAZARDS]), 0
        while at < logged:
            sound = sound and route[log[at], SOUND] != 0
            at += 2 + log[at + 1]
        if not sound or sums[SEARCHED] >= most:
            put_back(ways, at_way, site, types, route, node, absent, sums, log, logged, moved, moves, flags)
        elif sums[OBJECTIVE] < best[0]:
            sums[BETTER] += 1
            best[0] = sums[OBJECTIVE]
            for i in range(len(node)):
                best[1 + i] = node[i, FOLLOWING] if node[i, ROUTE] >= 0 else -1
        if growth > 0:
            lacking = False
            for m in range(sums[ABSENT]):
                c = absent[m]
                if site[c, REQUIRED] and not settled(site, node, c):
                    lacking = True
                    site[c, MISSED] += growth
                    sums[SEARCHED] += growth
            if not lacking:
                break
