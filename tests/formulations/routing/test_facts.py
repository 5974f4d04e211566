"""What is told of a problem: always the same of what all have, and the rest where there is any."""

import numpy as np
import pytest

from waybound import Energy, Group, RoutingProblem, Shipment, Sites, Travel, VehicleType

XY = np.arange(10.0).reshape(5, 2)


def told(vehicle: VehicleType | None = None, travel: Travel | None = None, **sites):
    return RoutingProblem(Sites.of("oabcd", **sites), travel or Travel("euclidean", XY), [vehicle or VehicleType()]).facts()


def test_plain_problems_tell_nothing_of_what_they_do_not_have():
    assert told().keys() == {"objective", "sites", "demand", "service", "windows", "travel", "fleet", "min_vehicles"}
    assert told()["fleet"][0].keys() == {
        "name", "count", "capacity", "start", "end", "max_duration", "max_distance", "energy", "fixed_cost", "unit_cost"
    }  # fmt: skip


def test_what_holds_of_sites_and_between_them_is_told():
    facts = told(
        VehicleType(skills=frozenset(["cold", "tall"])), demand=[[0, 0], [1, 2], [0, 0], [0, 0], [0, 0]], pickup=[0, 3, 0, 0, 0],
        penalty=[0, 0, 4, 0, 0], windows={1: [(0, 1), (3, 4)]}, skills={2: ["tall", "cold"]}, shipments=[Shipment(1, 2, (5.0,))],
        groups=[Group((3, 4))], reward=[0, 1, 2, 3, 4], travel=Travel("euclidean", XY, closing=np.where(np.eye(5), np.inf, 7.0)),
    )  # fmt: skip
    assert facts["further_demand"] == [{"total": 2, "least": 0, "largest": 2}]
    assert facts["pickup"]["total"] == 3 and facts["penalty"]["total"] == 4 and facts["reward"]["total"] == 10
    assert facts["several_windows"] == {"sites": 1, "most": 2}
    assert facts["skills"] == {"sites": 1, "names": ["cold", "tall"]}
    assert facts["shipments"] == {"count": 1, "load": 5} and facts["groups"] == {"count": 1, "required": 1}
    assert facts["travel"]["closing_moves"] == 20


def test_a_vehicle_names_sites_by_their_ids():
    vehicle = VehicleType(2, reloads=(0,), energy=Energy(9, stations=(0,)), shift=(1, 9), travel=Travel("manhattan", XY), speed=2)
    (fleet,) = told(vehicle)["fleet"]
    assert (fleet["reloads"], fleet["energy"]["stations"], fleet["shift"], fleet["speed"]) == (["o"], ["o"], [1, 9], 2)
    assert fleet["travel"] == {"metric": "manhattan", "coordinates": False, "own_durations": False}
    assert "initial" not in fleet["energy"]


@pytest.mark.parametrize(
    ("sites", "objective", "remarks"),
    [
        ({"reward": 2.0}, None, ["rewards count for nothing: every site is required"]),
        ({"penalty": 2.0, "required": False}, "total-cost", ["penalties count for nothing: the objective is total-cost"]),
        ({"penalty": 2.0, "required": False}, "makespan + penalties", []),
        ({"required": [False, True, True, True, False]}, None, ["1 site may be left out, and nothing tells what a visit is worth"]),
        (
            {"reward": 2.0, "required": False}, "total-cost - reward",
            ["sites may be left out, and what they are worth counts: the objective is total-cost - reward"],
        ),
        ({"demand": [0, 1, 1, 1, 1]}, None, ["demand counts for nothing: no vehicle has a capacity for it"]),
        ({"pickup": [0, 0, 3, 0, 0]}, None, ["pickup counts for nothing: no vehicle has a capacity for it"]),
        (
            {"demand": [[0, 0, 0]] + [[0, 1, 0]] * 4, "pickup": [[0, 0, 0]] + [[0, 2, 3]] * 4}, None,
            [
                "demand2 and pickup2 count for nothing: no vehicle has a capacity for them",
                "pickup3 counts for nothing: no vehicle has a capacity for it",
            ],
        ),
        (
            {"shipments": [Shipment(1, 2, (0.0, 5.0))], "demand": np.zeros((5, 2))}, None,
            ["load2 of shipments counts for nothing: no vehicle has a capacity for it"],
        ),
        ({"attributes": {"colour": list("abcde"), "node": range(5)}}, None, ["columns kept and not used: colour, node"]),
    ],
)  # fmt: skip
def test_what_does_not_count_is_told(sites, objective, remarks):
    made = Sites.of("oabcd", **sites)
    problem = RoutingProblem(made, Travel("euclidean", XY), [VehicleType()], objective, notes=["seen"])
    assert list(problem.remarks()) == ["seen", *remarks]


@pytest.mark.parametrize(
    ("vehicles", "remarks"),
    [
        ([VehicleType(capacity=9)], ["demand2 counts for nothing: no vehicle has a capacity for it"]),
        ([VehicleType(further_capacity=(9,))], ["demand counts for nothing: no vehicle has a capacity for it"]),
        ([VehicleType(capacity=9, further_capacity=(9,))], []),
        ([VehicleType(name="a", capacity=9), VehicleType(name="b", further_capacity=(7,))], []),
    ],
)
def test_loads_without_a_capacity_are_told(vehicles, remarks):
    sites = Sites.of("oabcd", demand=[[0, 0]] + [[1, 9]] * 4)
    assert list(RoutingProblem(sites, Travel("euclidean", XY), vehicles).remarks()) == remarks


def test_what_is_stated_of_depots_and_does_not_count_is_said():
    def remarks(vehicle: VehicleType | None = None, **sites):
        return RoutingProblem(Sites.of("oabcd", **sites), Travel("euclidean", XY), [vehicle or VehicleType()]).remarks()

    assert remarks(service=[0, 1, 1, 1, 1]) == ()
    assert remarks(service=[30, 1, 1, 1, 1]) == ("service of o, a depot, counts for nothing: departure and return take no time",)
    assert remarks(VehicleType(reloads=(0,)), service=30, demand=2) == (
        "service of o, a depot, counts at stops on the way alone: departure and return take no time",
        "demand of o, a depot, counts for nothing",
        "demand counts for nothing: no vehicle has a capacity for it",
    )
