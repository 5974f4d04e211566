import math

import pytest
from small_routing import FEATURES, WHOLE_FAMILY, plane, small, varied
from truth.routing import best_values

from waybound.formulations.stop import NEVER, Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.state_space import state_space_bound
from waybound.solvers.linear_programs import LinearPrograms

CHEAP = ("farthest-round-trip", "averaged-tour", "knapsack", "vehicles-needed", "cutting-planes", "spanning-tree", "state-space")


def gap(problem, seconds=5.0):
    return verified_bound(problem, state_space_bound(problem, Stop(seconds)))


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", [*WHOLE_FAMILY, *FEATURES])
def test_every_problem_of_the_family_has_a_verified_bound(feature):
    for seed in range(1, 3):
        problem = varied(feature, seed, 3) if feature in WHOLE_FAMILY else small(feature, seed, "round")
        best = best_values(problem)
        if best is None:
            continue
        found = []
        for name in CHEAP:
            method = BOUNDS[name]
            if not method.missing(problem):
                evidence = method.evidence(problem, Stop(60.0), LinearPrograms())
                found += [] if evidence is None else [verified_bound(problem, evidence)]
        sign = 1.0 if problem.sense == "min" else -1.0
        assert any(math.isfinite(bound) for bound in found)
        assert max(sign * bound for bound in found) <= sign * float(best[0]) + 1e-7


def test_loads_are_bounded_closely():
    problem = plane(3, 6, 12.0)
    best = best_values(problem)
    assert 0.93 * float(best[0]) <= gap(problem) <= float(best[0]) + 1e-9


@pytest.mark.parametrize("seed", range(3))
def test_rewards_within_a_range_are_bounded_closely(seed):
    problem = small("reward", seed, "round")
    best = best_values(problem)
    assert float(best[0]) - 1e-9 <= gap(problem) <= 1.1 * float(best[0])


def test_it_stops_and_leaves_time_to_others():
    problem = plane(1, 60, 40.0)
    assert state_space_bound(problem, Stop(0.0)) is None
    evidence = state_space_bound(problem, NEVER.within(0.05))
    assert evidence is None or verified_bound(problem, evidence) > -math.inf
