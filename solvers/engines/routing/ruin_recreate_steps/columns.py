"""Names of columns and flags of the flat arrays in which ``route_kernels`` holds routes. All numbers are whole."""

from __future__ import annotations

SERVICE, READY, DUE, REQUIRED, LOST, MISSED, AWAY, PARTNER, SECOND, GROUP, ALTERNATIVE, DEMAND = range(12)
"""Columns of sites. ``LOST`` is what leaving a site out costs in the objective, ``MISSED`` what it counts in the search;
``AWAY`` is the service and the least time of any move that follows. ``PARTNER`` is the other end of a shipment, -1 for sites of none, and
``SECOND`` tells its delivery. ``GROUP`` is the first of those of which one is visited, -1 for others, and ``ALTERNATIVE`` the next of them,
in a ring. Then come what is delivered of each load and, with ``PICKED``, what is picked up: of a shipment the load, and
the load taken away where it is delivered."""

(
    PROFILE,
    START,
    END,
    MAX_DURATION,
    MAX_DISTANCE,
    UNIT,
    FIXED,
    TIME,
    REGULAR,
    OVERTIME,
    OPENS,
    LEAVES,
    CLOSES,
    FIRST,
    SLOTS,
    USED,
    MOST_RELOADS,
    HOME,
    TRAVEL,
    CHARGE,
    STORE,
    FILLED,
    CAUTION,
    FINENESS,
    COMMITTED,
    HIGHEST,
    DEARER,
    CAPACITY,
) = (*range(26), 28, 31)
"""Columns of vehicle types: profile of travel, limits and costs, the first slot, how many there are and are used, how often they reload,
what it costs to drive from the start to the end alone, for vehicles that must; with ``WALKED`` limits on the time on the move, where no
limit on distance stands for it, and on what moves are charged, the time on the move that a full store lasts, and that it lasts at
departure; with ``RISKY`` by how many deviations limits are kept, times 2**40, and the power of 2 by which the root of the variances of
moves is divided; whether vehicles must drive; with ``TOPPED`` the largest duration, length and return of all routes, the same in each row,
and what a unit of each costs; capacities follow."""

KIND, VISITS, LENGTH, SPENT, COST, SOUND, PUNCTUAL, IN_USE, STAMP, TRIED, RELOADS, HAZARD, ROOM = range(13)
"""Columns of routes: vehicle type, visits, length, least duration, cost; whether all limits are kept, nobody comes too late, its vehicle is
counted as used; the last step that changed it; the last visit that was tried on it; how often its vehicle reloads; with ``SHARED`` its part
of the risk of the team. What it has room for of each load follows."""

FOLLOWING, PREVIOUS, ROUTE, SITE, AHEAD, FREE, LATEST, PLACE, TOOK, LATE, REST, EARLY, LISTED, CHOSEN, NODE_COLUMNS = *range(14), 16
"""Columns of nodes: neighbours on the route; the route, -1 if left out; the site; the length of the move that follows; when a vehicle can
leave at the earliest, and service must begin at the latest; the place among those left out; least duration up to here and the latest
departure for it; least duration from here on and the earliest arrival for it; the last step that listed it; of the first of a group, how
many of it are on routes. Rows have a width that keeps
what is read most in as few lines of the processor's cache as can be. With ``PICKED`` three more columns follow for each load: what the
vehicle has room for all the way up to the next node, all the way from here on, and on the move that follows."""

SEARCHED, OBJECTIVE, ABSENT, DRIVEN, STEPS, BETTER, FEWEST, SHORT, HAZARDS, MOST_HAZARDS = range(10)
"""Entries of ``sums``: cost of routes and what the search misses; the same in the objective; how many are left out; with ``COUNTED`` how
many routes visit somebody; steps done; how many of them led to a better answer than all before; how many routes there must be, and the
price of each that is missing; the risk of the team, as the sum of ``-log(1 - p)`` over its routes, and the most it may be, times 2**50."""

(
    TIMED, SPANNED, PICKED, SHIPPED, GROUPED, RELOADING, WINDOWED, COUNTED, WALKED, CLOSING, RECHARGING, RISKY, SHARED, TOPPED, LENGTHENED,
) = (1 << bit for bit in range(15))  # fmt: skip
"""Flags: anybody can come too late; the duration of a route is limited or priced; loads are picked up, too, and brought to the end or, of
a shipment, to another visit; there are groups; vehicles reload; sites have several windows, as many as
``flags >> MANY`` at most, which are the last columns of sites; there must be some number of routes;
some limits take a walk of the whole route (``walk_kernels``); moves close; stores are filled up on the way,
where nobody reloads; durations are uncertain, and how likely a route overruns its limits is limited, or how likely any route of the team
does; the largest of all routes is one term of the objective among others; a visit more makes no answer cheaper, but for what it
costs to leave it out."""

COMPUTED = ~(TIMED | GROUPED | LENGTHENED)
"""Flags of problems in which what is stored about routes that are put back is computed again."""

MANY = 16
"""Bits of flags before the number of windows."""

NONE = 1 << 60
"""Cost of what cannot be done."""
