"""All routes of a few customers prove the optimum, whatever the fleet and the objective; the truth is another enumeration's."""

from __future__ import annotations

import math

import numpy as np
import pytest
from small_routing import few, small, varied
from truth.routing import best_values

from waybound.formulations.evidence import CHECKERS
from waybound.formulations.routing.checking import all_routes
from waybound.formulations.routing.checking.all_routes import check_all_routes, orders
from waybound.formulations.routing.objective import LatestReturn, LongestRoute, Makespan, TotalCost
from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.errors import InputError
from waybound.instances.routing.instance import Energy, Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel

FEATURES = (
    "capacity", "time-windows", "depot-windows", "service-times", "max-duration", "max-distance", "travel", "elapsed",
    "elapsed-fixed-start", "windows", "limited-fleet", "heterogeneous-fleet", "fixed-cost", "multiple-depots", "open-routes",
    "separate-durations", "vehicles", "prizes", "reward", "reward-then-cost",
)  # fmt: skip


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", FEATURES)
@pytest.mark.parametrize("convention", ["exact", "round"])
def test_the_optimum_of_the_first_level_is_proved(feature: str, convention: str) -> None:
    for seed in range(3):
        problem = small(feature, seed, convention)
        best, bound = best_values(problem), check_all_routes(problem, {})
        if best is None:
            assert bound == (math.inf if problem.sense == "min" else -math.inf)
        else:
            assert bound == pytest.approx(float(best[0]), rel=1e-11)
            assert bound <= best[0] + 1e-12 * abs(best[0]) if problem.sense == "min" else bound >= best[0] - 1e-12 * abs(best[0])


@pytest.mark.share(4)
@pytest.mark.parametrize("term", [LongestRoute(), Makespan(), 3.0 * Makespan()])
@pytest.mark.parametrize("feature", ["time-windows", "heterogeneous-fleet", "elapsed", "limited-fleet"])
def test_the_largest_of_all_routes_is_proved(feature: str, term) -> None:
    for seed in range(3):
        problem = replace_objective(small(feature, seed, "exact"), term)
        best = best_values(problem)
        if best is not None:
            assert check_all_routes(problem, {}) == pytest.approx(float(best[0]), rel=1e-9)


@pytest.mark.parametrize("term", [LongestRoute(), TotalCost(), LatestReturn()])
@pytest.mark.parametrize("feature", ["vehicle-travel", "vehicle-speeds", "skills", "committed-vehicles"])
def test_vehicles_of_their_own_kind_are_never_bounded_beyond_the_optimum(feature: str, term) -> None:
    for seed in range(8):
        problem = replace_objective(varied(feature, seed, few(feature)), term)
        best = best_values(problem)
        assert best is None or check_all_routes(problem, {}) <= best[0] * (1.0 + 1e-12)


def replace_objective(problem: RoutingProblem, objective) -> RoutingProblem:
    return RoutingProblem(problem.sites, problem.travel, problem.fleet, objective)


LIMITED = (
    {"max_duration": 18.0}, {"energy": Energy(36.0, 2.0, "elapsed")}, {"energy": Energy(17.0)}, {"max_duration": 9.0, "speed": 2.0},
)  # fmt: skip


def at_risk(risk: float | None, team_risk: float | None, **limits) -> RoutingProblem:
    """Three vehicles and customers on a line, with a service of 1 at a speed of 1."""
    line = np.abs(np.subtract.outer(*[np.array([0.0, 4, -5, 6, -7])] * 2))
    sites = Sites.of(range(5), service=np.r_[0.0, np.full(4, 1.0 / limits.get("speed", 1.0))])
    fleet = (VehicleType(3, risk=risk, **limits),)
    return RoutingProblem(sites, Travel(EXPLICIT, matrix=line, variances=line / 4), fleet, team_risk=team_risk)


@pytest.mark.parametrize("limits", LIMITED)
def test_risks_of_routes_and_of_the_team_are_taken_up(limits) -> None:
    for risk in (0.3, 0.15, 0.06, 0.05, 1e-3):
        for problem in (at_risk(risk, None, **limits), at_risk(None, risk, **limits)):
            best = best_values(problem)
            assert check_all_routes(problem, {}) == (math.inf if best is None else pytest.approx(float(best[0])))


def test_risks_among_other_features_are_never_bounded_beyond_the_optimum() -> None:
    for feature in ("route-risk", "team-risk"):
        for seed in range(12):
            problem = varied(feature, seed, few(feature))
            best, bound = best_values(problem), check_all_routes(problem, {})
            if best is not None:
                slack = 1e-12 * abs(best[0])
                assert bound <= best[0] + slack if problem.sense == "min" else bound >= best[0] - slack


def test_routes_asked_for_and_moves_forbidden_count() -> None:
    line = np.abs(np.subtract.outer([0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 2.0, 3.0]))
    asked = {"sites": Sites.of("oabc"), "travel": Travel(EXPLICIT, matrix=line), "fleet": (VehicleType(),)}
    assert check_all_routes(RoutingProblem(**asked), {}) == pytest.approx(6.0)
    assert check_all_routes(RoutingProblem(**asked, min_vehicles=2), {}) == pytest.approx(8.0)
    assert check_all_routes(RoutingProblem(**asked, min_vehicles=4), {}) == math.inf
    forbidden = np.zeros((4, 4), dtype=bool)
    forbidden[3, 0] = forbidden[0, 3] = True
    assert check_all_routes(RoutingProblem(**asked, forbidden=forbidden), {}) == pytest.approx(6.0)
    forbidden[[1, 2], 0] = True
    assert check_all_routes(RoutingProblem(**asked, forbidden=forbidden), {}) == math.inf


def test_many_customers_and_mixtures_with_the_largest_route_prove_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = small("capacity", 0, "exact")
    assert orders(problem) == 5 + 20 + 60 + 120 + 120
    assert check_all_routes(replace_objective(problem, TotalCost() + Makespan()), {}) == -math.inf
    monkeypatch.setattr(all_routes, "MOST_ORDERS", 300)
    monkeypatch.setattr(all_routes, "MOST", 4)  # of customers, for all sets of them
    assert check_all_routes(problem, {}) == -math.inf
    assert orders(RoutingProblem(Sites.of(range(12)), Travel(EXPLICIT, matrix=np.ones((12, 12))), (VehicleType(),))) == math.inf


def test_other_families_are_refused() -> None:
    class Other:
        family = "arrays"

    with pytest.raises(InputError, match="routing"):
        CHECKERS["all-routes"](Other(), {})
