from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from coded import coded
from oracles import SQUARE_4, optimum, routing
from small_routing import small
from truth.routing import best_values

from waybound import Group, Reward, Route, Routes, RoutingProblem, Sites, TotalCost, Travel, UsageError, VehicleType
from waybound.instances.errors import Code
from waybound.solvers.backend import LIMITS, STATUSES, Control, Options
from waybound.solvers.engines.routing.ortools import STATUS_MAP, ORTools, _Search, with_more_routes
from waybound.solvers.engines.routing.routing_integers import integer_routing, with_slope


def test_every_status_of_the_library_has_one_of_ours() -> None:
    from ortools.constraint_solver import routing_enums_pb2

    assert set(STATUS_MAP) == set(routing_enums_pb2.RoutingSearchStatus.Value.keys())
    assert all(status in STATUSES and limit in LIMITS for status, limit in STATUS_MAP.values())


@pytest.mark.parametrize(
    "extra",
    [{"first_solution_strategy": "savings"}, {"metaheuristic": "simulated-annealing"}, {"local_search_metaheuristic": "TABU_SEARCH"},
     {"guided_local_search_lambda_coefficient": "0.2"}],
)  # fmt: skip
def test_options_of_the_library_are_taken_by_name(extra) -> None:
    problem = small("capacity", 0, "round")
    result = ORTools().run(problem, Options(time_limit=60.0, iterations=100, extra=extra), Control())
    assert problem.evaluate(result.answer).values == pytest.approx(best_values(problem))


@pytest.mark.parametrize(
    ("extra", "message"),
    [
        ({"first_solution_strategy": "magic"}, "is one of .*SAVINGS"), ({"metaheuristics": "x"}, "no option 'metaheuristics'"),
        ({"guided_local_search_lambda_coefficient": "much"}, "takes a number"), ({"solution_limit": 3}, "no option"),
    ],
)  # fmt: skip
def test_wrong_options_are_refused(extra, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        ORTools().run(small("capacity", 0, "round"), Options(extra=extra), Control())


@pytest.mark.parametrize(
    ("name", "value", "code"),
    [("first_solution_strategy", "magic", "unknown-name"), ("relocate_expensive_chain_num_arcs_to_consider", 10**20, "out-of-range")],
)
def test_values_that_an_option_cannot_have_are_told_apart(name: str, value: object, code: Code) -> None:
    with pytest.raises(UsageError, check=coded(code)):
        ORTools().run(small("capacity", 0, "round"), Options(extra={name: value}), Control())


def collecting(seed: int) -> RoutingProblem:
    rng = np.random.default_rng(seed)
    sites = Sites.of(range(40), reward=np.r_[0, rng.integers(1, 20, 39)], required=False)
    fleet = (VehicleType(count=2, max_distance=80.0),)
    return RoutingProblem(sites, Travel("euclidean", rng.uniform(0, 50, (40, 2))), fleet, Reward())


@pytest.mark.parametrize(("seed", "greedy"), [(0, 148.0), (1, 193.0), (4, 237.0)])
def test_rewards_alone_still_give_the_search_a_direction(seed: int, greedy: float) -> None:
    problem = collecting(seed)
    found = ORTools().run(problem, Options(time_limit=60.0, seed=1, iterations=60), Control())
    judged = problem.evaluate(found.answer)
    assert judged.feasible and judged.values[0] == found.objective
    assert judged.values[0] >= greedy


def test_no_way_is_so_long_that_a_reward_is_given_up_for_it() -> None:
    problem = collecting(0)
    data = with_slope(problem, integer_routing(problem))
    assert data.unit.all() and data.prize[1:].min() > sum(v.count for v in problem.fleet) * data.max_distance.max()
    assert data.prize / data.cost_factor == pytest.approx(problem.sites.reward)
    costly = replace(problem, objective=Reward().then(TotalCost()))
    priced = integer_routing(costly)
    assert with_slope(costly, priced) is priced


@pytest.mark.parametrize("required", [True, False])
def test_an_answer_without_a_required_group_is_none(required: bool) -> None:
    """Where the library finds no first answer it may leave out what is required, to go on from there; such answers are not taken."""
    sites = Sites.of("oabc", required=False, coordinates=np.zeros((4, 2)), groups=[Group((1, 2), required)])
    problem = RoutingProblem(sites, Travel("euclidean", sites.coordinates), (VehicleType(),), TotalCost())
    search = _Search(problem, integer_routing(problem), Options(), control := Control(), 0.0)
    for visits, taken in (((3,), not required), ((3, 2), True)):
        search.cost = search.answer = control.answer = None
        model = SimpleNamespace(routes=lambda successor, visits=visits: Routes.of([visits]), offset=0)
        search._take(0, model, lambda index: index)
        assert (search.answer is not None) == (control.answer is not None) == taken
    assert search._required() == ("required group" if required else "required site")


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
