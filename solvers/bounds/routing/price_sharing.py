"""Prices of visits by shares: each customer pays for his share of the best walk through him.

Prices rise, or fall, by what these walks lack, which leaves hardly any walk that costs less than its visits are worth, and follow the
visits of all these walks at once (Baldacci, Christofides, Mingozzi 2008).
"""

import math
from dataclasses import dataclass

import numpy as np

from ....formulations.routing.checking.vehicle_moves import VehicleMoves
from ....formulations.stop import Stop
from .arcs import Flags, Floats
from .resource_walks import Walks, at_level, step_size

WORK_PER_SECOND = 1.5e8
"""Moves times steps that are looked at in a second."""

ROUNDS = 200
"""Rounds for which there should be time at first; steps are coarser, and moves fewer, where there is not."""

NEIGHBOURS = 12
"""Moves into a customer, the cheapest ones, that are always looked at."""

SHARE = 0.05
"""Length of the first steps, as a part of the bound."""

TOPS = 8
"""Limits of the resource at which the best walks through a customer are looked for."""

FIRST = 0.6
"""Part of the time for the moves that are looked at first, and coarse steps."""

FINER = 8.0
"""Factor by which finer steps leave time for fewer rounds."""

LEAST_ROUNDS = 6.0
"""Rounds for which there should be time where all moves are looked at."""

DECAY = 0.3
"""Part of their length that steps have when the time ends."""

FALL = 0.03
"""Part of the value lost with further moves from which on prices follow the visits once more."""

RECOVERIES = 3
"""How often they do so at most."""

PATIENCE = 4
"""Steps without a rise after which they are halved."""


def shared_prices(
    moves: VehicleMoves, name: str, walks: Walks, routes: tuple[int, int], heavy: Floats, most: float, stop: Stop, fine: float
) -> tuple[Floats, float]:
    """Prices of customers, and their value on the moves and steps looked at last.

    The ascent begins with the moves of ``walks`` and goes on with those by which a walk may cost less than its visits are worth. ``name``
    is the resource, ``routes`` the least and the greatest number of routes, ``heavy``, shape (nodes,), the weights by which customers share
    a walk; a value that rises beyond ``most`` rises for ever; no step is smaller than ``fine``, that of the checker.
    """
    price = _begun(walks, heavy, stop)
    share, part, rounds, before, recoveries = SHARE, FIRST, float(ROUNDS), -math.inf, RECOVERIES
    best: _Ascent | None = None
    while True:
        inner = stop.within(part * stop.seconds_left)
        latest = _shared(walks, routes, heavy, most, inner, price, share)
        best = latest or best
        if best is None:
            return price[1:], -math.inf
        price = best.price
        if stop.reached() or latest is None or best.value > most:
            return best.surely(routes[1])
        rounds = max(LEAST_ROUNDS, rounds / FINER)
        work = WORK_PER_SECOND * min(stop.seconds_left, 10.0)
        whole = step_size(moves, name, walks.usable, work / LEAST_ROUNDS, 20) <= max(fine, walks.step)
        kept = walks.usable if whole else walks.kept | best.worst(NEIGHBOURS * len(heavy))
        step = max(fine, min(walks.step, step_size(moves, name, kept, work / rounds, 20)))
        fallen = walks.floor and recoveries > 0 and best.value < before - FALL * abs(before)
        if walks.floor and step == walks.step and not inner.reached() and not fallen and (kept == walks.kept).all():
            return best.surely(routes[1])
        walks, before, recoveries = Walks(walks.cost, walks.resource, step, kept, floor=True), best.value, recoveries - fallen
        share, part = 0.2 * SHARE if fallen else 0.0, 1.0 if whole else 0.5


