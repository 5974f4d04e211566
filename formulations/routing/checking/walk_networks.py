"""Walks in whole numbers, as the kernels go through them: moves, levels, who is remembered, and subset rows.

Levels are rounded so that all walks that keep them in doubles do. docs/proofs.md#labels-in-whole-numbers.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .known_features import Flags, Floats, Integers
from .relaxation import Resource, order_resource

Ints = NDArray[np.int32]

DONE, STOPPED, FULL = 0, 1, 2

BITS = 63
"""Bits of a word that are used; the lowest of a label's first word of memory tells whether a needed move is still to be made."""

FAR = 1 << 61
"""More than any walk costs."""

CELLS = 256
"""Parts of the range of the first level, for bounds on what is left of a walk."""

FEWEST_CELLS = 64

PASSES = 150_000_000
"""Moves in all cells together, where that leaves enough of them."""

LONGEST = 1 << 14
"""Visits of a walk; where the levels allow more, visits are counted."""


class Network(NamedTuple):
    """Moves, levels, memories and rows, as the kernels go through them; node 0 is the depot.

    ``first`` is the place of each node's first move in ``moves``, of shape (moves, 3 + levels): head, 1 for a needed one, cost, and what it
    adds to each level. ``start`` are the levels on leaving the depot, ``lower`` and ``upper``, shape (nodes, levels), the least and the
    greatest at a node, and ``above`` the level that each one is never below, -1 for none; ``grid`` has the least, the binary logarithm of
    the width, and the number of cells of the first level. ``listed`` are the customers who are remembered at a node, from position 1 on,
    ``place`` the position of each one there or -1, and ``reach`` the greatest levels at the node from which he can still be reached.
    ``rows_at`` are the rows that are remembered at a node, by their bits, ``row_place`` the bit of each one or -1, ``turned`` the bits that
    a visit turns over, and ``prices`` what a row costs that is turned back.
    """

    first: Integers
    moves: Integers
    start: Integers
    lower: Integers
    upper: Integers
    above: Integers
    grid: Integers
    listed: Ints
    place: Ints
    reach: Integers
    rows_at: Ints
    row_place: Ints
    turned: Integers
    prices: Integers


@dataclass(frozen=True, eq=False)
class Row:
    """A subset row of multiplier 1/2: its customers, the nodes at which it is remembered, and its price, at most 0."""

    sites: Integers
    memory: Integers
    price: float

    @property
    def most(self) -> int:
        """How often routes that visit each customer once have it, all together."""
        return len(self.sites) // 2


@dataclass(frozen=True, eq=False)
class Levels:
    """Whole levels, the one that cells are made of first, each never below the one that ``above`` names, -1 for none; the visits of a walk
    that keeps them are at most ``most``."""

    weight: Integers
    start: Integers
    lower: Integers
    upper: Integers
    above: Integers
    most: int

    def backwards(self) -> "Levels":
        """The levels of the same walks driven backwards: what is still left of each at a node, with a minus sign, so that it grows. None is
        held above another: that only adds walks."""
        lower, upper = -self.upper, -self.lower
        upper[0] = -self.start
        return Levels(
            np.ascontiguousarray(self.weight.transpose(0, 2, 1)), lower[0].copy(), lower, upper, np.full_like(self.above, -1), self.most
        )


