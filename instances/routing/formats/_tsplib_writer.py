"""Writing of TSPLIB-like files."""

import math

import numpy as np

from ...number_arrays import Floats
from ...text import plain
from ..instance import RoutingInstance
from ..travel import EXPLICIT, METRICS, Travel
from ._limits import cannot, finite, refuse_inexpressible, refuse_where
from ._tsplib import FLEET_IN_NAME, SET_X

EXACT_2D = "EXACT_2D"
"""LKH-3's word for Euclidean distances that are not rounded."""

SERVED = frozenset({"capacity", "demands", "time-windows", "depot-windows", "service-times", "limited-fleet", "max-duration", "pickups"})
SCORED = frozenset({"rewards", "optional-sites", "limited-fleet", "max-distance"})
"""Features that the format has a place for, but for orienteering, and there."""


def write(instance: RoutingInstance) -> str:
    """The text; see ``Format.write``."""
    tours = isinstance(instance, RoutingInstance) and instance.problem == "orienteering"
    present = refuse_inexpressible(instance, "vrplib", SCORED if tours else SERVED)
    sites, travel, vehicle = instance.sites, instance.travel, instance.fleet[0]
    n, own = len(sites), travel.metric in (EXPLICIT, "euclidean")
    refuse_where(
        instance, "vrplib",
        (not own and METRICS[travel.metric].file_rounding is None, f"the format has no {travel.metric} distances without rounding"),
        (travel.convention not in ("file", "exact" if own else "file"),
         f"its convention is {travel.convention}, and the format has its own"),
        (sites.ids != tuple(str(k) for k in range(1, n + 1)), "nodes must be numbered 1, 2, 3, ..."),
        (len(instance.name.splitlines()) != 1 or not instance.name.strip(), "its name is no single line"),
    )  # fmt: skip
    if tours:
        return _orienteering(instance)
    windows, tsp, name = bool(present & {"time-windows", "depot-windows"}), instance.problem == "tsp", instance.name
    refuse_where(
        instance, "vrplib",
        (windows and not finite(sites.due), "every site needs a due date if one has it"),
        (tsp and (present - {"limited-fleet", "max-duration"} or sites.depots[0] != 0),
         "a TSP has no windows, service, loads, and its first node is the depot"),
        (tsp and (vehicle.count != 1 or "max-duration" in present), "a TSP has one vehicle without a limit"),
        (not tsp and "capacity" not in present and ("demands" in present or not windows), "the format needs a capacity"),
        (not tsp and vehicle.count is None and FLEET_IN_NAME.search(name) and not SET_X.match(name),
         "the fleet is unlimited, but the end of its name would be read as a limit"),
    )  # fmt: skip
    symmetric = travel.matrix is None or np.array_equal(travel.matrix, travel.matrix.T)
    kind = ("TSP" if symmetric else "ATSP") if tsp else "VRPTW" if windows else "CVRP"
    if "pickups" in present:
        if windows and always_open(travel, sites.ready, sites.due, sites.service):
            raise cannot(instance, "vrplib", "windows that no route can outlast are not told from none")
        if not windows and math.isinf(longest_route(travel)):
            why = f"pickups need a time that no route outlasts, which {travel.metric} distances do not show"
            raise cannot(instance, "vrplib", why)
        kind = "VRPSPDTW" if windows else "VRPSPD"
    out = [f"NAME : {instance.name.strip()}", f"TYPE : {kind}", f"DIMENSION : {n}", *_metric(instance)]
    limits = (("VEHICLES", vehicle.count), ("CAPACITY", vehicle.capacity), ("DISTANCE", vehicle.max_duration))
    out += [f"{key} : {plain(limit)}" for key, limit in limits if not tsp and limit is not None and math.isfinite(limit)]
    out += _sections(instance, windows, tsp)
    return "\n".join([*out, "EOF"]) + "\n"


def _orienteering(instance: RoutingInstance) -> str:
    vehicle, sites = instance.fleet[0], instance.sites
    if vehicle.count != 1 or not math.isfinite(vehicle.max_distance) or sites.required.any():
        raise cannot(instance, "vrplib", "the format has one tour of limited length through sites that may be left out")
    out = [f"NAME : {instance.name.strip()}", "TYPE : OP", f"DIMENSION : {len(sites)}", f"COST_LIMIT : {plain(vehicle.max_distance)}"]
    out += [*_metric(instance), *_places(instance), *_table("NODE_SCORE_SECTION", sites.reward), *_depot(instance), "EOF"]
    return "\n".join(out) + "\n"


def _metric(instance: RoutingInstance) -> list[str]:
    metric = instance.travel.metric
    kind = f"EDGE_WEIGHT_TYPE : {EXACT_2D if metric == 'euclidean' else metric}"
    return [kind, "EDGE_WEIGHT_FORMAT : FULL_MATRIX"] if metric == EXPLICIT else [kind]


def _table(title: str, *columns: Floats) -> list[str]:
    return [title, *(f"{k} {' '.join(plain(v) for v in row)}" for k, row in enumerate(zip(*columns, strict=True), start=1))]


def _places(instance: RoutingInstance) -> list[str]:
    sites, travel = instance.sites, instance.travel
    if travel.matrix is None:
        assert travel.coordinates is not None
        return _table("NODE_COORD_SECTION", *travel.coordinates.T)
    xy = [] if sites.coordinates is None else _table("NODE_COORD_SECTION", *sites.coordinates.T)
    return [*xy, "EDGE_WEIGHT_SECTION", *(" ".join(plain(v) for v in row) for row in travel.matrix)]


def _depot(instance: RoutingInstance) -> list[str]:
    return ["DEPOT_SECTION", str(instance.sites.depots[0] + 1), "-1"]


def _sections(instance: RoutingInstance, windows: bool, tsp: bool) -> list[str]:
    sites, out = instance.sites, _places(instance)
    if tsp:
        return out
    if sites.pickup.any():
        always = max(1e7, math.ceil(longest_route(instance.travel) + float(sites.service.sum())))
        due = np.where(np.isfinite(sites.due), sites.due, always)
        columns = (np.zeros(len(sites)), sites.ready, due, sites.service, sites.pickup, sites.demand)
        return [*out, *_table("PICKUP_AND_DELIVERY_SECTION", *columns), *_depot(instance)]
    if sites.demand.any() or math.isfinite(instance.fleet[0].capacity):
        out += _table("DEMAND_SECTION", sites.demand)
    if sites.service.any():
        out += _table("SERVICE_TIME_SECTION", sites.service)
    if windows:
        out += _table("TIME_WINDOW_SECTION", sites.ready, sites.due)
    return [*out, *_depot(instance)]


def always_open(travel: Travel, ready: Floats, due: Floats, service: Floats) -> bool:
    """True if all sites share a window from 0 on that no route can outlast."""
    return not ready.any() and bool((due == due[0]).all()) and bool(due[0] >= longest_route(travel) + float(service.sum()))


def longest_route(travel: Travel) -> float:
    """An upper bound on the length of routes that visit each site at most once; infinite for metrics without a simple one."""
    if travel.matrix is not None:
        return float(travel.matrix.max(axis=1).sum())
    assert travel.coordinates is not None
    if travel.metric not in ("euclidean", "EUC_2D", "CEIL_2D", "MAN_2D"):
        return math.inf
    return len(travel) * (float(np.ptp(travel.coordinates, axis=0).sum()) + 1.0)  # a move, rounded up
