"""Subset-row cuts over routes, compiled: their coefficients, and which are violated. Imports numba: import it inside functions only."""

from ....formulations.kernels import kernel


@kernel("(i8[::1], i8[::1], b1[:, ::1], b1[:, ::1], i8, f8[:, ::1])", _nrt=False)
def count_pairs(begin, head, inside, memory, first, pairs):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Into ``pairs`` (routes, cuts): how many pairs of visits to customers ``inside`` (cuts, nodes) each route from number ``first`` on
    makes, the first of a pair being remembered as long as the route stays within ``memory`` (cuts, nodes)."""
    for k in range(first, len(begin) - 1):
        for c in range(len(inside)):
            odd, number = False, 0
            for at in range(begin[k], begin[k + 1]):
                j = head[at]
                odd = odd and memory[c, j]
                if inside[c, j]:
                    number += odd
                    odd = not odd
            pairs[k - first, c] = number


@kernel("i8(f8[:, ::1], f8[:, ::1], f8[::1], f8, i8[:, ::1], f8[::1])", _nrt=False)
def violated_triples(both, visits, values, least, triples, excess):  # type: ignore[no-untyped-def] # pragma: no cover - compiled
    """Sets of three customers of whom routes visit two or more by more than ``least`` more than once; returns their number.

    ``visits``, shape (nodes, routes), is 1 where a route visits a customer, ``values`` how often it is driven, ``both`` (nodes, nodes) how
    often routes visit two customers. ``triples`` and ``excess`` receive the sets and their violations, as many as there is room for.
    """
    n, number = len(both), 0
    for i in range(1, n):
        for j in range(i + 1, n):
            for k in range(j + 1, n):
                total = both[i, j] + both[i, k] + both[j, k]
                if total <= 1.0 + least:
                    continue
                for r in range(len(values)):
                    total -= 2.0 * values[r] * visits[i, r] * visits[j, r] * visits[k, r]
                if total > 1.0 + least and number < len(excess):
                    triples[number, 0], triples[number, 1], triples[number, 2], excess[number] = i, j, k, total - 1.0
                    number += 1
    return number
