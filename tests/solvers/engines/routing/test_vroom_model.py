from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_routing import small

from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Route, Routes
from waybound.instances.routing.instance import VehicleType
from waybound.solvers.backend import BACKENDS
from waybound.solvers.engines.routing.routing_integers import integer_routing
from waybound.solvers.engines.routing.vroom_model import LARGEST, Model
from waybound.solvers.engines.routing.vroom_priorities import Priorities, priorities

pytestmark = pytest.mark.skipif(not BACKENDS["vroom"].installed(), reason="VROOM is not installed")


def model(problem: RoutingProblem, most: int = 5) -> Model:
    asked = priorities(problem)
    assert isinstance(asked, Priorities)
    return Model(asked, integer_routing(asked.problem, largest=LARGEST, total=LARGEST), most)


def test_types_that_no_route_can_use_are_left_out() -> None:
    problem = small("multiple-depots", 0, "round")
    n = len(problem.sites)
    sites = replace(problem.sites, ready=np.array([50.0] + [0.0] * (n - 1)), due=np.array([np.inf, 20.0] + [np.inf] * (n - 2)))
    assert model(replace(problem, sites=sites, fleet=(VehicleType(2, start=0, end=1), VehicleType(3)))).types == [1, 1, 1]


def test_it_costs_what_the_problem_says() -> None:
    problem = small("capacity", 0, "round")
    cost, routes = model(problem).solved(5, 5.0)
    assert routes is not None
    assert problem.evaluate(routes).values == pytest.approx([cost])


def test_it_begins_with_answers_that_keep_the_rules_alone() -> None:
    problem = small("capacity", 0, "round")
    alone = Routes.of(Route((site,)) for site in problem.customers.tolist())
    begun, all_in_one, too_many = model(problem), model(problem), model(problem, most=2)
    begun.begin(alone)
    all_in_one.begin(Routes.of([Route(tuple(problem.customers.tolist()))]))
    too_many.begin(alone)
    assert sorted(begun.routes.values()) == [(site,) for site in problem.customers.tolist()]
    assert all_in_one.routes == too_many.routes == {}


def test_a_required_site_that_is_left_out_is_no_answer() -> None:
    problem = small("capacity", 0, "round")
    alone = replace(problem, fleet=(replace(problem.fleet[0], count=1, capacity=float(problem.sites.demand.max())),))
    assert model(alone).solved(0, 5.0) == (0, None)
