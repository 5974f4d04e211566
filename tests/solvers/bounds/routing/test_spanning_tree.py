import itertools
import math
import time

import numpy as np
import pytest
from patience import HANG

from waybound import Makespan, RoutingProblem, Sites, Travel, Vehicles, VehicleType
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.travel import EXPLICIT
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.arcs import arc_costs
from waybound.solvers.bounds.routing.spanning_tree import spanning_tree_bound


def plane(seed: int, customers: int, **vehicle) -> RoutingProblem:
    xy = np.random.default_rng(seed).integers(0, 100, (customers + 1, 2)).astype(float)
    demand = [0, *[1] * customers]
    sites = Sites.of(range(customers + 1), demand=demand)
    return RoutingProblem(sites, Travel("euclidean", coordinates=xy), (VehicleType(**vehicle),))


def shortest_tour(problem: RoutingProblem) -> float:
    d = problem.travel.distances
    tours = itertools.permutations(range(1, len(d)))
    return min(float(d[0, t[0]] + sum(d[a, b] for a, b in itertools.pairwise(t)) + d[t[-1], 0]) for t in tours)


@pytest.mark.parametrize("seed", range(8))
def test_one_vehicle_is_bounded_within_a_few_percent_of_the_shortest_tour(seed):
    problem = plane(seed, 7, count=1)
    evidence = spanning_tree_bound(problem, Stop(60.0))
    best = shortest_tour(problem)
    assert 0.95 * best <= verified_bound(problem, evidence) <= best + 1e-9


@pytest.mark.parametrize("vehicle", [{"count": 1}, {"capacity": 5}, {"capacity": 5, "fixed_cost": 30.0, "unit_cost": 2.0}, {}])
def test_the_checker_derives_the_bound_that_the_ascent_claims(vehicle):
    problem = plane(3, 25, **vehicle)
    evidence = spanning_tree_bound(problem, Stop(60.0))
    assert verified_bound(problem, evidence) == pytest.approx(evidence.value, rel=1e-9)


def test_the_ascent_improves_on_a_plain_spanning_tree():
    problem = plane(1, 30, count=1)
    evidence = spanning_tree_bound(problem, Stop(60.0))
    plain = {"multipliers": [0.0] * 31, "depot": 0.0}
    assert evidence.value > 1.05 * verified_bound(problem, type(evidence)("spanning-tree", "", 0.0, plain))


def test_loads_that_need_more_routes_raise_the_bound():
    wide, narrow = plane(2, 20, capacity=20.0), plane(2, 20, capacity=2.0)
    assert arc_costs(narrow).fewest == 10
    assert spanning_tree_bound(narrow, Stop(60.0)).value > 1.2 * spanning_tree_bound(wide, Stop(60.0)).value


def test_several_depots_and_vehicle_types_are_bounded_through_the_merged_fleet():
    rng = np.random.default_rng(5)
    sites = Sites.of(range(12), depot=[True, True] + [False] * 10, demand=[0, 0] + [1] * 10)
    fleet = (VehicleType(capacity=4, start=0, end=0, name="a"), VehicleType(capacity=6, start=1, end=0, fixed_cost=9.0, name="b"))
    problem = RoutingProblem(sites, Travel("euclidean", coordinates=rng.random((12, 2)) * 50), fleet)
    evidence = spanning_tree_bound(problem, Stop(60.0))
    assert verified_bound(problem, evidence) == pytest.approx(evidence.value, rel=1e-9)
    assert evidence.value > 0


def test_sites_that_no_usable_arc_joins_are_reported_as_a_proof():
    sites = Sites.of("oab", due=[50, 5, 50])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.full((3, 3), 10.0)), (VehicleType(),))
    evidence = spanning_tree_bound(problem, Stop(60.0))
    assert evidence.value == math.inf
    assert verified_bound(problem, evidence) == math.inf


def test_a_budget_is_kept_and_none_means_none():
    problem = plane(4, 400, count=1)
    assert spanning_tree_bound(problem, Stop(0.0)) is None
    began = time.perf_counter()
    spanning_tree_bound(problem, Stop(0.2))
    assert time.perf_counter() - began < HANG


def test_it_says_what_it_proves_nothing_for():
    method, problem = BOUNDS["spanning-tree"], plane(1, 4)
    optional = RoutingProblem(Sites.of("ab", required=[False, False]), Travel(EXPLICIT, matrix=np.ones((2, 2))), (VehicleType(),))
    makespan = RoutingProblem(problem.sites, problem.travel, problem.fleet, Makespan())
    assert method.missing(problem) == frozenset()
    assert method.missing(optional) == {"optional-sites"}
    assert method.missing(makespan) == {"objective:makespan"}
    assert method.missing(RoutingProblem(problem.sites, problem.travel, problem.fleet, Vehicles())) == frozenset()
