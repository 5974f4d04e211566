import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import WHOLE_FAMILY, drawn, excludes

from waybound import InputError, Makespan, Objective, Penalties, Reward, RoutingProblem, Sites, TotalCost, VehicleType
from waybound.formulations.routing.checking.knapsack import check_knapsack
from waybound.formulations.routing.checking.known_features import RESOURCES
from waybound.instances.routing.travel import EXPLICIT, Travel

GOALS = (Reward(), TotalCost() - Reward(), TotalCost() + Penalties(), Reward() - 0.25 * Makespan())


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", [*WHOLE_FAMILY, "reward", "prizes"])
def test_no_price_excludes_the_optimum(feature):
    for seed in range(2):
        asked = replace(drawn(feature, seed), objective=Objective.of(GOALS[seed % len(GOALS)]))
        for resource in RESOURCES:
            for rate in (-1.0, 0.0, 0.3, 1.0, 7.0):
                bound = check_knapsack(asked, {"resource": resource, "rate": rate})
                assert not math.isnan(bound) and not excludes(asked, bound, 0.0)


def star(rewards, limit, term=None):
    """Each site is 1 from the depot and 2 from the others."""
    n = len(rewards) + 1
    matrix = np.full((n, n), 2.0)
    matrix[0] = matrix[:, 0] = 1.0
    np.fill_diagonal(matrix, 0.0)
    sites = Sites.of(range(n), reward=[7.0, *rewards], required=[False] * n)
    return RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix), (VehicleType(count=1, max_distance=limit),), term or Reward())


def test_each_visit_takes_half_of_its_cheapest_moves():
    # Each takes 1, and of a limit of 4 half of the first and of the last move are gone: the best three. A price of 0 lets all pass.
    problem = star([9.0, 8.0, 5.0, 1.0], 4.0)
    assert check_knapsack(problem, {"resource": "distance", "rate": 5.0}) == 29.0
    assert check_knapsack(problem, {"resource": "distance", "rate": 0.0}) == 30.0
    assert check_knapsack(problem, {"resource": "load", "rate": 5.0}) == math.inf


def test_other_objectives_and_malformed_evidence():
    assert check_knapsack(star([1.0], 4.0, Reward() + TotalCost()), {"resource": "distance", "rate": 1.0}) == math.inf
    for wrong in ({"rate": math.nan}, {"resource": "order"}):
        with pytest.raises(InputError):
            check_knapsack(star([1.0], 4.0), {"resource": "distance", "rate": 1.0} | wrong)
