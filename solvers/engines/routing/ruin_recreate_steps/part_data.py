"""The data of a part of a routing problem: some of its sites and vehicles, in the integers of the whole."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from .....instances.routing.travel import Travel
from ..extents import distances_of
from ..integer_scales import Integers
from ..routing_integers import IntegerRouting

if TYPE_CHECKING:
    from .....formulations.routing.problem import RoutingProblem

OF_SITES = ("service", "ready", "due", "demand", "pickup", "prize")
"""Arrays of ``IntegerRouting`` with an entry a site."""

OF_TYPES = (
    "profile", "capacity", "max_duration", "max_distance", "regular_duration", "unit", "fixed", "counted", "time", "overtime", "opens",
    "leaves", "closes", "travel_limit", "travel_reach", "charge_limit", "latest_return", "store", "store_lacking",
)  # fmt: skip
"""Arrays of ``IntegerRouting`` with an entry a vehicle type."""


@dataclass(frozen=True, eq=False)
class Part:
    """A part as a problem of its own: its sites and vehicle types are those of ``sites`` and ``kinds`` in the whole."""

    problem: RoutingProblem
    data: IntegerRouting
    sites: Integers
    kinds: Integers


class Divisible:
    """A problem and its integers, of which parts are made; making one takes no step for each site of the whole."""

    def __init__(self, problem: RoutingProblem, data: IntegerRouting) -> None:
        self.problem, self.data = problem, data
        self.sites = replace(problem.sites, attributes={}) if problem.sites.attributes else problem.sites
        self.ends = np.unique([site for v in problem.fleet for site in (v.start, v.end)])
        self.travels: list[Travel] = [problem.travel] * len(data.moves)
        for kind, profile in enumerate(data.profile.tolist()):
            self.travels[profile] = problem.travel_of(kind)

    def part(self, customers: Integers, counts: Integers) -> Part:
        """The part of these customers, and of so many vehicles of each type."""
        problem, data = self.problem, self.data
        sites, kinds = np.concatenate([self.ends, customers]), np.nonzero(counts)[0]
        place = {site: k for k, site in enumerate(self.ends.tolist())}
        travel = problem.travel.subset(sites)
        fleet = tuple(
            replace(v, count=int(counts[k]), start=place[v.start], end=place[v.end], travel=None if v.travel is None else travel)
            for k, v in enumerate(problem.fleet)
            if counts[k]
        )
        forbidden = None if problem.forbidden is None else problem.forbidden[np.ix_(sites, sites)]
        profiles, profile = np.unique(data.profile[kinds], return_inverse=True)
        moves = []
        for p in profiles.tolist():
            every, (lengths, times) = data.moves[p], distances_of(self.travels[p].subset(sites))
            alike = times is lengths
            lengths = replace(lengths, few=(every.lengths.largest,))  # the largest of all stands for those of a part, too
            times = lengths if alike else replace(times, few=(every.times.largest,))
            moves.append(replace(every, lengths=lengths, times=times, closing=None, charge=None))
        own = {name: getattr(data, name)[sites] for name in OF_SITES} | {name: getattr(data, name)[kinds] for name in OF_TYPES}
        windows = tuple(data.windows[k] for k in sites.tolist())
        return Part(
            problem.altered(sites=self.sites.subset(sites), travel=travel, fleet=fleet, forbidden=forbidden, needed=()),
            replace(data, **(own | {"profile": profile.astype(np.int64)}), moves=tuple(moves), windows=windows),
            sites,
            kinds,
        )
