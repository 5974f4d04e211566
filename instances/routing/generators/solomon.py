"""Instances with time windows after Solomon's recipe, classes C1, C2, R1, R2, RC1, RC2.

Customers lie at random (R), in clusters (C), or half and half (RC). Type 1 has a short horizon and few customers a route, type 2
a long one and many. A share of the customers, the density, has time windows; half the width is a normal random number.

- R, RC: the centre of a window is uniform over the times at which service can begin, if the depot is left when it opens and
  reached again before it closes.
- C: each cluster becomes one route. The centres are the arrival times along that route, so that a very good answer, one vehicle
  for each cluster, is feasible. The routes are improved by 2-opt and Or-opt, where Solomon used 3-opt.

Coordinates are whole numbers, all different. Windows are rounded outwards, inside what the depot's horizon allows.

Source: Solomon (1987), Algorithms for the vehicle routing and scheduling problems with time window constraints, Operations
Research 35(2), section 4; horizons, capacities and service times as in the published files.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...generators import GENERATORS, Draw, Floats, Generator, Integers, Setting
from ..instance import RoutingInstance, Sites, VehicleType
from ..travel import Travel


@dataclass(frozen=True)
class SolomonClass:
    """Figures that the files of one class share: units of time and load as in the files, sides of the region in units of distance."""

    clustered: float
    horizon: int
    capacity: int
    service: int
    depot: tuple[int, int]
    side: tuple[int, int]
    cluster: int
    width: float


CLASSES = {
    "C1": SolomonClass(1.0, 1236, 200, 90, (40, 50), (100, 100), 10, 60.0),
    "C2": SolomonClass(1.0, 3390, 700, 90, (40, 50), (100, 100), 33, 160.0),
    "R1": SolomonClass(0.0, 230, 200, 10, (35, 35), (70, 80), 10, 30.0),
    "R2": SolomonClass(0.0, 1000, 1000, 10, (35, 35), (70, 80), 33, 240.0),
    "RC1": SolomonClass(0.5, 240, 200, 10, (40, 50), (100, 100), 10, 30.0),
    "RC2": SolomonClass(0.5, 960, 1000, 10, (40, 50), (100, 100), 10, 240.0),
}
SPREAD = 4.0
CLUSTER_DEMANDS = (10, 20, 30, 40, 50)
CLUSTER_WEIGHTS = (0.45, 0.33, 0.14, 0.06, 0.02)

SETTINGS = {
    "class": Setting("R1", "where customers lie, and type of horizon", choices=tuple(CLASSES)),
    "customers": Setting(100, "number of customers", least=1, most=1000),
    "density": Setting(1.0, "share of the customers with a time window", least=0.0, most=1.0),
    "width": Setting(None, "mean width of a time window; by default that of the class", type=float, least=0.0, most=10**6),
    "deviation": Setting(0.25, "standard deviation of the width, as a share of the mean", least=0.0, most=1.0),
    "vehicles": Setting(None, "number of vehicles; by default 25, or one for four customers", type=int, least=1, most=5000),
    "name": Setting(None, "name of the instance", type=str),
}


def make(draw: Draw, settings: Mapping[str, Any]) -> RoutingInstance:
    """One instance."""
    kind = CLASSES[settings["class"]]
    n = settings["customers"]
    xy, cluster = _positions(draw, kind, n)
    if 0.0 < kind.clustered < 1.0:
        order = draw.permutation(n)  # the first 25 customers are a mix, too
        xy, cluster = xy[order], cluster[order]
    demand = _cluster_demands(draw, kind, cluster) if kind.clustered == 1.0 else draw.integers(1, 41, n)
    points = np.vstack([np.array(kind.depot, dtype=np.float64), xy])
    travel = Travel("euclidean", coordinates=points)
    away = travel.distance(0, np.arange(1, n + 1))
    horizon = float(kind.horizon)
    if kind.clustered == 1.0:
        center, finish = _arrivals(travel, cluster, float(kind.service))
        horizon = max(horizon, math.ceil(finish) + 1.0)
    else:
        center = away + draw.uniform(0.0, 1.0, n) * (horizon - away - kind.service - away)
    latest = np.floor(horizon - away - kind.service)
    width = kind.width if settings["width"] is None else settings["width"]
    half = np.abs(draw.normal(width / 2.0, settings["deviation"] * width / 2.0, n))
    constrained = draw.chosen(round(settings["density"] * n), n)
    ready = np.where(constrained, np.maximum(0.0, np.floor(center - half)), 0.0)
    due = np.where(constrained, np.clip(np.ceil(center + half), np.ceil(away), latest), latest)
    sites = Sites.of(
        range(n + 1), demand=np.concatenate([[0], demand]), ready=np.concatenate([[0.0], np.minimum(ready, due)]),
        due=np.concatenate([[horizon], due]), service=np.where(np.arange(n + 1) > 0, kind.service, 0), coordinates=points,
    )  # fmt: skip
    count = settings["vehicles"] or max(25, math.ceil(n / 4))
    name = settings["name"] or f"{settings['class']}-n{n}-s{settings['seed']}"
    fleet = (VehicleType(count, kind.capacity),)
    return RoutingInstance(name, "generated", sites, travel, fleet, "vrptw", ("vrptw", "min-cost-vrp"))


def _positions(draw: Draw, kind: SolomonClass, n: int) -> tuple[Floats, Integers]:
    """Coordinates, and the number of each customer's cluster (-1: none)."""
    inside = round(kind.clustered * n)
    clusters = math.ceil(inside / kind.cluster)
    member = np.concatenate([np.arange(inside) % max(clusters, 1), np.full(n - inside, -1)]).astype(np.int64)
    member = np.concatenate([np.sort(member[:inside]), member[inside:]])
    middles = _middles(draw, kind, clusters)
    taken = {kind.depot}
    points: list[tuple[int, int]] = []
    for k in range(n):
        spread = SPREAD
        while len(points) == k:
            if member[k] < 0:
                x, y = (draw.integer(0, side) for side in kind.side)
            else:
                dx, dy = draw.normal(0.0, spread, 2).tolist()
                x, y = round(middles[member[k], 0] + dx), round(middles[member[k], 1] + dy)
                spread *= 1.02  # a full cluster grows at its rim
            if 0 <= x <= kind.side[0] and 0 <= y <= kind.side[1] and (x, y) not in taken:
                taken.add((x, y))
                points.append((x, y))
    return np.array(points, dtype=np.float64).reshape(n, 2), member


