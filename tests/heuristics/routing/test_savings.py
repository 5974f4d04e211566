import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from small_routing import context

from waybound import Objective, Routes, RoutingProblem, Sites, TotalCost, Travel, UsageError, Vehicles, VehicleType
from waybound.heuristics.heuristic import HEURISTICS
from waybound.heuristics.routing.savings import SLOW_TO_BEGIN
from waybound.instances.routing.travel import EXPLICIT

CONTEXT = context()


def run(problem: RoutingProblem, **parameters: float) -> Routes:
    answer = HEURISTICS["savings"].run(problem, CONTEXT, **parameters).answer
    assert isinstance(answer, Routes)
    return answer


def problem_of(rng: np.random.Generator, n: int, *, windows: bool, limit: bool) -> RoutingProblem:
    xy = rng.uniform(0, 100, (n + 1, 2))
    opens = rng.uniform(150, 300, n + 1) if windows else np.zeros(n + 1)
    opens[0] = 0
    due = opens + rng.uniform(5, 100, n + 1) if windows else np.full(n + 1, math.inf)
    due[0] = math.inf
    sites = Sites.of(range(n + 1), demand=np.r_[0, rng.integers(1, 10, n)], ready=opens, due=due, service=np.r_[0.0, np.full(n, 3.0)])
    travel = Travel("euclidean", coordinates=xy)
    longest = 2 * float(travel.distances.max()) + 4
    vehicle = VehicleType(capacity=25, max_duration=longest if limit else math.inf, max_distance=longest if limit else math.inf)
    return RoutingProblem(sites, travel, (vehicle,))


@settings(max_examples=draws(40), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 25), st.booleans(), st.booleans())
def test_answers_are_feasible_and_no_worse_than_one_route_a_customer(seed: int, n: int, windows: bool, limit: bool) -> None:
    problem = problem_of(np.random.default_rng(seed), n, windows=windows, limit=limit)
    single = problem.evaluate(Routes.of([[i] for i in range(1, n + 1)]))
    judged = problem.evaluate(run(problem))
    assert judged.feasible, judged.violations
    assert judged.values[0] <= single.values[0] + 1e-9


def test_routes_are_joined_at_either_end_only_without_windows() -> None:
    xy = np.array([(0, 0), (10, 1), (10, 0), (10, -1)], dtype=float)
    free = RoutingProblem(Sites.of(range(4)), Travel("euclidean", coordinates=xy), (VehicleType(),))
    assert len(run(free)) == 1
    ordered = Sites.of(range(4), ready=[0, 30, 20, 0], due=[math.inf, 40, 25, 15])
    assert run(RoutingProblem(ordered, free.travel, free.fleet)) == Routes.of([[3, 2, 1]])


def test_a_vehicles_fixed_cost_makes_joining_worth_more() -> None:
    xy = np.array([(0, 0), (1, 0), (-1, 0)], dtype=float)
    travel = Travel("euclidean", coordinates=xy)
    assert len(run(RoutingProblem(Sites.of(range(3)), travel, (VehicleType(),)))) == 2
    assert len(run(RoutingProblem(Sites.of(range(3)), travel, (VehicleType(fixed_cost=1.0),)))) == 1


def test_scaling_all_distances_leaves_the_routes() -> None:
    problem = problem_of(np.random.default_rng(5), 20, windows=False, limit=False)
    assert problem.travel.coordinates is not None
    scaled = RoutingProblem(problem.sites, Travel("euclidean", coordinates=4 * problem.travel.coordinates), problem.fleet)
    assert run(scaled) == run(problem)


def test_routes_are_joined_at_a_loss_while_the_fleet_is_too_small() -> None:
    xy = np.array([(0, 0), (1, 0), (-1, 0)], dtype=float)
    pair = RoutingProblem(Sites.of(range(3)), Travel("euclidean", coordinates=xy), (VehicleType(count=1),))
    assert len(run(pair)) == 1


