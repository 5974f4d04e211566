"""The relaxation holds every answer: its arcs, its costs, its numbers of routes."""

from __future__ import annotations

import itertools
import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from waybound.formulations.checking.relaxation import relax
from waybound.formulations.problems.routing import RoutingProblem
from waybound.formulations.routes import Route, Routes
from waybound.formulations.tolerance import LIMIT
from waybound.instances.instance import Sites, VehicleType
from waybound.instances.travel import EXPLICIT, Travel


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_every_feasible_answer_is_in_the_relaxation_at_no_greater_cost(random_problem, seed):
    problem = random_problem(seed)
    relaxed = relax(problem)
    assert relaxed is not None
    node = {int(site): k for k, site in enumerate(relaxed.customers, start=1)}
    rng = np.random.default_rng(seed)
    for _ in range(60):
        order = rng.permutation(problem.customers).tolist()
        cuts = sorted(set(rng.integers(1, len(order) + 1, 3).tolist()) | {len(order)})
        routes = [Route(tuple(order[a:b]), int(rng.integers(len(problem.fleet)))) for a, b in zip([0, *cuts], cuts, strict=False)]
        verdict = problem.evaluate(Routes(tuple(r for r in routes if r.visits)))
        if not verdict.feasible:
            continue
        driven = [r for r in routes if r.visits]
        assert relaxed.fewest <= len(driven) <= relaxed.most
        stops = [[0, *(node[i] for i in r.visits), 0] for r in driven]
        cost = math.fsum(float(relaxed.cost[i, j]) for s in stops for i, j in itertools.pairwise(s))
        assert cost <= verdict.values[0] + 1e-9
        if relaxed.grain is not None:
            grains = verdict.values[0] / relaxed.grain.size
            assert abs(grains - round(grains)) < 1e-6


def test_windows_shut_out_arcs_that_no_route_can_use():
    sites = Sites.of("oab", ready=[0, 0, 30], due=[100, 10, 40])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.full((3, 3), 5.0)), (VehicleType(),))
    cost = relax(problem).cost
    assert math.isfinite(cost[1, 2])
    assert math.isinf(cost[2, 1])


def test_loads_that_do_not_fit_together_shut_out_arcs():
    problem = RoutingProblem(Sites.of("oabc", demand=[0, 3, 3, 1]), Travel(EXPLICIT, matrix=np.ones((4, 4))), (VehicleType(capacity=4),))
    cost = relax(problem).cost
    assert math.isinf(cost[1, 2])
    assert math.isinf(cost[2, 1])
    assert math.isfinite(cost[1, 3])


def test_total_demand_sets_the_fewest_routes():
    problem = RoutingProblem(
        Sites.of("oabc", demand=[0, 3, 3, 3]), Travel(EXPLICIT, matrix=np.ones((4, 4))), (VehicleType(capacity=5, count=9),)
    )
    relaxed = relax(problem)
    assert (relaxed.fewest, relaxed.most) == (2, 3)


def test_a_late_arrival_within_the_tolerance_of_the_check_keeps_its_arc():
    matrix = np.array([[0, 10.0], [10.0, 0]])
    problem = RoutingProblem(Sites.of("oa", due=[100, 10 * (1 - 0.9 * LIMIT)]), Travel(EXPLICIT, matrix=matrix), (VehicleType(),))
    assert problem.evaluate(Routes.of([[1]])).feasible
    assert math.isfinite(relax(problem).cost[0, 1])
