"""Problems of certain durations, with margins for what is uncertain of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ....formulations.routing.overrun import quantile, route_overrun
from ....formulations.routing.routes import Route, Routes
from ....formulations.routing.schedule import schedule

if TYPE_CHECKING:
    from ....formulations.routing.problem import RoutingProblem
    from ....instances.routing.travel import Travel
    from ....instances.routing.vehicle_type import VehicleType


def allowed_risk(vehicle: VehicleType, share: float | None) -> float | None:
    """The risk of a route where each has a ``share`` in that of the team."""
    risks = [risk for risk in (vehicle.risk, share) if risk is not None]
    return min(risks, default=None)


def certain(problem: RoutingProblem, slope: float, share: float | None) -> RoutingProblem:
    """A problem of certain durations: those of the means for a ``slope`` of 0, otherwise answers to it keep the risk of each route.

    Parameters
    ----------
    problem : RoutingProblem
    slope : float
        What the variance of a move adds to its duration.
    share : float, optional
        The risk of each route in place of the team's.
    """
    fleet = []
    for vehicle in problem.fleet:
        own, uncertain = vehicle.travel, (vehicle.travel or problem.travel).uncertain
        risk = allowed_risk(vehicle, share) if uncertain else None
        margin = quantile(risk) ** 2 / (4.0 * slope * vehicle.speed) if risk is not None and slope else 0.0
        if risk is not None:
            own = None if own is None else _stretched(own, slope)
        elif slope and uncertain:
            own = _stretched(own or problem.travel, 0.0)
        energy = vehicle.energy
        if energy is not None:
            left = [None if held is None else max(0.0, held - energy.rate * margin) for held in (energy.capacity, energy.initial)]
            energy = replace(energy, capacity=left[0] or 0.0, initial=left[1])
        fleet.append(replace(vehicle, risk=None, travel=own, energy=energy, max_duration=max(0.0, vehicle.max_duration - margin)))
    return replace(problem, travel=_stretched(problem.travel, slope), fleet=tuple(fleet), team_risk=None)


def _stretched(travel: Travel, slope: float) -> Travel:
    if travel.variances is None:
        return travel
    longer = travel.durations + slope * travel.variances if slope else travel.duration_matrix
    return replace(travel, duration_matrix=longer, variances=None)


@dataclass(frozen=True, eq=False)
class Split:
    """A problem in which each route of an answer has a vehicle of its own, with its own risk and margin.

    Parameters
    ----------
    problem : RoutingProblem
        Of certain durations; its answers keep the risk of each route, and that of the team.
    start : Routes
        The answer, as one of it.
    kinds : tuple of int
        Type of vehicle in the problem that was split, for each type.
    """

    problem: RoutingProblem
    start: Routes
    kinds: tuple[int, ...]

    def back(self, answer: Routes) -> Routes:
        """An answer to the problem that was split."""
        return Routes(tuple(Route(route.visits, self.kinds[route.vehicle]) for route in answer))


def split(problem: RoutingProblem, answer: Routes) -> Split | None:
    """One vehicle a route of ``answer``, which keeps all limits; and one more of each type that has any left.

    Of a risk of the team each route keeps what it has, and all vehicles get equal parts of what is left of ``-log(1 - team_risk)``. Margins
    are exact for routes of the variance that they are made for, so that the answer is feasible still, and no better one is lost to them
    that differs from it by little. None where vehicles drive without a site to serve.
    """
    if any(v.committed for v in problem.fleet):
        return None
    plans = [schedule(problem, route) for route in answer]
    used = [route.vehicle for route in answer]
    spare = [k for k, v in enumerate(problem.fleet) if v.count is None or used.count(k) < v.count]
    drivers = [*used, *spare]
    variances = [plan.variance for plan in plans]
    mean = math.fsum(variances) / max(1, len(variances))
    shares: Sequence[float | None] = [None] * len(drivers)
    if problem.team_risk is not None:
        spent = [-math.log1p(-route_overrun(problem.fleet[k], plan)) for k, plan in zip(used, plans, strict=True)]
        left = max(0.0, -math.log1p(-problem.team_risk) - math.fsum(spent)) / len(drivers)
        weights = [s + left for s in spent] + [left] * len(spare)
        shares = [min(0.5, -math.expm1(-w)) or None for w in weights]
        if None in shares:
            return None
    fleet, start = [], []
    for number, (kind, share, variance) in enumerate(zip(drivers, shares, [*variances, *[mean] * len(spare)], strict=True)):
        vehicle = problem.fleet[kind]
        risk = allowed_risk(vehicle, share)
        slope = quantile(risk) / (2.0 * vehicle.speed * math.sqrt(variance)) if risk is not None and variance > 0.0 else 0.0
        alone = replace(problem, fleet=(replace(vehicle, count=1, travel=vehicle.travel or problem.travel, name=f"{number + 1}"),))
        fleet.append(certain(alone, slope, share).fleet[0])
        if number < len(used):
            start.append(Route(answer.routes[number].visits, number))
    plain = replace(problem.travel, variances=None)
    return Split(replace(problem, fleet=tuple(fleet), travel=plain, team_risk=None), Routes(tuple(start)), tuple(drivers))
