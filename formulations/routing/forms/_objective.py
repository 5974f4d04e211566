"""Terms of an objective that no sum over arcs gives, as variables of the three-index form.

For each vehicle k, where the term has a weight that makes less of it better::

    elapsed[k]     duration_k >= return_k - departure_k                  where somebody may have to wait
    worked[k]      duration_k >= sum (s_i + d_ij) x_ijk
    overtime[k]    overtime_k >= duration_k - regular duration
    makespan[k]    makespan >= duration_k
    longest[k]     longest >= sum distance_ij x_ijk
    latest[k]      latest >= return_k - M x_ogk,   M = max(0, earliest return of k - least latest); M = 0 for committed vehicles

``latest`` is at least the earliest departure of the fleet. The rows ``worked`` follow from ``elapsed`` for whole x alone; they make
the linear relaxation stronger. Where nobody can have to wait, sums of durations are costs of arcs, and ``worked`` is all that is needed.

Source: Mitchell (2020), CMU-RI-TR-20-52, (5.16), where each duration is a sum over arcs.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from ...programs.program import Floats
from ...programs.rows import Part, rows
from ..preparation import waiting_is_possible

if TYPE_CHECKING:
    from ....instances.routing.vehicle_type import VehicleType
    from ..problem import RoutingProblem
    from ._vehicle_columns import Drive, VehicleColumns, Written


def weights(problem: RoutingProblem) -> dict[str, float]:
    """Weight of each term of the objective's first level."""
    found: dict[str, float] = {}
    for weight, term in problem.objective.levels()[0].terms:
        found[term.name] = found.get(term.name, 0.0) + weight
    return found


def _prices(problem: RoutingProblem, vehicle: VehicleType) -> tuple[float, float]:
    """Of one unit of duration and of overtime."""
    weight = weights(problem)
    of_cost = weight.get("total-cost", 0.0)
    overtime = vehicle.unit_overtime_cost if math.isfinite(vehicle.regular_duration) else 0.0
    return of_cost * vehicle.unit_duration_cost + weight.get("total-duration", 0.0), of_cost * overtime


def durations_count(problem: RoutingProblem, vehicle: VehicleType) -> bool:
    """Whether the objective holds the duration of single routes of this type."""
    return bool(weights(problem).get("makespan") or any(_prices(problem, vehicle)))


def adverse(problem: RoutingProblem) -> frozenset[str]:
    """Features whose weight makes more of a maximum, or of time spent waiting, better: rows from below cannot express it."""
    sign, found = (1.0 if problem.sense == "min" else -1.0), set()
    for name, weight in weights(problem).items():
        if weight * sign >= 0:
            continue
        if name in ("makespan", "longest-route", "latest-return") or (name == "total-duration" and waiting_is_possible(problem)):
            found.add(f"objective:{name}")
        if name == "total-cost":
            found |= problem.features() & {"overtime"}
            found |= problem.features() & {"duration-cost"} if waiting_is_possible(problem) else set()
    return frozenset(found)


def idle_cost(problem: RoutingProblem, kind: VehicleColumns) -> float:
    """What a committed vehicle costs on its way straight home, but for durations that have variables."""
    weight, vehicle = weights(problem), kind.vehicle
    paid = weight.get("total-cost", 0.0) * (vehicle.fixed_cost + vehicle.unit_cost * kind.idle_distance)
    return paid if waiting_is_possible(problem) else paid + _prices(problem, vehicle)[0] * kind.idle_duration


def add_objective(made: Written) -> None:
    """The columns and rows of the terms that the objective has."""
    problem, weight = made.problem, weights(made.problem)
    if weight.get("makespan"):
        most = max(_longest_time(kind) for kind in made.types)
        makespan = made.add_columns("makespan", (), (), 0.0, most, weight["makespan"])
    for kind in made.types:
        if durations_count(problem, kind.vehicle):
            first = _durations(made, kind)
            if weight.get("makespan"):
                row = np.arange(kind.count)
                parts: list[Part] = [(row, np.full(kind.count, makespan), 1.0), (row, first + row, -1.0)]
                made.rows.append(rows("makespan", kind.count, parts, 0.0, keys=(kind.vehicles,), labels=(kind.numbers,)))
    if weight.get("makespan"):

        def encode(x: Floats, drives: list[Drive]) -> None:
            x[makespan] = max((float(d.clock[-1] - d.clock[0]) for d in drives), default=0.0)

        made.encoders.append(encode)
    if weight.get("longest-route"):
        _longest_route(made, weight["longest-route"])
    if weight.get("latest-return"):
        _latest_return(made, weight["latest-return"])


