"""Statements by which a proof distinguishes cases, and the problem that is left where statements hold."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ...instances.errors import InputError
from ...instances.printable import printable
from ..problem import Decision
from .objective import Objective, Penalties, Reward, Vehicles

if TYPE_CHECKING:
    from ...instances.routing.sites import Sites
    from ...instances.routing.vehicle_type import VehicleType
    from .problem import RoutingProblem

NEARLY = 1e-8
"""Part of a sum: by less a value may differ and still count as the same."""


def check_statement(problem: RoutingProblem, statement: Any) -> None:
    """``{"arc": [id, id]}``: some route goes from the one site to the other without a stop between; ``{"routes": k}``: at most k routes."""
    parts = statement if isinstance(statement, Mapping) and len(statement) == 1 else {}
    arc, routes = parts.get("arc"), parts.get("routes")
    if type(routes) is int and 1 <= routes <= len(problem.sites):
        return
    index = problem.site_index
    if not isinstance(arc, list) or len(arc) != 2 or not all(isinstance(site, str) and site in index for site in arc):
        expected = '{"arc": [the id of a site, the id of a site]}, or {"routes": a number of them}'
        raise InputError("not a statement on a move or on the number of routes", expected=expected, found=printable(str(statement), 80))


def in_words(problem: RoutingProblem, statement: Any, holds: bool) -> str:
    """A statement, or its opposite, for people."""
    if "routes" in statement:
        routes = statement["routes"] if holds else statement["routes"] + 1
        return f"there {'is' if routes == 1 else 'are'} at {'most' if holds else 'least'} {routes} route{'' if routes == 1 else 's'}"
    tail, head = statement["arc"]
    return f"{'some' if holds else 'no'} route goes from {tail} straight to {head}"


def restricted(problem: RoutingProblem, decisions: Sequence[Decision]) -> RoutingProblem:
    """The same problem without moves: one that is not made, and those beside one that is, for a customer is left and entered once.

    Of each type of vehicle there are as many as there are routes at most.
    """
    sites = problem.sites
    moves = np.zeros((len(sites),) * 2, dtype=bool) if problem.forbidden is None else problem.forbidden.copy()
    least, most = problem.min_vehicles, len(sites)
    for statement, holds in decisions:
        problem.check_statement(statement)
        if "routes" in statement:
            least, most = (least, min(most, statement["routes"])) if holds else (max(least, statement["routes"] + 1), most)
            continue
        i, j = (problem.site_index[site] for site in statement["arc"])
        if not holds:
            moves[i, j] = True
            continue
        kept = moves[i, j]
        if not sites.depot[i]:
            moves[i] = True
        if not sites.depot[j]:
            moves[:, j] = True
        moves[i, j] = kept
    return problem.altered(forbidden=moves, min_vehicles=least, fleet=_at_most(problem.fleet, most) if most < len(sites) else problem.fleet)


def later_levels(problem: RoutingProblem, values: Sequence[float]) -> RoutingProblem | None:
    """The levels after those of ``values``.

    Where a level before counts vehicles alone, there are no more of them than its value says; where it counts rewards or penalties alone,
    sites without whom its value is out of reach are required. Other levels restrict nothing, so that bounds hold for more answers than they
    need to.
    """
    levels = problem.objective.levels()
    if not 0 < len(values) < len(levels):
        return None
    fleet, sites = problem.fleet, problem.sites
    for level, value in zip(levels, values, strict=False):
        ((weight, term), *others) = level.terms
        if others or weight <= 0 or not math.isfinite(value):
            continue
        if isinstance(term, Vehicles):
            fleet = _at_most(fleet, max(1, math.floor(value / weight * (1.0 + 1e-9))))
        elif isinstance(term, Reward | Penalties):
            sites = _with_needed(sites, term, value / weight)
    return problem.altered(fleet=fleet, sites=sites, objective=Objective(levels[len(values) :]))


def _at_most(fleet: tuple[VehicleType, ...], count: int) -> tuple[VehicleType, ...]:
    return tuple(v if v.count is not None and v.count <= count else replace(v, count=count) for v in fleet)


def _with_needed(sites: Sites, term: Reward | Penalties, value: float) -> Sites:
    """``sites``, of which those are required whose loss alone is more than rewards, or penalties, of ``value`` leave.

    Members of groups are not, for a group may have another.
    """
    worth = sites.reward if isinstance(term, Reward) else np.where(sites.required, 0.0, sites.penalty)
    total = math.fsum(worth)
    sizes = math.fsum(sites.reward if isinstance(term, Reward) else sites.penalty)
    spare = (total - value if isinstance(term, Reward) else value) + NEARLY * max(sizes, abs(value))
    needed = ~sites.depot & (worth > spare)
    for group in sites.groups:
        needed[list(group.sites)] = False
    ends = [[s.pickup, s.delivery] for s in sites.shipments]  # both are visited, or none
    while any(needed[pair].any() != needed[pair].all() for pair in ends):
        for pair in ends:
            needed[pair] = needed[pair].any()
    try:
        return replace(sites, required=sites.required | needed)
    except InputError:  # no answer visits them: then more answers are looked at than there are
        return sites
