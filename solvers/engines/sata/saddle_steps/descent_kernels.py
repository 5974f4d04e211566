"""Compiled loop of the descent on squared deficits. Imports numba: import it inside functions only."""

from __future__ import annotations

import math

from .....formulations.kernels import inner, kernel
from .....formulations.stop_kernel import asked
from .layout import LAYOUT, Layout

_NAMED = (Layout,)
"""The named tuple that these types name."""

MOVES = 4
"""Shifts between two actions that a robot makes in one visit; robots of two actions need one."""

MOST_STEPS = 60
"""Far more than a shift takes: the slope is piecewise linear, with one breakpoint a target."""

INFINITE = math.inf

SAME = 1e-13
"""Shares that differ by less, in proportion to what can be moved, are the same."""

UNMOVED = 0.01
"""A target whose coverage changed by less than this share of what is negligible calls no robot."""


@inner
def _best_and_worst(graph, robot, shares, cover, level):  # type: ignore[no-untyped-def]
    """The actions of a robot by the weighted deficits that they see: the one of most, the used one of least, both sums, and edges."""
    best, worst, most, least, edges = -1, -1, -1.0, 0.0, 0
    for k in range(graph.first[robot], graph.first[robot + 1]):
        action, worth = graph.order[k], 0.0
        for e in range(graph.starts[action], graph.starts[action + 1]):
            deficit = level - cover[graph.targets[e]]
            if deficit > 0.0:
                worth += graph.weights[e] * deficit
        edges += graph.starts[action + 1] - graph.starts[action]
        if worth > most:
            best, most = action, worth
        if shares[action] > 0.0 and (worst < 0 or worth < least):
            worst, least = action, worth
    return best, worst, most, least, edges


@inner
def _merge(graph, best, worst, targets, gains):  # type: ignore[no-untyped-def]
    """The targets of two actions, and what each gains by a share that moves from ``worst`` to ``best``; returns how many there are."""
    count = 0
    e, f = graph.starts[best], graph.starts[worst]
    end_e, end_f = graph.starts[best + 1], graph.starts[worst + 1]
    while e < end_e or f < end_f:
        if f >= end_f or (e < end_e and graph.targets[e] < graph.targets[f]):
            targets[count], gains[count] = graph.targets[e], graph.weights[e]
            e += 1
        elif e >= end_e or graph.targets[f] < graph.targets[e]:
            targets[count], gains[count] = graph.targets[f], -graph.weights[f]
            f += 1
        else:
            targets[count], gains[count] = graph.targets[e], graph.weights[e] - graph.weights[f]
            e += 1
            f += 1
        count += 1
    return count


@inner
def _slope(deficits, gains, count, shift):  # type: ignore[no-untyped-def]
    """Fall of half the sum of squared deficits at ``shift``, and how fast it changes."""
    slope, curvature = 0.0, 0.0
    for k in range(count):
        deficit = deficits[k] - shift * gains[k]
        if deficit > 0.0:
            slope += gains[k] * deficit
            curvature += gains[k] * gains[k]
    return slope, curvature


@inner
def _shift(deficits, gains, count, most):  # type: ignore[no-untyped-def]
    """Share to move, at most ``most``, that makes the sum of squared deficits least; and how many steps that took.

    Newton's method on a slope that falls and is piecewise linear, in a bracket that is halved where a step would leave it.
    """
    slope, curvature = _slope(deficits, gains, count, 0.0)
    if slope <= 0.0:
        return 0.0, 1
    # Weights whose squares vanish or overflow leave no Newton step: then ends and halves of the bracket have to do.
    low, high, shift, steps = 0.0, most, most, 1
    if 0.0 < curvature < INFINITE:
        shift = slope / curvature
    if shift >= most:
        end, _ = _slope(deficits, gains, count, most)
        if end >= 0.0:
            return most, 2
        shift, steps = most * (slope / (slope - end)), 2
    while steps < MOST_STEPS:
        steps += 1
        slope, curvature = _slope(deficits, gains, count, shift)
        if slope > 0.0:
            low = shift
        elif slope < 0.0:
            high = shift
        else:
            break
        step = shift + slope / curvature if 0.0 < curvature < INFINITE else high
        if not low < step < high:
            step = 0.5 * (low + high)
        if abs(step - shift) <= SAME * most:
            break
        shift = step
    return shift, steps


@kernel(f"(i8[::1], {LAYOUT}, Tuple((i4[::1], f8[::1], f8[::1])), f8[::1], f8[::1], f8, f8, i4[::1], b1[::1], i8, i8, i8)")
def descend(flag, graph, scratch, shares, cover, level, negligible, queue, queued, head, size, most_work):  # type: ignore[no-untyped-def]
    """Visit the robots in the queue until it is empty, ``most_work`` edges were read, or the ``flag`` of a ``Stop`` is set.

    A visit shifts the robot's shares, between two actions at a time, to where the sum over targets of max(0, level - cover)^2 is least
    along the shift. Robots that see a target whose coverage has changed, and whose deficit exceeded or exceeds ``negligible``, are queued
    again.
    ``shares`` and ``cover`` change in place; returns the queue's head and size, and the edges read. ``scratch`` holds numbers and twice
    floats, as many as two actions have targets.
    """
    targets, gains, deficits = scratch
    robots, work = len(queued), 0
    while size > 0 and work < most_work and not asked(flag):
        robot = queue[head]
        head = head + 1 if head + 1 < robots else 0
        size -= 1
        queued[robot] = False
        moved, moves = True, 0
        while moved and moves < MOVES:
            moved = False
            moves += 1
            best, worst, most, least, edges = _best_and_worst(graph, robot, shares, cover, level)
            work += edges + 1
            if best < 0 or worst < 0 or best == worst or most - least <= 1e-12 * most:
                break
            count = _merge(graph, best, worst, targets, gains)
            for k in range(count):
                deficits[k] = level - cover[targets[k]]
            shift, steps = _shift(deficits, gains, count, shares[worst])
            work += (2 + steps) * count
            if shift <= 0.0:
                break
            shares[best] += shift
            shares[worst] = max(0.0, shares[worst] - shift)
            for k in range(count):
                cover[targets[k]] += shift * gains[k]
            for k in range(count):
                target = targets[k]
                if max(deficits[k], level - cover[target]) <= negligible or abs(shift * gains[k]) <= UNMOVED * negligible:
                    continue
                moved = True
                work += graph.viewer_starts[target + 1] - graph.viewer_starts[target]
                for f in range(graph.viewer_starts[target], graph.viewer_starts[target + 1]):
                    other = graph.viewers[f]
                    if other != robot and not queued[other]:
                        queued[other] = True
                        place = head + size
                        queue[place if place < robots else place - robots] = other
                        size += 1
            if graph.first[robot + 1] - graph.first[robot] == 2:
                moved = False
        if moved and not queued[robot]:
            queued[robot] = True
            place = head + size
            queue[place if place < robots else place - robots] = robot
            size += 1
    return head, size, work
