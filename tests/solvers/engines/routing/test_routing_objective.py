from dataclasses import replace

import numpy as np
import pytest
from small_routing import small

from waybound import LatestReturn, LongestRoute, Makespan, Objective, Penalties, Reward, RoutingProblem, TotalCost, TotalDuration, Vehicles
from waybound.formulations.routing.routes import Routes
from waybound.instances.errors import UnsupportedError
from waybound.solvers.engines.routing.routing_objective import claimed_objective, scalarised, unscalable


def value(problem: RoutingProblem, answer: Routes) -> float:
    """The sum that an engine minimises, of one answer."""
    goal = scalarised(problem)
    total, largest = 0.0, np.zeros(3)
    for route in answer:
        k, kind = route.vehicle, problem.fleet[route.vehicle]
        if not route.visits:
            continue
        stops = [kind.start, *route.visits, kind.end]
        distance, duration = (of(stops[:-1], stops[1:]).sum() for of in (problem.travel.distance, problem.travel.duration))
        total += goal.unit[k] * distance + goal.fixed[k] + goal.time[k] * duration
        total += goal.overtime[k] * max(0.0, duration - kind.regular_duration)
        total -= goal.prize[list(route.visits)].sum()
        largest = np.maximum(largest, [duration, distance, duration])
    return float(total + goal.maxima @ largest)


def priced(objective) -> RoutingProblem:
    """Prizes, penalties, costs of time and of overtime; nobody waits."""
    problem = small("prizes", 3, "trunc1")
    sites = replace(problem.sites, penalty=np.where(problem.sites.required, 0.0, problem.sites.reward[::-1].copy()))
    vehicle = replace(problem.fleet[0], unit_duration_cost=0.25, regular_duration=60.0, unit_overtime_cost=1.5)
    return replace(problem, sites=sites, fleet=(vehicle,), objective=Objective.of(objective))


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
        TotalDuration(), Penalties().then(TotalDuration()), TotalCost() + 2.0 * Penalties(), Makespan(), Reward().then(Makespan()),
        LongestRoute() + 0.5 * LatestReturn(), Reward() - 0.25 * Makespan(),
    ],
    ids=str,
)  # fmt: skip
def test_the_sum_orders_answers_as_the_objective_does(objective) -> None:
    problem = priced(objective)
    signs = np.array([1.0 if s == "min" else -1.0 for s in problem.senses])
    ranked = sorted(answers(problem, np.random.default_rng(0)), key=lambda a: value(problem, a))
    keys = [tuple(np.round(signs * problem.evaluate(a).values, 6)) for a in ranked]
    assert keys == sorted(keys)


def test_the_claim_is_the_value_in_the_objectives_own_sense() -> None:
    for objective in (
        TotalCost(), Reward() - 0.5 * TotalCost(), TotalCost() - 1.5 * Reward(), TotalCost() + 0.5 * Penalties(),
        Reward() - 0.1 * Makespan(),
    ):  # fmt: skip
        problem = priced(objective)
        for answer in answers(problem, np.random.default_rng(1)):
            assert claimed_objective(problem, value(problem, answer)) == pytest.approx(problem.evaluate(answer).values[0])


def test_nothing_is_claimed_of_objectives_in_order_of_priority() -> None:
    assert claimed_objective(replace(small("vehicles", 0, "round")), 17.0) is None


@pytest.mark.parametrize(
    ("objective", "word"),
    [
        (LongestRoute().then(TotalCost()), "longest-route before others"), (TotalCost().then(Vehicles()), "total-cost before others"),
        (TotalCost() + Reward(), "1\\*reward"), ((TotalCost() + Vehicles()).then(Reward()), "before others"),
    ],
)  # fmt: skip
def test_what_one_sum_cannot_say_is_refused_by_name(objective, word: str) -> None:
    problem = replace(small("prizes", 3, "round"), objective=Objective.of(objective))
    assert unscalable(problem)
    with pytest.raises(UnsupportedError, match=word):
        scalarised(problem)
