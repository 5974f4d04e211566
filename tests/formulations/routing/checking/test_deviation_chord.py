import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from draws import draws
from hostile_instances import Units, routing_at_risk
from hypothesis import given, settings, strategies as st
from small_routing import LINE, at_risk
from truth.routing import RoutingTruth

from waybound import Energy, Evidence, InputError, Makespan, Objective, RoutingProblem, Sites, TotalCost, UsageError, VehicleType
from waybound.formulations.routing.checking.deviation_chord import KIND, check_deviation_chord, lacks_chord, without_risks
from waybound.formulations.routing.overrun import quantile
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.features import RISKS
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.reports.benchmarks.routing_variants import risky

line = partial(at_risk, count=4)
ALL_ROUTES = {"kind": "all-routes", "data": {}}


def test_the_example_by_hand() -> None:
    """No move has more than 1/4 of its duration of variance: 4 s^2 + z s = 18. A risk of the team is one of each route."""
    z = quantile(0.06)
    largest = (-z + math.sqrt(z * z + 16.0 * 18.0)) / 8.0
    for problem in (line(0.06), line(None, 0.06), line(0.3, 0.06)):
        made = without_risks(problem)
        assert made is not None and not made.features() & RISKS
        (vehicle,) = made.fleet
        assert vehicle.travel is not None and vehicle.max_duration == pytest.approx(18.0)
        assert vehicle.travel.durations[0, 1] == pytest.approx(4.0 + z / largest)
        assert vehicle.travel.durations[1, 3] == pytest.approx(1.0 + 2.0 + z / largest * 0.5)
        assert (vehicle.travel.distances == LINE).all()
    assert check_deviation_chord(line(0.06), ALL_ROUTES) == pytest.approx(36.0)  # the optimum, where means would allow 26
    assert check_deviation_chord(line(0.15), ALL_ROUTES) == pytest.approx(26.0)
    assert check_deviation_chord(line(1e-12), ALL_ROUTES) == math.inf  # nobody reaches e


@settings(max_examples=draws(60), deadline=None)
@given(data=st.data())
def test_it_is_never_beyond_the_optimum(data: st.DataObject) -> None:
    n = data.draw(st.integers(2, 4))
    numbers = st.lists(st.integers(0, 9), min_size=n * n, max_size=n * n).map(lambda v: np.array(v, dtype=float).reshape(n, n))
    means, variances, service = (
        data.draw(numbers),
        data.draw(numbers),
        np.array(data.draw(st.lists(st.integers(0, 3), min_size=n, max_size=n))),
    )
    risk, team = (data.draw(st.sampled_from((None, 0.01, 0.1, 0.3, 0.5))) for _ in range(2))
    limit = float(data.draw(st.integers(1, 40)))
    energy = Energy(2.0 * limit, 2.0, data.draw(st.sampled_from(("travel", "elapsed")))) if data.draw(st.booleans()) else None
    vehicle = VehicleType(
        None, max_duration=math.inf if energy else limit, energy=energy, risk=risk, speed=data.draw(st.sampled_from((1.0, 2.0)))
    )
    np.fill_diagonal(means, 0.0)
    travel = Travel(EXPLICIT, matrix=means, variances=variances)
    problem = RoutingProblem(Sites.of(range(n), service=service.astype(float)), travel, (vehicle,), team_risk=team)
    best, bound = RoutingTruth(problem).lenient, check_deviation_chord(problem, ALL_ROUTES)
    assert bound <= (math.inf if best is None else float(best[0]) + 1e-9)
    if problem.features() & RISKS:
        certain = replace(problem, fleet=(replace(vehicle, risk=None),), team_risk=None)
        assert bound >= verified_bound(certain, Evidence("all-routes", "", 0.0, {})) - 1e-9
    else:
        assert bound == -math.inf


