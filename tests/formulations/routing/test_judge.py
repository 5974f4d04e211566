"""The judge of routes: schedules by hand, every violation by name and amount, and what must not change a verdict."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st

from waybound import LongestRoute, Makespan, Objective, Penalties, Reward, Route, Routes, RoutingProblem, TotalCost, Vehicles
from waybound.formulations.routing.judge import CHECKS, schedule
from waybound.formulations.tolerance import same
from waybound.instances.routing.instance import Energy, Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel

SQUARE = np.array([(0, 0), (3, 0), (3, 4), (0, 4), (-3, 0)], dtype=float)
WINDOWS = {"ready": [0, 0, 0, 10, 0], "due": [math.inf, 20, 6, 12, 4]}


def square(vehicle: VehicleType | None = None, objective: Objective | None = None, min_vehicles: int = 0, **sites) -> RoutingProblem:
    places = Sites.of("oabcd", coordinates=SQUARE, **sites)
    return RoutingProblem(
        places, Travel("euclidean", coordinates=SQUARE), (vehicle or VehicleType(),), objective or Objective(), min_vehicles
    )


def violations(problem: RoutingProblem, *routes) -> list[tuple[str, str | None, str | None, float]]:
    verdict = problem.evaluate(Routes(tuple(r if isinstance(r, Route) else Route(tuple(r)) for r in routes)))
    return [(v.check, v.vehicle, v.site, round(v.amount, 6)) for v in verdict.violations]


# -- schedules -------------------------------------------------------------------------------------------------------


def test_a_schedule_with_waiting_matches_the_one_by_hand():
    plan = schedule(square(**WINDOWS), Route((2, 3, 1)))
    assert plan.departure == 1.0
    assert plan.arrival.tolist() == [6.0, 9.0, 15.0]
    assert plan.begin.tolist() == [6.0, 10.0, 15.0]
    assert plan.finish == 18.0
    assert plan.waiting == 1.0
    # Travel 16; leaving a unit late (site b closes at 6) saves a unit of the 2 waited; the printed row charges 5 + 10 + 5 + 3.
    assert plan.charged == {"travel": 16.0, "elapsed": 17.0, "elapsed-fixed-start": 18.0, "windows": 23.0}
    assert plan.duration == 17.0


def test_services_delay_and_are_part_of_the_duration():
    plan = schedule(square(service=[9, 1, 2, 3, 4]), Route((1, 2)))
    assert plan.begin.tolist() == [3.0, 8.0]
    assert plan.finish == 15.0
    assert plan.charged["travel"] == 12.0
    assert plan.duration == 15.0


def test_departure_is_postponed_until_waiting_or_slack_is_used_up():
    late = square(ready=[0, 50, 0, 0, 0], due=[100, 60, 100, 100, 100])
    assert schedule(late, Route((1,))).duration == 6.0
    start_closes_early = RoutingProblem(
        Sites.of("oea", depot=[True, True, False], ready=[0, 0, 50], due=[20, 100, 60]),
        Travel("euclidean", coordinates=np.array([(0, 0), (0, 0), (3, 0)], dtype=float)),
        (VehicleType(start=0, end=1),),
    )
    assert schedule(start_closes_early, Route((2,))).duration == 53.0 - 20.0


def test_nobody_waits_for_the_depot_to_open_on_return():
    plan = schedule(square(ready=[10, 0, 0, 0, 0], due=[100, 100, 100, 100, 100]), Route((1,)))
    assert (plan.departure, plan.finish, plan.waiting) == (10.0, 16.0, 0.0)


def test_load_and_distance_accumulate_visit_by_visit():
    plan = schedule(square(demand=[0, 1, 2, 3, 4]), Route((1, 2, 3)))
    assert plan.load.tolist() == [1.0, 3.0, 6.0]
    assert plan.distance.tolist() == [3.0, 7.0, 10.0]
    assert plan.total_distance == 14.0


@settings(max_examples=draws(80), deadline=None)
@given(seed=st.integers(0, 10**6))
def test_the_shortest_duration_is_the_best_over_all_departures(seed):
    rng = np.random.default_rng(seed)
    ready = np.append(0.0, rng.integers(0, 30, 4)).astype(float)
    due = np.append(200.0, ready[1:] + rng.integers(0, 25, 4))
    problem = square(ready=ready, due=due, service=np.append(0, rng.integers(0, 4, 4)))
    route = Route(tuple(int(i) for i in rng.permutation([1, 2, 3, 4])[: rng.integers(1, 5)]))
    plan = schedule(problem, route)
    if any(a > d for a, d in zip(plan.arrival, due[list(route.visits)], strict=True)):
        return
    spans = []
    for departure in np.arange(0.0, 80.0, 0.25):
        at, clock, fits = 0, departure, True
        for site in route.visits:
            clock = max(clock + (problem.sites.service[at] if at else 0.0) + problem.travel.durations[at, site], ready[site])
            fits &= bool(clock <= due[site] + 1e-9)
            at = site
        clock += problem.sites.service[at] + problem.travel.durations[at, 0]
        if fits and clock <= due[0]:
            spans.append(clock - departure)
    # The scan steps by a quarter, so it may miss the best departure by one step.
    assert min(spans) - 0.25 <= plan.duration <= min(spans) + 1e-9


# -- verdicts --------------------------------------------------------------------------------------------------------


def test_a_feasible_answer_passes_every_check_and_its_values_are_recomputed():
    problem = square(VehicleType(count=2, capacity=9, fixed_cost=10, unit_cost=2), demand=[0, 1, 2, 3, 4], reward=[0, 4, 10, 5, 3])
    verdict = problem.evaluate(Routes.of([[1, 2, 3], [4]]))
    assert verdict.feasible
    assert verdict.values == (2 * 10 + 2 * (14 + 6),)
    assert [c.name for c in verdict.checks] == list(CHECKS)
    assert all(c.passed for c in verdict.checks)
    assert verdict.quantities == {"distance": 20.0, "vehicles": 2.0, "waiting": 0.0, "reward": 22.0}


@pytest.mark.parametrize(
    ("objective", "value"),
    [(Makespan(), 14.0), (LongestRoute(), 14.0), (Vehicles(), 2.0), (Reward(), 22.0), (TotalCost() + 3 * Vehicles(), 26.0)],
)
def test_each_term_is_recomputed(objective, value):
    problem = square(objective=Objective.of(objective), reward=[0, 4, 10, 5, 3])
    assert problem.evaluate(Routes.of([[1, 2, 3], [4]])).values == (value,)


def test_priorities_give_one_value_a_level():
    problem = square(objective=Vehicles().then(TotalCost()))
    assert problem.evaluate(Routes.of([[1, 2, 3], [4]])).values == (2.0, 20.0)


FREE = {"required": [False, False, True, True, True]}
LOADED = {"vehicle": VehicleType(capacity=4.5), "demand": [0, 1, 2, 3, 4]}
NAMED = {
    "a dropped visit": ({}, [[1, 2, 3]], [("visits", None, "d", 1.0)]),
    "a doubled visit, with how often": ({}, [[1, 2, 3, 4], [2, 1], [2]], [("visits", None, "a", 1.0), ("visits", None, "b", 2.0)]),
    "no optional site that is left out": (FREE, [[2, 3, 4]], []),
    "an optional site visited twice": (FREE, [[1, 2, 3, 4, 1]], [("visits", None, "a", 1.0)]),
    "a depot on the way": ({}, [[1, 0, 2, 3, 4]], [("visits", "vehicle 1", "o", 1.0)]),
    "no load that fits": (LOADED, [[1, 2], [4], [3]], []),
    "an overload": (LOADED, [[4], [1, 2, 3]], [("load", "vehicle 2", None, 1.5)]),
    "no arrival in time": (WINDOWS, [[4], [2, 3, 1]], []),
    "a late arrival": (WINDOWS, [[4], [3, 2], [1]], [("time-windows", "vehicle 2", "b", 7.0)]),
    "a late return": ({"due": [17.5, 50, 50, 50, 50]}, [[1, 2, 3, 4]], [("time-windows", "vehicle 1", "o", 0.5)]),
    "a distance": ({"vehicle": VehicleType(max_distance=17.0)}, [[1, 2, 3, 4]], [("distance", "vehicle 1", None, 1.0)]),
    "a duration": ({"vehicle": VehicleType(max_duration=17.5)}, [[1, 2, 3, 4]], [("duration", "vehicle 1", None, 0.5)]),
    "too many vehicles": ({"vehicle": VehicleType(count=1)}, [[1, 2], [3, 4]], [("fleet", None, None, 1.0)]),
    "too few vehicles": ({"min_vehicles": 3}, [[1, 2], [3, 4]], [("fleet", None, None, 1.0)]),
}


@pytest.mark.parametrize("case", NAMED)
def test_every_violation_is_named_with_its_amount(case):
    problem, routes, named = NAMED[case]
    assert violations(square(**problem), *routes) == named


@pytest.mark.parametrize("route", [Route((1, 2, 3, 9)), Route((-1, 1)), Route((1, 2), 3), Route((1, 2), -1)])
def test_sites_and_vehicles_that_do_not_exist_are_violations(route):
    assert ("visits", "vehicle 1", None, 1.0) in violations(square(), route)


@pytest.mark.parametrize(("charge", "drawn"), [("travel", 16.0), ("elapsed", 17.0), ("elapsed-fixed-start", 18.0), ("windows", 23.0)])
def test_energy_is_charged_as_its_mode_says(charge, drawn):
    enough, short = Energy(2 * drawn, 2.0, charge), Energy(2 * drawn - 1.0, 2.0, charge)
    assert violations(square(VehicleType(energy=enough), **WINDOWS), [2, 3, 1], [4]) == []
    assert violations(square(VehicleType(energy=short), **WINDOWS), [2, 3, 1], [4]) == [("energy", "vehicle 1", None, 1.0)]


def test_each_vehicle_type_has_its_own_limits():
    fleet = (VehicleType(count=1, capacity=2, name="bike"), VehicleType(count=1, capacity=9, name="van"))
    problem = replace(square(demand=[0, 1, 2, 3, 4]), fleet=fleet)
    assert violations(problem, Route((2,), 0), Route((1, 3, 4), 1)) == []
    assert [v[0] for v in violations(problem, Route((1, 2), 0), Route((3, 4), 1))] == ["load"]
    assert [v[0] for v in violations(problem, Route((2,), 0), Route((1,), 0), Route((3, 4), 1))] == ["fleet"]


def test_a_route_without_visits_is_not_driven():
    problem = square(VehicleType(count=1, fixed_cost=5.0), min_vehicles=1)
    verdict = problem.evaluate(Routes((Route(()), Route((1, 2, 3, 4)))))
    assert verdict.feasible
    assert verdict.values == (23.0,)
    assert violations(problem, Route(())) != []


def test_open_routes_start_and_end_at_their_own_depots():
    xy = np.array([(0, 0), (10, 0), (4, 3)], dtype=float)
    problem = RoutingProblem(
        Sites.of("oea", depot=[True, True, False]), Travel("euclidean", coordinates=xy), (VehicleType(start=0, end=1),)
    )
    assert problem.evaluate(Routes.of([[2]])).values[0] == pytest.approx(5.0 + math.hypot(6, 3))


# -- what must not matter --------------------------------------------------------------------------------------------


def random_case(seed: int) -> tuple[RoutingProblem, Routes]:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 8))
    ready = np.append(0.0, rng.integers(0, 20, n - 1)).astype(float)
    sites = Sites.of(
        [f"s{k}" for k in range(n)], demand=rng.integers(0, 5, n), ready=ready, due=np.append(90.0, ready[1:] + rng.integers(0, 40, n - 1)),
        service=rng.integers(0, 3, n),
    )  # fmt: skip
    vehicle = VehicleType(
        count=3, capacity=9.0, max_duration=60.0, energy=Energy(40.0, 1.0, str(rng.choice(["travel", "elapsed", "windows"])))
    )
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=rng.integers(1, 20, (n, n)).astype(float)), (vehicle,))
    order = rng.permutation(np.arange(1, n))[: int(rng.integers(1, n))]
    cut = int(rng.integers(0, len(order) + 1))
    return problem, Routes.of([order[:cut], order[cut:]])


def shape(verdict) -> tuple:
    return verdict.feasible, verdict.values, sorted((v.check, v.amount) for v in verdict.violations)


SEEDS = st.integers(0, 10**6)


@settings(max_examples=draws(60), deadline=None)
@given(seed=SEEDS)
def test_the_order_of_sites_in_the_file_does_not_matter(seed):
    problem, answer = random_case(seed)
    order = np.random.default_rng(seed).permutation(len(problem.sites))
    position = {int(site): k for k, site in enumerate(order)}
    vehicle = replace(problem.fleet[0], start=position[0], end=position[0])
    moved = RoutingProblem(problem.sites.subset(order), problem.travel.subset(order), (vehicle,))
    renamed = Routes.of([[position[i] for i in r.visits] for r in answer])
    assert shape(moved.evaluate(renamed)) == shape(problem.evaluate(answer))


@settings(max_examples=draws(60), deadline=None)
@given(seed=SEEDS)
def test_another_unit_of_length_and_time_scales_the_value_and_keeps_the_verdict(seed):
    problem, answer = random_case(seed)
    s, v, factor = problem.sites, problem.fleet[0], 4.0
    sites = replace(s, ready=s.ready * factor, due=s.due * factor, service=s.service * factor)
    vehicle = replace(v, max_duration=v.max_duration * factor, energy=Energy(v.energy.capacity * factor, v.energy.rate, v.energy.charge))
    scaled = RoutingProblem(sites, Travel(EXPLICIT, matrix=problem.travel.distances * factor), (vehicle,))
    mine, other = problem.evaluate(answer), scaled.evaluate(answer)
    assert other.feasible == mine.feasible
    assert other.values[0] == factor * mine.values[0]
    assert [(a.check, a.site) for a in other.violations] == [(a.check, a.site) for a in mine.violations]


@settings(max_examples=draws(60), deadline=None)
@given(seed=SEEDS)
def test_a_vehicle_type_or_an_optional_site_that_nobody_uses_changes_nothing(seed):
    problem, answer = random_case(seed)
    spare = replace(problem, fleet=(*problem.fleet, VehicleType(count=1, capacity=0.0, name="spare")))
    assert shape(spare.evaluate(answer)) == shape(problem.evaluate(answer))
    s, n = problem.sites, len(problem.sites)
    arrays = {k: np.append(getattr(s, k), 0.0) for k in ("demand", "ready", "service", "reward")}
    sites = Sites.of(
        [*s.ids, "extra"], depot=np.append(s.depot, False), due=np.append(s.due, 99.0), required=np.append(s.required, False), **arrays
    )
    matrix = np.full((n + 1, n + 1), 7.0)
    matrix[:n, :n] = problem.travel.distances
    assert shape(RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix), problem.fleet).evaluate(answer)) == shape(problem.evaluate(answer))


@settings(max_examples=draws(60), deadline=None)
@given(seed=SEEDS)
def test_the_order_of_routes_does_not_matter(seed):
    problem, answer = random_case(seed)
    assert shape(problem.evaluate(Routes(answer.routes[::-1]))) == shape(problem.evaluate(answer))


def test_no_penalty_is_known_as_closely_as_all_penalties_of_which_programs_take_away_those_avoided():
    problem = square(objective=Objective.of(Penalties()), penalty=[0, 3, 4, 0.6, 0.4], required=[False] * 5)
    verdict = problem.evaluate(Routes.of([[1, 2, 3, 4]]))
    assert (verdict.values, verdict.sizes) == ((0.0,), (8.0,))
    assert same(7e-15, verdict.values[0], verdict.size) and not same(1e-4, verdict.values[0], verdict.size)


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("objective", [None, "total-cost", "total-duration", "vehicles"])
def test_an_answer_that_adds_up_nothing_is_compared_like_a_first_move(unit: float, objective: str | None) -> None:
    """Bounds that rounding puts a little below 0 meet an optimum of 0, in any unit; others do not."""
    places = {"x": [0.0, 30.0 * unit, 50.0 * unit], "y": 0.0, "required": [True, False, False]}
    sites = pd.DataFrame({**places, "reward": [0.0, 5.0 * unit, 7.0 * unit]})
    given = {} if objective is None else {"objective": objective}
    empty = RoutingProblem.from_frame(sites, vehicles=1, **given).evaluate(Routes.of([]))
    one = 1.0 if objective == "vehicles" else unit
    assert empty.values == (0.0,)
    assert empty.same_at(0, -1e-10 * one) and not empty.same_at(0, -1e-6 * one)
