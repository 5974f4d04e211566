"""Sets of customers never prove more than is true, and all of it where what counts adds up along routes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import FEATURES, WHOLE_FAMILY, few, small, varied
from truth.routing import best_values

import waybound as wb
from waybound.formulations.evidence import Evidence
from waybound.formulations.routing.checking import all_routes
from waybound.formulations.routing.checking.all_routes import MOST_ORDERS, check_all_routes, orders
from waybound.formulations.routing.checking.route_sets import put_together
from waybound.formulations.routing.objective import Objective, TotalCost, TotalDuration, Vehicles
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.stop import Stop, until
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel

ADDS_UP = ("capacity", "max-distance", "travel", "limited-fleet", "heterogeneous-fleet", "fixed-cost", "multiple-depots", "open-routes",
           "separate-durations", "prizes", "reward")  # fmt: skip


@pytest.fixture(autouse=True)
def by_sets(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(all_routes, "MOST_ORDERS", 0)


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", [*FEATURES, *(name for name in WHOLE_FAMILY if name not in FEATURES)])
def test_no_more_is_proved_than_is_true(feature: str) -> None:
    for seed in range(5):
        problem = small(feature, seed, "exact") if feature in FEATURES else varied(feature, seed, few(feature, 4))
        if seed % 2 and problem.sense == "min" and len(problem.senses) == 1:
            goal = (TotalDuration() + 3.0 * Vehicles(), TotalCost() + 0.5 * TotalDuration())[seed % 4 == 1]
            problem = replace(problem, objective=Objective.of(goal))
        best, bound, sign = best_values(problem), check_all_routes(problem, {}), 1.0 if problem.sense == "min" else -1.0
        if best is None:
            continue
        assert sign * bound <= sign * float(best[0]) + 1e-11 * abs(best[0]), (seed, problem)
        if feature in ADDS_UP:
            assert bound == pytest.approx(float(best[0]), rel=1e-9), (seed, problem)


@pytest.mark.parametrize("team", [False, True])
@pytest.mark.parametrize("seed", range(12))
def test_risks_of_routes_and_of_the_team_are_proved(seed: int, team: bool) -> None:
    rng = np.random.default_rng(seed)
    n = 5
    matrix, variances = rng.integers(2, 20, (n, n)).astype(float), rng.integers(0, 30, (n, n)).astype(float)
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(variances, 0.0)
    risk = float(rng.choice([0.02, 0.1, 0.3]))
    vehicle = VehicleType(
        None if seed % 2 else 2, 9.0, max_duration=float(rng.integers(35, 70)), risk=None if team else risk, fixed_cost=4.0
    )
    sites = Sites.of(range(n), demand=[0, *rng.integers(1, 5, n - 1)], service=[0, *rng.integers(0, 3, n - 1)])
    problem = RoutingProblem(
        sites, Travel(EXPLICIT, matrix=matrix, variances=variances), (vehicle,), team_risk=risk if team else None, min_vehicles=seed % 3
    )
    best, bound = best_values(problem), check_all_routes(problem, {})
    assert bound == (math.inf if best is None else pytest.approx(float(best[0]), rel=1e-9))


def test_ten_sites_at_risk_are_proved_optimal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(all_routes, "MOST_ORDERS", MOST_ORDERS)
    rng = np.random.default_rng(5)
    xy = rng.uniform(0, 100, (9, 2))
    far = np.hypot(*(xy[:, None] - xy).transpose(2, 0, 1))
    travel = Travel("euclidean", xy, variances=np.square(0.4 * rng.uniform(0, 1, far.shape) * far))
    for given in ({"risk": 0.05}, {"team_risk": 0.05}):
        vehicle = VehicleType(max_duration=260.0, risk=given.get("risk"))
        problem = RoutingProblem(Sites.of(range(9)), travel, (vehicle,), team_risk=given.get("team_risk"))
        assert orders(problem) > MOST_ORDERS
        found = wb.solve(problem, "highs", form="set-partitioning", bound_time=0)
        assert check_all_routes(problem, {}) == pytest.approx(found.objective, rel=1e-9)


def test_numbers_of_routes_count_where_they_are_limited() -> None:
    def front(*rows: tuple[float, float]) -> np.ndarray:
        return np.array(rows)

    found = [{0b01: front((1.0, 0.0)), 0b10: front((1.0, 0.0)), 0b11: front((5.0, 0.0))}]
    for risk in (math.inf, 1.0):
        assert put_together(found, 2, 0, 2, risk)[0b11, 1] == 2.0, "any number"
        assert put_together(found, 2, 0, 1, risk) == {(0, 0): 0.0, (1, 1): 1.0, (2, 1): 1.0, (3, 1): 5.0}
        assert put_together(found, 2, 2, 2, risk)[0b11, 2] == 2.0
    shared = [{0b01: front((1.0, 0.7), (3.0, 0.2)), 0b10: front((1.0, 0.7))}]
    assert put_together(shared, 2, 0, 2, 1.0)[0b11, 1] == 4.0, "one of them the safer way"


def test_it_gives_up_when_asked() -> None:
    problem = small("capacity", 1, "exact")
    with until(Stop(0.0)):
        assert check_all_routes(problem, {}) == -math.inf
    assert Evidence("all-routes", "", 0.0, {}).kind == "all-routes" and check_all_routes(problem, {}) > 0
