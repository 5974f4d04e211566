"""Rows of the three-index form over arcs and times: visits, flow, limits of single vehicles, and the order of time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...programs.program import Floats, Rows
from ...programs.rows import Part, rows
from ..preparation import SHORT
from ..reachability import minimum_vehicles
from ._vehicle_columns import VehicleColumns

if TYPE_CHECKING:
    from ..problem import RoutingProblem


def visits_rows(types: list[VehicleColumns]) -> Rows:
    """Arcs are in order of their tails, so that each type's columns of a customer are a range."""
    prep = types[0].prep
    n = prep.customers
    parts: list[Any] = []
    for kind in types:
        count = kind.count
        columns = np.arange(kind.first + (kind.idle + 1) * count, kind.clock, dtype=np.int32)
        parts.append((np.repeat(kind.tail[kind.idle + 1 :] - 1, count), columns))
    sizes = [np.bincount(row, minlength=n) for row, _ in parts]
    columns = parts[0][1]
    if len(parts) > 1:
        order = np.argsort(np.concatenate([row for row, _ in parts]), kind="stable")
        columns = np.concatenate([c for _, c in parts])[order]
    least = np.where(prep.required[1:-1], 1.0, 0.0)
    return Rows(
        "visit", (np.arange(1, n + 1),), (types[0].names,), indptr=_starts(sum(sizes)), indices=columns, data=np.ones(len(columns)),
        lower=least, upper=np.ones(n),
    )  # fmt: skip


def fleet_rows(problem: RoutingProblem, types: list[VehicleColumns]) -> Rows:
    columns = np.concatenate([kind.each(np.arange(kind.idle)) for kind in types])
    least = minimum_vehicles(problem)
    size = int(least > 0)
    return rows("fleet", size, [(np.zeros(len(columns), dtype=np.int64), columns, 1.0)] if size else [], lower=float(least))


def connecting_rows(kind: VehicleColumns) -> list[Rows]:
    """Rows of single vehicles: departure and flow."""
    return [kind.over_arcs("depart", np.arange(kind.idle + 1), np.ones(kind.idle + 1), 1.0, 1.0), _flow(kind)]


def limits_rows(problem: RoutingProblem, kind: VehicleColumns) -> list[Rows]:
    """Rows of single vehicles: loads, distance, duration and energy."""
    prep, vehicle = kind.prep, kind.vehicle
    every, inner = np.arange(len(kind.tail)), np.arange(kind.idle + 1, len(kind.tail))
    blocks: list[Rows] = []
    for name, resource in prep.resources.items():
        if name.startswith(("load", "pickup")):
            capacity = vehicle.capacities[int(name.partition("-")[2] or 1) - 1]
            blocks.append(kind.over_arcs(name, inner, _at_head(kind, resource.weight)[kind.tail[inner]], -math.inf, capacity))
    if "distance" in prep.resources:
        blocks.append(kind.over_arcs("distance", every, kind.with_idle(prep.distance, kind.idle_distance), -math.inf, vehicle.max_distance))
    if math.isfinite(vehicle.max_duration):
        blocks.append(_elapsed(kind, "duration", 1.0, vehicle.max_duration))
    energy = vehicle.energy
    if energy is not None and energy.charge == "elapsed":
        blocks.append(_elapsed(kind, "energy", energy.rate, energy.at_departure))
    elif energy is not None and "energy" in prep.resources:
        weight = kind.with_idle(prep.resources["energy"].weight, energy.rate * kind.idle_duration)
        blocks.append(kind.over_arcs("energy", every, weight, -math.inf, energy.at_departure))
    if vehicle.max_reloads is not None:
        into = np.nonzero(np.isin(prep.sites[kind.head], vehicle.reloads) & (kind.head != prep.end))[0]
        blocks.append(kind.over_arcs("reloads", into, np.ones(len(into)), -math.inf, float(vehicle.max_reloads)))
    if (vehicle.reloads or vehicle.stations) and len(every) > 1:
        # Who only stops at depots serves no site.
        served = np.nonzero((kind.tail >= 1) & (kind.tail <= len(problem.customers)))[0]
        arcs = np.append(served, kind.idle)
        blocks.append(kind.over_arcs("serves", arcs, np.ones(len(arcs)), 1.0, math.inf))
    return blocks


def _at_head(kind: VehicleColumns, weight: Floats) -> Floats:
    """A weight of arcs that depends on the head alone, by node."""
    weights = np.zeros(kind.prep.nodes)
    weights[kind.prep.head] = weight
    weights[-1] = 0.0
    return weights


def _elapsed(kind: VehicleColumns, name: str, rate: float, limit: float) -> Rows:
    """Time from departure to return, times ``rate``, within ``limit``."""
    count = kind.count
    row, last = np.arange(count), kind.prep.end * count
    parts: list[Part] = [(row, kind.clock + last + row, rate), (row, kind.clock + row, -rate)]
    return rows(name, count, parts, upper=limit, keys=(kind.vehicles,), labels=(kind.numbers,))


