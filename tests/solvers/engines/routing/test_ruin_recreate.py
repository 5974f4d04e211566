"""Ruin and recreate: that it finds optima is held by the conformance suite; here is what is its own."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from coded import coded
from small_routing import small, varied
from truth.routing import best_values

import waybound as wb
from waybound.instances.errors import UsageError
from waybound.solvers.backend import Control, Options
from waybound.solvers.engines.routing import ruin_recreate
from waybound.solvers.engines.routing.ruin_recreate import RuinRecreate


def run(problem: wb.RoutingProblem, **options: object) -> object:
    return RuinRecreate().run(problem, Options(**{"time_limit": 60.0, **options}), Control())  # type: ignore[arg-type]


def test_iterations_and_a_seed_make_the_same_routes() -> None:
    problem = wb.generate("random", customers=40, capacity=40)
    answers = [wb.solve(problem, "ruin-recreate", iterations=3000, seed=seed, bound_time=0).answer for seed in (1, 1, 2)]
    assert answers[0] == answers[1] != answers[2]


def test_it_counts_ruins_and_ends_without_improvement() -> None:
    problem = wb.generate("random", customers=20, capacity=40)
    assert run(problem, iterations=1234).statistics["iterations"] == 1234
    ended = run(problem, no_improvement=500)
    assert ended.limit == "iterations" and ended.statistics["iterations"] >= 500


def test_who_is_on_no_route_is_named() -> None:
    problem = wb.generate("random", customers=6, capacity=40)
    far = replace(problem, fleet=(replace(problem.fleet[0], count=1, capacity=float(problem.sites.demand.max())),))
    found = run(far, iterations=500)
    assert found.status == "unknown" and found.answer is None
    assert found.message.startswith("no answer was found that visits every required site; the best one leaves out ")


def test_a_vehicle_takes_no_route_over_that_it_lacks_skills_for() -> None:
    problem = varied("skills", 27, 5)
    for seed in range(3):
        assert problem.evaluate(run(problem, iterations=2000, seed=seed).answer).feasible


@pytest.mark.parametrize("iterations", [1641, 2000])
def test_the_search_for_places_ends_with_its_share_of_iterations(iterations: int) -> None:
    problem = wb.generate("random", customers=6, capacity=40)
    tight = replace(problem, fleet=(replace(problem.fleet[0], count=1, capacity=float(problem.sites.demand.max())),))
    assert run(tight, iterations=iterations).statistics["iterations"] == iterations


def test_routes_are_dissolved_where_vehicles_count_first() -> None:
    """Twelve loads of 5, 5 and 6 go on four vehicles of 16 in one way only."""
    load = np.array([0, *[5, 5, 6] * 4])
    turn = np.linspace(0, 2 * np.pi, 13)
    xy = np.column_stack([np.cos(turn), np.sin(turn)]) * 100 * (load > 0)[:, None]
    sites = wb.Sites.of(range(13), demand=load, coordinates=xy)
    goal = wb.Vehicles().then(wb.TotalCost())
    problem = wb.RoutingProblem(sites, wb.Travel("euclidean", xy), (wb.VehicleType(capacity=16.0),), goal)
    found = run(problem, iterations=20_000)
    assert problem.evaluate(found.answer).values[0] == 4


def test_several_anneals_and_answers_made_of_two_are_no_worse_and_repeat(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ruin_recreate, "AMPLE", 2_000)
    problem = wb.generate("random", customers=30, capacity=40)
    many = ruin_recreate.AMPLE * 30
    found, again = (run(problem, iterations=many) for _ in range(2))
    assert found.answer == again.answer and problem.evaluate(found.answer).feasible
    assert found.statistics["iterations"] == many


def test_where_only_rewards_count_the_claim_is_the_judges_and_routes_are_short() -> None:
    problem = small("reward", 2, "exact")
    found = run(problem, iterations=2000)
    judged = problem.evaluate(found.answer)
    assert judged.feasible and found.objective == judged.values[0]


@pytest.mark.parametrize("scale", [1.0, 1e3, 1e6, 1e9])
def test_no_reward_is_worth_a_required_site(scale: float) -> None:
    """One vehicle can visit a poor required site, or the rich ones that lie the other way."""
    xy = np.array([[0, 0], [-40, 0], *([30 + k, 0] for k in range(8))], dtype=float)
    sites = wb.Sites.of(range(10), required=[False, True, *[False] * 8], reward=np.array([0, 1, *range(50, 58)]) * scale, coordinates=xy)
    vehicle = wb.VehicleType(count=1, max_distance=90.0)
    for objective in (wb.Reward(), wb.Reward().then(wb.TotalCost()), wb.TotalCost() - wb.Reward()):
        problem = wb.RoutingProblem(sites, wb.Travel("euclidean", xy), (vehicle,), objective)
        found = run(problem, iterations=2000)
        assert found.answer is not None and problem.evaluate(found.answer).feasible


@pytest.mark.parametrize("optional", [False, True])
def test_no_answer_has_fewer_routes_than_are_asked_for(optional: bool) -> None:
    problem = wb.generate("random", customers=6, capacity=0)
    if optional:
        problem = replace(problem, sites=replace(problem.sites, required=np.zeros(7, dtype=bool)))
    for fewest in (2, 6):
        found = run(replace(problem, min_vehicles=fewest), iterations=300)
        assert len(found.answer) == fewest
    alone = replace(problem, fleet=(replace(problem.fleet[0], count=7),), min_vehicles=7)
    found = run(alone, iterations=300)
    assert found.answer is None and found.message == "no answer was found that has 7 routes"


@pytest.mark.slow
def test_of_alternatives_those_are_visited_that_fill_no_route_too_many(benchmarks: Path) -> None:
    from waybound.instances.reading import read_instance
    from waybound.reports.benchmarks.made_problems import grouped

    problem = grouped(read_instance(benchmarks / "cvrp/X/X-n200-k36.vrp"), "groups-of-three", {})
    counts = [len(run(problem, iterations=60_000, seed=seed).answer) for seed in range(3)]  # type: ignore[attr-defined]
    assert sorted(counts)[1] == 10  # by the cheapest place alone, nearly all have eleven


def test_overtime_is_no_reason_to_leave_a_required_site_out() -> None:
    xy = np.array([[0, 0], [3, 0], [-3, 0], [0, 4]], dtype=float)
    vehicle = wb.VehicleType(count=1, unit_cost=0.0, regular_duration=1.0, unit_overtime_cost=5.0)
    problem = wb.RoutingProblem(wb.Sites.of(range(4), coordinates=xy), wb.Travel("euclidean", xy), (vehicle,))
    found = run(problem, iterations=200)
    assert problem.evaluate(found.answer).feasible and len(found.answer) == 1


def test_the_longest_route_is_taken_by_bisection() -> None:
    problem = replace(small("capacity", 0, "exact"), objective=wb.Objective.of(wb.LongestRoute()))
    found = run(problem, iterations=4000)
    assert any(link.name == "bisection" for link in found.links)
    assert problem.evaluate(found.answer).feasible


@pytest.mark.parametrize("feature", ["route-risk", "team-risk"])
def test_risks_are_kept_and_best_answers_found(feature: str) -> None:
    for seed in range(8):
        problem = varied(feature, seed)
        best, found = best_values(problem), run(problem, iterations=2000).answer
        assert (None if found is None else problem.evaluate(found).values) == (best and pytest.approx(best)), seed


@pytest.mark.parametrize("term", [wb.Makespan(), wb.LongestRoute(), wb.LatestReturn()])
def test_a_maximum_is_weighed_against_other_terms(term: Any) -> None:
    for seed in range(5):
        problem = replace(varied("shifts", seed), objective=wb.TotalCost() + 0.5 * term)
        best, found = best_values(problem), run(problem, iterations=2000).answer
        assert (None if found is None else problem.evaluate(found).values) == (best and pytest.approx(best)), seed


def test_a_risk_hangs_on_the_longest_duration_that_is_allowed_which_no_bisection_may_change() -> None:
    problem = replace(varied("route-risk", 0), objective=wb.Makespan())
    assert not RuinRecreate().bisects(problem)
    assert problem.evaluate(run(problem, iterations=2000).answer).values == pytest.approx(best_values(problem))


@pytest.mark.parametrize(
    ("option", "value"), [("removals", 0.0), ("string", 0.5), ("neighbours", 0), ("hot", -1.0), ("cold", -1e-9), ("worth", -1.0)]
)
def test_options_out_of_range_are_refused(option: str, value: float) -> None:
    with pytest.raises(UsageError, match=option, check=coded("out-of-range")):
        run(small("capacity", 0, "round"), extra={option: value})


def test_time_on_the_move_is_limited_by_itself_where_moves_take_other_than_they_are_long() -> None:
    problem = small("travel", 0, "exact")
    slow = replace(problem, fleet=(replace(problem.fleet[0], speed=0.8),))
    for one in (problem, slow):
        assert not RuinRecreate().missing(one) and one.evaluate(run(one, iterations=500).answer).feasible
    assert not slow.evaluate(run(problem, iterations=500).answer).feasible


def test_charges_by_windows_are_refused_where_vehicles_reload() -> None:
    problem = varied("reloads", 0, 3)
    charged = replace(problem, fleet=tuple(replace(v, energy=wb.Energy(99.0, 1.0, "windows")) for v in problem.fleet))
    assert "energy:windows with reloads" in RuinRecreate().missing(charged)


def test_an_empty_answer_is_left_for_visits_that_pay_only_together() -> None:
    xy = np.array([[0, 0], [30, 0], [31, 0], [30, 1]], dtype=float)
    sites = wb.Sites.of(range(4), required=[False] * 4, penalty=[0, 40, 40, 40], coordinates=xy)
    problem = wb.RoutingProblem(sites, wb.Travel("euclidean", xy), (wb.VehicleType(),), wb.TotalCost() + wb.Penalties())
    assert len(run(problem, iterations=2000).answer) == 1


def test_a_limit_of_time_is_kept_and_the_best_answer_handed_out() -> None:
    problem = wb.generate("random", customers=200, capacity=60)
    control, heard = Control(), []
    control.goal = lambda answer, objective: heard.append(objective) or False
    found = RuinRecreate().run(problem, Options(time_limit=0.3), control)
    assert found.limit == "time" and problem.evaluate(found.answer).feasible
    assert np.all(np.diff(heard) <= 0) and found.objective == min(heard)


def test_a_window_that_opens_after_the_depot_closes_is_of_no_use() -> None:
    """Both sites are open up to 4 and from 50 on, and one vehicle reaches only one of them before 4."""
    xy = np.array([[0, 0], [3, 0], [-3, 0]], dtype=float)
    sites = wb.Sites.of(range(3), coordinates=xy, windows={k: [(0, 4), (50, math.inf)] for k in (1, 2)}, due=[40, math.inf, math.inf])
    problem = wb.RoutingProblem(sites, wb.Travel("euclidean", xy), (wb.VehicleType(count=2, fixed_cost=100.0),))
    found = run(problem, iterations=500)
    assert problem.evaluate(found.answer).feasible and len(found.answer) == 2


def test_a_run_that_ends_without_improvement_repeats() -> None:
    problem = wb.generate("random", customers=30, capacity=40)
    one, again = (run(problem, no_improvement=2000) for _ in range(2))
    assert one.answer == again.answer and one.statistics["iterations"] == again.statistics["iterations"]


def test_a_course_cools_down_once_or_begins_again() -> None:
    once = ruin_recreate.Course(100.0, 1.0)
    assert [once.warmth(share, 0) for share in (0.0, 0.5, 1.0)] == pytest.approx([100.0, 10.0, 1.0]) and not once.over(1.0, 0)
    course = ruin_recreate.Course(100.0, 1.0, anneals=2)
    each = ruin_recreate.FROM_NOTHING / 2
    assert course.warmth(each / 2, 0) == pytest.approx(10.0) and not course.over(each / 2, 0) and course.over(each, 0)
    assert course.next(each, 500, 40)
    assert course.warmth(each, 500) == pytest.approx(100.0 * ruin_recreate.COOLER) and course.warmth(2 * each, 900) == pytest.approx(1.0)
    assert not course.next(2 * each, 1000, 40)
    assert course.warmth(0.7, 1000) == pytest.approx(100.0 * ruin_recreate.REWARMED)
    assert not course.over(0.7, 1039) and course.over(0.7, 1040)


def test_one_anneal_of_many_customers_begins_cooler_the_less_time_there_is() -> None:
    from types import SimpleNamespace

    def begun(customers: int, ruins_each: float) -> tuple[int, float]:
        from waybound.solvers.engines.routing.ruin_recreate_steps import columns

        course, held = ruin_recreate.Course(100.0, 1.0), SimpleNamespace(flags=0, most_visits=customers)
        ruin_recreate._Search.plan(SimpleNamespace(columns=columns, held=held, abreast=1), course, ruins_each * customers)
        return course.anneals, course.hot

    assert begun(400, 12_000) == (ruin_recreate.ANNEALS, 100.0) and begun(400, 6_000) == (1, 50.0) and begun(400, 10) == (1, 25.0)
    assert begun(299, 10) == (1, 100.0)