def test_a_fleet_too_small_is_said() -> None:
    problem = problem_of(np.random.default_rng(5), 20, windows=True, limit=False)
    tight = RoutingProblem(problem.sites, problem.travel, (VehicleType(count=1, capacity=25),))
    assert "for a fleet of 1" in HEURISTICS["savings"].run(tight, CONTEXT).message


# -- large instances, and being cut short ------------------------------------------------------------------------------


def scattered(n: int, seed: int = 1, matrix: bool = False, **fleet: Any) -> RoutingProblem:
    rng = np.random.default_rng(seed)
    sites = Sites.of(range(n), demand=np.concatenate([[0], rng.integers(1, 10, n - 1)]))
    travel = Travel("EUC_2D", rng.integers(0, 1000, (n, 2)))
    return RoutingProblem(sites, Travel(EXPLICIT, matrix=travel.distances) if matrix else travel, (VehicleType(**fleet),))


@pytest.mark.parametrize("matrix", [False, True])
@pytest.mark.parametrize("fleet", [{"count": 1}, {"capacity": 40.0}, {"max_distance": 4000.0}, {"capacity": 40.0, "count": 80}])
def test_joins_of_near_sites_are_nearly_as_good_as_all(fleet: dict[str, Any], matrix: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = scattered(500, matrix=matrix, **fleet)
    plain = HEURISTICS["savings"].run(problem, CONTEXT)
    monkeypatch.setattr("waybound.heuristics.routing.savings.ALL_PAIRS", 100)
    monkeypatch.setattr("waybound.heuristics.routing.savings.NEIGHBOURS", 20)
    near = HEURISTICS["savings"].run(problem, CONTEXT)
    judged = problem.evaluate(near.answer)
    assert judged.feasible
    assert judged.values[0] <= 1.02 * problem.evaluate(plain.answer).values[0]
    assert "20 nearest" in near.message and "nearest" not in plain.message


def test_many_sites_need_no_matrix(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = scattered(5_000, capacity=200.0)
    monkeypatch.setattr(Travel, "distances", property(lambda self: pytest.fail("all distances")))
    outcome = HEURISTICS["savings"].run(problem, CONTEXT)
    assert problem.evaluate(outcome.answer).feasible
    assert 100 < len(outcome.answer) < 200


def test_more_sites_than_there_is_memory_for_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("waybound.instances.memory.available", lambda: 1e6)
    with pytest.raises(UsageError, match=r"savings for 2,500 sites needs 14 MiB, more than there is"):
        HEURISTICS["savings"].run(scattered(2_500), CONTEXT)


@pytest.mark.share(2)
@pytest.mark.parametrize("n", [300, 3_000])
def test_cut_short_it_has_joined_fewer_routes(n: int) -> None:
    problem = scattered(n, capacity=100.0)
    outcome = HEURISTICS["savings"].run(problem, replace(CONTEXT, time_limit=0.0))
    assert problem.evaluate(outcome.answer).feasible
    assert outcome.limit == "time" and "routes were left" in outcome.message


def test_cut_short_a_lone_vehicle_still_drives_a_tour() -> None:
    problem = scattered(3_000, count=1)
    outcome = HEURISTICS["savings"].run(problem, replace(CONTEXT, time_limit=0.0))
    assert problem.evaluate(outcome.answer).feasible
    assert len(outcome.answer) == 1 and outcome.limit == "time"


def test_the_routes_are_those_of_least_cost_whatever_is_counted_and_open_large_problems() -> None:
    problem = scattered(40, capacity=40.0)
    plain = HEURISTICS["savings"].run(problem, CONTEXT).answer
    for objective in (Vehicles().then(TotalCost()), 2.0 * Vehicles() + TotalCost()):
        asked = replace(problem, objective=Objective.of(objective))
        assert not HEURISTICS["savings"].missing(asked)
        assert HEURISTICS["savings"].run(asked, CONTEXT).answer == plain
    assert not HEURISTICS["savings"].opens(problem) and HEURISTICS["savings"].opens(scattered(SLOW_TO_BEGIN + 1))
