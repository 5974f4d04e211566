import numpy as np
import pytest
from small_routing import plane

from waybound.formulations.routing.checking.state_space import check_state_space
from waybound.formulations.routing.checking.vehicle_moves import VehicleMoves, terms_of
from waybound.formulations.stop import NEVER
from waybound.solvers.bounds.routing.price_sharing import shared_prices
from waybound.solvers.bounds.routing.resource_walks import Walks


def prices(problem, kept):
    n = len(problem.customers)
    moves = VehicleMoves.of(problem, problem.fleet[0], terms_of(problem), np.zeros(n), {})
    walks = Walks(moves.cost, moves.resources["load"], 1.0, np.isfinite(moves.cost) & kept)
    heavy = np.append(0.0, problem.sites.demand[problem.customers])
    found, value = shared_prices(moves, "load", walks, (1, n), heavy, 1e9, NEVER.within(2.0), 1.0)
    listed = np.zeros(len(problem.sites))
    listed[problem.customers] = found
    return value, check_state_space(problem, {"prices": listed.tolist(), "resource": "load", "step": 1.0})


def test_what_is_found_is_what_the_checker_derives():
    value, bound = prices(plane(5, 20, 25.0), np.ones((21, 21), dtype=bool))
    assert bound == pytest.approx(value, rel=1e-3)


def test_moves_that_were_not_looked_at_come_in():
    problem = plane(5, 20, 25.0)
    far = problem.travel.distances
    near = far <= np.sort(far, axis=1)[:, 3:4]
    few, all_of_them = prices(problem, near)[1], prices(problem, np.ones((21, 21), dtype=bool))[1]
    assert few >= 0.98 * all_of_them
