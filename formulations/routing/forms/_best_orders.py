"""The orders of stops that can be best, set of sites by set of sites, where all that counts of a route adds up along it.

Of two orders of the same sites with the same last one, the one with less distance, less time and less variance is as good however the
route goes on, since a risk of at most 1/2 rises with the mean and with the variance.
Source: Held and Karp (1962); with several sums the labels of Desrochers and Soumis (1988).
"""

import math
from collections.abc import Iterator

import numpy as np

from ....instances.number_arrays import Flags, Floats, Integers
from ...programs.size import TooLargeError
from ..preparation import waiting_is_possible
from ..problem import RoutingProblem
from ._all_routes import Walk
from ._objective import weights_of_levels

MOST_SITES = 12
"""Sites of which all sets are looked at."""

MOST_LABELS = 2_000_000
"""Orders of sets of one size that may be kept at once."""

SLACK = 1e-9
"""Part of a limit by which an order may seem to be beyond it, and is priced all the same: what prices it has the last word."""


def adds_up(problem: RoutingProblem) -> bool:
    """Whether sites are few, nobody waits, loads on the way or stops elsewhere, and less of each sum along a route is better."""
    sites, at = problem.sites, problem.customers
    if len(at) > MOST_SITES or problem.travel.closing is not None or sites.shipments or any(map(bool, sites.windows)):
        return False
    if np.isfinite(sites.due[at]).any() or sites.pickup[at].any() or sites.further_pickup[at].any() or waiting_is_possible(problem):
        return False
    if any(v.reloads or v.stations or (v.energy is not None and v.energy.charge == "windows") for v in problem.fleet):
        return False
    if any(v.travel is not None and v.travel.closing is not None for v in problem.fleet):
        return False
    levels = zip(problem.senses, weights_of_levels(problem), strict=True)
    return all(
        weight.get(term, 0.0) * (1.0 if sense == "min" else -1.0) >= 0.0
        for sense, weight in levels for term in ("total-cost", "total-duration")
    )  # fmt: skip


def best_orders(walk: Walk) -> Iterator[tuple[int, ...]]:
    """Orders of sites of which one is best for each set that the vehicle can serve, whatever it is that counts."""
    sites, at = np.array(walk.customers, dtype=np.int64), walk.vehicle
    if not len(sites):
        return
    sums = _Sums(walk, sites)
    mask, last = np.int64(1) << np.arange(len(sites)), np.arange(len(sites))
    along, before = sums.first.copy(), np.full(len(sites), -1)
    steps: list[tuple[Integers, Integers]] = []  # the last site of each label of a size, and the label before it
    for size in range(1, len(sites) + 1):
        kept = _undominated(mask * len(sites) + last, along, np.nonzero(sums.within(mask, along, SLACK))[0])
        mask, last, along, before = mask[kept], last[kept], along[:, kept], before[kept]
        steps.append((last, before))
        for label in sums.ended(mask, along + sums.home[:, last]).tolist():
            visits = []
            for lasts, earlier in reversed(steps):
                visits.append(int(sites[lasts[label]]))
                label = int(earlier[label])
            yield tuple(reversed(visits))
        parts = []
        for site in range(len(sites) if size < len(sites) else 0):
            free = np.nonzero((mask >> site) & 1 == 0)[0]
            to = np.full(len(free), site)
            parts.append((mask[free] | (1 << site), to, along[:, free] + sums.between[:, last[free], site], free))
        if sum(len(part[0]) for part in parts) > MOST_LABELS:
            raise TooLargeError(f"form set-partitioning would look at more than {MOST_LABELS:,} orders of {size + 1} sites of {at.name}")
        if parts:
            mask, last, before = (np.concatenate([part[k] for part in parts]) for k in (0, 1, 3))
            along = np.concatenate([part[2] for part in parts], axis=1)


