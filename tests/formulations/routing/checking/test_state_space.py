"""State-space bounds never exclude the optimum, whatever the prices, the resource and the step, and reach it where walks are routes."""

import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import FEATURES, WHOLE_FAMILY, drawn, enumerated, excludes, plane

from waybound import InputError, Makespan, Objective, Reward, RoutingProblem, Sites, TotalCost, Vehicles, VehicleType
from waybound.formulations.routing.checking import state_space
from waybound.formulations.routing.checking.state_space import COUNTED, check_state_space
from waybound.instances.routing.travel import EXPLICIT, Travel


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", [*WHOLE_FAMILY, *FEATURES])
def test_no_prices_however_wrong_exclude_the_optimum(feature):
    judged = 0
    for seed in range(3):
        problem, rng = drawn(feature, seed), np.random.default_rng(seed)
        for scale in (0.0, 2.0, 8.0, 30.0):
            for resource in COUNTED:
                step, shares = float(rng.choice([0.37, 1.0, 3.0])), {name: float(rng.uniform(-0.2, 0.5)) for name in ("load", "distance")}
                prices = (scale * rng.normal(0.5, 1.0, len(problem.sites))).tolist()
                bound = check_state_space(problem, {"prices": prices, "resource": resource, "step": step, "shares": shares})
                assert not math.isnan(bound) and not excludes(problem, bound)
                judged += math.isfinite(bound) and enumerated(problem) is not None
    assert judged


def line(loads, capacity, objective=None, **fleet):
    places = np.arange(len(loads) + 1.0)
    sites = Sites.of(range(len(places)), demand=[0, *loads], reward=[5, *[3] * len(loads)])
    travel = Travel(EXPLICIT, matrix=np.abs(places[:, None] - places))
    return RoutingProblem(sites, travel, (VehicleType(capacity=capacity, **fleet),), objective)


def test_a_first_site_at_the_place_of_the_depot_delays_no_route():
    travel = Travel(EXPLICIT, matrix=np.abs(np.subtract.outer([0.0, 0, 1], [0.0, 0, 1])))
    problem = RoutingProblem(Sites.of("oab", due=[2.0, 0.0, 2.0]), travel, (VehicleType(fixed_cost=10.0),))  # one route: o a b o
    assert check_state_space(problem, {"prices": [0, 10, 12], "resource": "time", "step": 1.0}) <= 12.0


def test_prices_of_the_optimum_prove_it():
    problem = line([1, 1, 1, 1], 2.0)  # 4 and 3, 2 and 1: 8 + 4
    shares = {"prices": [0, 1, 3, 3, 5], "resource": "load", "step": 1.0}
    assert check_state_space(problem, shares) == 12.0
    assert check_state_space(problem, shares | {"step": 2.0}) < 12.0  # a load of 1 counts as none, then, and concedes a step


def test_rewards_of_depots_and_the_grain_count():
    problem = line([0, 0, 0], math.inf, Objective.of(Reward()), count=1, max_distance=4.0)
    problem = replace(problem, sites=replace(problem.sites, required=np.zeros(4, dtype=bool)))
    # The third site is too far, and 1-2-1 is no walk.
    assert check_state_space(problem, {"prices": [0, 0, 0, 0], "resource": "distance", "step": 1.0}) == 11.0
    assert check_state_space(problem, {"prices": [0, -0.4, 0, 0], "resource": "distance", "step": 1.5}) == 11.0


def test_the_price_of_another_limit_counts():
    problem = line([1, 1, 1, 1], 2.0)
    free = {"prices": [0, 1, 3, 3, 5], "resource": "order", "step": 1.0}
    assert check_state_space(problem, free) < check_state_space(problem, free | {"shares": {"load": 1.0}}) <= 12.0


def test_maxima_count_by_the_farthest_round_trip():
    problem = line([1, 1, 1], 3.0, Objective.of(Vehicles() + 2.0 * Makespan()))
    assert check_state_space(problem, {"prices": [0] * 4, "resource": "load", "step": 1.0}) == pytest.approx(13.0)


def test_more_of_a_cost_is_bounded_by_nothing():
    problem = line([1, 1], 2.0, Objective.of(Reward() + TotalCost()))
    assert check_state_space(problem, {"prices": [0] * 3, "resource": "load", "step": 1.0}) == math.inf


def test_too_many_steps_prove_nothing(monkeypatch):
    problem = plane(1, 6, 20.0)
    data = {"prices": [0.0] * 7, "resource": "load", "step": 1.0}
    assert check_state_space(problem, data) > -math.inf
    assert check_state_space(problem, data | {"step": 1e-4}) == -math.inf
    monkeypatch.setattr(state_space, "WORK", 10)
    assert check_state_space(problem, data) == -math.inf


def test_a_walk_does_not_return_straight_to_where_it_came_from():
    # Between the two far customers there is a gain each way: i-j-i would repeat it.
    matrix = np.array([[0, 10, 10], [10, 0, 1], [10, 1, 0]], dtype=float)
    problem = RoutingProblem(Sites.of("abc"), Travel(EXPLICIT, matrix=matrix), (VehicleType(count=1),))
    assert check_state_space(problem, {"prices": [0, 10.5, 10.5], "resource": "order", "step": 1.0}) == 21.0


@pytest.mark.parametrize(
    "wrong", [{"prices": [0.0]}, {"resource": "colour"}, {"step": 0.0}, {"step": math.nan}, {"shares": [1]}, {"shares": {"colour": 1.0}}]
)
def test_malformed_evidence_is_refused(wrong):
    with pytest.raises(InputError):
        check_state_space(line([1, 1], 2.0), {"prices": [0.0] * 3, "resource": "load", "step": 1.0} | wrong)
