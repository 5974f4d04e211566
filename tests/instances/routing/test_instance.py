import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from coded import coded

from waybound.instances.errors import Code, InputError, UsageError
from waybound.instances.instance import Instance, digest
from waybound.instances.routing.instance import Energy, RoutingInstance, Sites, VehicleType
from waybound.instances.routing.travel import Travel

XY = np.array([[0.0, 0], [0, 3], [4, 0], [4, 3]])


def instance(**changes: Any) -> RoutingInstance:
    parts = {
        "name": "tiny", "format": "test", "sites": Sites.of("dabc", demand=[0, 1, 2, 3], coordinates=XY),
        "travel": Travel("euclidean", coordinates=XY), "fleet": (VehicleType(2, 5.0),),
    }  # fmt: skip
    return RoutingInstance(**{**parts, **changes})


def test_an_instance_follows_the_protocol() -> None:
    assert isinstance(instance(), Instance)


def test_sites_have_the_documented_defaults() -> None:
    sites = Sites.of(["d", "a"])
    assert sites.depots.tolist() == [0] and sites.customers.tolist() == [1]
    assert sites.required.tolist() == [False, True]
    assert sites.ready.tolist() == [0, 0] and sites.due.tolist() == [math.inf] * 2
    assert sites.index() == {"d": 0, "a": 1}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"ids": []}, "there are no sites"),
        ({"ids": ["a", "b", "a"]}, "two sites have the id 'a'"),
        ({"demand": [0, -1, 0]}, "demand of site b must be finite and not negative; found -1.0"),
        ({"demand": [0, math.nan, 0]}, "demand of site b"),
        ({"service": [0, 0, math.inf]}, "service of site c"),
        ({"reward": [0, 0, -2]}, "reward of site c"),
        ({"ready": [0, math.nan, 0]}, "ready time of site b must be finite"),
        ({"due": [0, math.nan, 9]}, "due time of site b must be a number"),
        ({"due": [0, -math.inf, 9]}, "due time of site b must be a number"),
        ({"ready": 5, "due": [9, 4, 9]}, "time window of site b closes before it opens"),
        ({"depot": [False] * 3}, "there is no depot"),
        ({"coordinates": [[0, 0], [1, 1]]}, "two entries a site"),
        ({"coordinates": [[0, 0], [1, math.nan], [0, 0]]}, "coordinate of site b is not finite"),
    ],
)
def test_sites_refuse_what_makes_no_sense_and_name_the_site(changes: dict[str, Any], message: str) -> None:
    arguments = {"ids": ["a", "b", "c"], **changes}
    with pytest.raises(InputError, match=message):
        Sites.of(arguments.pop("ids"), **arguments)


def test_arrays_are_read_only() -> None:
    sites = Sites.of("ab")
    with pytest.raises(ValueError, match="read-only"):
        sites.demand[0] = 1


def test_a_depot_is_never_required() -> None:
    assert Sites.of("ab", required=True).required.tolist() == [False, True]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"count": 0}, "at least 1"), ({"capacity": -1.0}, "capacity of vehicle"), ({"capacity": math.nan}, "capacity of vehicle"),
        ({"max_duration": math.nan}, "max_duration"), ({"max_distance": -5}, "max_distance"), ({"fixed_cost": math.inf}, "fixed_cost"),
        ({"unit_cost": -1}, "unit_cost"),
    ],
)  # fmt: skip
def test_a_vehicle_refuses_what_makes_no_sense(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        VehicleType(**changes)


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({"capacity": -1}, "out-of-range"), ({"capacity": math.inf}, "out-of-range"), ({"rate": 0}, "out-of-range"),
        ({"rate": math.nan}, "out-of-range"), ({"charge": "solar"}, "unknown-name"),
    ],
)  # fmt: skip
def test_an_energy_store_refuses_what_makes_no_sense(changes: dict[str, Any], code: Code) -> None:
    with pytest.raises(InputError, check=coded(code)):
        Energy(**{"capacity": 1.0, **changes})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"travel": Travel("euclidean", coordinates=XY[:2])}, "different sizes; expected 4; found 2"),
        ({"fleet": ()}, "the fleet is empty"),
        ({"fleet": (VehicleType(start=1),)}, "site a, which is no depot; expected d"),
        ({"fleet": (VehicleType(end=9),)}, "site 9, which does not exist; expected 0 to 3"),
        ({"min_vehicles": -1}, "must not be negative"),
        ({"min_vehicles": 3}, "at least 3 vehicles are asked for, but the fleet has 2"),
        (
            {"fleet": (VehicleType(unit_cost=1e200),)},
            "unit_cost of vehicle is too large to compute with; expected at most 1e.150",
        ),
        ({"travel": Travel("euclidean", coordinates=1e200 * XY)}, "coordinate of site . is too large to compute with; expected at most"),
        ({"travel": Travel("EXPLICIT", matrix=np.full((4, 4), 5e307))}, "distance of site . is too large to compute with"),
    ],
)
def test_parts_that_do_not_fit_each_other_are_refused(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        instance(**changes)


def test_the_first_customers_are_kept_with_the_depots() -> None:
    late_depot = instance(
        sites=Sites.of("abcd", depot=[False, False, False, True], demand=[1, 2, 3, 0], coordinates=XY), fleet=(VehicleType(1, 9, 3, 3),)
    )
    short = late_depot.with_customers(2)
    assert short.name == "tiny.2"
    assert short.sites.ids == ("a", "b", "d")
    assert (short.fleet[0].start, short.fleet[0].end) == (2, 2)
    assert short.travel.distance(0, 2) == late_depot.travel.distance(0, 3)


@pytest.mark.parametrize("count", [0, 4, -1])
def test_a_number_of_customers_out_of_range_is_refused(count: int) -> None:
    with pytest.raises(UsageError, match="tiny has 3 customers"):
        instance().with_customers(count)


def test_a_digest_tells_values_types_and_shapes_apart() -> None:
    a = np.array([1.0, 2.0])
    assert digest(a, "x") == digest(a.copy(), "x")
    different = [
        digest(a), digest(a[None]), digest(np.array([1, 2])), digest(np.array([1.0, np.nextafter(2, 3)])), digest("a", "b"), digest("ab"),
    ]  # fmt: skip
    assert len(set(different)) == len(different)


def test_whole_and_decimal_limits_hash_alike() -> None:
    assert repr(VehicleType(1, 5)) == repr(VehicleType(1, 5.0))
    assert repr(Energy(3)) == repr(Energy(3.0))


def test_problems_always_hold_the_problem() -> None:
    assert instance(problem="vrptw").problems == ("vrptw",)
    assert replace(instance(), fleet=[VehicleType()]).fleet == (VehicleType(),)  # type: ignore[arg-type]


def test_more_vehicles_than_anyone_counts_are_refused() -> None:
    assert VehicleType(10**18).count == 10**18
    with pytest.raises(InputError, match="at most 1000000000000000000; found 99999999999999999999"):
        VehicleType(99999999999999999999)