def _middles(draw: Draw, kind: SolomonClass, clusters: int) -> Floats:
    """Middles of the clusters: of 20 random ones each time the one farthest from those before and from the depot."""
    chosen = [np.array(kind.depot, dtype=np.float64)]
    margin = 2 * SPREAD
    for _ in range(clusters):
        offers = np.column_stack([draw.uniform(margin, side - margin, 20) for side in kind.side])
        gaps = np.min([np.hypot(*(offers - m).T) for m in chosen], axis=0)
        chosen.append(offers[int(np.argmax(gaps))])
    return np.array(chosen[1:]).reshape(clusters, 2)


def _cluster_demands(draw: Draw, kind: SolomonClass, cluster: Integers) -> Integers:
    """Multiples of ten, drawn again for a cluster that one vehicle could not serve."""
    demand = np.zeros(len(cluster), dtype=np.int64)
    for c in range(int(cluster.max()) + 1):
        at = np.nonzero(cluster == c)[0]
        while True:
            demand[at] = draw.weighted(CLUSTER_DEMANDS, CLUSTER_WEIGHTS, len(at))
            if demand[at].sum() <= kind.capacity:
                break
    return demand


def _arrivals(travel: Travel, cluster: Integers, service: float) -> tuple[Floats, float]:
    """Arrival times along one good route for each cluster, and the latest return."""
    arrival = np.zeros(len(cluster))
    finish = 0.0
    for c in range(int(cluster.max()) + 1):
        stops = np.concatenate([[0], np.nonzero(cluster == c)[0] + 1])
        order = stops[_good_tour(travel.subset(stops).distances)]
        legs = travel.distance(order, np.roll(order, -1))
        times = np.cumsum(legs[:-1] + np.concatenate([[0.0], np.full(len(order) - 2, service)]))
        arrival[order[1:] - 1] = times
        finish = max(finish, float(times[-1] + service + legs[-1]))
    return arrival, finish


def _good_tour(d: Floats) -> Integers:
    """A tour from 0 by nearest neighbours, then 2-opt and Or-opt moves (segments of up to three) until none helps."""
    n = len(d)
    tour, unvisited = [0], list(range(1, n))
    while unvisited:
        nearest = min(unvisited, key=lambda k: (d[tour[-1], k], k))
        tour.append(nearest)
        unvisited.remove(nearest)
    improved = True
    while improved:
        improved = False
        for candidate in _neighbours(tour):
            if _length(d, candidate) < _length(d, tour) - 1e-9:
                tour, improved = candidate, True
                break
    return np.array(tour, dtype=np.int64)


def _neighbours(tour: list[int]) -> Any:
    n = len(tour)
    for i in range(1, n - 1):
        for j in range(i + 1, n):
            yield tour[:i] + tour[i : j + 1][::-1] + tour[j + 1 :]
    for size in (1, 2, 3):
        for i in range(1, n - size + 1):
            segment, rest = tour[i : i + size], tour[:i] + tour[i + size :]
            for j in range(1, len(rest) + 1):
                if j != i:
                    yield rest[:j] + segment + rest[j:]


def _length(d: Floats, tour: list[int]) -> float:
    return float(d[tour, np.roll(tour, -1)].sum())


GENERATORS.enter(Generator("solomon", "time windows after Solomon's recipe, classes C1 to RC2", SETTINGS, make))
