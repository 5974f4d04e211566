from typing import Any

import waybound as wb
from waybound.formulations.routing.routes import Routes
from waybound.solvers.backend import Control
from waybound.solvers.engines.routing.best_routes import BestRoutes


def made(objective: Any) -> tuple[wb.RoutingProblem, BestRoutes, list[Any]]:
    """Three sites on a line, a vehicle for each."""
    sites = wb.Sites.of(range(4), reward=[0, 1, 1, 1], required=[False] * 4, coordinates=[[0, 0], [1, 0], [2, 0], [3, 0]])
    problem = wb.RoutingProblem(sites, wb.Travel("euclidean", sites.coordinates), (wb.VehicleType(3),), objective)
    told: list[Any] = []
    return problem, BestRoutes(problem, Control(lambda event: told.append(event["objective"]))), told


def test_only_what_is_feasible_and_better_is_kept_and_told() -> None:
    _, best, told = made(wb.TotalCost() - 10 * wb.Reward())
    assert best.claim is None
    assert best.take(Routes.of([[1]])) and not best.take(Routes.of([[1]]))
    assert not best.take(Routes.of([[1], [1, 2, 3]]))  # twice at 1
    assert best.take(Routes.of([[1, 2, 3]])) and not best.take(Routes.of([[1, 2]]))
    assert best.answer == Routes.of([[1, 2, 3]]) and best.claim == 6.0 - 30.0 and told == [-8.0, -24.0]


def test_levels_count_in_their_order_and_make_no_claim() -> None:
    _, best, told = made(wb.Reward().then(wb.TotalCost()))
    assert best.take(Routes.of([[2, 1, 3]])) and best.take(Routes.of([[1, 2, 3]])) and not best.take(Routes.of([[1, 2]]))
    assert best.values == (3.0, 6.0) and best.claim is None and told == [None, None]
