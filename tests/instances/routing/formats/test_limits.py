from typing import Any

import numpy as np
import pytest

from waybound import RoutingInstance, Sites, Travel, UsageError, VehicleType
from waybound.instances.routing.formats._limits import refuse_inexpressible

XY = np.array([(0, 0), (3, 0), (0, 4)], dtype=float)


def instance(vehicle: VehicleType, objective: tuple[str, ...] = (), **sites: Any) -> RoutingInstance:
    return RoutingInstance(
        "tiny", "json", Sites.of("abc", coordinates=XY, **sites), Travel("euclidean", XY), (vehicle,), objective=objective
    )


def test_sites_distances_a_depot_and_equal_vehicles_need_no_place() -> None:
    refuse_inexpressible(instance(VehicleType()), "scroll", ())


@pytest.mark.parametrize(
    ("made", "names"),
    [
        (instance(VehicleType(max_duration=5)), "max-duration"),
        (instance(VehicleType(), service=[0, 1, 0]), "service-times"),
        (instance(VehicleType(fixed_cost=2, max_distance=9)), "fixed-cost, max-distance"),
        (instance(VehicleType(), objective=("vehicles", "total-cost")), "objective"),
    ],
)
def test_what_has_no_place_is_refused_by_name(made: RoutingInstance, names: str) -> None:
    with pytest.raises(UsageError, match=f"tiny cannot be written as scroll, which has no place for {names}; use json") as caught:
        refuse_inexpressible(made, "scroll", {"capacity", "time-windows"})
    assert caught.value.code == "unsupported"
    refuse_inexpressible(made, "scroll", names.split(", "))


def test_instances_of_other_families_hold_no_routing_data() -> None:
    with pytest.raises(UsageError, match="this holds no routing data, so it cannot be written as scroll; use json"):
        refuse_inexpressible(object(), "scroll", ())
