import math
from typing import Any

import numpy as np
import pytest
from coded import check_coded
from file_cases import check_refused, refused

from waybound import InputError, RoutingInstance, Sites
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.instances.routing.vehicle_type import Energy, VehicleType

XY = np.array([[0.0, 0], [0, 3], [4, 0]])


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"speed": 0}, "speed of vehicle must be positive and finite"),
        ({"speed": math.nan}, "speed of vehicle must be positive and finite"),
        ({"shift": (5, 3)}, "the shift of vehicle must have a begin and a later end"),
        ({"shift": (math.inf, math.inf)}, "the shift of vehicle must have a begin"),
        ({"unit_duration_cost": -1}, "unit_duration_cost of vehicle must be finite and not negative"),
        ({"unit_overtime_cost": math.inf}, "unit_overtime_cost of vehicle must be finite"),
        ({"regular_duration": -1}, "regular_duration of vehicle must be a number and not negative"),
        ({"further_capacity": (math.nan,)}, "capacity of vehicle must be a number and not negative in each load dimension"),
        ({"max_reloads": -1, "reloads": (0,)}, "max_reloads of vehicle must not be negative"),
        ({"max_reloads": 1}, "max_reloads of vehicle is given, but no depot where it may reload"),
        ({"committed": True}, "vehicle is committed, but without number"),
    ],
)
def test_a_vehicle_that_makes_no_sense_is_refused(given: dict[str, Any], message: str) -> None:
    assert message in refused(VehicleType, **given)


def test_a_store_has_its_own_errors() -> None:
    check_refused(InputError, "energy at departure must be within the capacity; expected 0 to 5; found 6", Energy, 5, initial=6)
    check_coded(InputError, "contradiction", Energy, 5, charge="elapsed", stations=(0,))
    assert (Energy(5).at_departure, Energy(5, initial=0).at_departure) == (5, 0)


@pytest.mark.parametrize(
    ("vehicle", "sites", "message"),
    [
        (VehicleType(reloads=(1,)), {}, "vehicle reloads at site a, which is no depot; expected o"),
        (VehicleType(energy=Energy(5, stations=(7,))), {}, "vehicle recharges at site 7, which does not exist; expected 0 to"),
        (
            VehicleType(further_capacity=(5,)),
            {},
            "capacity of vehicle has another number of load dimensions than the sites; expected 1; found 2",
        ),
        (VehicleType(shift=(8, 9)), {"due": [7, 99, 99]}, "the shift of vehicle begins after its depot has closed"),
        (VehicleType(shift=(-9, -3)), {}, "the shift of vehicle leaves no time between departure and return"),
        (VehicleType(energy=Energy(5, charge="windows")), {"windows": {1: [(0, 1), (3, 4)]}}, "charged by windows, and a site has several"),
        (VehicleType(), {"skills": {2: ["cold"]}}, "no vehicle has the skills that site b asks for; expected cold"),
        (VehicleType(travel=Travel(EXPLICIT, matrix=np.zeros((2, 2)))), {}, "travel of vehicle and sites have different sizes"),
        (VehicleType(travel=Travel("euclidean", XY, convention="round")), {}, "vehicle travels under another convention than the others"),
        (VehicleType(unit_duration_cost=1e200), {}, "unit_duration_cost of vehicle is too large to compute with"),
    ],
)
def test_a_vehicle_must_fit_the_sites(vehicle: VehicleType, sites: dict[str, Any], message: str) -> None:
    assert message in refused(RoutingInstance, "i", "test", Sites.of("oab", **sites), Travel("euclidean", XY), (vehicle,))


def test_a_matrix_of_its_own_is_under_any_convention_that_does_not_round() -> None:
    own = VehicleType(travel=Travel(EXPLICIT, matrix=np.ones((3, 3))))
    assert RoutingInstance("i", "test", Sites.of("oab"), Travel("euclidean", XY), (own,)).fleet == (own,)


def test_the_first_customers_keep_what_their_vehicles_need() -> None:
    vehicle = VehicleType(reloads=(3,), energy=Energy(9, stations=(3,)), travel=Travel("manhattan", np.zeros((4, 2))))
    sites = Sites.of("oabd", depot=[True, False, False, True])
    few = RoutingInstance("i", "test", sites, Travel("euclidean", np.zeros((4, 2))), (vehicle,)).with_customers(1)
    kept = few.fleet[0]
    assert few.sites.ids == ("o", "a", "d")
    assert (kept.reloads, kept.stations, len(kept.travel or ())) == ((2,), (2,), 3)


def test_a_repr_tells_what_is_not_usual() -> None:
    assert repr(VehicleType(2, 5)).endswith("unit_cost=1.0, name='vehicle')")
    assert repr(VehicleType(skills=frozenset("ba"), speed=2)).endswith("name='vehicle', skills=['a', 'b'], speed=2.0)")
    assert repr(Energy(5)) == "Energy(capacity=5.0, rate=1.0, charge='travel')"
