import itertools
import math
from typing import Any

import numpy as np
import pytest
from draws import draws
from hypothesis import assume, given, settings
from oracles import SQUARE_4, TW_4, optimum, routing, small_problems
from truth.routing import routes

from waybound import LongestRoute, Reward, RoutingProblem, TotalCost, Vehicles, VehicleType
from waybound.formulations.stop import Stop
from waybound.solvers.bounds.routing.arcs import Arcs, arc_costs, lacks_arc_costs, too_many_arcs


def arcs_of(problem: RoutingProblem) -> Arcs:
    return arc_costs(problem)


@settings(max_examples=draws(60), deadline=None)
@given(problem=small_problems(most=3, hetero=True))
def test_no_route_that_can_be_driven_pays_less_than_its_arcs(problem: RoutingProblem) -> None:
    assume(not lacks_arc_costs(problem))
    made = arcs_of(problem)
    node = {int(site): k for k, site in enumerate(made.customers, start=1)}
    weights = {term.name: weight for weight, term in problem.objective.levels()[0].terms}
    for vehicle in problem.fleet:
        for visits in routes(problem, vehicle):
            length = sum(float(problem.travel.distances[i, j]) for i, j in itertools.pairwise((vehicle.start, *visits, vehicle.end)))
            paid = weights.get("vehicles", 0.0) + weights.get("total-cost", 0.0) * (vehicle.fixed_cost + vehicle.unit_cost * length)
            through = [0, *(node[i] for i in visits), 0]
            assert sum(made.cost[i, j] for i, j in itertools.pairwise(through)) <= paid + 1e-9


@settings(max_examples=draws(60), deadline=None)
@given(problem=small_problems(most=3))
def test_the_number_of_routes_of_every_answer_is_within_its_limits(problem: RoutingProblem) -> None:
    assume(not lacks_arc_costs(problem) and optimum(problem) is not None)
    made = arcs_of(problem)
    assert made.fewest <= made.most <= len(problem.customers)


def test_costs_of_a_fleet_are_those_of_its_cheapest_vehicle_at_each_end() -> None:
    """West pays 5 and 1 a unit, east nothing and 2 a unit: to site 1 (1 from west, 9 from east) 6, to site 2 (9 and 1) 2."""
    xy = np.array([(0, 0), (1, 0), (9, 0), (10, 0)], dtype=float)
    fleet = (VehicleType(1, fixed_cost=5.0, start=0, end=0, name="west"), VehicleType(1, unit_cost=2.0, start=3, end=3, name="east"))
    made = arcs_of(routing(xy=xy, sites={"depot": [True, False, False, True]}, fleet=fleet))
    assert made.cost.tolist() == [[math.inf, 6.0, 2.0], [1.0, math.inf, 8.0], [2.0, 8.0, math.inf]]
    assert (made.fewest, made.most) == (1, 2)


def test_weights_of_the_objective_count() -> None:
    made = arcs_of(routing(xy=SQUARE_4, objective=3 * TotalCost() + 100 * Vehicles()))
    assert made.cost[0, 1] == 109.0 and made.cost[1, 0] == 9.0 and made.cost[1, 2] == 12.0


def test_moves_that_load_or_windows_rule_out_are_left_out() -> None:
    made = arcs_of(routing(xy=SQUARE_4, sites={"demand": [0, 3, 3, 1, 1]}, capacity=5, count=4))
    assert math.isinf(made.cost[1, 2]) and math.isinf(made.cost[2, 1]) and math.isfinite(made.cost[1, 3])
    assert made.fewest == 2  # 8 in all
    late = arcs_of(routing(xy=SQUARE_4, sites=dict(TW_4), count=4))
    assert math.isinf(late.cost[3, 2]) and math.isfinite(late.cost[2, 3])  # 3 opens at 10, 2 closes at 6


@pytest.mark.parametrize(
    ("given", "lacking"),
    [
        ({}, set()), ({"objective": Vehicles()}, set()), ({"objective": Vehicles().then(LongestRoute())}, set()),
        ({"sites": {"required": False}}, {"optional-sites"}), ({"objective": LongestRoute()}, {"objective:longest-route"}),
        ({"objective": TotalCost() - Reward()}, {"objective:reward"}),
    ],
)  # fmt: skip
def test_what_is_no_sum_over_arcs_is_named(given: dict[str, Any], lacking: set[str]) -> None:
    assert lacks_arc_costs(routing(xy=SQUARE_4, **given)) == lacking


def test_more_arcs_than_the_time_allows_are_not_drawn_up() -> None:
    problem = routing(xy=SQUARE_4)
    assert too_many_arcs(problem, 1e-6) and not too_many_arcs(problem, 1.0)
    assert arc_costs(problem, Stop(1e-9)) is None
