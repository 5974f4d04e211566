"""Capacitated instances after the recipe of set X.

Source: Uchoa, Pecin, Pessoa, Poggi, Vidal and Subramanian (2017), New benchmark instances for the capacitated vehicle routing
problem, EJOR 257(3), section 3. All sites lie at different points of the grid [0, 1000] x [0, 1000], or a larger one for more
customers than theirs; a point attracts a customer with probability sum over the seeds s of exp(-d(p, s) / 40); the capacity is
ceil(r * total demand / customers), where r is the average number of customers on a route; distances are rounded to the nearest integer.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...errors import UsageError
from ...generators import GENERATORS, Draw, Generator, Integers, Setting
from ..instance import RoutingInstance, Sites, VehicleType
from ..travel import Travel

DECAY = 40.0
BATCH = 4096
CROWDED = 0.25  # part of the points of the grid that may be taken
CLUSTER = 5000  # customers that one seed attracts before its surroundings are full
RANGES = {"1-1": (1, 1), "1-10": (1, 10), "5-10": (5, 10), "1-100": (1, 100), "50-100": (50, 100)}

SETTINGS = {
    "customers": Setting(100, "number of customers", least=1, most=200_000),
    "depot": Setting("R", "depot: C in the centre, E in the corner, R anywhere", choices=("C", "E", "R")),
    "positions": Setting("RC", "customers: R anywhere, C in clusters, RC half of each", choices=("R", "C", "RC")),
    "grid": Setting(1000, "side of the square in which all lie", least=10, most=10_000),
    "demand": Setting(
        "1-100", "range of demands; Q: by quadrant; SL: many small, few large", choices=(*RANGES, "Q", "SL")
    ),
    "route-length": Setting(None, "customers on a route, on average; drawn from the triangle (3, 6, 25) by default", type=float,
                            least=1.0, most=200_000.0),
    "seeds": Setting(None, "number of clusters; drawn from 3 to 8 by default", type=int, least=1, most=1000),
    "name": Setting(None, "name of the instance", type=str),
}  # fmt: skip


def make(draw: Draw, settings: Mapping[str, Any]) -> RoutingInstance:
    """One instance of set X's kind, with an unlimited fleet."""
    n, grid = settings["customers"], settings["grid"]
    if n > CROWDED * grid * grid:
        raise UsageError(f"{n} customers need a grid of {math.isqrt(math.ceil(n / CROWDED)) + 1} or more, not {grid}", "out-of-range")
    centre = {"C": (grid // 2, grid // 2), "E": (0, 0)}.get(settings["depot"])
    depot = draw.integers(0, grid, 2) if centre is None else np.array(centre, dtype=np.int64)
    clusters = min(settings["seeds"] or draw.integer(3, 8), n)
    scattered = {"R": n, "C": 0, "RC": n // 2}[settings["positions"]]
    least = math.ceil((n - scattered) / CLUSTER)
    if clusters < least:
        raise UsageError(f"{n - scattered} customers in clusters need {least} seeds or more, not {clusters}", "out-of-range")
    xy = _positions(draw, grid, depot, n, scattered, clusters)
    demand = _demands(draw, grid, xy, settings["demand"])
    length = settings["route-length"] or draw.triangular(3.0, 6.0, 25.0)
    capacity = max(math.ceil(length * int(demand.sum()) / n), int(demand.max()))
    points = np.vstack([depot, xy]).astype(np.float64)
    sites = Sites.of(range(1, n + 2), demand=np.concatenate([[0], demand]), coordinates=points)
    name = settings["name"] or f"uchoa-{settings['depot']}-{settings['positions']}-{settings['demand']}-n{n + 1}-s{settings['seed']}"
    travel = Travel("EUC_2D", coordinates=points)
    return RoutingInstance(name, "generated", sites, travel, (VehicleType(None, capacity),), "cvrp", ("cvrp", "min-cost-vrp"))


def _positions(draw: Draw, grid: int, depot: Integers, n: int, scattered: int, clusters: int) -> Integers:
    """Points of the customers: the random ones, then the seeds of the clusters, then the customers they attract."""
    taken = {(int(depot[0]), int(depot[1]))}
    points: list[tuple[int, int]] = []

    def add(candidates: Integers, upto: int) -> None:
        for x, y in candidates.tolist():
            if len(points) < upto and (x, y) not in taken:
                taken.add((x, y))
                points.append((x, y))

    while len(points) < scattered:
        add(draw.integers(0, grid, (scattered - len(points), 2)), scattered)
    seeds_end = min(scattered + clusters, n)
    while len(points) < seeds_end:
        add(draw.integers(0, grid, (seeds_end - len(points), 2)), seeds_end)
    seeds = np.array(points[scattered:seeds_end], dtype=np.float64)
    while len(points) < n:
        candidates = draw.integers(0, grid, (BATCH, 2))
        apart = np.sqrt(((candidates[:, None, :] - seeds[None, :, :]) ** 2).sum(axis=2))
        accepted = draw.uniform(0.0, 1.0, BATCH) <= np.exp(-apart / DECAY).sum(axis=1)
        add(candidates[accepted], n)
    return np.array(points, dtype=np.int64)


def _demands(draw: Draw, grid: int, xy: Integers, rule: str) -> Integers:
    n = len(xy)
    if rule in RANGES:
        return draw.integers(*RANGES[rule], n)
    small, large = draw.integers(1, 50, n), draw.integers(51, 100, n)
    if rule == "Q":
        half = grid / 2
        odd_quadrant = (xy[:, 0] >= half) == (xy[:, 1] >= half)
        return np.where(odd_quadrant, large, small)
    share = float(draw.uniform(0.70, 0.95, 1)[0])
    small, large = draw.integers(1, 10, n), draw.integers(50, 100, n)
    return np.where(draw.chosen(round(share * n), n), small, large)


GENERATORS.enter(Generator("uchoa", "capacitated instances after the recipe of Uchoa et al.'s set X", SETTINGS, make))
