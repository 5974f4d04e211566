"""The search of the local algorithm: for every action the largest level, found or nearly, that is valid for its tree."""

import math
from typing import Any

import numpy as np

from .....formulations.stop import NEVER, Stop
from .....instances.errors import UsageError
from .cleaning import CleanGraph, Floats, Indices
from .records import Lists, Scratch, Sight

MARGIN = 1e-9
"""Levels found are lowered by this part: z_R(t (1 - d)) >= (1 - d) z_R(t) + d cap, so rounding makes no red copy negative."""

SLACK = MARGIN / 2
"""A red copy may lie so far below 0, in parts of the cap, at a valid level of the additive search: less than the margin mends."""

_INTERVALS = 7
"""Between the eight levels of a block."""

_LINEAR = 7 * _INTERVALS
"""Wider ranges of levels are first cut into coarse parts: measured."""

_SAMPLE = (64, 16, 4)
"""Robots that are looked at to guess where the others' levels lie: fewer where their surroundings are large."""


_MOST_STEPS = 1e12
"""Numbers of steps must stay whole in a double."""


def aligned_rows(rows: int, width: int) -> Floats:
    """An array of shape (rows, width) that starts at a cache line; not set."""
    raw = np.empty(rows * width + 8)
    skip = -raw.ctypes.data % 64 // 8
    return raw[skip : skip + rows * width].reshape(rows, width)


def _scratch(clean: CleanGraph) -> Scratch:
    actions, targets, most = clean.num_actions, clean.num_targets, clean.delta_r
    return Scratch(
        aligned_rows(actions, 8), np.empty(actions), aligned_rows(targets, 8), aligned_rows(targets, 8),
        aligned_rows(targets, 4), aligned_rows(targets, 4), aligned_rows(most, 8), np.empty(most),
    )  # fmt: skip


def tree_minima(clean: CleanGraph, start: Floats, floor: Floats, rows: int, h: int, stop: Stop) -> Floats:
    """Minima over trees: row l gets, per blue copy B(v, l), the least of ``start`` over the roots above it.

    ``start`` has one value a root; ``floor``, of shape (actions,) or (0,), is joined in at every layer; ``rows`` is ``h``, or 1 for the
    last layer alone, l = h - 1.
    """
    from .layer_kernels import minima_layer

    near, next_near = aligned_rows(clean.num_targets, 4), aligned_rows(clean.num_targets, 4)
    own, back, layers = np.empty(clean.delta_r), np.empty(clean.delta_r), np.empty((rows, clean.num_actions))
    for layer in range(h):
        stop.check()
        above, out = layers[min(max(layer - 1, 0), rows - 1)], layers[min(layer, rows - 1)]
        minima_layer(clean.layout, start, floor, above, near, next_near, own, back, out, layer == 0, layer == h - 1)
        near, next_near = next_near, near
    return layers


def sums_at_caps(clean: CleanGraph) -> Floats:
    """Coverage of each target by all its viewers at their caps."""
    first, starts, targets, weights, _, caps = clean.layout
    given = weights * np.repeat(caps, np.diff(starts[first]))
    return np.bincount(targets, given, clean.num_targets).astype(np.float64)  # of nothing, numpy counts in whole numbers


def _capacities(clean: CleanGraph) -> Floats:
    """The least coverage of each action's targets by all viewers at their caps."""
    first, starts, targets, _, private, caps = clean.layout
    sums = sums_at_caps(clean)
    lowest = np.where(private > 0.0, private * np.repeat(caps, np.diff(first)), math.inf)
    seeing = np.flatnonzero(np.diff(starts))
    if len(seeing):
        lowest[seeing] = np.minimum(lowest[seeing], np.minimum.reduceat(sums[targets], starts[seeing]))
    return lowest


def _reachable(clean: CleanGraph, stop: Stop) -> tuple[Sight, Lists, Indices]:
    """Working arrays for a part of the graph: robots of a target, lists to fill, and the robot of each action."""
    from .....formulations.transpose_kernels import transpose

    graph = clean.layout
    starts, robots, _ = transpose(stop.flag, clean.num_targets, graph.starts[graph.first], graph.targets, graph.weights[:0])
    stop.check()
    sight = Sight(starts, robots)
    lists = Lists(
        np.full(clean.num_robots, -1, dtype=np.int32), np.zeros(clean.num_targets, dtype=np.bool_),
        np.empty(clean.num_robots, dtype=np.int32), np.empty(clean.num_targets, dtype=np.int32),
    )  # fmt: skip
    owner = np.repeat(np.arange(clean.num_robots, dtype=np.int32), np.diff(graph.first))
    return sight, lists, owner


