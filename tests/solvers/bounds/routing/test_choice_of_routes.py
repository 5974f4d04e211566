from dataclasses import replace

import numpy as np
import pytest
from small_routing import plane

from waybound import Objective, RoutingProblem, VehicleType
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.choice_of_routes import choice_of_routes_bound, lacks_one_peak, lacks_routes, largest_route_bound
from waybound.solvers.linear_programs import LinearPrograms


def spread(objective: str) -> RoutingProblem:
    return replace(plane(5, 6, 100.0, 2), objective=Objective.of(objective))


def test_what_limits_cannot_take_the_place_of_is_named() -> None:
    problem = spread("longest-route")
    assert not lacks_one_peak(problem)
    assert lacks_one_peak(replace(problem, objective=Objective.of("makespan + longest-route"))) == {
        "objective:makespan",
        "objective:longest-route",
    }
    assert lacks_one_peak(replace(problem, objective=Objective.of("-1*makespan"))) == {"objective:makespan"}
    variances = np.full((7, 7), 0.01)
    risky = replace(
        problem, travel=Travel(EXPLICIT, matrix=problem.travel.distances, variances=variances),
        fleet=(VehicleType(2, max_duration=1e4, risk=0.1),),
    )  # fmt: skip
    assert not lacks_one_peak(risky)
    assert lacks_one_peak(replace(risky, objective=Objective.of("makespan"))) == {"route-risk"}
    assert lacks_routes(spread("total-cost + makespan")) == {"objective:total-cost", "objective:makespan"}
    assert not lacks_routes(spread("total-cost")) and not lacks_routes(spread("makespan then total-cost"))


@pytest.mark.parametrize("objective", ["longest-route", "longest-route then total-cost", "total-cost"])
def test_the_first_level_decides(objective: str) -> None:
    problem = spread(objective)
    evidence = choice_of_routes_bound(problem, Stop(60.0))
    limited = evidence.kind == "branching-tree" and "term" in evidence.data["nodes"][0]["branch"]
    assert limited is (objective != "total-cost")
    best = 205.0 if limited else verified_bound(problem, evidence)
    again = BOUNDS["branch-price-cut"].evidence(problem, Stop(60.0), LinearPrograms(), best)
    assert again is not None and verified_bound(problem, again) == pytest.approx(best)


def test_nothing_is_searched_for_without_time_or_customers_in_reach() -> None:
    assert largest_route_bound(spread("makespan"), Stop(0.0)) is None
