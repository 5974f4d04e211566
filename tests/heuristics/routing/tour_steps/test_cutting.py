import numpy as np
import pytest

from waybound import Route, Routes, RoutingProblem, Sites, Travel, VehicleType
from waybound.heuristics.heuristic import HEURISTICS
from waybound.heuristics.routing.tour_steps.cutting import in_turn, routes_of, too_many, visits_by_route

LINE = Travel("euclidean", np.column_stack([np.arange(5.0), np.zeros(5)]))


def test_a_route_ends_at_each_mark() -> None:
    sites = np.array([4, 2, 3, 1])
    assert routes_of(sites, np.array([False, True, True, True])) == [Route((4, 2)), Route((3,)), Route((1,))]
    assert routes_of(sites[:0], np.zeros(0, dtype=bool)) == []


def test_in_turn_they_fill_vehicles_or_go_alone() -> None:
    loads = RoutingProblem(Sites.of(range(5), demand=[0, 2, 2, 3, 1]), LINE, (VehicleType(capacity=4),))
    assert in_turn(loads) == Routes.of([[1, 2], [3, 4]])
    windows = RoutingProblem(Sites.of(range(5), due=[99, 9, 9, 9, 9]), LINE, (VehicleType(),))
    assert in_turn(windows) == Routes.of([[1], [2], [3], [4]])


def test_visits_stand_by_route_and_place() -> None:
    assert [part.tolist() for part in visits_by_route(np.array([1, -1, 0, 1]), np.array([2, 0, 0, 1]))] == [[2], [3, 0]]
    assert visits_by_route(np.array([-1]), np.array([0])) == []


@pytest.mark.parametrize("name", ["christofides", "insertion", "savings", "split", "tour-partitioning"])
def test_open_routes_are_named(name: str) -> None:
    sites = Sites.of(range(5), depot=[True, False, False, False, True])
    assert HEURISTICS[name].missing(RoutingProblem(sites, LINE, (VehicleType(start=0, end=4),))) == {"open-routes", "multiple-depots"}
    assert not HEURISTICS[name].missing(RoutingProblem(Sites.of(range(5)), LINE, (VehicleType(),)))


def test_more_routes_than_vehicles_are_told() -> None:
    problem = RoutingProblem(Sites.of(range(5)), LINE, (VehicleType(count=1),))
    assert "fleet of 1" in too_many(problem, Routes.of([[1], [2]]), "split")
    assert too_many(problem, Routes.of([[1]]), "split") == ""