def network_of(reduced: Integers, usable: Flags, levels: Levels, listed: Ints, rows: Sequence[tuple[Row, int]]) -> Network:
    """The network of whole reduced costs, shape (nodes, nodes); of rows with what each costs, in whole numbers too.

    ``listed``, shape (nodes, positions), are those who are remembered at each node, without himself, -1 behind. No move is needed.
    """
    tails, heads = np.nonzero(usable)
    grown = [weight[tails, heads] for weight in levels.weight]
    moves = np.column_stack([heads, np.zeros_like(heads), reduced[tails, heads], *grown]).astype(np.int64)
    first = np.searchsorted(tails, np.arange(len(usable) + 1)).astype(np.int64)
    span = max(0, int(levels.upper[:, 0].max() - levels.start[0]))
    shift = (span // min(CELLS, max(FEWEST_CELLS, PASSES // max(1, len(moves))))).bit_length()
    grid = np.array([levels.start[0], shift, (span >> shift) + 1], dtype=np.int64)
    listed, place = _memory(listed)
    reach = _reach(usable, levels, listed)
    return Network(
        first, moves, levels.start, levels.lower, levels.upper, levels.above, grid, listed, place, reach, *_rows(len(usable), rows)
    )


def with_needed(network: Network, needed: Integers) -> Network:
    """The same network with 1 for moves that are needed."""
    moves = network.moves.copy()
    moves[:, 1] = needed
    return network._replace(moves=moves)


def _memory(given: Ints) -> tuple[Ints, Ints]:
    """``listed`` and ``place``, with each customer himself."""
    nodes = len(given)
    listed = np.full((nodes, given.shape[1] + 2), -1, np.int32)
    listed[1:, 1], listed[1:, 2:] = np.arange(1, nodes), given[1:]
    place = np.full((nodes, nodes), -1, np.int32)
    at, positions = np.nonzero(listed >= 0)
    place[at, listed[at, positions]] = positions
    return listed, place


def _reach(usable: Flags, levels: Levels, listed: Ints) -> Integers:
    reach = np.full((*listed.shape, len(levels.start)), -FAR)  # nobody is reached from himself
    at, positions = np.nonzero((listed >= 0) & (listed != np.arange(len(listed))[:, None]))
    who, inner = listed[at, positions], usable[1:, 1:]
    for r, weight in enumerate(levels.weight):
        # Straight, or by a first and a last move of their own.
        added = np.where(inner, weight[1:, 1:], FAR >> 1)
        way = np.minimum(added, added.min(axis=1)[:, None] + added.min(axis=0)[None, :])
        reach[at, positions, r] = levels.upper[who, r] - way[at - 1, who - 1]
    return reach


def _rows(nodes: int, rows: Sequence[tuple[Row, int]]) -> tuple[Ints, Ints, Integers, Integers]:
    """``rows_at``, ``row_place``, ``turned`` and ``prices``."""
    at = np.concatenate([np.zeros(0, np.int64), *(row.memory for row, _ in rows)])
    which = np.repeat(np.arange(len(rows)), [len(row.memory) for row, _ in rows])
    order = np.argsort(at, kind="stable")
    at, which = at[order], which[order]
    bit = np.arange(len(at)) - np.searchsorted(at, at)
    words = -(-int(bit.max(initial=-1) + 1) // BITS)
    rows_at, row_place = np.full((nodes, max(1, BITS * words)), -1, np.int32), np.full((nodes, max(1, len(rows))), -1, np.int32)
    prices, turned = np.zeros(rows_at.shape, np.int64), np.zeros((nodes, words), np.int64)
    rows_at[at, bit], row_place[at, which] = which, bit
    prices[at, bit] = np.array([price for _, price in rows], np.int64)[which]
    for k, (row, _) in enumerate(rows):
        bit = row_place[row.sites, k]
        turned[row.sites, bit // BITS] |= np.int64(1) << (bit % BITS).astype(np.int64)
    return rows_at, row_place, turned, prices


def whole_levels(resources: Sequence[Resource], usable: Flags, *, counted: bool) -> Levels:
    """Whole levels of all resources; the one that the fewest visits use up comes first.

    Visits are counted too where that is asked for, or where walks could go on for ever, or for very long.
    """
    inner = usable[1:, 1:]

    def steps(level: tuple[Integers, int, Integers, Integers]) -> tuple[bool, float]:
        """Whether many moves add nothing, and how many of those that add something there is room for."""
        weight, start, _, upper = level
        added = weight[1:, 1:][inner]
        span = float(max(0, upper.max() - start))
        return bool((added == 0).mean() > 0.1) if added.size else False, span / float(added[added > 0].min(initial=max(1, int(span))))

    exponents = [min(52 - math.frexp(_top(resource, usable))[1], 1000) for resource in resources]
    partners = [next((k for k, other in enumerate(resources) if other is one.above), -1) for one in resources]
    for k, partner in enumerate(partners):
        if partner >= 0:  # levels that are compared are counted in the same steps
            exponents[k] = exponents[partner] = min(exponents[k], exponents[partner])
    levels = [_whole_level(resource, usable, exponent) for resource, exponent in zip(resources, exponents, strict=True)]
    ranked = sorted(range(len(levels)), key=lambda k: steps(levels[k]))
    first = levels[ranked[0]]
    most = math.floor(steps(first)[1]) + 1
    if counted or bool((first[0][1:, 1:][inner] == 0).any()) or most > LONGEST:
        levels.append(_whole_level(order_resource(len(usable) - 1), usable, 0))
        partners.append(-1)
        ranked = [len(ranked), *ranked] if steps(first)[0] else [*ranked, len(ranked)]
        most = len(usable) - 1
    weights, starts, lowers, uppers = zip(*(levels[k] for k in ranked), strict=True)
    above = np.array([ranked.index(partners[k]) if partners[k] >= 0 else -1 for k in ranked], dtype=np.int64)
    return Levels(np.array(weights), np.array(starts, dtype=np.int64), np.column_stack(lowers), np.column_stack(uppers), above, most)


def _limits(resource: Resource, usable: Flags) -> tuple[Floats, Floats, Floats]:
    """Weights of moves, and levels at nodes, which are infinite where nobody comes or nothing is limited."""
    return (
        np.where(usable, resource.weight, 0.0),
        np.where(np.isfinite(resource.lower), resource.lower, resource.start),
        resource.upper + resource.slack,
    )


def _top(resource: Resource, usable: Flags) -> float:
    limits = _limits(resource, usable)
    return max(abs(resource.start), *(float(np.abs(v).max(initial=0.0, where=np.isfinite(v))) for v in limits))


def _whole_level(resource: Resource, usable: Flags, exponent: int) -> tuple[Integers, int, Integers, Integers]:
    """Weights, start, lower and upper levels of a resource in whole multiples of a power of two; what is allowed stays so."""
    weight, lower, upper = _limits(resource, usable)
    upper = np.where(np.isfinite(upper), upper, _top(resource, usable))
    if weight.min(initial=0.0) < 0.0:
        raise OverflowError  # no level that grows

    def below(values: Floats) -> Integers:
        return np.floor(np.ldexp(values, exponent)).astype(np.int64)

    return below(weight), int(below(np.array(resource.start))), below(lower), below(upper)
