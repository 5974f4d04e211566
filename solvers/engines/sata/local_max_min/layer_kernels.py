"""Smoothing and solution of the layered program, one layer a pass over the edges. Imports numba: import it inside functions only."""

import math

from .....formulations.kernels import kernel
from .....formulations.stop_kernel import asked
from .cleaning import Layout
from .lane_kernels import inlined

INFINITE = math.inf

_NAMED = (Layout,)
"""The named tuple that these types name."""

GRAPH = "named(Layout, read(i4[::1]), read(i4[::1]), read(i4[::1]), read(f8[::1]), read(f8[::1]), read(f8[::1]))"


@inlined
def clear(near, k):  # type: ignore[no-untyped-def]
    """Row k of ``near`` holds the two smallest values noted at a target, and the action that the smallest is from; none yet."""
    near[k, 0] = near[k, 1] = INFINITE
    near[k, 2] = -1.0


@inlined
def note(near, k, v, value):  # type: ignore[no-untyped-def]
    """Note a value of action v at target k. Without branches: which of the two it is cannot be predicted."""
    smallest, second, owner = near[k, 0], near[k, 1], near[k, 2]
    first = value < smallest
    near[k, 0] = value if first else smallest
    near[k, 2] = v if first else owner
    middle = smallest if first else value
    near[k, 1] = middle if middle < second else second


@inlined
def least_of_others(starts, targets, v, near):  # type: ignore[no-untyped-def]
    """The least value noted at the targets of action v by other actions: told apart by owner, since values may tie."""
    value = INFINITE
    for e in range(starts[v], starts[v + 1]):
        k = targets[e]
        found = near[k, 0] if near[k, 2] != v else near[k, 1]
        value = found if found < value else value
    return value


@kernel(f"({GRAPH}, f8[::1], f8[::1], f8[::1], f8[:, ::1], f8[:, ::1], f8[::1], f8[::1], f8[::1], b1, b1)", _nrt=False)
def minima_layer(graph, start, floor, above, near, next_near, own, back, out, top, bottom):  # type: ignore[no-untyped-def]
    """A layer of ``search.tree_minima``: ``out`` from what is noted at the targets in ``near`` and from the layer ``above``."""
    first, starts, targets, _, private, _ = graph
    for k in range(next_near.shape[0]):
        clear(next_near, k)
    for i in range(len(first) - 1):
        begin, end = first[i], first[i + 1]
        for v in range(begin, end):
            value = start[v] if top else least_of_others(starts, targets, v, near)
            if not top and private[v] > 0.0 and above[v] < value:
                value = above[v]
            if len(floor) and floor[v] < value:
                value = floor[v]
            own[v - begin] = value
        if end - begin == 1:
            out[begin] = own[0]
        elif end - begin == 2:
            out[begin], out[begin + 1] = own[1], own[0]
        else:
            lowest = INFINITE
            for v in range(end - 1, begin - 1, -1):
                back[v - begin] = lowest
                lowest = min(lowest, own[v - begin])
            lowest = INFINITE
            for v in range(begin, end):
                out[v] = min(lowest, back[v - begin])
                lowest = min(lowest, own[v - begin])
        if not bottom:
            for v in range(begin, end):
                for e in range(starts[v], starts[v + 1]):
                    note(next_near, targets[e], v, out[v])


@kernel(f"(i8[::1], {GRAPH}, f8[::1], f8[::1], f8[::1], i8, f8[::1])", _nrt=False)
def ball_minima(flag, graph, start, near, lowest, hops, out):  # type: ignore[no-untyped-def]
    """``out`` of each action: the least of ``start`` over all actions of robots within ``hops`` hops of its robot."""
    first, starts, targets, _, _, _ = graph
    for i in range(len(lowest)):
        lowest[i] = INFINITE
        for v in range(first[i], first[i + 1]):
            lowest[i] = min(lowest[i], start[v])
    for _ in range(hops):
        if asked(flag):
            break
        near[:] = INFINITE
        for i in range(len(lowest)):
            for e in range(starts[first[i]], starts[first[i + 1]]):
                near[targets[e]] = min(near[targets[e]], lowest[i])
        for i in range(len(lowest)):
            for e in range(starts[first[i]], starts[first[i + 1]]):
                lowest[i] = min(lowest[i], near[targets[e]])
    for i in range(len(lowest)):
        for v in range(first[i], first[i + 1]):
            out[v] = lowest[i]


@kernel(f"({GRAPH}, f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], f8[::1], b1)", _nrt=False)
def solve_layer(graph, levels, reds, sums, next_sums, blues, back, total, top):  # type: ignore[no-untyped-def]
    """The recursion at the next layer, with a level of its own for each blue copy; adds all copies of each action to ``total``."""
    first, starts, targets, weights, private, caps = graph
    next_sums[:] = 0.0
    for i in range(len(caps)):
        begin, end, cap = first[i], first[i + 1], caps[i]
        for v in range(begin, end):
            most = -INFINITE
            for e in range(starts[v], starts[v + 1]):
                value = (levels[v] - sums[targets[e]]) * (1.0 / weights[e])
                most = value if value > most else most
            value = most + reds[v]
            if private[v] > 0.0:
                value = max(value, levels[v] * (2.0 / private[v]) - reds[v])
            blues[v - begin] = value if value > 0.0 else 0.0
        if end - begin == 1:
            reds[begin] = cap - blues[0]
        elif end - begin == 2:
            reds[begin], reds[begin + 1] = cap - blues[1], cap - blues[0]
        else:
            most = 0.0
            for v in range(end - 1, begin - 1, -1):
                back[v - begin] = most
                most = max(most, blues[v - begin])
            most = 0.0
            for v in range(begin, end):
                reds[v] = cap - max(most, back[v - begin])
                most = max(most, blues[v - begin])
        for v in range(begin, end):
            total[v] += reds[v] + blues[v - begin]
            if not top:
                for e in range(starts[v], starts[v + 1]):
                    next_sums[targets[e]] += weights[e] * reds[v]
