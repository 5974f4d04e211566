from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from small_routing import small
from truth.routing import best_values

from waybound.formulations.routing.objective import Reward, TotalCost
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Routes
from waybound.instances.errors import UsageError
from waybound.instances.routing.instance import Group, Sites, VehicleType
from waybound.instances.routing.travel import Travel
from waybound.solvers.backend import LIMITS, STATUSES, Control, Options
from waybound.solvers.engines.routing.ortools import STATUS_MAP, ORTools, _Search
from waybound.solvers.engines.routing.ortools_model import short_ways
from waybound.solvers.engines.routing.routing_integers import integer_routing


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
    data = short_ways(problem, integer_routing(problem))
    assert data.unit.all() and int(data.prize[1:].min()) > 2 * 39 * int(data.moves[0].distance.max())
    assert data.prize / data.cost_factor == pytest.approx(problem.sites.reward)
    costly = replace(problem, objective=Reward().then(TotalCost()))
    priced = integer_routing(costly)
    assert short_ways(costly, priced) is priced


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