@dataclass(frozen=True, eq=False)
class _Ascent:
    """The end of an ascent: prices of shape (nodes,), their value, and how many ``routes`` share the visits.

    ``lacking``, shape (nodes, nodes), is how much less walks over moves that were not looked at may cost than their visits are worth.
    """

    price: Floats
    value: float
    lacking: Floats
    routes: float

    def worst(self, count: int) -> Flags:
        """The moves that lack most, ``count`` of them at most."""
        count = min(count, int((self.lacking < 0.0).sum()))
        if not count:
            return np.zeros(self.lacking.shape, dtype=bool)
        worst: Flags = self.lacking <= min(0.0, float(np.partition(self.lacking.ravel(), count - 1)[count - 1]))
        return worst

    def surely(self, most: int) -> tuple[Floats, float]:
        """Prices of customers and their value, lowered for moves that were not looked at where that costs less than ``most`` routes
        at what these lack."""
        least = float(self.lacking.min())
        lower = _lowered(self.price, self.routes, least)
        if float(lower.sum()) > self.value + most * least:
            return lower[1:], float(lower.sum())
        return self.price[1:], self.value


def _shared(walks: Walks, limits: tuple[int, int], heavy: Floats, most: float, stop: Stop, price: Floats, share: float) -> _Ascent | None:
    """Prices that follow the best walks through all customers, by steps that are a ``share`` of the bound to begin with; None where there
    is no time for any."""
    from .state_space_kernels import best_through, share_out

    n = len(heavy) - 1
    best, best_price = -math.inf, price
    rate, how = np.full(n + 1, math.inf), np.zeros((n + 1, 4), np.int64)
    waited, whole, routes = 0, stop.seconds_left, float(limits[0])
    average = np.zeros(n + 1)
    tops = np.unique(np.linspace(0, walks.top, TOPS + 1)[1:].astype(np.int64))
    while not stop.reached() and best <= most:
        ahead, before, load = walks.ahead(stop, price, heavy)
        back, after, rest = walks.back(stop, price, heavy)
        if stop.reached():
            break
        least, _ = walks.best(ahead)
        worth = float(price.sum())
        value, lower = worth + limits[0 if least > 0 else 1] * least, _lowered(price, routes, least)
        if float(lower.sum()) > value:
            value = float(lower.sum())
        else:
            lower = price
        if value > best:
            waited = 0 if value > best + 1e-4 * abs(best) else waited + 1
            best, best_price, best_cells = value, lower, (ahead, back)
        else:
            waited += 1
        best_through(ahead, before, load, *walks.grid, back, after, rest, *walks.back_grid, heavy, tops, rate, how)
        visits = np.zeros(n + 1)
        routes = share_out(
            before, *walks.moves, *walks.grid, after, *walks.back_moves, *walks.back_grid, rate, how, heavy, walks.room, visits
        )
        slope = 1.0 - visits
        slope[0] = 0.0
        average = 0.5 * average + slope
        length = float(average @ average)
        if waited > PATIENCE:
            if share == 0.0:
                break
            share, waited = share / 2.0, 0
            if share < 1e-4:
                share, price = 0.0, best_price
                continue
        price = price + heavy * np.where(np.isfinite(rate), rate, 0.0)
        now = share * DECAY ** (1.0 - stop.seconds_left / whole) if whole < math.inf else share
        if length > 0:
            price = price + now * abs(float(price.sum())) / length * average
    if best == -math.inf:
        return None
    lacking = np.where(walks.usable & ~walks.kept, np.minimum(0.0, walks.through(best_price, *best_cells)), 0.0)
    return _Ascent(best_price, best, lacking, routes)


def _lowered(price: Floats, routes: float, least: float) -> Floats:
    """Prices scaled down as far as walks that cost ``least`` less than they are worth ask for, where ``routes`` of them share visits."""
    worth = float(price.sum())
    return price * max(0.0, 1.0 + min(0.0, least) * routes / worth) if worth > 0 else price


def _begun(walks: Walks, heavy: Floats, stop: Stop) -> Floats:
    """First prices that no walk beats: to each customer his share of a walk through him that is as full as can be."""
    free = np.zeros(len(heavy))
    ahead, back = walks.ahead(stop, free, heavy)[0], walks.back(stop, free, heavy)[0]
    least = at_level(ahead, walks.grid, walks.top) + at_level(back, walks.back_grid, walks.top)
    full = max(float(heavy.max()), walks.top * float(heavy[1:].sum()) / max(1.0, float(np.minimum(walks.first[1:], walks.top).sum())))
    return np.where(np.isfinite(least), least, 0.0) * heavy / full
