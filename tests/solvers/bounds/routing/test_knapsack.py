import numpy as np
from small_routing import small

from waybound import Evidence
from waybound.formulations.routing.checking.knapsack import check_knapsack
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.knapsack import knapsack_bound


def test_no_other_price_proves_more():
    for seed in range(4):
        problem = small("reward", seed, "round")
        evidence = knapsack_bound(problem)
        best = min(check_knapsack(problem, {"resource": "distance", "rate": float(rate)}) for rate in np.linspace(0.0, 5.0, 101))
        assert verified_bound(problem, evidence) == evidence.value <= best + 1e-9
        everything = verified_bound(problem, Evidence("knapsack", "", 0.0, {"resource": "time", "rate": 0.0}))
        assert evidence.value <= everything == problem.sites.reward.sum()


def test_objectives_without_rewards_are_left_to_others():
    assert BOUNDS["knapsack"].missing(small("capacity", 1, "round"))
    assert not BOUNDS["knapsack"].missing(small("prizes", 1, "round"))
