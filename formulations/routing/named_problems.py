"""The standard members of the family: their names, their objectives, and a constructor for each.

Each constructor checks that the data have what the name stands for, and leaves all else to ``RoutingProblem``: capacities, windows, several
depots and the like may be added to any of them.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ...instances.errors import InputError, UsageError
from ...instances.routing.fleet import equal_fleet
from ...instances.routing.instance import RoutingInstance
from ...instances.routing.sites import Sites
from ...instances.routing.travel import Travel
from ...instances.routing.vehicle_type import Energy, VehicleType
from ..problem import PROBLEMS
from .objective import DEFAULT_OBJECTIVE, Composable, Makespan, Objective, Reward, default_objective
from .problem import RoutingProblem


def _build(instance: Any, problem: str, settings: dict[str, Any]) -> RoutingProblem:
    if not isinstance(instance, RoutingInstance):
        raise UsageError(f"{instance.name} holds no routing data, so it cannot be read as {problem}", "foreign")
    return RoutingProblem.from_instance(instance, problem, settings)


for _name in DEFAULT_OBJECTIVE:
    PROBLEMS.add(_name, _build)


def vrptw(sites: Sites, travel: Travel, *, vehicles: int | None = None, capacity: float = math.inf, **limits: Any) -> RoutingProblem:
    """Capacitated vehicle routing with time windows: least cost, each customer served within its window.

    Parameters
    ----------
    sites : Sites
        The depot and customers with their windows.
    travel : Travel
        Distances and durations between them.
    vehicles : int, optional
        At each depot; any number by default.
    capacity : float
        Of each vehicle, in units of load.
    **limits
        Of ``VehicleType``; or ``fleet=`` a list of vehicle types in place of all; ``objective=``, ``min_vehicles=``, ``name=``.

    Raises
    ------
    InputError
        If no site has a window.

    Notes
    -----
    Source: Solomon (1987); Mitchell (2020), section 3.2.
    """
    if not (sites.ready.any() or np.isfinite(sites.due).any()):
        raise InputError("no site has a time window", "missing", expected="ready or due; cvrp or min_cost_vrp without")
    return _named_problem("vrptw", sites, travel, vehicles, capacity=capacity, **limits)


def cvrp(sites: Sites, travel: Travel, *, capacity: float, vehicles: int | None = None, **limits: Any) -> RoutingProblem:
    """Capacitated vehicle routing: least cost, each customer once, loads within the capacity. Parameters as of ``vrptw``.

    Notes
    -----
    Source: Dantzig and Ramser (1959).
    """
    return _named_problem("cvrp", sites, travel, vehicles, capacity=capacity, **limits)


def tsp(sites: Sites, travel: Travel, **limits: Any) -> RoutingProblem:
    """Travelling salesman: the cheapest tour of one vehicle through all sites. Parameters as of ``vrptw``."""
    return _named_problem("tsp", sites, travel, 1, **limits)


def mdvrp(sites: Sites, travel: Travel, *, capacity: float = math.inf, vehicles: int | None = None, **limits: Any) -> RoutingProblem:
    """Several depots, ``vehicles`` at each, which return to where they started. Parameters as of ``vrptw``.

    Notes
    -----
    Source: Cordeau, Gendreau and Laporte (1997).
    """
    if len(sites.depots) < 2:
        raise InputError("there is one depot only", "missing", expected="two or more; cvrp with one")
    return _named_problem("mdvrp", sites, travel, vehicles, capacity=capacity, **limits)


def min_cost_vrp(sites: Sites, travel: Travel, *, vehicles: int | None = None, **limits: Any) -> RoutingProblem:
    """Least cost, vehicles limited in duration, distance or energy. Parameters as of ``vrptw``.

    Notes
    -----
    Source: Mitchell (2020), (5.9)-(5.15), corrected in docs/formulations/routing.md#errata.
    """
    return _named_problem("min-cost-vrp", sites, travel, vehicles, **limits)


def min_makespan_vrp(sites: Sites, travel: Travel, *, vehicles: int, **limits: Any) -> RoutingProblem:
    """The longest route as short as possible. Parameters as of ``vrptw``.

    Notes
    -----
    Source: Mitchell (2020), (5.16).
    """
    return _named_problem("min-makespan-vrp", sites, travel, vehicles, **limits)


def orienteering(sites: Sites, travel: Travel, **limits: Any) -> RoutingProblem:
    """The largest reward that one limited route collects; every site may be left out. Parameters as of ``vrptw``.

    Raises
    ------
    InputError
        If no site has a reward.

    Notes
    -----
    Source: Golden, Levy and Vohra (1987); Mitchell (2020), (5.17)-(5.18).
    """
    return _named_problem("orienteering", _optional(sites), travel, 1, **limits)


def team_orienteering(sites: Sites, travel: Travel, *, vehicles: int, **limits: Any) -> RoutingProblem:
    """The largest reward that several limited routes collect, each site once. Parameters as of ``vrptw``.

    Notes
    -----
    Source: Chao, Golden and Wasil (1996); Mitchell (2020), (5.17)-(5.18).
    """
    return _named_problem("team-orienteering", _optional(sites), travel, vehicles, **limits)


def makespan_orienteering(
    sites: Sites, travel: Travel, *, vehicles: int, weight: float | str | None = None, **limits: Any
) -> RoutingProblem:
    """The largest reward, and among the plans that collect it one of least makespan.

    Parameters
    ----------
    sites, travel, vehicles, **limits
        As of ``orienteering``.
    weight : float or "printed", optional
        Maximise reward minus ``weight`` times makespan instead, in one sum. ``printed`` is the weight of the source, the least positive
        reward over the longest duration, with which a plan may collect less than the largest reward, by less than the least one.

    Raises
    ------
    InputError
        If no site has a reward, or for the printed weight no limit of duration holds.

    Notes
    -----
    Source: Mitchell (2020), section 5.5.4; where the printed weight fails: docs/formulations/routing.md#errata.
    """
    problem = _named_problem("makespan-orienteering", _optional(sites), travel, vehicles, **limits)
    if weight is None:
        return problem
    if weight == "printed":
        rewards = sites.reward[sites.reward > 0]
        stores = (math.inf if v.energy is None else v.energy.at_departure / v.energy.rate for v in problem.fleet)
        longest = max(min(v.max_duration, store) for v, store in zip(problem.fleet, stores, strict=True))
        if not 0 < longest < math.inf:
            raise InputError(
                "the printed weight needs a limit of duration", "missing", expected="max_duration, or energy charged for travel"
            )
        weight = float(rewards.min()) / longest
    elif isinstance(weight, str):
        raise UsageError(
            f"unknown weight {weight!r}; give a number, printed, or none for an objective in order of priority", "unknown-name"
        )
    return replace(problem, objective=Objective.of(Reward() - float(weight) * Makespan()))


def recharging_vrp(
    sites: Sites, travel: Travel, *, energy: float, rate: float = 1.0, homes: Sequence[int] | None = None, **limits: Any
) -> RoutingProblem:
    """Visit all sites in the least makespan, recharging at any depot any number of times.

    Parameters
    ----------
    sites, travel, **limits
        As of ``vrptw``.
    energy : float
        That a full store holds; each unit of time on the move draws ``rate``.
    rate : float
        Energy per unit of time, above 0.
    homes : sequence of int, optional
        Site index of the depot of each vehicle; one vehicle at the first depot by default.

    Notes
    -----
    Source: Mitchell (2020), (2.7)-(2.12), connectivity added; docs/formulations/routing.md#recharging.
    """
    depots = sites.depots.tolist()
    places = [depots[0]] if homes is None else [int(k) for k in homes]
    store = Energy(energy, rate, "travel", tuple(depots))
    kinds = {home: places.count(home) for home in places}
    names = ["vehicle"] if len(kinds) == 1 else [f"vehicle at {sites.ids[k] if 0 <= k < len(sites) else k}" for k in kinds]
    own = {key: limits.pop(key) for key in ("objective", "min_vehicles", "name") if key in limits}
    fleet = [
        VehicleType(count, start=home, end=home, energy=store, name=name, **limits)
        for (home, count), name in zip(kinds.items(), names, strict=True)
    ]
    return _named_problem("recharging-vrp", sites, travel, None, fleet=fleet, **own)


def pdptw(sites: Sites, travel: Travel, *, capacity: float, vehicles: int | None = None, **limits: Any) -> RoutingProblem:
    """Pickups and deliveries in pairs, each on one vehicle: fewest vehicles, then least cost. Parameters as of ``vrptw``.

    Raises
    ------
    InputError
        If there are no shipments.

    Notes
    -----
    Source: Savelsbergh and Sol (1995); Li and Lim (2003) for the objective.
    """
    if not sites.shipments:
        raise InputError("there are no shipments", "missing", expected="shipments of the sites")
    return _named_problem("pdptw", sites, travel, vehicles, capacity=capacity, **limits)


def _optional(sites: Sites) -> Sites:
    if not sites.reward.any():
        raise InputError("no site has a reward", "missing", expected="a positive one")
    return replace(sites, required=np.zeros(len(sites), dtype=bool), groups=tuple(replace(g, required=False) for g in sites.groups))


def _named_problem(problem: str, sites: Sites, travel: Travel, vehicles: int | None, **limits: Any) -> RoutingProblem:
    objective: Composable = limits.pop("objective", None) or default_objective(problem, sites)
    least, name, fleet = limits.pop("min_vehicles", 0), limits.pop("name", problem), limits.pop("fleet", None)
    if fleet is None:
        try:
            fleet = equal_fleet(sites, count=vehicles, **limits)
        except TypeError:
            unknown = ", ".join(sorted(set(limits) - set(VehicleType.__dataclass_fields__)))
            raise UsageError(f"{problem} does not know {unknown}; it takes what VehicleType takes", "unknown-name") from None
    elif vehicles not in (None, 1) or any(limits[key] != math.inf for key in limits):
        raise UsageError(f"fleet tells the vehicles already; leave out {', '.join(['vehicles', *limits])}")
    return RoutingProblem(sites, travel, fleet, objective, least, name, problem)
