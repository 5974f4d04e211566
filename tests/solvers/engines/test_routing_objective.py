from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_routing import small

from waybound.formulations.routing.objective import LongestRoute, Objective, Reward, TotalCost, Vehicles
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Routes
from waybound.instances.errors import UnsupportedError
from waybound.solvers.engines.routing_objective import claimed_objective, scalarised, unscalable


def value(problem: RoutingProblem, answer: Routes) -> float:
    """The sum that an engine minimises, of one answer."""
    goal = scalarised(problem)
    total = 0.0
    for route in answer:
        kind = problem.fleet[route.vehicle]
        stops = [kind.start, *route.visits, kind.end]
        total += goal.unit[route.vehicle] * problem.travel.distance(stops[:-1], stops[1:]).sum() + goal.fixed[route.vehicle]
        total -= goal.prize[list(route.visits)].sum()
    return float(total)


def answers(problem: RoutingProblem, rng: np.random.Generator) -> list[Routes]:
    made = []
    for _ in range(40):
        order = rng.permutation(problem.customers)[: rng.integers(1, 6)]
        cuts = np.sort(rng.integers(0, len(order) + 1, rng.integers(0, 3)))
        made.append(Routes.of([part.tolist() for part in np.split(order, cuts)]))
    return made


@pytest.mark.parametrize(
    "objective",
    [
        TotalCost(), Vehicles(), Reward(), 2.0 * TotalCost() + 7.0 * Vehicles(), Reward() - 0.5 * TotalCost(),
        Vehicles().then(TotalCost()), Reward().then(TotalCost()), Reward().then(Vehicles()).then(TotalCost()), -1.0 * TotalCost(),
    ],
    ids=str,
)  # fmt: skip
def test_the_sum_orders_answers_as_the_objective_does(objective) -> None:
    problem = replace(small("prizes", 3, "trunc1"), objective=Objective.of(objective))
    signs = np.array([1.0 if s == "min" else -1.0 for s in problem.senses])
    made = answers(problem, np.random.default_rng(0))
    ranked = sorted(made, key=lambda a: value(problem, a))
    keys = [tuple(np.round(signs * problem.evaluate(a).values, 6)) for a in ranked]
    assert keys == sorted(keys)


def test_the_claim_is_the_value_in_the_objectives_own_sense() -> None:
    for objective in (TotalCost(), Reward() - 0.5 * TotalCost(), TotalCost() - 1.5 * Reward()):
        problem = replace(small("prizes", 3, "trunc1"), objective=Objective.of(objective))
        for answer in answers(problem, np.random.default_rng(1)):
            assert claimed_objective(problem, value(problem, answer)) == pytest.approx(problem.evaluate(answer).values[0])


def test_nothing_is_claimed_of_objectives_in_order_of_priority() -> None:
    problem = replace(small("vehicles", 0, "round"))
    assert claimed_objective(problem, 17.0) is None


@pytest.mark.parametrize(
    ("objective", "word"),
    [
        (LongestRoute(), "longest-route"), (TotalCost().then(Vehicles()), "total-cost before others"),
        (TotalCost() + Reward(), "1\\*reward"), ((TotalCost() + Vehicles()).then(Reward()), "before others"),
    ],
)  # fmt: skip
def test_what_one_sum_cannot_say_is_refused_by_name(objective, word: str) -> None:
    problem = replace(small("prizes", 3, "round"), objective=Objective.of(objective))
    assert unscalable(problem)
    with pytest.raises(UnsupportedError, match=word):
        scalarised(problem)
