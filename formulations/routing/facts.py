"""Facts of a routing problem for ``waybound info``, and the hash of its data."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ...instances.instance import digest
from ...instances.routing.features import features
from ...instances.routing.geography import middle
from ...instances.routing.sites import Sites, with_unused
from ...instances.routing.travel import EXPLICIT
from .objective import DEFAULT_OBJECTIVE, default_objective, pointless
from .reachability import unreachable
from .routes import Floats, Integers

if TYPE_CHECKING:
    from ...instances.routing.travel import Travel
    from ...instances.routing.vehicle_type import VehicleType
    from .problem import RoutingProblem

FIRST = 10
"""Fields of a vehicle type that are always shown; the others where they differ from what is usual."""


def facts(problem: RoutingProblem) -> dict[str, Any]:
    """Objective, sites, demand, service, windows, travel and fleet; loads, relations of sites and the like where there are any."""
    s, at, present = problem.sites, problem.customers, features(problem)
    due = s.due[at][np.isfinite(s.due[at])]
    return {
        "objective": str(problem.objective),
        "sites": {
            "depots": [s.ids[i] for i in s.depots],
            "customers": len(at),
            "optional": int((~s.required[at]).sum()),
            "unreachable": len(unreachable(problem)),
        },
        "demand": _spread(s.demand[at]),
        "service": _spread(s.service[at]),
        "windows": {
            "sites": int(((s.ready[at] > 0) | np.isfinite(s.due[at])).sum()),
            "earliest": float(s.ready[at].min(initial=math.inf)),
            "latest": float(due.max()) if len(due) else None,
            "depot": [[float(s.ready[i]), float(s.due[i])] for i in s.depots],
            **({} if problem.clock is None else {"clock": dataclasses.asdict(problem.clock)}),
        },
        "travel": _travel(problem.travel, s) | ({} if problem.forbidden is None else {"forbidden_moves": int(problem.forbidden.sum())}),
        "fleet": [_vehicle(v, s) for v in problem.fleet],
        "min_vehicles": problem.min_vehicles,
        **({} if problem.team_risk is None else {"team_risk": problem.team_risk}),
        **({"around": dataclasses.asdict(middle(s.coordinates))} if s.geographic and s.coordinates is not None else {}),
        **{key: of(s, at) for feature, (key, of) in FURTHER.items() if feature in present},
    }


def remarks(problem: RoutingProblem) -> tuple[str, ...]:
    """Data that do not count, and what counts though nobody asked."""
    s, at, aims = problem.sites, problem.customers, problem.objective.features()
    texts = list(with_unused(problem.notes, s.attributes))
    aim = str(problem.objective)
    for name, values in (("rewards", s.reward), ("penalties", s.penalty)):
        if values[at].any() and f"objective:{name.removesuffix('s') if name == 'rewards' else name}" not in aims:
            why = "every site is required" if s.required[at].all() else f"the objective is {aim}"
            texts.append(f"{name} count for nothing: {why}")
    stops = any(v.reloads or v.stations for v in problem.fleet)
    at_stops = "at stops on the way alone: departure and return take no time" if stops else "for nothing: departure and return take no time"
    for name, values, why in (("service", s.service, at_stops), ("demand", s.demand, "for nothing"), ("pickup", s.pickup, "for nothing")):
        if idle := [s.ids[k] for k in s.depots.tolist() if values[k] > 0.0]:
            texts.append(f"{name} of {', '.join(idle[:5])}{', ...' if len(idle) > 5 else ''}, a depot, counts {why}")
    texts += _unlimited(problem)
    if many := pointless(s):
        texts.append(f"{many} {'site' if many == 1 else 'sites'} may be left out, and nothing tells what a visit is worth")
    if aim == str(default_objective(problem.problem, s)) != str(DEFAULT_OBJECTIVE.get(problem.problem)):
        texts.append(f"sites may be left out, and what they are worth counts: the objective is {aim}")
    return tuple(texts)


def _unlimited(problem: RoutingProblem) -> list[str]:
    """Loads that no vehicle has a capacity for: whoever tells them means a limit."""
    s, at, texts = problem.sites, problem.customers, []
    for k in range(s.dimensions):
        if any(math.isfinite(v.capacities[k]) for v in problem.fleet if k < len(v.capacities)):
            continue
        number = "" if k == 0 else str(k + 1)
        loads = {
            f"demand{number}": s.demand if k == 0 else s.further_demand[:, k - 1],
            f"pickup{number}": s.pickup if k == 0 else s.further_pickup[:, k - 1],
        }
        names = [name for name, values in loads.items() if values[at].any()]
        if any(k < len(shipment.load) and shipment.load[k] for shipment in s.shipments):
            names.append(f"load{number} of shipments")
        if names:
            counts = "count" if len(names) > 1 else "counts"
            texts.append(f"{' and '.join(names)} {counts} for nothing: no vehicle has a capacity for {'them' if len(names) > 1 else 'it'}")
    return texts


FURTHER: dict[str, tuple[str, Callable[[Sites, Integers], Any]]] = {
    "demand-or-service-of-depots": (
        "at_depots", lambda s, at: {name: math.fsum(getattr(s, name)[s.depots]) for name in ("demand", "service")}
    ),
    "several-loads": ("further_demand", lambda s, at: [_spread(column) for column in s.further_demand[at].T]),
    "pickups": ("pickup", lambda s, at: _spread(s.pickup[at])),
    "rewards": ("reward", lambda s, at: _spread(s.reward[at])),
    "penalties": ("penalty", lambda s, at: _spread(s.penalty[at])),
    "several-windows": (
        "several_windows", lambda s, at: {"sites": sum(1 for w in s.windows if w), "most": max(len(w) for w in s.windows)}
    ),
    "skills": ("skills", lambda s, at: {"sites": sum(1 for names in s.skills if names), "names": sorted(frozenset().union(*s.skills))}),
    "shipments": ("shipments", lambda s, at: {"count": len(s.shipments), "load": math.fsum(x.load[0] for x in s.shipments)}),
    "groups": ("groups", lambda s, at: {"count": len(s.groups), "required": sum(g.required for g in s.groups)}),
}  # fmt: skip
"""Facts that most problems do not have, by feature: the key, and the value from sites and indices of the customers."""


def _travel(travel: Travel, sites: Sites) -> dict[str, Any]:
    facts = {
        "metric": travel.metric, "coordinates": sites.coordinates is not None, "own_durations": travel.own_durations
    }  # fmt: skip
    if travel.closing is not None:
        facts["closing_moves"] = int(np.isfinite(travel.closing).sum())
    if travel.uncertain:
        facts["largest_variance"] = float(np.max(travel.variances))  # type: ignore[arg-type]
    return facts


def _vehicle(vehicle: VehicleType, sites: Sites) -> dict[str, Any]:
    facts: dict[str, Any] = {"name": vehicle.name}
    for number, field in enumerate(dataclasses.fields(vehicle)):
        value = getattr(vehicle, field.name)
        if number < FIRST or value != field.default:
            facts[field.name] = sorted(value) if isinstance(value, frozenset) else list(value) if isinstance(value, tuple) else value
    facts |= {"start": sites.ids[vehicle.start], "end": sites.ids[vehicle.end]}
    if vehicle.reloads:
        facts["reloads"] = [sites.ids[k] for k in vehicle.reloads]
    if vehicle.travel is not None:
        facts["travel"] = _travel(vehicle.travel, sites)
    if vehicle.energy is not None:
        store = dataclasses.asdict(vehicle.energy)
        for key in ("stations", "initial"):
            if not store[key] and store[key] != 0.0:
                del store[key]
        if vehicle.energy.stations:
            store["stations"] = [sites.ids[k] for k in vehicle.energy.stations]
        facts["energy"] = store
    return facts


def digested(problem: RoutingProblem) -> str:
    """Hash of all data; what most problems do not have leaves it as it is without."""
    s, further = problem.sites, list[Any]()
    for name in ("penalty", "pickup", "further_demand", "further_pickup"):
        values = getattr(s, name)
        further += [name, values] if values.any() or (name == "further_demand" and values.size) else []
    for name in ("windows", "shipments", "groups"):
        further += [name, getattr(s, name)] if getattr(s, name) else []
    further += ["skills", [sorted(needs) for needs in s.skills]] if any(s.skills) else []
    for travel in (v.travel for v in problem.fleet):
        further += [] if travel is None else [*_moves(travel), travel.closing, *_variances(travel)]
    further += [part for part in (problem.travel.closing, problem.forbidden) if part is not None]
    further += ["needed", *problem.needed] if problem.needed else []
    further += ["exceeded", *sorted(problem.exceeded.items())] if problem.exceeded else []
    further += _variances(problem.travel)
    further += [] if problem.team_risk is None else ["team-risk", problem.team_risk]
    return digest(
        "routing", s.ids, s.depot, s.demand, s.ready, s.due, s.service, s.reward, s.required, *_moves(problem.travel),
        tuple(v if v.travel is None else dataclasses.replace(v, travel=None) for v in problem.fleet), problem.min_vehicles,
        str(problem.objective), *further,
    )  # fmt: skip


def _moves(travel: Travel) -> list[Any]:
    raw = travel.matrix if travel.metric == EXPLICIT else travel.coordinates
    pace = [] if travel.pace == 1.0 else ["pace", travel.pace]
    return [travel.metric, raw, travel.duration_matrix, travel.convention, *pace]


def _variances(travel: Travel) -> list[Any]:
    return ["variances", travel.variances] if travel.uncertain else []


def _spread(values: Floats) -> dict[str, float]:
    some = values if len(values) else np.zeros(1)
    return {"total": math.fsum(some), "least": float(some.min()), "largest": float(some.max())}
