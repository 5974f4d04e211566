"""Shipments for engines in which the ends of a shipment are stops for it alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem


def entangled(problem: RoutingProblem) -> frozenset[str]:
    """What the ends of shipments have besides one shipment; empty where they have nothing else."""
    sites = problem.sites
    ends = [site for shipment in sites.shipments for site in (shipment.pickup, shipment.delivery)]
    grouped = {site for group in sites.groups for site in group.sites}
    lacking = set()
    if len(set(ends)) < len(ends):
        lacking.add("several shipments of one site")
    if sites.demand[ends].any() or sites.pickup[ends].any() or sites.further_demand[ends].any() or sites.further_pickup[ends].any():
        lacking.add("shipments of sites with demands or pickups")
    if grouped.intersection(ends):
        lacking.add("shipments of groups")
    return frozenset(lacking)
