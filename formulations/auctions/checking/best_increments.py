"""Evidence ``best-increments``: robots gain at most by the best visits and observations, one a robot and step, each in a room within reach.

It holds for every instance, and has no data. A visit that gains takes a step, and so does an observation. A room d doors from the nearest
start is entered in step d at the earliest, and observed in the step after. Without regard to contact, the sets of gains that can be had,
one a robot and step, are a matroid, so that taking the largest first is best (Edmonds 1971).
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ...evidence import checker


@checker("best-increments", "room-exploration", "best increments are")
def check_best_increments(problem: Any, data: Mapping[str, Any]) -> float:
    """Upper bound on the gain, rounded upwards; the evidence must have no data.

    Source: docs/formulations/room-exploration.md#evidence.
    """
    if data:
        raise InputError("evidence best-increments holds no data", found=str(data)[:40])
    instance = problem.instance
    robots, steps = instance.num_robots, instance.steps
    first = np.full(instance.num_rooms, -1)
    here, count = np.zeros(instance.num_rooms, dtype=bool), 0
    here[instance.starts] = True
    while here.any():
        first[here] = count
        here = instance.adjacent[here].any(axis=0) & (first < 0)
        count += 1
    entered = np.where(first == 0, 2, first)  # out of a start, and back; sooner by who comes from another
    if robots > 1:
        for room in np.nonzero(first == 0)[0].tolist():
            others = instance.starts[instance.starts != room]
            entered[room] = 1 if instance.adjacent[room][others].any() else 2
    gains: list[tuple[float, int]] = []  # and the first step in which each can be had
    for table, soonest in ((instance.exploring, entered), (instance.mapping, first + 1), (instance.searching, first + 1)):
        for room, row in enumerate(table.tolist()):
            if first[room] >= 0 and soonest[room] <= steps:
                gains += [(value, int(soonest[room])) for value in row if value > 0.0]
    room_left = [robots * (steps - each + 1) for each in range(steps + 1)]  # for gains that are had from that step on
    taken = []
    for value, since in sorted(gains, reverse=True):
        if min(room_left[1 : since + 1]) > 0:
            taken.append(value)
            for each in range(1, since + 1):
                room_left[each] -= 1
        if len(taken) == robots * steps:
            break
    total = math.fsum(taken)
    return math.nextafter(total, math.inf) if total else 0.0
