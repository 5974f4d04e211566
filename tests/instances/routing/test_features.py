import math
from typing import Any

import numpy as np
import pytest

from waybound import Energy, Group, RoutingInstance, RoutingProblem, Shipment, Sites, Travel, VehicleType
from waybound.instances.routing.features import FEATURES, features, restrictions
from waybound.instances.routing.fleet import problems_of

XY = np.array([[0.0, 0], [0, 3], [4, 0], [4, 3]])
UNCERTAIN = Travel("euclidean", XY, variances=np.ones((4, 4)))


def holding(sites: dict[str, Any] | None = None, fleet: Any = None, travel: Travel | None = None, **more: Any) -> RoutingInstance:
    made = Sites.of("dabc", coordinates=XY, **(sites or {}))
    return RoutingInstance("i", "test", made, travel or Travel("euclidean", XY), fleet or (VehicleType(),), **more)


CASES: dict[str, tuple[dict[str, Any], set[str]]] = {
    "capacity": ({"fleet": [VehicleType(capacity=5)]}, set()),
    "demands": ({"sites": {"demand": [0, 1, 0, 0]}}, set()),
    "time-windows": ({"sites": {"due": [math.inf, 9, math.inf, math.inf]}}, {"time-windows"}),
    "depot-windows": ({"sites": {"ready": [1, 0, 0, 0]}}, {"depot-windows"}),
    "service-times": ({"sites": {"service": [0, 0, 2, 0]}}, {"service-times"}),
    "demand-or-service-of-depots": ({"sites": {"service": [3, 0, 0, 0]}}, set()),
    "rewards": ({"sites": {"reward": [0, 0, 0, 1]}}, set()),
    "optional-sites": ({"sites": {"required": [False, True, False, True]}}, {"optional-sites"}),
    "limited-fleet": ({"fleet": [VehicleType(2)]}, {"limited-fleet"}),
    "min-vehicles": ({"min_vehicles": 1}, {"min-vehicles"}),
    "heterogeneous-fleet": ({"fleet": [VehicleType(), VehicleType(name="other")]}, {"heterogeneous-fleet"}),
    "multiple-depots": ({"sites": {"depot": [True, True, False, False]}}, {"multiple-depots"}),
    "max-duration": ({"fleet": [VehicleType(max_duration=9)]}, {"max-duration"}),
    "max-distance": ({"fleet": [VehicleType(max_distance=9)]}, {"max-distance"}),
    **{
        f"energy:{charge}": ({"fleet": [VehicleType(energy=Energy(9, charge=charge))]}, {f"energy:{charge}"})
        for charge in ("travel", "elapsed", "elapsed-fixed-start", "windows")
    },
    "fixed-cost": ({"fleet": [VehicleType(fixed_cost=1)]}, {"fixed-cost"}),
    "unit-cost": ({"fleet": [VehicleType(unit_cost=2)]}, set()),
    "separate-durations": ({"travel": Travel("euclidean", XY, duration_matrix=np.ones((4, 4)))}, {"separate-durations"}),
    "duration-cost": ({"fleet": [VehicleType(unit_duration_cost=2)]}, {"duration-cost"}),
    "overtime": ({"fleet": [VehicleType(regular_duration=9, unit_overtime_cost=2)]}, {"overtime"}),
    "shifts": ({"fleet": [VehicleType(shift=(2, math.inf))]}, {"shifts"}),
    "vehicle-speeds": ({"fleet": [VehicleType(speed=2)]}, {"vehicle-speeds"}),
    "vehicle-travel": ({"fleet": [VehicleType(travel=Travel("manhattan", XY))]}, {"vehicle-travel"}),
    "several-loads": ({"sites": {"demand": np.zeros((4, 2))}}, {"several-loads"}),
    "pickups": ({"sites": {"pickup": [0, 1, 0, 0]}}, {"pickups"}),
    "shipments": ({"sites": {"shipments": [Shipment(1, 2)]}}, {"shipments"}),
    "penalties": ({"sites": {"penalty": [0, 1, 0, 0]}}, set()),
    "skills": ({"sites": {"skills": {1: ["cold"]}}, "fleet": [VehicleType(skills=frozenset(["cold"]))]}, {"skills"}),
    "closing-moves": ({"travel": Travel("euclidean", XY, closing=np.full((4, 4), 9.0))}, {"closing-moves"}),
    "reloads": ({"fleet": [VehicleType(reloads=(0,))]}, {"reloads"}),
    "uncertain-durations": ({"travel": UNCERTAIN}, set()),
    "forbidden-moves": ({"forbidden": np.eye(4, k=1, dtype=bool)}, {"forbidden-moves"}),
    "route-risk": ({"fleet": [VehicleType(risk=0.1)]}, set()),
    "team-risk": ({"team_risk": 0.1}, set()),
}

