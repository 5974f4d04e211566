from dataclasses import replace

import hostile_instances
import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from small_routing import context

import waybound as wb
from waybound import Routes, RoutingProblem, Sites, TotalCost, Travel, Vehicles, VehicleType
from waybound.heuristics.heuristic import HEURISTICS
from waybound.reports.ratios.judged_runs import run_heuristic

CONTEXT = context()
LINE = Travel("euclidean", np.column_stack([[0.0, 10, 8, -3, 1], np.zeros(5)]))


@settings(max_examples=draws(150), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 8))
def test_answers_are_feasible_wherever_everybody_can_be_served_alone(seed: int, n: int) -> None:
    problem = hostile_instances.routing(np.random.default_rng(seed), hostile_instances.Units(), most=n, plain=True)
    problem = replace(problem, fleet=(replace(problem.fleet[0], count=None),))
    alone = problem.evaluate(Routes.of([[k] for k in problem.customers.tolist()]))
    judged = problem.evaluate(run_heuristic(problem, "insertion", {}, seed).answer)
    assert judged.feasible or not alone.feasible, judged.violations
    every = [v for v in judged.violations if v.check == "visits"]
    assert not every


def test_it_begins_with_the_farthest_and_fills_the_route() -> None:
    problem = RoutingProblem(Sites.of(range(5), demand=[0, 1, 1, 1, 1]), LINE, (VehicleType(capacity=3),))
    found = run_heuristic(problem, "insertion", {"mu": 1, "lamda": 2, "alpha1": 1}, 1)
    # 1 first; c2 = 2 d_0u - c1: site 2 has 16 - 0, site 3 has 6 - 6, site 4 has 2 - 0; then 4 has 2 and 3 has 0
    assert {frozenset(route.visits) for route in found.answer} == {frozenset({1, 2, 4}), frozenset({3})}


def test_with_a_weight_on_delays_the_place_of_the_least_delay_is_taken() -> None:
    sites = Sites.of(range(4), ready=[0, 0, 30, 0], due=[999, 999, 99, 999])
    travel = Travel("euclidean", np.array([(0.0, 0), (10, 0), (10, 1), (0, 9)]))
    problem = RoutingProblem(sites, travel, (VehicleType(),))
    found = run_heuristic(problem, "insertion", {"mu": 1, "lamda": 2, "alpha1": 0, "seeds": "earliest-due"}, 1)
    assert len(found.answer) == 1
    order = found.answer.routes[0].visits
    assert order.index(2) == 2  # whoever opens late delays nobody at the end


@pytest.mark.parametrize("seeds", ["farthest", "earliest-due"])
def test_a_solomon_file_is_served_within_its_fleet(seeds: str) -> None:
    problem = wb.read("demo-rc50")
    assert problem.evaluate(run_heuristic(problem, "insertion", {"seeds": seeds}, 1).answer).feasible


def test_the_best_of_all_settings_is_kept_under_the_objective() -> None:
    fewest = replace(wb.read("demo-rc50"), objective=Vehicles().then(TotalCost()))
    runs = [
        fewest.evaluate(run_heuristic(fewest, "insertion", {"lamda": lamda, "alpha1": a, "seeds": s}, 1).answer).values
        for lamda in (1, 2) for a in (0, 1) for s in ("farthest", "earliest-due")
    ]  # fmt: skip
    found = run_heuristic(fewest, "insertion", {}, 1)
    assert fewest.evaluate(found.answer).values == min(runs)
    assert found.statistics["seeds"] in ("farthest", "earliest-due")


def test_limits_are_kept() -> None:
    problem = RoutingProblem(Sites.of(range(5), service=[0, 1, 1, 1, 1]), LINE, (VehicleType(max_duration=23.0),))
    judged = problem.evaluate(run_heuristic(problem, "insertion", {}, 1).answer)
    assert judged.feasible and judged.quantities["vehicles"] == 2


def test_cut_short_the_rest_go_alone() -> None:
    rng = np.random.default_rng(1)
    problem = RoutingProblem(Sites.of(range(300)), Travel("EUC_2D", rng.integers(0, 1000, (300, 2))), (VehicleType(),))
    published: list[Routes] = []
    found = HEURISTICS["insertion"].run(problem, replace(CONTEXT, time_limit=1e-9, publish=published.append))
    assert problem.evaluate(found.answer).feasible and found.limit == "time"
