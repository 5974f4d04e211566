"""Evidence that there is no answer: ``infeasible-site``, no vehicle of any type can serve a required site."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.errors import InputError
from .known_features import Flags, routing_evidence, unknown_features
from .route_limits import Limits, able, allowed, limits_of, named_customers, servable_sets, summable, within_reach, within_stores
from .stops_on_the_way import without_stops

if TYPE_CHECKING:
    from ..problem import RoutingProblem

MOST_DETOURS = 5_000
"""Customers among whom ways over others are looked for."""


@routing_evidence("infeasible-site", "an unreachable site is")
def check_infeasible_site(problem: RoutingProblem, data: Mapping[str, Any]) -> float:
    """Infinity if no route of any vehicle can visit the required ``site`` (its id) of ``data``; else nothing is proved."""
    name = data.get("site")
    index = problem.sites.index()
    if not isinstance(name, str) or name not in index:
        raise InputError("evidence names an unknown site", expected="the id of a site", found=str(name)[:80])
    if not problem.sites.required[index[name]] or not summable(without_stops(problem)):
        return verdict(proved=False)
    return verdict(proved=not _can_be_served(problem, named_customers(problem, [name])[0]))


def out_of_reach(problem: RoutingProblem) -> Flags:
    """Sites that are shown here to be on no route of any vehicle, required or not; shape (sites,)."""
    beyond, customers, relaxed = np.zeros(len(problem.sites), dtype=bool), problem.sites.customers, without_stops(problem)
    if unknown_features(relaxed):
        return beyond
    if len(customers) > MOST_DETOURS:  # no matrix of moves: the demand alone tells
        beyond[customers] = problem.sites.demand[customers] > max(allowed(v.capacity) for v in problem.fleet)
    elif summable(relaxed):
        beyond[customers] = ~np.any([near for _, near in _reached(problem, relaxed)], axis=0)
    return beyond


def verdict(*, proved: bool) -> float:
    """Bound of a proof that there is no answer, and of no proof."""
    return math.inf if proved else -math.inf


def _reached(problem: RoutingProblem, relaxed: RoutingProblem) -> Iterator[tuple[Limits, Flags]]:
    """For each vehicle type its limits ``without_stops``, and the customers that it may be able to visit."""
    for vehicle, unstopped in zip(problem.fleet, relaxed.fleet, strict=True):
        limits = limits_of(relaxed, unstopped)
        yield limits, within_reach(limits) & able(problem, vehicle) & within_stores(problem, vehicle)


def _can_be_served(problem: RoutingProblem, node: int) -> bool:
    for limits, near in _reached(problem, without_stops(problem)):
        if near[node - 1]:
            others = np.nonzero(near)[0] + 1
            if servable_sets(limits, np.array([node]), others[others != node], 1):
                return True
    return False