IN_COMPANY: dict[str, tuple[dict[str, Any], set[str]]] = {
    "open-routes": (
        {"sites": {"depot": [True, True, False, False]}, "fleet": [VehicleType(end=1)]}, {"open-routes", "multiple-depots"}
    ),
    "groups": ({"sites": {"groups": [Group((1, 2))]}}, {"groups", "optional-sites"}),
    "several-windows": ({"sites": {"windows": {1: [(0, 2), (5, 9)]}}}, {"several-windows", "time-windows"}),
    "recharging": ({"fleet": [VehicleType(energy=Energy(9, stations=(0,)))]}, {"recharging", "energy:travel"}),
    "initial-energy": ({"fleet": [VehicleType(energy=Energy(9, initial=5))]}, {"initial-energy", "energy:travel"}),
    "committed-vehicles": ({"fleet": [VehicleType(2, committed=True)]}, {"committed-vehicles", "limited-fleet"}),
}  # fmt: skip
"""Features that do not come alone."""


@pytest.mark.parametrize("name", CASES)
def test_each_feature_is_named_by_itself_and_asked_of_solvers_where_it_restricts_routes(name: str) -> None:
    parts, restricting = CASES[name]
    instance = holding(**parts)
    assert features(instance) == {name}
    assert restrictions(instance) == restricting
    assert RoutingProblem.from_instance(instance, "cvrp").features() == restricting | {"objective:total-cost"}


@pytest.mark.parametrize("name", IN_COMPANY)
def test_a_feature_that_brings_others_names_all_of_them(name: str) -> None:
    parts, held = IN_COMPANY[name]
    assert features(holding(**parts)) == restrictions(holding(**parts)) == held


def test_every_feature_has_a_case() -> None:
    assert FEATURES.keys() == CASES.keys() | IN_COMPANY.keys()


def test_plain_data_hold_none() -> None:
    assert features(holding()) == frozenset()


def test_a_capacity_restricts_where_there_are_demands() -> None:
    assert restrictions(holding({"demand": [0, 1, 0, 0]}, [VehicleType(capacity=5)])) == {"capacity"}


def test_one_limited_type_of_several_is_a_limited_fleet() -> None:
    assert "limited-fleet" in features(holding(fleet=[VehicleType(2, name="own"), VehicleType(name="hired")]))


@pytest.mark.parametrize(
    ("parts", "meant"),
    [
        ({"sites": {"due": 99}, "fleet": [VehicleType(1)]}, "vrptw"),
        ({"sites": {"ready": [1, 0, 0, 0]}}, "vrptw"),
        ({"fleet": [VehicleType(1, capacity=5)]}, "cvrp"),
        ({"fleet": [VehicleType(1)]}, "tsp"),
        ({"fleet": [VehicleType(2)]}, "min-cost-vrp"),
        ({"fleet": [VehicleType(1, max_distance=9)]}, "min-cost-vrp"),
        ({"fleet": [VehicleType(1)], "sites": {"required": [False, True, False, True]}}, "min-cost-vrp"),
        ({"fleet": [VehicleType(1, energy=Energy(9))]}, "min-cost-vrp"),
        ({"sites": {"depot": [True, True, False, False], "due": 99}}, "min-cost-vrp"),
        ({"sites": {"shipments": [Shipment(1, 2)], "due": 99}}, "vrptw"),
        ({"sites": {"shipments": [Shipment(1, 2)]}, "fleet": [VehicleType(1, capacity=5)]}, "min-cost-vrp"),
        ({"fleet": [VehicleType(1, energy=Energy(9, stations=(0,)))]}, "recharging-vrp"),
        ({"fleet": [VehicleType(1, shift=(0, 9))]}, "min-cost-vrp"),
    ],
)
def test_the_problem_that_is_meant_follows_from_the_features(parts: dict[str, Any], meant: str) -> None:
    found = problems_of(holding(**parts))
    assert found[0] == meant
    assert "min-cost-vrp" in found


def test_what_else_may_be_asked_follows_from_the_data() -> None:
    assert "pdptw" in problems_of(holding({"shipments": [Shipment(1, 2)]})) and "pdptw" not in problems_of(holding())
    assert "min-makespan-vrp" in problems_of(holding(fleet=[VehicleType(2)])) and "min-makespan-vrp" not in problems_of(holding())
    assert "mdvrp" in problems_of(holding({"depot": [True, True, False, False]}))
    chosen = {"reward": [0, 1, 2, 3], "required": False}
    assert {"orienteering", "team-orienteering", "makespan-orienteering"} <= set(problems_of(holding(chosen, [VehicleType(1)])))
    assert "orienteering" not in problems_of(holding(chosen, [VehicleType(2)]))


@pytest.mark.parametrize(("name", "parts"), [("route-risk", {"fleet": [VehicleType(risk=0.1)]}), ("team-risk", {"team_risk": 0.1})])
def test_a_risk_restricts_where_durations_are_uncertain(name: str, parts: dict[str, Any]) -> None:
    assert restrictions(holding(travel=UNCERTAIN, **parts)) == {name}


@pytest.mark.parametrize("sites", [{"pickup": [0, 1, 0, 0]}, {"shipments": [Shipment(1, 2, (3.0,))]}])
def test_a_capacity_restricts_where_anything_is_carried(sites: dict[str, Any]) -> None:
    assert "capacity" in restrictions(holding(sites, [VehicleType(capacity=5)]))
