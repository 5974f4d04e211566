import math
from dataclasses import replace
from statistics import NormalDist

import numpy as np
import pytest
from coded import coded
from file_cases import check_refused

from waybound import Energy, InputError, Routes, RoutingInstance, RoutingProblem, Sites, UsageError, VehicleType
from waybound.formulations.routing.overrun import quantile, route_overrun, tail, uncertain
from waybound.formulations.routing.schedule import schedule
from waybound.instances.routing.travel import EXPLICIT, Travel

N = 5
MEANS = np.array([[0.0, 4, 6, 5, 7], [4, 0, 3, 6, 5], [6, 3, 0, 4, 6], [5, 6, 4, 0, 3], [7, 5, 6, 3, 0]])
VARIANCES = np.array([[0.0, 1, 4, 2, 3], [1, 0, 0.5, 2, 1], [4, 2.5, 0, 1, 2], [2, 2, 1, 0, 0.25], [3, 1, 2, 0.25, 0]])
SERVICE = np.array([0.0, 1, 1, 2, 0])


def problem(vehicle: VehicleType, team_risk: float | None = None, **sites: object) -> RoutingProblem:
    held = Sites.of(range(N), **{"service": SERVICE, **sites})
    return RoutingProblem(held, Travel(EXPLICIT, matrix=MEANS, variances=VARIANCES), (vehicle,), team_risk=team_risk)


TWO = Routes.of([[1, 2], [3, 4]])
LASTS = VehicleType(max_duration=20.0, energy=Energy(28.0, 2.0, "travel"), risk=0.2)


def drawn(asked: RoutingProblem, answer: Routes, count: int) -> np.ndarray:
    """Which routes overrun a limit, shape (count, routes), by drawing the duration of every move."""
    rng, found = np.random.default_rng(5), []
    for route in answer:
        vehicle = asked.fleet[route.vehicle]
        stops = np.array([vehicle.start, *route.visits, vehicle.end])
        moves = rng.normal(MEANS[stops[:-1], stops[1:]] / vehicle.speed, np.sqrt(VARIANCES[stops[:-1], stops[1:]]) / vehicle.speed,
                           (count, len(stops) - 1)).sum(axis=1)  # fmt: skip
        over = moves + SERVICE[stops[1:-1]].sum() > vehicle.max_duration
        if vehicle.energy is not None:
            over |= vehicle.energy.rate * moves > vehicle.energy.at_departure
        found.append(over)
    return np.stack(found, axis=1)


@pytest.mark.parametrize("vehicle", [LASTS, replace(LASTS, speed=1.25), replace(LASTS, energy=None), replace(LASTS, max_duration=math.inf)])
def test_probabilities_are_those_of_drawn_durations(vehicle: VehicleType) -> None:
    asked, count = problem(vehicle, 0.3), 200_000
    over, found = drawn(asked, TWO, count), asked.evaluate(TWO).quantities
    exact = [route_overrun(vehicle, schedule(asked, route)) for route in TWO]
    for p, seen in zip([*exact, found["team-overrun"]], [*over.mean(axis=0), over.any(axis=1).mean()], strict=True):
        assert abs(p - seen) < 4.0 * math.sqrt(max(p, 1e-5) / count)
    assert found["largest-route-overrun"] == max(exact)
    assert found["expected-overruns"] == pytest.approx(sum(exact)) and found["expected-overruns"] >= found["team-overrun"]
    assert found["team-overrun"] == pytest.approx(1.0 - (1.0 - exact[0]) * (1.0 - exact[1]))


def test_a_route_by_hand() -> None:
    """0-1-2-0: 13 on the move and 2 of service, variance 1 + 0.5 + 4; duration up to 20, and 28 of energy at rate 2."""
    asked = problem(LASTS)
    first, second = uncertain(LASTS, schedule(asked, TWO.routes[0]))
    assert (first.name, first.mean, first.deviation, first.limit) == ("duration", 15.0, math.sqrt(5.5), 20.0)
    assert (second.name, second.mean, second.deviation, second.limit) == ("energy", 26.0, 2.0 * math.sqrt(5.5), 28.0)
    assert second.overrun() == pytest.approx(1.0 - NormalDist().cdf(1.0 / math.sqrt(5.5)))
    verdict = asked.evaluate(Routes.of([[1, 2], [3], [4]]))
    (wrong,) = [v for v in verdict.violations if v.vehicle == "vehicle 1"]
    assert wrong.check == "route-risk" and "limit of energy of 28 with probability 0.334" in wrong.message
    assert wrong.amount == pytest.approx(26.0 + 2.0 * math.sqrt(5.5) * NormalDist().inv_cdf(0.8) - 28.0)


