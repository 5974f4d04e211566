import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from file_cases import refused
from small_routing import WHOLE_FAMILY, varied

from waybound import Energy, RoutingInstance, RoutingProblem, Sites, Travel, VehicleType
from waybound.instances.document import dump_json
from waybound.instances.formats.waybound_json import read, write
from waybound.instances.routing.json_vehicles import decode_vehicle, encode_vehicle

SITES = Sites.of(["yard", "far", "a"], depot=[True, True, False], demand=np.zeros((3, 2)), coordinates=np.zeros((3, 2)))


@pytest.mark.parametrize(
    "vehicle",
    [
        VehicleType(),
        VehicleType(2, 5.0, further_capacity=(math.inf,), end=1, shift=(2, math.inf), skills=frozenset("ab"), speed=2.5),
        VehicleType(energy=Energy(9, 2, stations=(0, 1), initial=4), reloads=(1,), max_reloads=2, unit_duration_cost=0.5),
        VehicleType(1, committed=True, regular_duration=8, unit_overtime_cost=3, max_duration=10, shift=(-math.inf, 99)),
    ],
)
def test_a_vehicle_reads_back(vehicle: VehicleType) -> None:
    data = json.loads(dump_json(encode_vehicle(vehicle, SITES)))
    assert decode_vehicle(data, "fleet[0]", SITES.index(), SITES) == vehicle


def test_travel_of_its_own_reads_back_with_its_convention() -> None:
    own = Travel(
        "manhattan", np.array([[0.0, 0], [1, 2], [3, 4]]), closing=np.array([[0, 1, math.inf], [2, 3, 4], [5, 6, 7]]), convention="round"
    )
    data = json.loads(dump_json(encode_vehicle(VehicleType(travel=own), SITES)))
    found = decode_vehicle(data, "fleet[0]", SITES.index(), SITES).travel
    assert found is not None and found.closing is not None and own.closing is not None
    assert (found.metric, found.convention) == ("manhattan", "round")
    assert np.array_equal(found.distances, own.distances) and np.array_equal(found.closing, own.closing)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"travel": {"metric": "EXPLICIT"}}, "fleet[0].travel by EXPLICIT needs matrix"),
        ({"travel": {"metric": "manhattan", "x": [1, 2, 3]}}, "fleet[0].travel has x alone"),
        ({"capacity": []}, "fleet[0].capacity is empty"),
        ({"shift": [None, None, 1]}, "fleet[0].shift has a wrong length"),
        ({"skills": "cold"}, "fleet[0].skills must be a list"),
        ({"max_reloads": -1, "reloads": ["yard"]}, "fleet[0].max_reloads must be a whole number"),
    ],
)
def test_a_fault_is_named_by_its_path(data: dict[str, Any], message: str) -> None:
    assert message in refused(decode_vehicle, data, "fleet[0]", SITES.index(), SITES)


@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_a_problem_of_the_whole_family_reads_back_the_same(feature: str, tmp_path: Path) -> None:
    for seed in range(4):
        problem = varied(feature, seed, 3)
        instance = RoutingInstance("i", "test", problem.sites, problem.travel, problem.fleet, "min-cost-vrp")
        text = write(instance)
        found = read(text, Path("i.json"))
        assert isinstance(found, RoutingInstance)
        assert RoutingProblem.from_instance(found).digest() == RoutingProblem.from_instance(instance).digest()
        assert write(found) == text
