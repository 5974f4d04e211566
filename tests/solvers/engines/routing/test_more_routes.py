"""More routes of fewer: as many as are asked for, within the fleet, or none."""

from __future__ import annotations

import pytest
from oracles import SQUARE_4, optimum, routing

from waybound.formulations.routing.routes import Route, Routes
from waybound.instances.routing.instance import VehicleType
from waybound.solvers.backend import Control, Options
from waybound.solvers.engines.routing.more_routes import with_more_routes
from waybound.solvers.engines.routing.ortools import ORTools


def test_each_further_route_is_the_least_detour() -> None:
    problem = routing(xy=SQUARE_4, count=3, min_vehicles=2)
    assert with_more_routes(problem, Routes.of([[1, 2, 3, 4]])) == Routes.of([[1, 2, 3], [4]])
    enough = Routes.of([[1, 2], [3, 4]])
    assert with_more_routes(problem, enough) == enough


def test_a_vehicle_that_cannot_serve_the_customer_is_passed_over() -> None:
    fleet = (VehicleType(1, 9.0, name="large"), VehicleType(1, 1.0, name="small"))
    problem = routing(xy=SQUARE_4, sites={"demand": [0, 2, 2, 1, 2]}, fleet=fleet, min_vehicles=2)
    found = with_more_routes(problem, Routes.of([[1, 2, 3, 4]]))
    assert found is not None and found.routes[1] == Route((3,), 1)
    assert problem.evaluate(found).feasible


def test_a_site_that_was_left_out_may_get_a_route() -> None:
    problem = routing(xy=SQUARE_4, count=2, min_vehicles=2, sites={"required": False, "reward": 1}, max_distance=9.0)
    assert with_more_routes(problem, Routes.of([[1]])) == Routes.of([[1], [4]])


def test_what_does_not_work_out_is_none() -> None:
    fleet = (VehicleType(1, name="large"), VehicleType(1, 1.0, name="small"))
    problem = routing(xy=SQUARE_4, sites={"demand": [0, 2, 2, 2, 2]}, fleet=fleet, min_vehicles=2)
    assert with_more_routes(problem, Routes.of([[1, 2, 3, 4]])) is None
    assert with_more_routes(routing(xy=SQUARE_4[:2], count=2, min_vehicles=1), Routes.of([[1]])) == Routes.of([[1]])


@pytest.mark.parametrize(("least", "fixed"), [(2, 0.0), (3, 5.0), (4, 0.0)])
def test_or_tools_begins_with_enough_routes_and_keeps_them(least: int, fixed: float) -> None:
    problem = routing(xy=SQUARE_4, count=4, min_vehicles=least, fixed_cost=fixed)
    found = ORTools().run(problem, Options(time_limit=60.0, iterations=40), Control())
    assert found.objective == pytest.approx(optimum(problem))
    assert problem.evaluate(found.answer).feasible
    assert "start" not in found.statistics
