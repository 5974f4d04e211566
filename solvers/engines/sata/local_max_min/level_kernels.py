"""The recursion at eight levels side by side, for all robots or for those around some. Imports numba: import it inside functions only.

Of the layered program only depth matters, ``d = h - l``: a red copy R(v, d) and a blue copy B(v, d) of action v have one value a
level q, whichever root they belong to. With S_k the sum of c_kv R(v, d - 1) over all viewers of target k::

    B(v, d) = max(0, R(v, d - 1) + max_k (q - S_k) / c_kv)      R(v, 0) = cap
    R(v, d) = cap - max over the other actions w of the robot of B(w, d)

``room`` holds q - S_k. Nothing is summed twice, and sums run over actions in ascending order, so that a part of the graph gives
the same bits as the whole. R(v, d - 1) itself counts in B(v, d) only if nobody else views a target, but is in ``room``, and is taken out
again. So it is cut where it is far below 0: products of weights over h layers would bury the rest under its rounding.
"""

import math

import numpy as np

from .....formulations.kernels import kernel
from .....formulations.stop_kernel import asked
from .cleaning import Layout
from .lane_kernels import add, inlined, larger, load, multiply, splat, store, subtract
from .layer_kernels import GRAPH, clear, least_of_others, note
from .records import DEEPEST, Lists, Scratch, Sight

_SIGHT = "named(Sight, i8[::1], i4[::1])"
_SCRATCH = "named(Scratch, f8[:, ::1], f8[::1], f8[:, ::1], f8[:, ::1], f8[:, ::1], f8[:, ::1], f8[:, ::1], f8[::1])"
_LISTS = "named(Lists, i4[::1], b1[::1], i4[::1], i4[::1])"
_NAMED = (Layout, Lists, Scratch, Sight)
"""The named tuples that these types name."""

# Without ``_nrt`` numba counts no references: kernels that make no arrays need none, and in inner loops they would cost more than the work.

INFINITE = math.inf
BELOW = -1.0
"""Lane before the first, said of a red copy that is negative at all levels of a block."""