def test_it_is_never_beyond_the_optimum_whatever_else_the_data_hold() -> None:
    proved = 0
    for number in range(draws(100)):
        problem = risky(5, number)
        bound, best = check_deviation_chord(problem, ALL_ROUTES), RoutingTruth(problem).lenient
        sign = 1.0 if problem.sense == "min" else -1.0
        assert best is None or sign * bound <= sign * float(best[0]) + 1e-9 * max(1.0, abs(float(best[0]))), problem.name
        proved += math.isfinite(bound)
    assert proved >= 0.2 * draws(100)


def test_it_is_never_beyond_the_optimum_on_hostile_numbers() -> None:
    """Nor are all routes, which know the roots of variances themselves; the judge takes every answer of enumeration."""
    at_risk = 0
    for seed in range(draws(150)):
        rng = np.random.default_rng([19, seed])
        problem = routing_at_risk(rng, Units.drawn(rng))
        truth = RoutingTruth(problem)
        bounds = [check_deviation_chord(problem, ALL_ROUTES), verified_bound(problem, Evidence("all-routes", "", 0.0, {}))]
        if truth.lenient is not None:
            best, size = float(truth.lenient[0]), float(truth.size)
            assert max(bounds) <= best + 1e-9 * max(abs(best), size), seed
        assert all(problem.evaluate(answer).feasible for answer in truth.samples), seed
        at_risk += bool(problem.features() & RISKS)
    assert at_risk >= 0.5 * draws(150)


@pytest.mark.parametrize("exponent", [-300, -40, 7, 60])
def test_times_in_other_units_have_the_squares_for_variances_and_the_same_bound(exponent: int) -> None:
    scale = 2.0**exponent
    assert check_deviation_chord(line(0.06, scale=scale), ALL_ROUTES) == check_deviation_chord(line(0.06), ALL_ROUTES)


def test_a_move_that_takes_no_time_but_has_a_variance_leaves_the_chord_to_the_limit_alone() -> None:
    problem = line(0.06)
    means = LINE.copy()
    means[1, 3] = 0.0
    problem = replace(problem, sites=replace(problem.sites, service=np.zeros(5)), travel=replace(problem.travel, duration_matrix=means))
    made = without_risks(problem)
    assert made is not None and made.fleet[0].travel is not None
    z = quantile(0.06)
    assert made.fleet[0].travel.durations[0, 1] == pytest.approx(4.0 + z * z / 18.0)


def test_without_variances_or_where_durations_count_it_proves_nothing() -> None:
    assert check_deviation_chord(replace(line(0.06), travel=Travel(EXPLICIT, matrix=LINE)), ALL_ROUTES) == -math.inf
    makespan = replace(line(0.06), objective=Objective.of(TotalCost() + Makespan()))
    assert lacks_chord(makespan) == {"objective:makespan"} and check_deviation_chord(makespan, ALL_ROUTES) == -math.inf
    assert lacks_chord(line(0.06, unit_duration_cost=1.0)) == {"duration-cost"}
    assert lacks_chord(line(0.06, committed=True)) == {"committed-vehicles"}


@pytest.mark.parametrize(
    "data",
    [
        {}, {"kind": "all-routes"}, {"kind": 3, "data": {}}, {"kind": KIND, "data": ALL_ROUTES}, {"kind": "all-routes", "data": []},
        {"kind": "no-such-kind", "data": {}}, {"kind": "state-space", "data": {"prices": [1.0], "step": 1.0, "resource": "time"}},
    ],
)  # fmt: skip
def test_malformed_evidence_is_refused_whatever_is_wrong_with_it(data) -> None:
    with pytest.raises((InputError, UsageError)):
        verified_bound(line(0.06), Evidence(KIND, "", 0.0, data))


def test_tampered_prices_prove_no_more_than_the_optimum() -> None:
    rng = np.random.default_rng(3)
    for _ in range(40):
        prices = rng.normal(0.0, 20.0, 5).tolist()
        data = {"kind": "state-space", "data": {"prices": prices, "resource": "duration", "step": float(rng.choice([0.25, 1.0, 3.0]))}}
        assert check_deviation_chord(line(0.06), data) <= 36.0
