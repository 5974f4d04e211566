import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from coded import coded
from small_routing import varied
from truth.routing import RoutingTruth, routes

from waybound import Energy, InputError, Route, Routes, RoutingProblem, Sites, UnsupportedError, UsageError, VehicleType, generate, solve
from waybound.formulations.routing.objective import Makespan, Objective, Reward, TotalCost
from waybound.formulations.routing.overrun import joint_overrun, route_overrun
from waybound.formulations.routing.schedule import schedule
from waybound.formulations.stop import NEVER, Stop
from waybound.heuristics.heuristic import HEURISTICS, Context
from waybound.heuristics.routing import safety_margins
from waybound.heuristics.routing.safety_margins import Pool, certain, split
from waybound.instances.routing.features import RISKS
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.reports.ratios.judged_runs import run_heuristic
from waybound.solvers.linear_programs import LinearPrograms

NAME = "safety-margins"
LINE = np.abs(np.subtract.outer(*[np.array([0.0, 4, -5, 6, -7])] * 2))


def line(risk: float | None = None, team_risk: float | None = None, vehicles: int | None = 3, **limits: object) -> RoutingProblem:
    """Customers on both sides of the depot, each with a service of 1."""
    sites, travel = Sites.of(range(5), service=[0, 1, 1, 1, 1]), Travel(EXPLICIT, matrix=LINE, variances=LINE / 4)
    vehicle = VehicleType(vehicles, risk=risk, **{"max_duration": 18.0, **limits})  # type: ignore[arg-type]
    return RoutingProblem(sites, travel, (vehicle,), team_risk=team_risk)


@pytest.mark.share(2)
@pytest.mark.parametrize(
    ("risk", "team_risk", "cost"),
    [(0.15, None, 26.0), (0.06, None, 36.0), (None, 0.3, 26.0), (None, 0.15, 34.0), (0.05, None, None), (None, 0.06, None)],
)
def test_the_example_of_risks(risk: float | None, team_risk: float | None, cost: float | None) -> None:
    """With 0.15 for the team the optimum of 34 gives one route nearly all of it, where equal shares for all would cost 36."""
    problem = line(risk, team_risk)
    answer = run_heuristic(problem, NAME, {}, 1).answer
    if cost is None:
        assert answer is None
    else:
        judged = problem.evaluate(answer)
        assert judged.feasible and judged.values == (cost,)


@pytest.mark.share(2)
@pytest.mark.parametrize("feature", ["team-risk", "route-risk"])
def test_answers_keep_all_limits_and_most_are_optimal(feature: str) -> None:
    found = best = 0
    for seed in range(24):
        problem = replace(varied(feature, seed), objective=Objective.of(TotalCost()))
        if HEURISTICS[NAME].missing(problem):
            continue
        truth, answer = RoutingTruth(problem), run_heuristic(problem, NAME, {"steps": 200}, seed).answer
        if truth.best is None or answer is None:
            assert answer is None or truth.lenient is not None
            continue
        judged = problem.evaluate(answer)
        assert judged.feasible and judged.values[0] >= float(truth.best[0]) - 1e-9
        found += 1
        best += judged.values[0] <= float(truth.best[0]) + 1e-9
    assert found >= 8 and best >= 0.7 * found


def test_the_same_seed_finds_the_same_and_a_start_is_kept_where_it_is_good() -> None:
    problem = line(None, 0.15)
    assert run_heuristic(problem, NAME, {}, 5).answer == run_heuristic(problem, NAME, {}, 5).answer
    start = Routes.of([[1], [2, 4], [3]])
    assert solve(problem, heuristic=NAME, start=start, bound_time=0.0).objective == 34.0


def test_what_it_cannot_take_is_named() -> None:
    lacks = HEURISTICS[NAME].missing
    assert lacks(replace(line(), travel=Travel(EXPLICIT, matrix=LINE))) == {"problems without a limit on risk"}
    assert lacks(line(0.1, max_duration=math.inf, energy=Energy(30.0))) >= {"energy:travel"}
    assert lacks(line(0.1)) == lacks(line(None, 0.1)) == frozenset()
    for options in ({"rounds": 0}, {"steps": 1.5}, {"splits": -1}):
        with pytest.raises(UsageError, check=coded("out-of-range")):
            run_heuristic(line(0.1), NAME, options, 1)
    with pytest.raises(UsageError, check=coded("contradiction")):
        run_heuristic(line(0.1), NAME, {"engine": "highs"}, 1)