@kernel(f"(i8[::1], {GRAPH}, {_SIGHT}, read(i4[::1]), i4[::1], i8, i4[::1], b1[::1], i4[::1], i4[::1])")
def place(flag, graph, sight, robot_of, roots, h, distance, marked, robots, targets):  # type: ignore[no-untyped-def]
    """Find the robots within h hops of the roots, in ascending order, and their ``distance`` (elsewhere -1).

    ``targets`` are those that robots within h - 1 hops see. Returns the lengths of both lists.
    """
    first, starts, edges, _, _, _ = graph
    target_starts, viewers = sight
    reached, seen = 0, 0
    for p in range(len(roots)):
        i = robot_of[roots[p]]
        if distance[i] < 0:
            distance[i] = 0
            robots[reached] = i
            reached += 1
    done = 0
    while done < reached and not asked(flag):
        i = robots[done]
        done += 1
        if distance[i] == h:
            break
        for e in range(starts[first[i]], starts[first[i + 1]]):
            k = edges[e]
            if marked[k]:
                continue
            marked[k] = True
            targets[seen] = k
            seen += 1
            for f in range(target_starts[k], target_starts[k + 1]):
                j = viewers[f]
                if distance[j] < 0:
                    distance[j] = distance[i] + 1
                    robots[reached] = j
                    reached += 1
    if 16 * reached < len(distance):
        gap = reached
        while gap > 1:  # Shell's sort: numba takes a second to compile its own
            gap = max(1, gap * 5 // 11)
            for p in range(gap, reached):
                i, q = robots[p], p
                while q >= gap and robots[q - gap] > i:
                    robots[q] = robots[q - gap]
                    q -= gap
                robots[q] = i
    else:
        reached = 0
        for i in range(len(distance)):
            if distance[i] >= 0:
                robots[reached] = i
                reached += 1
    return reached, seen


@kernel("(i4[::1], b1[::1], i4[::1], i4[::1])", _nrt=False)
def unplace(distance, marked, robots, targets):  # type: ignore[no-untyped-def]
    """Undo the marks of ``place``."""
    for p in range(len(robots)):
        distance[robots[p]] = -1
    for p in range(len(targets)):
        marked[targets[p]] = False


@inlined
def _blue(starts, targets, weights, private, v, q, reds, room):  # type: ignore[no-untyped-def]
    most = splat(-INFINITE)
    for e in range(starts[v], starts[v + 1]):
        most = larger(most, multiply(load(room, targets[e]), splat(1.0 / weights[e])))
    red = load(reds, v)
    value = larger(splat(0.0), add(most, red))
    if private[v] > 0.0:
        value = larger(value, subtract(multiply(q, splat(2.0 / private[v])), red))
    return value


@inlined
def _least_below(starts, targets, private, v, least, near, noted):  # type: ignore[no-untyped-def]
    """The least crossing below B(v, d); a target that nobody else sees hands down v's own."""
    value = least_of_others(starts, targets, v, near) if noted else INFINITE
    if private[v] > 0.0 and least[v] < value:
        value = least[v]
    return value


@inlined
def _crossing(reds, v, levels, secant, slack, cap):  # type: ignore[no-untyped-def]
    """The level where R(v, d) falls below -slack: the root of the secant, or the number of the last lane before it; infinite for nowhere.

    Then it is cut: how deep it falls decides nothing. A secant that ends below that has no root but the last level before it.
    """
    if reds[v, 7] >= -slack:
        return INFINITE
    j = 6
    while j >= 0 and reds[v, j] < -slack:
        j -= 1
    value = float(j)
    if secant and j >= 0:
        value = levels[0, j]
        if reds[v, j + 1] >= -DEEPEST * cap:
            value += (levels[0, j + 1] - levels[0, j]) * (reds[v, j] / (reds[v, j] - reds[v, j + 1]))
    store(reds, v, larger(load(reds, v), splat(-DEEPEST * cap)))
    return value


@inlined
def _pass_down(starts, targets, weights, v, reds, value, room, near, noted, within):  # type: ignore[no-untyped-def]
    """Take R(v, d) off the room of v's targets, and note the least value below it; returns whether any was noted."""
    red = load(reds, v)
    for e in range(starts[v], starts[v + 1]):
        k = targets[e]
        store(room, k, subtract(load(room, k), multiply(red, splat(weights[e]))))
    if value == INFINITE:
        return noted
    if not noted:
        for p in range(len(within)):
            clear(near, within[p])
    for e in range(starts[v], starts[v + 1]):
        note(near, targets[e], v, value)
    return True


@kernel(f"(i8[::1], {GRAPH}, {_SCRATCH}, i4[::1], i4[::1], i4[::1], i8, f8[:, ::1], b1, f8)", _nrt=False)
def sweep(flag, graph, scratch, robots, within, distance, h, levels, secant, slack):  # type: ignore[no-untyped-def]
    """Test eight levels for the roots in ``robots`` of distance 0; ``scratch.least`` gets what limits each action's root.

    That is the least of all crossings (see ``_crossing``) in the root's tree: ``BELOW`` where the first level is not valid already,
    infinite where all are valid. ``robots`` must hold all within h hops in ascending order, and ``distance`` tell how far they are.
    """
    first, starts, targets, weights, private, caps = graph
    reds, least, room, next_room, near, next_near, blues, below = scratch
    q = load(levels, 0)
    for p in range(len(within)):
        store(room, within[p], q)
    for p in range(len(robots)):
        i = robots[p]
        red = splat(caps[i])
        for v in range(first[i], first[i + 1]):
            store(reds, v, red)
            least[v] = INFINITE
            for e in range(starts[v], starts[v + 1]):
                k = targets[e]
                store(room, k, subtract(load(room, k), multiply(red, splat(weights[e]))))
    noted = False
    for d in range(1, h + 1):  # one depth more, for robots that are not too far
        if asked(flag):
            break
        reach = h - d
        for p in range(len(within)):
            store(next_room, within[p], q)
        next_noted = False
        for p in range(len(robots)):
            i = robots[p]
            if asked(flag):
                break
            if distance[i] > reach:
                continue
            cap, start, end = splat(caps[i]), first[i], first[i + 1]
            tolerance = slack * caps[i]
            if end - start == 2:
                a, b = start, start + 1
                blue_a = _blue(starts, targets, weights, private, a, q, reds, room)
                blue_b = _blue(starts, targets, weights, private, b, q, reds, room)
                below_a = _least_below(starts, targets, private, a, least, near, noted)
                below_b = _least_below(starts, targets, private, b, least, near, noted)
                store(reds, a, subtract(cap, blue_b))
                store(reds, b, subtract(cap, blue_a))
                least[a] = min(below_b, _crossing(reds, a, levels, secant, tolerance, caps[i]))
                least[b] = min(below_a, _crossing(reds, b, levels, secant, tolerance, caps[i]))
            elif end - start == 1:
                value = _least_below(starts, targets, private, start, least, near, noted)
                store(reds, start, subtract(cap, _blue(starts, targets, weights, private, start, q, reds, room)))
                least[start] = min(value, _crossing(reds, start, levels, secant, tolerance, caps[i]))
            else:
                # Largest of all others: running extremes from the front wait in place, those from the back join them.
                most, lowest = splat(0.0), INFINITE
                for v in range(start, end):
                    blue = _blue(starts, targets, weights, private, v, q, reds, room)
                    value = _least_below(starts, targets, private, v, least, near, noted)
                    store(blues, v - start, blue)
                    below[v - start] = value
                    store(reds, v, most)
                    least[v] = lowest
                    most = larger(most, blue)
                    lowest = min(lowest, value)
                most, lowest = splat(0.0), INFINITE
                for v in range(end - 1, start - 1, -1):
                    store(reds, v, subtract(cap, larger(load(reds, v), most)))
                    value = min(least[v], lowest)
                    least[v] = min(value, _crossing(reds, v, levels, secant, tolerance, caps[i]))
                    most = larger(most, load(blues, v - start))
                    lowest = min(lowest, below[v - start])
            if reach > 0:
                for v in range(start, end):
                    next_noted = _pass_down(starts, targets, weights, v, reds, least[v], next_room, next_near, next_noted, within)
        noted = next_noted
        room, next_room, near, next_near = next_room, room, next_near, near


@kernel(f"(i8[::1], {GRAPH}, {_SIGHT}, read(i4[::1]), {_SCRATCH}, {_LISTS}, i8, f8, f8, f8, i4[::1], f8[::1], f8[::1])")
def step_groups(flag, graph, sight, robot_of, scratch, lists, h, step, stride, slack, order, ceilings, base):  # type: ignore[no-untyped-def]
    """One digit of the additive search: in ``order`` roots of one ceiling U and one ``base`` stand together.

    The first valid of the levels U - k step has k from base to base + 8 stride - 1; base moves to the part of it where it lies.
    """
    levels = np.empty((1, 8))
    start = 0
    while start < len(order) and not asked(flag):
        end, v = start + 1, order[start]
        while end < len(order) and ceilings[order[end]] == ceilings[v] and base[order[end]] == base[v]:
            end += 1
        for j in range(8):
            levels[0, j] = ceilings[v] - (base[v] + stride * (8 - j) - 1) * step
        roots = order[start:end]
        reached, seen = place(flag, graph, sight, robot_of, roots, h, lists.distance, lists.marked, lists.robots, lists.targets)
        robots, targets = lists.robots[:reached], lists.targets[:seen]
        sweep(flag, graph, scratch, robots, targets, lists.distance, h, levels, False, slack)
        unplace(lists.distance, lists.marked, robots, targets)
        for p in range(len(roots)):
            last = min(max(scratch.least[roots[p]], 0.0), 7.0)
            base[roots[p]] += stride * (7 - int(last))
        start = end