class LevelGrid:
    """Levels 2^(j / m) for whole j, with the least m that makes neighbours at most a factor 1 + eps apart, 0 < eps <= 1.

    Weights times a power of two meet the same levels times that power; and nobody needs to know the weights of others for it.
    """

    def __init__(self, eps: float) -> None:
        self.parts = math.ceil(math.log(2.0) / math.log1p(eps))

    def number(self, level: float) -> float:
        """The j of a level, not rounded."""
        part, whole = math.frexp(level)
        return whole * self.parts + math.log2(part) * self.parts

    def level(self, j: int) -> float:
        """Level number j."""
        whole, part = divmod(j, self.parts)
        return math.ldexp(2.0 ** (part / self.parts), whole)


class SecantSearch:
    """Levels of a grid, the same for all robots wherever they are; between two neighbours the root of the secant.

    A red copy is concave in the level, so the secant's root never lies beyond the true one, and it is at least the lower neighbour: ``t* /
    (1 + eps) <= t <= t*``, the latter up to rounding: 2.1e-9 of it in the worst of 614 random graphs, which moved no share. Which levels
    are looked at first depends on the whole graph, the result does not.
    """

    def __init__(self, clean: CleanGraph, h: int, eps: float, stop: Stop = NEVER) -> None:
        self._stop = stop
        self._clean, self._h, self._grid = clean, h, LevelGrid(eps)
        self._scratch = _scratch(clean)
        self._all = Lists(
            np.zeros(clean.num_robots, dtype=np.int32), np.zeros(0, dtype=np.bool_),
            np.arange(clean.num_robots, dtype=np.int32), np.arange(clean.num_targets, dtype=np.int32),
        )  # fmt: skip
        self._part: tuple[Sight, Lists, Indices] | None = None
        self._settled = np.full(clean.num_actions, np.nan)

    def run(self) -> Floats:
        """The level of each action's root, shape (actions,); raises Stopped where it has to end before."""
        clean = self._clean
        capacities = _capacities(clean)
        smallest, largest = float(capacities.min()), float(capacities.max())
        # Half the capacity is always valid, more than the capacity never; one more level each way for rounding.
        low = math.floor(self._grid.number(smallest / 2)) - 1
        high = math.ceil(self._grid.number(largest)) + 1
        everyone = np.arange(clean.num_actions, dtype=np.int32)
        guess = self._guess(low, high)
        self._settle([(everyone, low, high)] if guess is None else self._split(everyone, low, high, guess, 1))
        return self._settled

    def _settle(self, work: list[tuple[Indices, int, int]]) -> None:
        """Find the levels of all roots in ``work``, each set with the numbers between which its levels lie."""
        while work:
            roots, low, high = work.pop()
            stride = 1 if high - low <= _LINEAR else -(-(high - low) // _INTERVALS)
            work += self._split(roots, low, high, low, stride)

    def _guess(self, low: int, high: int) -> int | None:
        """The level to look at first: the block that holds most results of a few robots, if their surroundings are a small part of the
        whole."""
        clean = self._clean
        if high - low <= _INTERVALS or clean.num_robots < 64 * _SAMPLE[-1]:
            return None
        for size in _SAMPLE:
            robots = np.linspace(0, clean.num_robots - 1, size).astype(np.int32)
            roots = clean.layout.first[robots]
            if self._reach(roots, clean.num_robots // 16):
                break
        else:
            return None
        self._settle([(roots, low, high)])
        numbers = np.floor([self._grid.number(t) for t in self._settled[roots]]).astype(np.int64)
        self._settled[roots] = np.nan
        blocks = np.arange(numbers.min() - _INTERVALS + 1, numbers.max() + 1)
        held = ((numbers >= blocks[:, None]) & (numbers < blocks[:, None] + _INTERVALS)).sum(axis=1)
        best = blocks[held == held.max()]
        return int(best[len(best) // 2]) if 2 * held.max() >= len(roots) else None

    def _placed(self, roots: Indices) -> Lists:
        """The robots and targets within reach of ``roots``, marked until ``unplace`` undoes it."""
        from .level_kernels import place

        if self._part is None:
            self._part = _reachable(self._clean, self._stop)
        sight, lists, owner = self._part
        reached, seen = place(self._stop.flag, self._clean.layout, sight, owner, roots, self._h, *lists)
        return lists._replace(robots=lists.robots[:reached], targets=lists.targets[:seen])

    def _reach(self, roots: Indices, limit: int) -> bool:
        """True if at most ``limit`` robots are within reach of ``roots``."""
        from .level_kernels import unplace

        part = self._placed(roots)
        unplace(*part)
        self._stop.check()
        return len(part.robots) <= limit

    def _split(self, roots: Indices, low: int, high: int, start: int, stride: int) -> list[tuple[Indices, int, int]]:
        """Test the levels start, start + stride, ...: settle the roots whose level they tell, and return the others by interval."""
        from . import level_kernels as kernels

        levels = np.array([[self._grid.level(start + stride * j) for j in range(_INTERVALS + 1)]])
        secant = stride == 1
        limits = self._limits(kernels, roots, levels, secant)
        rest = []
        above, below = np.isinf(limits), limits == kernels.BELOW
        end = start + stride * _INTERVALS
        if above.any():
            rest.append((roots[above], end, max(high, end + _INTERVALS)))
        if below.any():
            if start > low:
                rest.append((roots[below], low, start))
            else:  # the lowest level is valid for all, so this is rounding
                self._settled[roots[below]] = levels[0, 0]
        between = ~(above | below)
        if secant:
            self._settled[roots[between]] = limits[between]
            return rest
        for j in range(_INTERVALS):
            inside = limits == j
            if inside.any():
                rest.append((roots[inside], start + stride * j, start + stride * (j + 1)))
        return rest

    def _limits(self, kernels: Any, roots: Indices, levels: Floats, secant: bool) -> Floats:
        some = 3 * len(roots) < self._clean.num_actions
        part = self._placed(roots) if some else self._all
        graph, flag = self._clean.layout, self._stop.flag
        kernels.sweep(flag, graph, self._scratch, part.robots, part.targets, part.distance, self._h, levels, secant, 0.0)
        if some:
            kernels.unplace(*part)
        self._stop.check()
        return np.asarray(self._scratch.least[roots], dtype=np.float64)


def step_search(clean: CleanGraph, h: int, step: float, stop: Stop = NEVER) -> tuple[Floats, float]:
    """Levels U, U - step, U - 2 step, ... for each root from its own ceiling U: the first that is valid, never below U/2.

    U is the least value that a target in the root's tree has with all its viewers at their caps. The levels are not tried one by one:
    validity is monotone, so the digits of their number are found, to base 8. Returns the levels, of shape (actions,), and how far, at most,
    the largest valid level lies above the one found, in parts of it: step / (t* - step) at most, which is no (1 + eps) for weights of
    another size.

    Source: the search whose output the thesis tabulates (Sung 2019, Table 3.1, step 0.1).
    """
    from .level_kernels import step_groups

    lowest = _capacities(clean)
    ceiling = tree_minima(clean, lowest, lowest, 1, h, stop)[0]
    steps = float(ceiling.max()) / (2 * step) + 2
    if steps > _MOST_STEPS:
        raise UsageError(f"step must be at least {float(ceiling.max()) / _MOST_STEPS:.3g} for these weights, not {step!r}", "out-of-range")
    base = np.zeros(clean.num_actions)
    scratch, (sight, lists, owner) = _scratch(clean), _reachable(clean, stop)
    stride = 1
    while 8 * stride < steps:
        stride *= 8
    while stride >= 1:
        order = np.lexsort((base, ceiling)).astype(np.int32)
        step_groups(stop.flag, clean.layout, sight, owner, scratch, lists, h, step, float(stride), SLACK, order, ceiling, base)
        stop.check()
        stride //= 8
    levels = np.maximum(ceiling - base * step, ceiling / 2)
    relative = float((np.minimum(ceiling, levels + step) / levels).max() - 1.0)
    return levels, relative
