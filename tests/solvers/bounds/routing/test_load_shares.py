"""Bounds that need no search are there at any size, whatever time there is."""

from dataclasses import replace

import numpy as np
from small_routing import plane

from waybound import Objective, Reward, RoutingProblem, Sites, TotalCost, Travel, Vehicles, VehicleType
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.travel import EXPLICIT
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.load_shares import load_shares, nearest_moves
from waybound.solving.bounding import find_bounds


def uniform(n: int) -> RoutingProblem:
    """Customers in a square of 1,000, demands of 1 to 9, vehicles that hold 100."""
    rng = np.random.default_rng(1)
    sites = Sites.of(range(n + 1), demand=[0, *rng.integers(1, 10, n)])
    return RoutingProblem(sites, Travel("euclidean", rng.uniform(0, 1000, (n + 1, 2))), (VehicleType(capacity=100.0),))


def test_however_little_time_there_is_the_bound_is_the_same() -> None:
    problem = uniform(6_000)
    trips = 2.0 * problem.travel.distance(0, problem.customers) @ problem.sites.demand[problem.customers] / 100.0
    for bound_time in (1e-9, 1e-3):
        found = find_bounds(problem, bound_time)
        assert {e.kind for e in found} == {"load-shares", "nearest-moves"}
        assert max(verified_bound(problem, e) for e in found) >= trips * (1 - 1e-9)


def test_all_moves_of_a_matrix_take_time() -> None:
    problem = plane(1, 30, 30.0)
    matrix = replace(problem, travel=Travel(EXPLICIT, matrix=problem.travel.distances))
    for method in (load_shares, nearest_moves):
        assert method(matrix, Stop(0.0)) is None
        evidence = method(matrix)
        assert evidence is not None and verified_bound(matrix, evidence) == evidence.value > 0


def test_what_lacks_costs_or_capacity_is_named() -> None:
    problem = plane(1, 4, 100.0)
    loads, moves = BOUNDS["load-shares"].missing, BOUNDS["nearest-moves"].missing
    assert not loads(problem) and not moves(problem)
    endless = replace(problem, fleet=(VehicleType(),))
    assert loads(endless) == {"problems without capacity"} and not moves(endless)
    assert moves(replace(problem, objective=Objective.of(Reward()))) == {"objectives without costs"}
    assert moves(replace(problem, objective=Objective.of(Vehicles() - TotalCost()))) == {"objective:weights"}
