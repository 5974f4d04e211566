"""Random instances for tests: uniform sites, everything optional. No recipe of the literature."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ...errors import UsageError
from ...generators import GENERATORS, Draw, Generator, Setting
from ..fleet import with_problems
from ..instance import RoutingInstance, Sites, VehicleType
from ..travel import EXPLICIT, Travel

LARGEST_MATRIX = 5000
"""Customers with a matrix of all moves between them."""

SETTINGS = {
    "customers": Setting(6, "number of customers", least=1, most=1_000_000),
    "vehicles": Setting(None, "number of vehicles; unlimited by default", type=int, least=1, most=1_000_000),
    "capacity": Setting(20, "load of a vehicle; 0 for no loads at all", least=0, most=10**6),
    "demand": Setting(10, "largest demand", least=1, most=10**6),
    "windows": Setting(False, "whether customers have time windows"),
    "service": Setting(0, "largest service time", least=0, most=10**6),
    "metric": Setting("euclidean", "how distances come about", choices=("euclidean", "EUC_2D", "explicit")),
    "extent": Setting(100, "side of the square that the sites lie in", least=1, most=10**6),
    "max-duration": Setting(None, "longest duration of a route; none by default", type=float, least=0, most=10**9),
    "deviation": Setting(0.0, "largest standard deviation of the duration of a move, in parts of it", least=0, most=1),
    "name": Setting(None, "name of the instance", type=str),
}


def make(draw: Draw, settings: Mapping[str, Any]) -> RoutingInstance:
    """One instance. Every customer can be served by a vehicle of its own, unless durations are limited; with a fleet limit all of them
    together need not be."""
    n, extent = settings["customers"] + 1, settings["extent"]
    if n - 1 > LARGEST_MATRIX and (settings["metric"] == "explicit" or settings["deviation"] > 0):
        raise UsageError(f"metric=explicit and deviation take a matrix of all moves, of {LARGEST_MATRIX} customers at most", "too-large")
    xy = draw.integers(0, extent, (n, 2)).astype(np.float64)
    if settings["metric"] == "explicit":
        travel = Travel(EXPLICIT, matrix=draw.integers(1, extent, (n, n)).astype(np.float64))
    else:
        travel = Travel(settings["metric"], coordinates=xy)
    customer = np.arange(n) > 0
    loads = settings["capacity"] > 0
    demand = np.where(customer & loads, draw.integers(1, min(settings["demand"], max(settings["capacity"], 1)), n), 0)
    service = np.where(customer, draw.integers(0, settings["service"], n), 0)
    ready, due = np.zeros(n), np.full(n, math.inf)
    if settings["windows"]:
        every = np.arange(n)
        out, back = travel.duration(0, every), travel.duration(every, 0)
        horizon = math.ceil(float((out + service + back).max()) * 2.0) + 1
        latest = np.floor(horizon - back - service)
        center = out + draw.uniform(0.0, 1.0, n) * (latest - out)
        half = draw.uniform(0.02, 0.25, n) * horizon
        ready = np.where(customer, np.maximum(0.0, np.floor(center - half)), 0.0)
        due = np.where(customer, np.minimum(latest, np.ceil(center + half)), horizon)
    sites = Sites.of(range(n), demand=demand, ready=ready, due=due, service=service, coordinates=xy)
    longest = math.inf if settings["max-duration"] is None else settings["max-duration"]
    fleet = (VehicleType(settings["vehicles"], settings["capacity"] if loads else math.inf, max_duration=longest),)
    if settings["deviation"] > 0:
        times = travel.duration(np.arange(n)[:, None], np.arange(n))
        travel = replace(travel, variances=np.square(draw.uniform(0.0, settings["deviation"], (n, n)) * times))
    name = settings["name"] or f"random-n{n - 1}-s{settings['seed']}"
    return with_problems(RoutingInstance(name, "generated", sites, travel, fleet))


GENERATORS.enter(Generator("random", "uniform instances, optionally with loads and windows", SETTINGS, make))
