import math
from typing import Any

import numpy as np
import pytest

from waybound import Energy, RoutingInstance, Sites, Travel, VehicleType
from waybound.instances.routing.fleet import equal_fleet, problems_of


def sites(**more: Any) -> Sites:
    return Sites.of("abc", **more)


def test_each_depot_has_a_type_of_its_own() -> None:
    (one,) = equal_fleet(sites(), count=3, capacity=5.0)
    assert (one.name, one.count, one.start, one.end, one.capacity) == ("vehicle", 3, 0, 0, 5.0)
    two = equal_fleet(sites(depot=[True, False, True]))
    assert [(v.name, v.count, v.start, v.end) for v in two] == [("vehicle at a", None, 0, 0), ("vehicle at c", None, 2, 2)]
    assert all(math.isinf(v.capacity) for v in two)


ONE = (VehicleType(1),)


@pytest.mark.parametrize(
    ("data", "fleet", "first"),
    [
        ({}, ONE, "tsp"),
        ({}, (VehicleType(2),), "min-cost-vrp"),
        ({}, (VehicleType(),), "min-cost-vrp"),
        ({"required": [True, True, False]}, ONE, "min-cost-vrp"),
        ({}, (VehicleType(1, max_distance=9.0),), "min-cost-vrp"),
        ({}, (VehicleType(1, energy=Energy(9.0)),), "min-cost-vrp"),
        ({}, (VehicleType(1), VehicleType(1, name="b")), "min-cost-vrp"),
        ({}, (VehicleType(1, 5.0),), "cvrp"),
        ({}, (VehicleType(None), VehicleType(2, 5.0, name="b")), "cvrp"),
        ({"due": [math.inf, 5.0, math.inf]}, (VehicleType(1, 5.0),), "vrptw"),
        ({"ready": [0.0, 5.0, 0.0]}, ONE, "vrptw"),
        ({"ready": [0.0, 5.0, 0.0], "depot": [True, False, True]}, (VehicleType(1, 5.0),), "min-cost-vrp"),
    ],
)
def test_the_first_problem_is_what_the_data_mean_and_least_cost_is_always_allowed(
    data: dict[str, Any], fleet: tuple[VehicleType, ...], first: str
) -> None:
    xy = np.array([(0, 0), (3, 0), (0, 4)], dtype=float)
    found = problems_of(RoutingInstance("tiny", "json", sites(**data), Travel("euclidean", xy), fleet))
    assert found[0] == first and "min-cost-vrp" in found
    assert ("min-makespan-vrp" in found) == any(v.count is not None for v in fleet)
    assert len(set(found)) == len(found)
