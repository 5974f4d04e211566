import itertools
import math

import numpy as np
import pytest
from oracles import ASYM_5, GAP_5, SQUARE_4, optimum, routing

from waybound import TotalCost, Vehicles
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.assignment import assignment_bound


def cheapest(matrix: np.ndarray, routes: range, fixed: float = 0.0) -> float:
    """Least cost of successors of all sites but 0, which has so many: by enumeration."""
    n, best = len(matrix) - 1, math.inf
    for k in routes:
        nodes = [0] * k + list(range(1, n + 1))
        for chosen in itertools.permutations(nodes):
            if all(i != j for i, j in zip(nodes, chosen, strict=True)):
                best = min(best, k * fixed + sum(matrix[i, j] for i, j in zip(nodes, chosen, strict=True)))
    return best


@pytest.mark.parametrize(("count", "least"), [(1, 0), (2, 0), (2, 2), (3, 2), (None, 0)])
@pytest.mark.parametrize("seed", range(3))
def test_it_is_the_cheapest_assignment_and_no_more_than_the_optimum(seed: int, count: int | None, least: int) -> None:
    matrix = np.random.default_rng(seed).integers(1, 50, (5, 5)).astype(float)
    np.fill_diagonal(matrix, 0.0)
    problem = routing(matrix=matrix, count=count, min_vehicles=least, fixed_cost=7.0)
    found = assignment_bound(problem)
    assert found is not None and verified_bound(problem, found) == found.value
    assert found.value >= cheapest(matrix, range(max(1, least), (count or 4) + 1), 7.0) - 1e-6
    assert found.value <= (optimum(problem) or 0.0) + 1e-6


def test_far_from_symmetric_costs_it_proves_nearly_everything() -> None:
    assert assignment_bound(routing(matrix=ASYM_5, count=1)).value == pytest.approx(16.0)  # type: ignore[union-attr]
    assert optimum(routing(matrix=ASYM_5, count=1)) == 16.0


def test_levels_and_fleets_of_their_own_price_are_counted() -> None:
    problem = routing(xy=SQUARE_4, count=4, min_vehicles=3, objective=Vehicles() * 5 + TotalCost())
    found = assignment_bound(problem)
    assert found is not None and 15.0 < found.value <= (optimum(problem) or 0.0)


def test_nothing_is_begun_that_the_budget_does_not_hold() -> None:
    assert assignment_bound(routing(xy=GAP_5, count=1), Stop(0.0)) is None
    assert BOUNDS["assignment"].missing(routing(xy=SQUARE_4, sites={"required": False}))
