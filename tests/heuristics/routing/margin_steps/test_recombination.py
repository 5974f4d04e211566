"""The best of routes that were met: by brute force over a few, and what is no route of a pool."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from waybound.formulations.routing.objective import Makespan, Objective, Reward
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Route, Routes
from waybound.formulations.stop import Stop
from waybound.heuristics.routing.margin_steps.recombination import Pool
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel

LINE = np.abs(np.subtract.outer(*[np.array([0.0, 4, -5, 6, -7])] * 2))


def line(team_risk: float | None) -> RoutingProblem:
    """Customers on both sides of the depot, each with a service of 1."""
    sites, travel = Sites.of(range(5), service=[0, 1, 1, 1, 1]), Travel(EXPLICIT, matrix=LINE, variances=LINE / 4)
    return RoutingProblem(sites, travel, (VehicleType(4, max_duration=18.0),), team_risk=team_risk)


@pytest.mark.parametrize(("team_risk", "cost"), [(0.3, 26.0), (0.15, 34.0), (0.08, 36.0)])
def test_the_best_choice_keeps_the_risk_of_the_team(team_risk: float, cost: float) -> None:
    """a-c and b-e from two answers, of which only one may be taken under 0.15, and neither beside e under 0.08."""
    problem = line(team_risk)
    pool = Pool(problem)
    pool.add(Routes.of([[1, 3], [2], [4]]))
    pool.add(Routes.of([[1], [3], [2, 4]]))
    answer = pool.best(Stop(), 1, None)
    assert answer is not None and problem.evaluate(answer).feasible and problem.evaluate(answer).values == (cost,)
    assert pool.best(Stop(), 1, None) is None  # nothing new
    pool.add(Routes.of([[3, 1]]))
    assert pool.best(Stop(), 1, answer) is not None


def test_routes_that_break_a_limit_by_themselves_are_not_kept() -> None:
    problem = line(0.02)
    pool = Pool(problem)
    before = set(pool.routes)
    assert Route((4,)) not in before  # overruns with 0.0544
    pool.add(Routes.of([[1, 2], [2, 4], [1, 3]]))
    assert set(pool.routes) == before | {Route((1, 3))}


def test_a_maximum_that_should_be_large_is_beyond_it() -> None:
    problem = replace(line(0.1), objective=Objective.of(Reward() + Makespan()))
    pool = Pool(problem)
    pool.add(Routes.of([[1]]))
    assert not pool.routes and pool.best(Stop(), 1, None) is None


def test_asked_to_stop_it_looks_for_nothing() -> None:
    stop = Stop()
    stop.ask()
    assert Pool(line(0.3)).best(stop, 1, None) is None
