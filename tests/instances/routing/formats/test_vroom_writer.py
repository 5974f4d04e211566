import json
import math
from collections.abc import Callable
from typing import Any

import pytest
from file_cases import check_refused

from waybound import Energy, RoutingInstance, Shipment, Sites, UsageError, VehicleType
from waybound.instances.routing.formats._vroom_writer import write
from waybound.instances.routing.travel import EXPLICIT, Travel


def tiny(
    vehicle: VehicleType | None = None, problem: str = "cvrp", objective: tuple[str, ...] = (), matrix: Any = None, **sites: Any
) -> RoutingInstance:
    travel = Travel(EXPLICIT, matrix=[[0, 1, 2], [3, 0, 4], [5, 6, 0]] if matrix is None else matrix)
    return RoutingInstance("tiny", "json", Sites.of("abc", **sites), travel, (vehicle or VehicleType(1),), problem, objective=objective)


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: tiny(VehicleType()), "needs a number of vehicles"),
        (lambda: tiny(VehicleType(10**9)), "lists each vehicle"),
        (lambda: tiny(VehicleType(1, max_duration=9)), "no place for max-duration"),
        (lambda: tiny(VehicleType(1, max_distance=9)), "limits distances where costs are by distance"),
        (lambda: tiny(VehicleType(1, energy=Energy(9, 2.0))), "limits travel time, and no other energy"),
        (lambda: tiny(VehicleType(1, skills=frozenset({"crane"}))), "skills are numbers there, not crane"),
        (lambda: tiny(demand=[0, 1, 1]), "vehicles that carry loads need a capacity"),
        (lambda: tiny(VehicleType(1, 2.5), demand=[0, 1, 1]), "a capacity is 2.5"),
        (lambda: tiny(matrix=[[0, 1.5, 2], [3, 0, 4], [5, 6, 0]]), "a distance is 1.5"),
        (lambda: tiny(service=[0, 0.5, 0]), "a service time is 0.5"),
        (lambda: tiny(ready=[0, 4, 0]), "the window of site b has no end"),
        (lambda: tiny(VehicleType(1, skills=frozenset({"crane"})), skills={1: {"crane"}}), "skills are numbers there, not crane"),
        (lambda: tiny(required=False), "this asks for something else"),
        (lambda: tiny(required=False, reward=[0, 1, 2], objective=("reward", "total-cost")), "this asks for something else"),
        (lambda: tiny(objective=("vehicles", "total-cost")), "this asks for something else"),
        (lambda: tiny(VehicleType(1, 2), shipments=[Shipment(1, 2)], required=False, reward=[0, 1, 4], objective=("reward", "total-cost")),
         "both ends of a shipment need the same priority"),
    ],
)  # fmt: skip
def test_what_the_format_cannot_express_is_refused(made: Callable[[], Any], message: str) -> None:
    check_refused(UsageError, message, write, made())


def test_tasks_without_numbers_are_numbered_by_their_place() -> None:
    data = json.loads(write(tiny(due=[math.inf, 9, 9])))
    assert [job["id"] for job in data["jobs"]] == [1, 2]
    assert data["matrices"]["car"]["durations"] == [[0, 1, 2], [3, 0, 4], [5, 6, 0]]