def _longest_time(kind: VehicleColumns) -> float:
    return max(0.0, float(kind.upper[-1] - kind.lower[0]))


def _durations(made: Written, kind: VehicleColumns) -> int:
    """The durations of one type, and their overtime; returns the first column."""
    vehicle, count = kind.vehicle, kind.count
    price, extra = _prices(made.problem, vehicle)
    waits, most = waiting_is_possible(made.problem), _longest_time(kind)
    keys, labels, row = (kind.vehicles,), (kind.numbers,), np.arange(count)
    first = made.add_columns("duration", keys, labels, 0.0, most, price if waits else 0.0)
    if waits:
        end = kind.clock + kind.prep.end * count
        parts: list[Part] = [(row, first + row, 1.0), (row, end + row, -1.0), (row, kind.clock + row, 1.0)]
        made.rows.append(rows("elapsed", count, parts, 0.0, keys=keys, labels=labels))
    busy = kind.with_idle(kind.prep.time.weight, kind.idle_duration)
    made.rows.append(kind.over_arcs("worked", np.arange(len(kind.tail)), busy, -math.inf, 0.0, first))
    if extra:
        regular = vehicle.regular_duration
        over = made.add_columns("overtime", keys, labels, 0.0, max(0.0, most - regular), extra)
        parts = [(row, over + row, 1.0), (row, first + row, -1.0)]
        made.rows.append(rows("overtime", count, parts, -regular, keys=keys, labels=labels))

    def encode(x: Floats, drives: list[Drive]) -> None:
        for d in drives:
            if d.kind is kind:
                x[first + d.number] = d.clock[-1] - d.clock[0]
                if extra:
                    x[over + d.number] = max(0.0, x[first + d.number] - regular)

    made.encoders.append(encode)
    return first


def _longest_route(made: Written, weight: float) -> None:
    lengths = [kind.with_idle(kind.prep.distance, kind.idle_distance) for kind in made.types]
    most = max(_farthest(kind, length) for kind, length in zip(made.types, lengths, strict=True))
    column = made.add_columns("longest", (), (), 0.0, most, weight)
    for kind, length in zip(made.types, lengths, strict=True):
        every, row = np.arange(len(kind.tail)), np.arange(kind.count)
        parts: list[Part] = [
            (np.repeat(row, len(every)), kind.each(every), np.tile(-length, kind.count)), (row, np.full(kind.count, column), 1.0),
        ]  # fmt: skip
        made.rows.append(rows("longest", kind.count, parts, 0.0, keys=(kind.vehicles,), labels=(kind.numbers,)))

    def encode(x: Floats, drives: list[Drive]) -> None:
        of = [d.kind.prep.distance[d.arcs].sum() if len(d.arcs) else d.kind.idle_distance for d in drives]
        x[column] = max(of, default=0.0)

    made.encoders.append(encode)


def _farthest(kind: VehicleColumns, length: Floats) -> float:
    """No route is longer than the longest moves out of all nodes together."""
    out = np.zeros(kind.prep.nodes)
    np.maximum.at(out, kind.tail, length)
    return float(out.sum())


def _latest_return(made: Written, weight: float) -> None:
    least = min(float(kind.prep.time.lower[0]) for kind in made.types)
    column = made.add_columns("latest", (), (), least, max(least, *(float(kind.upper[-1]) for kind in made.types)), weight)
    for kind in made.types:
        count, row = kind.count, np.arange(kind.count)
        big = 0.0 if kind.committed else max(0.0, float(kind.lower[-1]) - least)
        parts: list[Part] = [(row, np.full(count, column), 1.0), (row, kind.clock + kind.prep.end * count + row, -1.0)]
        if big:
            parts.append((row, kind.first + kind.idle * count + row, big))
        made.rows.append(rows("latest", count, parts, 0.0, keys=(kind.vehicles,), labels=(kind.numbers,)))

    def encode(x: Floats, drives: list[Drive]) -> None:
        x[column] = max([least, *(float(d.clock[-1]) for d in drives)])

    made.encoders.append(encode)
