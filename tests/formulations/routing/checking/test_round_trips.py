"""Round trips bound makespan, longest route and latest return, along shortest ways."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import WHOLE_FAMILY, few, varied
from truth.routing import best_values

from waybound.formulations.routing.checking.round_trips import check_farthest_round_trip
from waybound.formulations.routing.objective import LatestReturn, LongestRoute, Makespan, Objective, TotalCost
from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel

TERMS = {"makespan": Makespan(), "longest-route": LongestRoute(), "latest-return": LatestReturn()}


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_no_bound_exceeds_the_optimum(feature):
    for seed in range(2):
        problem = varied(feature, seed, few(feature))
        for term in TERMS.values():
            asked = replace(problem, objective=Objective.of(term))
            best = best_values(asked)
            if best is not None:
                assert check_farthest_round_trip(asked, {}) <= float(best[0]) * (1 + 1e-12)


@pytest.mark.parametrize(("term", "least"), [("makespan", 11.0), ("longest-route", 8.0), ("latest-return", 27.0)])
def test_ways_lead_over_other_sites_with_their_services_and_windows(term, least):
    matrix = np.array([[0, 2, 50], [2, 0, 2], [50, 2, 0]], dtype=float)
    sites = Sites.of("abc", service=[0, 1, 1], ready=[4, 0, 22])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix), (VehicleType(),), TERMS[term])
    assert check_farthest_round_trip(problem, {}) == pytest.approx(least + (1.0 if term == "latest-return" else 0.0))


def test_sites_that_may_be_left_out_and_other_objectives_prove_nothing():
    sites = Sites.of("abc", required=[False, False, False], ready=[4, 0, 0])
    travel = Travel(EXPLICIT, matrix=np.ones((3, 3)) - np.eye(3))
    problem = RoutingProblem(sites, travel, (VehicleType(),), Makespan())
    assert check_farthest_round_trip(problem, {}) == 0.0
    assert check_farthest_round_trip(replace(problem, objective=Objective.of(LatestReturn())), {}) == pytest.approx(4.0)
    assert check_farthest_round_trip(replace(problem, objective=Objective.of(TotalCost())), {}) == -math.inf
    assert check_farthest_round_trip(replace(problem, objective=Objective.of(Makespan() - LongestRoute())), {}) == -math.inf
