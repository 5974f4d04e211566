"""Problems of certain durations: what is feasible in them keeps the risk, and where a margin is exact."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import varied
from truth.routing import routes

from waybound.formulations.routing.overrun import joint_overrun, route_overrun
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Route, Routes
from waybound.formulations.routing.schedule import schedule
from waybound.heuristics.routing.margin_steps.certain import certain, split
from waybound.instances.routing.features import RISKS
from waybound.instances.routing.instance import Energy, Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel

LINE = np.abs(np.subtract.outer(*[np.array([0.0, 4, -5, 6, -7])] * 2))


def line(risk: float | None = None, team_risk: float | None = None, vehicles: int | None = 3, **limits: object) -> RoutingProblem:
    """Customers on both sides of the depot, each with a service of 1."""
    sites, travel = Sites.of(range(5), service=[0, 1, 1, 1, 1]), Travel(EXPLICIT, matrix=LINE, variances=LINE / 4)
    vehicle = VehicleType(vehicles, risk=risk, **{"max_duration": 18.0, **limits})  # type: ignore[arg-type]
    return RoutingProblem(sites, travel, (vehicle,), team_risk=team_risk)


@pytest.mark.parametrize("feature", ["route-risk", "team-risk"])
def test_what_is_feasible_with_margins_keeps_the_risk_of_each_route(feature: str) -> None:
    kept = 0
    for seed, slope in itertools.product(range(6), (0.05, 0.1, 0.3)):
        problem = varied(feature, seed)
        restricted = certain(problem, slope, problem.team_risk)
        assert not restricted.features() & RISKS
        for kind, vehicle in enumerate(restricted.fleet):
            for visits in routes(restricted, vehicle):
                broken = {v.check for v in problem.evaluate(Routes((Route(visits, kind),))).violations}
                assert broken <= {"visits", "fleet"}, (seed, slope, visits)
                kept += 1
    assert kept > 20


def test_the_margin_is_exact_for_routes_of_the_variance_that_it_is_made_for() -> None:
    """0-1-3-0: a variance of 3, a mean of 14; the limit is met, and missed below it."""
    z = 1.6448536269514722
    least = 14.0 + z * math.sqrt(3.0)
    for limit, good in ((least * (1 + 1e-9), True), (least * (1 - 1e-6), False)):
        made = certain(line(0.05, max_duration=limit), z / (2.0 * math.sqrt(3.0)), None)
        broken = {v.check for v in made.evaluate(Routes.of([[1, 3]])).violations}
        assert broken == ({"visits"} if good else {"visits", "duration"})


def test_speeds_stores_and_vehicles_without_risk_have_margins_of_their_own() -> None:
    fleet = (
        VehicleType(2, risk=0.1, max_duration=30.0, speed=2.0, energy=Energy(40.0, 2.0, "elapsed", initial=30.0), name="fast"),
        VehicleType(2, max_duration=30.0, name="sure"),
    )
    problem = replace(line(), fleet=fleet)
    fast, sure = certain(problem, 0.5, None).fleet
    margin = 1.2815515655446004**2 / (4.0 * 0.5 * 2.0)
    assert fast.max_duration == pytest.approx(30.0 - margin) and fast.energy is not None
    assert (fast.energy.capacity, fast.energy.initial) == pytest.approx((40.0 - 2.0 * margin, 30.0 - 2.0 * margin))
    assert sure.max_duration == 30.0 and sure.travel is not None and (sure.travel.durations == LINE).all()
    assert (certain(problem, 0.5, None).travel.durations == LINE + 0.5 * LINE / 4).all()
    means = certain(problem, 0.0, None)
    assert [v.max_duration for v in means.fleet] == [30.0, 30.0] and (means.travel.durations == LINE).all()


def test_a_split_has_the_answer_and_only_answers_that_keep_the_risk_of_the_team() -> None:
    """Any routes of the vehicles that a split has keep all risks together, whoever drives what."""
    problem, answer = line(None, 0.15, vehicles=None), Routes.of([[1], [2, 4], [3]])
    parts = split(problem, answer)
    assert parts is not None and len(parts.problem.fleet) == 4 and not parts.problem.features() & RISKS
    assert parts.problem.evaluate(parts.start).feasible and parts.back(parts.start) == answer
    worst = []
    for kind, vehicle in enumerate(parts.problem.fleet):
        alone = [Routes((Route(visits, kind),)) for visits in routes(parts.problem, vehicle)]
        good = [one for one in alone if not {v.check for v in parts.problem.evaluate(one).violations} & {"duration"}]
        worst.append(max(route_overrun(problem.fleet[0], schedule(problem, parts.back(one).routes[0])) for one in good))
    assert 0.1442 < joint_overrun(worst) <= 0.15


def test_a_split_of_types_goes_back_to_them_and_leaves_committed_vehicles_alone() -> None:
    fleet = (VehicleType(1, max_duration=30.0, risk=0.1, name="a"), VehicleType(2, max_duration=20.0, risk=0.2, speed=2.0, name="b"))
    problem = replace(line(), fleet=fleet)
    answer = Routes((Route((2, 4), 1), Route((1, 3), 0)))
    assert problem.evaluate(answer).feasible
    parts = split(problem, answer)
    assert parts is not None and parts.kinds == (1, 0, 1) and parts.back(parts.start) == answer
    assert parts.problem.evaluate(parts.start).feasible
    assert split(replace(problem, fleet=(replace(fleet[0], committed=True), fleet[1])), answer) is None
