import numpy as np
import pytest
from small_routing import small

from waybound.formulations.routing.checking.state_space import check_state_space
from waybound.formulations.routing.checking.vehicle_moves import VehicleMoves, needed_routes, terms_of
from waybound.formulations.stop import NEVER
from waybound.solvers.bounds.routing.resource_walks import Walks, at_level, step_size


def moves_of(problem):
    return VehicleMoves.of(problem, problem.fleet[0], terms_of(problem), np.zeros(len(problem.customers)), {})


@pytest.mark.parametrize(("feature", "name"), [("capacity", "load"), ("time-windows", "time"), ("max-distance", "distance")])
def test_the_best_walk_costs_the_same_both_ways_and_for_the_checker(feature, name):
    for seed in range(3):
        problem = small(feature, seed, "round")
        moves, n = moves_of(problem), len(problem.customers)
        walks = Walks(moves.cost, moves.resources[name], 1.0, np.isfinite(moves.cost), floor=True)
        price = np.append(0.0, np.random.default_rng(seed).integers(10, 60, n).astype(float))
        heavy = np.append(0.0, np.ones(n))
        ahead, before, _ = walks.ahead(NEVER, price, heavy)
        back, _, _ = walks.back(NEVER, price, heavy)
        least, node = walks.best(ahead)
        home = at_level(back, walks.back_grid, walks.top) + walks.first_cost - price
        assert least == pytest.approx(home[1:].min())
        assert walks.through(price, ahead, back).min() <= least + 1e-9
        assert walks.visits(before, node)[node] >= 1
        listed = np.zeros(len(problem.sites))
        listed[problem.customers] = price[1:]
        bound = check_state_space(problem, {"prices": listed.tolist(), "resource": name, "step": 1.0})
        routes = n if least < 0 else int(needed_routes(problem, np.ones(n, dtype=bool)))
        assert 0.0 <= bound - (price.sum() + routes * least) + 1e-6 <= 1.0  # whole numbers


def test_steps_are_units_of_the_data_where_there_is_time_and_coarser_where_not():
    moves = moves_of(small("capacity", 1, "round"))
    every = np.isfinite(moves.cost)
    assert step_size(moves, "load", every, 1e9, 5) == 1.0
    assert step_size(moves, "load", every, 1.0, 5) == pytest.approx(15.0 / 5)
