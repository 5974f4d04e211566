import itertools
from dataclasses import replace

import numpy as np
import pytest
from small_routing import plane

from waybound.formulations.stop import NEVER
from waybound.solvers.bounds.routing.load_cuts import LoadCut, overloaded
from waybound.solvers.bounds.routing.restricted_master import Pool


def test_coefficients_count_the_moves_into_the_set() -> None:
    pool = Pool()
    pool.add([(0, np.array(route)) for route in ([1, 2, 3], [3, 1, 4, 2], [4])])
    inside = np.array([False, True, True, False, False])
    assert LoadCut.coefficients([LoadCut(inside, 1.0)], pool, 0)[:, 0].tolist() == [1.0, 2.0, 0.0]
    assert LoadCut(inside, 1.0).missing(5).tolist() == [1.0, 1.0, 0.0, 0.0]


@pytest.mark.parametrize("seed", range(3))
def test_sets_that_are_entered_too_seldom_are_found_once(seed: int) -> None:
    problem = plane(seed, 12, 25.0)
    demand = problem.sites.demand[problem.customers]
    flow = np.zeros((13, 13))  # one tour of all: it carries far too much
    tour = [0, *range(1, 13), 0]
    for i, j in itertools.pairwise(tour):
        flow[i, j] = 1.0
    known = set[bytes]()
    cuts = overloaded(problem, flow, known, NEVER)
    assert cuts and all(cut.right >= np.ceil(demand[cut.inside[1:]].sum() / 25.0 - 1e-9) for cut in cuts)
    assert all(flow[cut.moves].sum() < cut.right for cut in cuts)
    assert not overloaded(problem, flow, known, NEVER)


def test_what_is_collected_fills_vehicles_too() -> None:
    problem = plane(1, 6, 100.0)
    pickup = np.append(0.0, np.full(6, 40.0))
    flow = np.zeros((7, 7))
    for i, j in itertools.pairwise([0, *range(1, 7), 0]):
        flow[i, j] = 1.0
    cuts = overloaded(problem.altered(sites=replace(problem.sites, pickup=pickup)), flow, set(), NEVER)
    assert cuts and not overloaded(problem, flow, set(), NEVER)
    assert all(cut.right == np.ceil(cut.inside.sum() * 0.4) for cut in cuts)