def _flow(kind: VehicleColumns) -> Rows:
    """Arcs into a customer less arcs out of it, vehicle by vehicle."""
    n, count = kind.prep.customers, len(kind.vehicles)
    entering = np.nonzero(kind.head != kind.prep.end)[0]
    leaving = np.arange(kind.idle + 1, len(kind.tail))
    at = np.concatenate([kind.head[entering], kind.tail[leaving]])
    order = np.argsort(at, kind="stable")
    arcs = np.concatenate([entering, leaving])[order]
    sign = np.where(order < len(entering), 1.0, -1.0)
    sizes = np.bincount(at, minlength=n + 1)[1:]
    return Rows(
        "flow", (np.tile(np.arange(1, n + 1, dtype=np.int32), count), np.repeat(kind.vehicles, n)), (kind.names, kind.numbers),
        indptr=_starts(np.tile(sizes, count)), indices=kind.each(arcs), data=np.tile(sign, count),
        lower=np.zeros(n * count), upper=np.zeros(n * count),
    )  # fmt: skip


def time_rows(kind: VehicleColumns) -> Rows:
    """t_i - t_j + M x <= M - s_i - d_ij, three entries a row."""
    count = kind.count
    tail, head, weight = kind.tail, kind.head, kind.with_idle(kind.prep.time.weight, kind.idle_duration)
    big = kind.upper[tail] + weight - kind.lower[head]
    if not kind.committed:
        big[kind.idle] = 0.0
    arcs = np.nonzero(big > 0)[0].astype(np.int32)
    i, j, big = tail[arcs], head[arcs], big[arcs]
    k = np.arange(count, dtype=np.int32)
    columns = np.empty((len(arcs), count, 3), dtype=np.int32)
    for place, base in enumerate((kind.clock + i * count, kind.clock + j * count, kind.first + arcs * count)):
        np.add(base[:, None], k, out=columns[:, :, place])
    data = np.empty((len(arcs), count, 3))
    data[:, :, 0], data[:, :, 1], data[:, :, 2] = 1.0, -1.0, big[:, None]
    size = len(arcs) * count
    return Rows(
        "time", (np.repeat(i, count), np.repeat(j, count), np.tile(kind.vehicles, len(arcs))), (kind.names, kind.names, kind.numbers),
        indptr=np.arange(0, 3 * size + 1, 3, dtype=np.int32), indices=columns.ravel(), data=data.ravel(),
        lower=np.full(size, -math.inf), upper=np.repeat(big - weight[arcs], count),
    )  # fmt: skip


def closing_rows(kind: VehicleColumns) -> Rows:
    """t_i + (b_i + s_i - closing_ij) x_ijk <= b_i, so that nobody begins a move that is closed."""
    count, service = kind.count, kind.prep.service
    over = kind.upper[kind.tail] + service[kind.tail] - kind.closing
    arcs = np.nonzero((over > 0) & np.isfinite(kind.closing))[0]
    if not kind.committed:
        arcs = arcs[arcs != kind.idle]
    i, row = np.repeat(kind.tail[arcs], count), np.arange(len(arcs) * count)
    number = np.tile(np.arange(count), len(arcs))
    parts: list[Part] = [(row, kind.clock + i * count + number, 1.0), (row, kind.together(arcs), np.repeat(over[arcs], count))]
    keys = (i, np.repeat(kind.head[arcs], count), np.tile(kind.vehicles, len(arcs)))
    return rows("closing", len(row), parts, upper=kind.upper[i], keys=keys, labels=(kind.names, kind.names, kind.numbers))


def order_rows(kind: VehicleColumns, first: int, every: bool) -> Rows:
    """Visit numbers that grow along ``every`` arc, or those of (almost) no duration; ``first`` is the column of the first node's."""
    n, count = kind.prep.customers, kind.count
    short = kind.with_idle(kind.prep.time.weight) <= SHORT * kind.prep.time.size
    arcs = np.nonzero(kind.inner() & (every | short))[0]
    i, j = np.repeat(kind.tail[arcs], count), np.repeat(kind.head[arcs], count)
    row = np.arange(len(i))
    parts: list[Part] = [(row, first + i - 1, 1.0), (row, first + j - 1, -1.0), (row, kind.together(arcs), float(n))]
    keys = (i, j, np.tile(kind.vehicles, len(arcs)))
    return rows("order", len(row), parts, upper=n - 1.0, keys=keys, labels=(kind.names, kind.names, kind.numbers))


def _starts(sizes: Any) -> NDArray[np.int32]:
    starts = np.zeros(len(sizes) + 1, dtype=np.int32)
    np.cumsum(sizes, out=starts[1:])
    return starts
