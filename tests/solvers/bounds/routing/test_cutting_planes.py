from dataclasses import replace

import numpy as np
import pytest
from small_routing import plane, small, varied
from truth.routing import best_values

from waybound import Reward, RoutingProblem, Sites, Travel, VehicleType
from waybound.formulations.stop import NEVER, Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.travel import EXPLICIT
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.cutting_planes import cutting_planes_bound


def tour(seed, sites, limit):
    """A tour of limited length through some of the sites in a square; each visit takes a while too."""
    rng = np.random.default_rng(seed)
    xy = rng.integers(0, 100, (sites, 2)).astype(float)
    free = Sites.of(range(sites), reward=rng.integers(1, 50, sites).astype(float), required=[False] * sites, service=1.0, coordinates=xy)
    return RoutingProblem(free, Travel("euclidean", xy, convention="round"), (VehicleType(count=1, max_duration=limit),), Reward())


@pytest.mark.parametrize("feature", ["reward", "prizes", "penalties", "groups", "skills", "reloads"])
def test_the_checker_derives_what_it_finds_and_no_optimum_is_excluded(feature):
    found = 0
    for seed in range(3):
        problem = varied(feature, seed, 3) if feature in ("penalties", "groups", "skills", "reloads") else small(feature, seed, "round")
        if BOUNDS["cutting-planes"].missing(problem):
            problem = replace(problem, objective=Reward())
        best, evidence = best_values(problem), cutting_planes_bound(problem)
        if best is None or evidence is None:
            continue
        bound, sign = verified_bound(problem, evidence), 1.0 if problem.sense == "min" else -1.0
        assert sign * bound <= sign * float(best[0]) + 1e-7
        found += 1
    assert found


def test_a_tour_is_bounded_closely_and_what_is_found_is_what_is_checked():
    problem = tour(1, 40, 300.0)
    evidence = cutting_planes_bound(problem, NEVER)
    assert evidence is not None and evidence.data["cuts"]
    bound = verified_bound(problem, evidence)
    assert bound == np.floor(evidence.value + 1e-6)
    assert bound < 0.95 * verified_bound(problem, BOUNDS["knapsack"].compute(problem, NEVER))


def test_edges_beyond_the_nearest_count():
    # Two rings far from each other: the nearest edges of each node stay within its ring.
    angle = np.linspace(0.0, 2.0 * np.pi, 13)[:-1]
    ring = 10.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    xy = np.rint(np.concatenate([ring, ring + np.array([500.0, 0.0])]))
    sites = Sites.of(range(24), reward=1.0, required=[False] * 24, coordinates=xy)
    problem = RoutingProblem(sites, Travel("euclidean", xy, convention="round"), (VehicleType(count=1, max_distance=5000.0),), Reward())
    evidence = cutting_planes_bound(problem)
    assert evidence is not None and verified_bound(problem, evidence) == 24.0


def test_one_way_streets_are_taken():
    rng = np.random.default_rng(3)
    matrix = rng.integers(1, 40, (8, 8)).astype(float)
    matrix[rng.random((8, 8)) < 0.2] = 500.0
    np.fill_diagonal(matrix, 0.0)
    sites = Sites.of(range(8), reward=rng.integers(1, 9, 8).astype(float), required=[False] * 8)
    fleet = (VehicleType(count=1, max_distance=35.0),)
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix), fleet, Reward())
    best, evidence = best_values(problem), cutting_planes_bound(problem)
    assert float(best[0]) - 1e-9 <= verified_bound(problem, evidence) < sites.reward.sum()


def test_loads_are_cut_where_they_take_more_vehicles():
    problem = plane(3, 6, 12.0)
    best, evidence = best_values(problem), cutting_planes_bound(problem)
    assert 0.95 * float(best[0]) <= verified_bound(problem, evidence) <= float(best[0]) + 1e-9


def test_it_stops_and_leaves_windows_to_others():
    assert cutting_planes_bound(tour(1, 60, 300.0), Stop(0.0)) is None
    evidence = cutting_planes_bound(tour(1, 60, 300.0), NEVER.within(0.05))
    assert evidence is None or verified_bound(tour(1, 60, 300.0), evidence) > 0
    assert BOUNDS["cutting-planes"].missing(small("time-windows", 1, "round"))
