"""Terms of an objective that no sum over arcs gives, as variables of the three-index form.

For each vehicle k, where the term has a weight that makes less of it better, in whichever level of the objective::

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
    from ._vehicles import Drive, VehicleBlocks, VehicleColumns


Weights = dict[str, float]
"""Weight of each term, by its name."""


def weights_of_levels(problem: RoutingProblem) -> list[Weights]:
    """Weights of each level of the objective, for the terms that any level holds: a term is written whichever level it decides."""
    levels: list[Weights] = []
    for level in problem.objective.levels():
        levels.append({})
        for weight, term in level.terms:
            levels[-1][term.name] = levels[-1].get(term.name, 0.0) + weight
    names = dict.fromkeys(name for level in levels for name, weight in sorted(level.items()) if weight)
    return [{name: level.get(name, 0.0) for name in sorted(names)} for level in levels]


def weights(problem: RoutingProblem) -> Weights:
    """Weights of the first level."""
    return weights_of_levels(problem)[0]


def _prices(weight: Weights, vehicle: VehicleType) -> tuple[float, float]:
    """Weights of one unit of duration and of overtime."""
    of_cost = weight.get("total-cost", 0.0)
    overtime = vehicle.unit_overtime_cost if math.isfinite(vehicle.regular_duration) else 0.0
    return of_cost * vehicle.unit_duration_cost + weight.get("total-duration", 0.0), of_cost * overtime


def durations_count(problem: RoutingProblem, vehicle: VehicleType) -> bool:
    """Whether the objective holds the duration of single routes of this type."""
    return any("makespan" in weight or any(_prices(weight, vehicle)) for weight in weights_of_levels(problem))


def adverse(problem: RoutingProblem) -> frozenset[str]:
    """Features whose weight makes more of a maximum, or of time spent waiting, better: rows from below cannot express it."""
    features = set()
    levels = zip(problem.senses, weights_of_levels(problem), strict=True)
    for sense, name, weight in ((sense, *item) for sense, level in levels for item in level.items()):
        if weight == 0 or (weight > 0) == (sense == "min"):
            continue
        if name in ("makespan", "longest-route", "latest-return") or (name == "total-duration" and waiting_is_possible(problem)):
            features.add(f"objective:{name}")
        if name == "total-cost":
            features |= problem.features() & {"overtime"}
            features |= problem.features() & {"duration-cost"} if waiting_is_possible(problem) else set()
    return frozenset(features)


def idle_cost(problem: RoutingProblem, kind: VehicleColumns) -> float:
    """Cost of a committed vehicle on its way straight home, but for durations that have variables."""
    weight, vehicle = weights(problem), kind.vehicle
    paid = weight.get("total-cost", 0.0) * (vehicle.fixed_cost + vehicle.unit_cost * kind.idle_distance)
    return paid if waiting_is_possible(problem) else paid + _prices(weight, vehicle)[0] * kind.idle_duration


def add_objective(blocks: VehicleBlocks) -> None:
    """The columns and rows of the terms that the objective has."""
    problem, weight = blocks.problem, weights(blocks.problem)
    if "makespan" in weight:
        most = max(_longest_time(kind) for kind in blocks.types)
        makespan = blocks.add_columns("makespan", (), (), 0.0, most, weight["makespan"])
    for kind in blocks.types:
        if durations_count(problem, kind.vehicle):
            first = _durations(blocks, kind)
            if "makespan" in weight:
                row = np.arange(kind.count)
                parts: list[Part] = [(row, np.full(kind.count, makespan), 1.0), (row, first + row, -1.0)]
                blocks.rows.append(rows("makespan", kind.count, parts, 0.0, keys=(kind.vehicles,), labels=(kind.numbers,)))
    if "makespan" in weight:

        def encode(x: Floats, drives: list[Drive]) -> None:
            x[makespan] = max((float(d.clock[-1] - d.clock[0]) for d in drives), default=0.0)

        blocks.encoders.append(encode)
    if "longest-route" in weight:
        _longest_route(blocks, weight["longest-route"])
    if "latest-return" in weight:
        _latest_return(blocks, weight["latest-return"])


def _longest_time(kind: VehicleColumns) -> float:
    return max(0.0, float(kind.upper[-1] - kind.lower[0]))


def _durations(blocks: VehicleBlocks, kind: VehicleColumns) -> int:
    """Adds a duration variable for each vehicle of one type, and one for its overtime where that is priced, with their rows.

    Returns the column of the first duration.
    """
    vehicle, count = kind.vehicle, kind.count
    price, extra = _prices(weights(blocks.problem), vehicle)
    late = any(_prices(weight, vehicle)[1] for weight in weights_of_levels(blocks.problem))
    waits, most = waiting_is_possible(blocks.problem), _longest_time(kind)
    keys, labels, row = (kind.vehicles,), (kind.numbers,), np.arange(count)
    first = blocks.add_columns("duration", keys, labels, 0.0, most, price if waits else 0.0)
    if waits:
        end = kind.clock + kind.prep.end * count
        parts: list[Part] = [(row, first + row, 1.0), (row, end + row, -1.0), (row, kind.clock + row, 1.0)]
        blocks.rows.append(rows("elapsed", count, parts, 0.0, keys=keys, labels=labels))
    busy = kind.with_idle(kind.prep.time.weight, kind.idle_duration)
    blocks.rows.append(kind.over_arcs("worked", np.arange(len(kind.tail)), busy, -math.inf, 0.0, first))
    if late:
        regular = vehicle.regular_duration
        over = blocks.add_columns("overtime", keys, labels, 0.0, max(0.0, most - regular), extra)
        parts = [(row, over + row, 1.0), (row, first + row, -1.0)]
        blocks.rows.append(rows("overtime", count, parts, -regular, keys=keys, labels=labels))

    def encode(x: Floats, drives: list[Drive]) -> None:
        for d in drives:
            if d.kind is kind:
                x[first + d.number] = d.clock[-1] - d.clock[0]
                if late:
                    x[over + d.number] = max(0.0, x[first + d.number] - regular)

    blocks.encoders.append(encode)
    return first


def _longest_route(blocks: VehicleBlocks, weight: float) -> None:
    lengths = [kind.with_idle(kind.prep.distance, kind.idle_distance) for kind in blocks.types]
    most = max(float(kind.largest_out(length).sum()) for kind, length in zip(blocks.types, lengths, strict=True))
    column = blocks.add_columns("longest", (), (), 0.0, most, weight)
    for kind, length in zip(blocks.types, lengths, strict=True):
        parts: list[Part] = [kind.along(np.arange(len(kind.tail)), -length), (np.arange(kind.count), np.full(kind.count, column), 1.0)]
        blocks.rows.append(rows("longest", kind.count, parts, 0.0, keys=(kind.vehicles,), labels=(kind.numbers,)))

    def encode(x: Floats, drives: list[Drive]) -> None:
        of = [d.kind.prep.distance[d.arcs].sum() if len(d.arcs) else d.kind.idle_distance for d in drives]
        x[column] = max(of, default=0.0)

    blocks.encoders.append(encode)


def _latest_return(blocks: VehicleBlocks, weight: float) -> None:
    least = min(float(kind.prep.time.lower[0]) for kind in blocks.types)
    column = blocks.add_columns("latest", (), (), least, max(least, *(float(kind.upper[-1]) for kind in blocks.types)), weight)
    for kind in blocks.types:
        count, row = kind.count, np.arange(kind.count)
        big = 0.0 if kind.committed else max(0.0, float(kind.lower[-1]) - least)
        parts: list[Part] = [(row, np.full(count, column), 1.0), (row, kind.clock + kind.prep.end * count + row, -1.0)]
        if big:
            parts.append((row, kind.first + kind.idle * count + row, big))
        blocks.rows.append(rows("latest", count, parts, 0.0, keys=(kind.vehicles,), labels=(kind.numbers,)))

    def encode(x: Floats, drives: list[Drive]) -> None:
        x[column] = max([least, *(float(d.clock[-1]) for d in drives)])

    blocks.encoders.append(encode)
