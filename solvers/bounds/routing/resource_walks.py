"""Walks of one vehicle type over levels of a resource; node 0 is the depot."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....formulations.checking.granularity import grain
from ....formulations.routing.checking.relaxation import Resource
from ....formulations.routing.checking.vehicle_moves import VehicleMoves
from ....formulations.stop import Stop
from .arcs import Flags, Floats, Integers

Cells = tuple[Floats, NDArray[np.int32], Floats]
"""Least costs, nodes before, and weights of walks, shape (cells, 2)."""

STEPS = 10_000
"""Most steps of the counted resource."""

CELLS = 1e6
"""Most pairs of a node and a level."""

LEVELS = 6
"""Levels by which walks over a move that is not looked at are told apart."""


@dataclass(eq=False)
class Walks:
    """The moves of a vehicle type and their grid of levels; it keeps no prices.

    ``cost`` and ``kept``, the moves between customers that are looked at, have shape (nodes, nodes). With ``floor`` weights lose parts of
    steps, as for the checker; otherwise, for coarse steps, they are rounded to the nearest.
    """

    cost: Floats
    resource: Resource
    step: float
    kept: Flags
    floor: bool = False

    def __post_init__(self) -> None:
        r, nodes = self.resource, len(self.cost)
        reached = np.isfinite(r.lower) & np.isfinite(r.upper)
        self.usable = usable = np.isfinite(self.cost) & reached[:, None] & reached
        weight = np.where(usable, r.weight, 0.0) / self.step
        weight = (np.floor(weight + 1e-9) if self.floor else np.rint(weight)).astype(np.int64)
        weight[1:, 1:] = np.maximum(weight[1:, 1:], 1)
        lower = np.floor(np.where(reached, r.lower - r.start, 0.0) / self.step + 1e-9).astype(np.int64)
        upper = np.floor(np.where(reached, r.upper - r.start, -2.0 * self.step) / self.step + 1e-6).astype(np.int64)
        self.top = int(upper[0])
        upper = np.minimum(upper, self.top)
        self.first, self.last = weight[0].copy(), weight[:, 0].copy()
        self.first_cost, self.last_cost = (np.where(usable[0], self.cost[0], math.inf), np.where(usable[:, 0], self.cost[:, 0], math.inf))
        self.grid, self.back_grid = _grid(lower, upper), _grid(self.top - upper, self.top - lower)
        inner = usable & self.kept & (upper >= lower) & (upper >= lower)[:, None]
        inner[0] = inner[:, 0] = False
        heads, tails = np.nonzero(inner.T)
        back_tails, back_heads = np.nonzero(inner)
        at = np.arange(nodes + 1)
        self.moves = np.searchsorted(heads, at), np.ascontiguousarray(tails), weight[tails, heads]
        self.back_moves = np.searchsorted(back_tails, at), np.ascontiguousarray(back_heads), weight[back_tails, back_heads]
        self.heads, self.ahead_cost, self.back_cost = heads, self.cost[tails, heads], self.cost[back_tails, back_heads]
        self.lower, self.ends = lower, np.minimum(upper, self.top - self.last)
        self.room = np.zeros(2 * self.top + 4, np.int64)

    def ahead(self, stop: Stop, price: Floats, heavy: Floats) -> Cells:
        from .state_space_kernels import walk_costs

        cost = self.ahead_cost - price[self.heads]
        return walk_costs(stop.flag, *self.moves, cost, self.first_cost - price, self.first, *self.grid, heavy)  # type: ignore[no-any-return]

    def back(self, stop: Stop, price: Floats, heavy: Floats) -> Cells:
        from .state_space_kernels import walk_costs

        cost = self.back_cost - price[self.back_moves[1]]
        return walk_costs(  # type: ignore[no-any-return]
            stop.flag, *self.back_moves, cost, self.last_cost, self.last, *self.back_grid, heavy
        )

    def best(self, values: Floats) -> tuple[float, int]:
        """Least cost of a walk, and the last node of it."""
        good = np.nonzero(self.ends >= self.lower)[0]
        good = good[good > 0]
        if not len(good):
            return math.inf, 0
        ends = values[self.grid[0][good] + self.ends[good] - self.lower[good], 0] + self.last_cost[good]
        at = int(np.argmin(ends))
        return float(ends[at]), int(good[at])

    def visits(self, before: NDArray[np.int32], node: int) -> Floats:
        """How often the best walk that ends at ``node`` visits each node."""
        from .state_space_kernels import walk_to

        count = walk_to(before, *self.moves, *self.grid, node, int(self.ends[node]), 0, self.room)
        return np.bincount(self.room[:count], minlength=len(self.cost)).astype(np.float64)

    def through(self, price: Floats, ahead: Floats, back: Floats) -> Floats:
        """Lower bounds on the cost of the best walk over each move, shape (nodes, nodes), from the best walks on the moves that are looked
        at."""
        least = np.full(self.cost.shape, math.inf)
        levels = np.linspace(0, self.top, LEVELS + 1).astype(np.int64)
        for low, high in zip(levels[:-1].tolist(), levels[1:].tolist(), strict=True):
            come, go = at_level(ahead, self.grid, high), at_level(back, self.back_grid, self.top - low)
            np.minimum(least, come[:, None] + go, out=least)
        return least + (self.cost - price)


def at_level(values: Floats, grid: tuple[Integers, Integers, Integers], level: int) -> Floats:
    """Least cost at a level or below it, by node."""
    base, lower, upper = grid
    cell = base[:-1] + np.minimum(level, upper) - lower
    some = (upper >= lower) & (level >= lower)
    return np.where(some, values[np.where(some, cell, 0), 0], math.inf) if len(values) else np.full(len(lower), math.inf)


def _grid(lower: Integers, upper: Integers) -> tuple[Integers, Integers, Integers]:
    """First cell of each node, and its levels; the depot has none."""
    count = np.maximum(0, upper - lower + 1)
    count[0] = 0
    return np.append(0, np.cumsum(count)), lower, np.where(count > 0, upper, lower - 1)


def step_size(moves: VehicleMoves, name: str, kept: Flags, work: float, least: int) -> float:
    """A step of which weights and limits are multiples, if the work that it takes allows; else a coarser one."""
    resource = moves.resources[name]
    room = float(resource.upper[0]) - resource.start
    if not room > 0:
        return 1.0
    span = np.where(np.isfinite(resource.lower) & np.isfinite(resource.upper), resource.upper - resource.lower, 0.0)
    span = np.clip(span, 0.0, room)
    arcs = kept[1:, 1:].sum(axis=0)
    steps = room * min(work / max(1e-300, float(span[1:] @ arcs)), CELLS / max(1e-300, float(span.sum())))
    most = float(np.clip(steps, least, STEPS))
    finite = resource.weight[np.isfinite(resource.weight)]
    unit = grain(finite[:4000])
    size = 0.0 if unit is None else unit.size
    return size if size and room / size <= most else room / most