def test_routes_are_by_any_engine_that_takes_what_is_left() -> None:
    problem = line(0.06)
    answer = run_heuristic(problem, NAME, {"engine": "ortools", "rounds": 2, "splits": 1, "steps": 20}, 1).answer
    assert problem.evaluate(answer).feasible and problem.evaluate(answer).values == (36.0,)
    asked = replace(problem, objective=Objective.of(TotalCost() - Reward()))
    with pytest.raises(UnsupportedError, match=r"engine vroom cannot take this problem: it does not handle .*objective:reward"):
        run_heuristic(asked, NAME, {"engine": "vroom"}, 1)


@pytest.mark.parametrize("seed", range(3))
def test_a_split_of_what_is_left_of_the_risk_never_costs_anything(seed: int) -> None:
    made = generate("random", customers=12, capacity=0, deviation=0.4, seed=seed, **{"max-duration": 240.0})
    problem, values = replace(made, team_risk=0.1), []
    for splits in (0, 3):
        answer = run_heuristic(problem, NAME, {"splits": splits, "steps": 60}, seed).answer
        verdict = problem.evaluate(answer)
        assert verdict.feasible and verdict.quantities["team-overrun"] <= 0.1 * (1 + 1e-9)
        values.append(verdict.values[0])
    assert values[1] <= values[0] * (1 + 1e-12)


def test_asked_to_stop_it_returns_what_it_has() -> None:
    stop = Stop()
    stop.ask()
    context = Context(np.random.default_rng(1), 10.0, Routes.of([[1], [2, 4], [3]]), lambda answer: None, stop, LinearPrograms())
    found = HEURISTICS[NAME].run(line(None, 0.15), context)
    assert found.limit == "interrupt" and found.answer is not None
    assert HEURISTICS[NAME].run(line(0.05), replace(context, start=None, stop=NEVER)).message == "no routes were found that keep the limits"


def test_an_engine_that_cannot_count_the_margins_costs_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, calls = safety_margins.PyVRP.run, list[float]()

    def only(*, first: bool) -> None:
        def run(*args: Any) -> Any:
            calls.append(1.0)
            if first and len(calls) == 1:
                return whole(*args)
            raise InputError("the largest duration is too large")

        calls.clear()
        monkeypatch.setattr(safety_margins.PyVRP, "run", run)

    only(first=True)
    late = line(0.06)
    start = Routes.of([[1], [2], [3, 4]]) if late.evaluate(Routes.of([[1], [2], [3, 4]])).feasible else Routes.of([[1, 3], [2], [4]])
    assert solve(late, heuristic=NAME, start=start, bound_time=0).answer is not None and len(calls) > 1
    only(first=False)
    refused = solve(late, heuristic=NAME, bound_time=0)
    assert refused.answer is None and "pyvrp refuses durations with margins: the largest duration is too large" in refused.message


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


@pytest.mark.parametrize(("team_risk", "cost"), [(0.3, 26.0), (0.15, 34.0), (0.08, 36.0)])
def test_the_best_choice_keeps_the_risk_of_the_team(team_risk: float, cost: float) -> None:
    """a-c and b-e from two answers, of which only one may be taken under 0.15, and neither beside e under 0.08."""
    problem = line(None, team_risk, 4)
    pool = Pool(problem)
    pool.add(Routes.of([[1, 3], [2], [4]]))
    pool.add(Routes.of([[1], [3], [2, 4]]))
    answer = pool.best(Stop(), 1, None)
    assert answer is not None and problem.evaluate(answer).feasible and problem.evaluate(answer).values == (cost,)
    assert pool.best(Stop(), 1, None) is None  # nothing new
    pool.add(Routes.of([[3, 1]]))
    assert pool.best(Stop(), 1, answer) is not None


def test_routes_that_break_a_limit_by_themselves_are_not_kept() -> None:
    pool = Pool(line(None, 0.02, 4))
    before = set(pool.routes)
    assert Route((4,)) not in before  # overruns with 0.0544
    pool.add(Routes.of([[1, 2], [2, 4], [1, 3]]))
    assert set(pool.routes) == before | {Route((1, 3))}


def test_a_maximum_that_should_be_large_is_beyond_it() -> None:
    pool = Pool(replace(line(None, 0.1, 4), objective=Objective.of(Reward() + Makespan())))
    pool.add(Routes.of([[1]]))
    assert not pool.routes and pool.best(Stop(), 1, None) is None


def test_asked_to_stop_it_looks_for_nothing() -> None:
    stop = Stop()
    stop.ask()
    assert Pool(line(None, 0.3, 4)).best(stop, 1, None) is None