class _Sums:
    """Sums along the routes of a vehicle type: distance, time without service and variance, as far as one says more than the others.

    ``first`` and ``home`` have shape (sums, sites), ``between`` (sums, sites, sites).
    """

    def __init__(self, walk: Walk, sites: Integers) -> None:
        vehicle, travel = walk.vehicle, walk.problem.travel_of(walk.kind)
        length, time = np.array(walk.length), np.array(walk.time)
        matrices = [length]
        self.distance, self.time, self.variance, self.pace = 0, 0, -1, 1.0
        if travel.duration_matrix is None:
            self.pace = travel.pace
        else:
            matrices.append(time)
            self.time = 1
        if walk.spread is not None:
            self.variance = len(matrices)
            matrices.append(np.array(walk.spread))
        self.first = np.array([m[vehicle.start, sites] for m in matrices])
        self.home = np.array([m[sites, vehicle.end] for m in matrices])
        self.between = np.array([m[np.ix_(sites, sites)] for m in matrices])
        self.walk, self.vehicle = walk, vehicle
        sets = np.arange(1 << len(sites))
        inside = (sets[:, None] >> np.arange(len(sites))) & 1
        self.service = inside @ np.array(walk.service)[sites]
        self.carried = np.ones(len(sets), dtype=bool)
        for load, capacity in zip((inside @ walk.demand[sites]).T, vehicle.capacities, strict=False):
            self.carried &= load <= capacity * (1.0 + SLACK)
        risks = [risk for risk in (vehicle.risk, walk.problem.team_risk) if risk is not None]
        from scipy.special import ndtri

        self.deviations = -float(ndtri(min(risks))) if risks and self.variance >= 0 else 0.0

    def within(self, mask: Integers, along: Floats, slack: float) -> Flags:
        """Which labels keep all limits, each widened by a part of it; a negative part asks for room."""
        vehicle, time = self.vehicle, self.pace * along[self.time]
        busy = time + self.service[mask]
        spread = self.deviations * np.sqrt(along[self.variance]) if self.deviations else 0.0
        limits = [
            (along[self.distance], vehicle.max_distance), (busy + spread, vehicle.max_duration),
            (busy + self.walk.opens, self.walk.home_by),
        ]  # fmt: skip
        energy = vehicle.energy
        if energy is not None:
            limits.append((energy.rate * ((time if energy.charge == "travel" else busy) + spread), energy.at_departure))
        good: Flags = self.carried[mask]
        for value, limit in limits:
            if math.isfinite(limit):
                good = good & (value <= limit + slack * max(abs(limit), abs(self.walk.opens)))
        return good

    def ended(self, mask: Integers, along: Floats) -> Integers:
        """Labels of routes that can be best of their sets: where the team has no risk, variance counts no more beyond the limits."""
        able = np.nonzero(self.within(mask, along, SLACK))[0]
        if self.variance < 0 or self.walk.problem.team_risk is not None:
            return _undominated(mask, along, able)
        surely = self.within(mask, along, -SLACK)
        counted = along[: self.variance]
        return np.concatenate([_undominated(mask, counted, able[surely[able]]), able[~surely[able]]])


def _undominated(group: Integers, sums: Floats, at: Integers) -> Integers:
    """The labels of ``at`` that no other one of their group dominates in all sums; of equal ones one."""
    order = np.lexsort((*sums[::-1, at], group[at]))
    at = at[order]
    rank = 0
    while len(at):  # in this order none is dominated by a later one
        own = group[at]
        starts = np.nonzero(np.append(True, own[1:] != own[:-1]))[0]
        sizes = np.diff(np.append(starts, len(at)))
        if rank >= int(sizes.max()) - 1:
            break
        leader = np.repeat(starts + np.minimum(rank, sizes - 1), sizes)
        worse = (np.arange(len(at)) > leader) & (sums[:, at] >= sums[:, at[leader]]).all(axis=0)
        at = at[~worse]
        rank += 1
    return at