def test_a_risk_is_kept_up_to_what_it_allows() -> None:
    exact = route_overrun(LASTS, schedule(problem(LASTS), TWO.routes[0]))
    for risk, good in ((exact, True), (exact * (1 + 1e-8), True), (exact * (1 - 1e-8), False)):
        one = replace(LASTS, risk=risk)
        broken = {v.check for v in problem(one).evaluate(Routes.of([[1, 2]])).violations}
        assert broken == ({"visits"} if good else {"visits", "route-risk"})
        together = {v.check for v in problem(replace(one, risk=None), risk).evaluate(Routes.of([[1, 2]])).violations}
        assert together == ({"visits"} if good else {"visits", "team-risk"})


def test_the_tail_keeps_its_digits() -> None:
    for x, p in ((0.0, 0.5), (1.959963984540054, 0.025), (10.0, 7.619853024160526e-24), (37.0, 5.725571222524577e-300)):
        assert tail(x) == pytest.approx(p, rel=1e-12)
        assert quantile(p) == pytest.approx(x, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("risk", [0.0, -0.1, 0.51, 1.0, math.nan])
def test_a_risk_is_a_probability_up_to_one_half(risk: float) -> None:
    check_refused(InputError, "the risk of vehicle must be a probability above 0, and 1/2 at most", VehicleType, risk=risk)
    check_refused(InputError, "the risk of the team must be", problem, VehicleType(), risk)


@pytest.mark.parametrize(
    ("vehicle", "sites", "why"),
    [
        (replace(LASTS, energy=Energy(28.0, stations=(0,))), {}, "filled up on the way"),
        (replace(LASTS, energy=Energy(28.0, charge="windows")), {}, "charged by windows"),
        (LASTS, {"ready": [0, 0, 5, 0, 0]}, "may have to wait at site 2"),
        (replace(LASTS, max_duration=math.inf, energy=Energy(28.0, charge="elapsed")), {"windows": {1: [(0, 5), (9, 20)]}}, "site 1"),
    ],
)
def test_what_is_no_sum_of_moves_is_refused(vehicle: VehicleType, sites: dict[str, object], why: str) -> None:
    with pytest.raises(InputError, match=why):
        problem(vehicle, **sites)
    problem(replace(vehicle, risk=None), **sites)
    with pytest.raises(InputError, match=why):
        problem(replace(vehicle, risk=None), 0.1, **sites)


def test_energy_for_travel_may_be_uncertain_where_vehicles_wait() -> None:
    problem(replace(LASTS, max_duration=math.inf), ready=[0, 0, 5, 0, 0])


@pytest.mark.parametrize(
    ("variances", "why"),
    [(-VARIANCES, "variance in row 1, column 2 must be finite and not negative"), (np.ones((2, 2)), "variance matrix has another size")],
)
def test_variances_are_not_negative_and_one_a_move(variances: np.ndarray, why: str) -> None:
    with pytest.raises(InputError, match=why):
        Travel(EXPLICIT, matrix=MEANS, variances=variances)


def test_the_first_customers_keep_their_variances() -> None:
    asked = problem(LASTS)
    cut = RoutingInstance("i", "test", asked.sites, asked.travel, asked.fleet, team_risk=0.1).with_customers(2)
    assert cut.team_risk == 0.1 and cut.travel.variances is not None and (cut.travel.variances == VARIANCES[:3, :3]).all()


def test_data_decide_the_digest() -> None:
    asked = problem(LASTS)
    others = [
        replace(asked, team_risk=0.1),
        problem(replace(LASTS, risk=0.1)),
        replace(asked, travel=replace(asked.travel, variances=None)),
    ]
    assert len({p.digest() for p in (asked, *others)}) == 4


def test_a_team_risk_is_not_continued() -> None:
    with pytest.raises(UsageError, match="cannot be continued with team-risk"):
        problem(replace(LASTS, risk=None), 0.3).continue_from(TWO, 2.0)


def test_risks_are_set_by_name() -> None:
    asked = problem(VehicleType(max_duration=20.0))
    instance = RoutingInstance("i", "test", asked.sites, asked.travel, (asked.fleet[0], replace(asked.fleet[0], name="other")))
    made = RoutingProblem.from_instance(instance, settings={"risk": "0.05", "team-risk": 0.1})
    assert [v.risk for v in made.fleet] == [0.05, 0.05] and made.team_risk == 0.1
    with pytest.raises(InputError, match="the risk of the team must be a probability above 0, and 1/2 at most"):
        RoutingProblem.from_instance(instance, settings={"team-risk": 0.7})
    with pytest.raises(UsageError, check=coded("malformed")):
        RoutingProblem.from_instance(instance, settings={"risk": "low"})
    with pytest.raises(UsageError, match="durations of i are certain"):
        RoutingProblem.from_instance(replace(instance, travel=replace(asked.travel, variances=None)), settings={"risk": 0.1})


def test_an_even_chance_needs_the_mean_and_no_hair_more() -> None:
    assert quantile(0.5) == 0.0  # at a limit of 0 there is no slack for the least number above it
