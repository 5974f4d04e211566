import itertools
from dataclasses import replace
from typing import Any

import pytest
from draws import draws
from small_routing import plane, small, varied
from truth.routing import best_values

import waybound as wb
from waybound import Objective, UnsupportedError, UsageError
from waybound.solvers.backend import BACKENDS
from waybound.solving.search_log import counts_of

FEATURES = ("capacity", "time-windows", "max-distance", "open-routes", "limited-fleet", "fixed-cost")
OTHERS = ("heterogeneous-fleet", "multiple-depots", "prizes", "reward")  # types of vehicle, and sites that may be left out


@pytest.mark.parametrize(("feature", "seed"), [*itertools.product(FEATURES, range(draws(5))), *itertools.product(OTHERS, range(3))])
def test_small_problems_end_optimal_and_verified_or_without_an_answer(feature: str, seed: int) -> None:
    problem = small(feature, seed, "exact")
    best, solution = best_values(problem), wb.solve(problem, "branch-price-cut", bound_time=0 if feature in OTHERS else None)
    if best is None:
        assert feature not in OTHERS and solution.status == "infeasible"
    else:
        assert (solution.status, solution.bound_kind) == ("optimal", "verified")
        assert solution.objective == pytest.approx(best[0]) == solution.bound


def test_a_start_is_taken_and_bettered() -> None:
    problem = plane(3, 12, 25.0)
    start = wb.Routes.of([[int(site)] for site in problem.customers])
    solution = wb.solve(problem, "branch-price-cut", start=start)
    assert solution.status == "optimal" and solution.objective < problem.evaluate(start).values[0]


def test_options_are_checked_and_limits_are_kept_to() -> None:
    problem = plane(3, 12, 25.0)
    with pytest.raises(UsageError, match="columns"):
        wb.solve(problem, "branch-price-cut", no_such=1)
    for name, value in (("columns", 0), ("labels", 1), ("memory", -1)):
        with pytest.raises(UsageError, match=f"option {name} must be at least"):
            wb.solve(problem, "branch-price-cut", **{name: value})
    with pytest.raises(UsageError, match="stabilisation must be one of trust-region, smoothing, none, not 'box'"):
        wb.solve(problem, "branch-price-cut", stabilisation="box")
    with pytest.raises(UsageError, match="the memory limit must be at least 271 MB for this problem, not 5"):
        wb.solve(problem, "branch-price-cut", memory_limit=5)
    assert wb.solve(problem, "branch-price-cut", memory_limit=271, bound_time=0).status == "optimal"
    few = wb.solve(problem, "branch-price-cut", labels=5, bound_time=0)
    assert (few.status, few.limit) == ("feasible", "memory") and few.objective >= wb.solve(problem, "branch-price-cut").objective


def test_a_gap_ends_it_early_and_is_kept_to() -> None:
    problem = plane(4, 14, 30.0)
    whole, near = wb.solve(problem, "branch-price-cut"), wb.solve(problem, "branch-price-cut", gap=0.5)
    assert whole.status == "optimal" and near.bound_kind == "verified"
    assert near.bound <= whole.objective <= near.objective and near.objective - near.bound <= 0.5 * near.objective


@pytest.mark.parametrize("stabilisation", ["smoothing", "trust-region", "none"])
@pytest.mark.parametrize("seed", range(draws(4)))
def test_proofs_are_verified_however_prices_are_stabilised(stabilisation: str, seed: int) -> None:
    problem = plane(seed, 12, 25.0)
    solution = wb.solve(problem, "branch-price-cut", stabilisation=stabilisation, bound_time=0)
    assert (solution.status, solution.bound_kind) == ("optimal", "verified")
    assert solution.objective == pytest.approx(wb.solve(problem, "branch-price-cut").objective)


def test_what_it_cannot_price_it_refuses_by_name() -> None:
    for objective in ("total-cost + longest-route", "makespan + longest-route", "reward - makespan"):
        with pytest.raises(UnsupportedError, match=r"objective:(longest-route|makespan)"):
            wb.solve(replace(small("capacity", 1, "exact"), objective=Objective.of(objective)), "branch-price-cut")


@pytest.mark.parametrize("term", ["makespan", "longest-route", "2*latest-return"])
@pytest.mark.parametrize("feature", ["limited-fleet", "service-times", "max-distance", "multiple-depots", "separate-durations"])
@pytest.mark.parametrize("seed", range(draws(2)))
def test_the_largest_route_ends_optimal_and_verified_or_without_an_answer(feature: str, term: str, seed: int) -> None:
    problem = small(feature, seed, "exact")
    fleet = tuple(replace(v, count=1 if len(problem.fleet) > 1 else 2, capacity=2.0 * v.capacity) for v in problem.fleet)
    problem = replace(problem, objective=Objective.of(term), fleet=fleet)
    best, solution = best_values(problem), wb.solve(problem, "branch-price-cut", bound_time=0)
    if best is None:
        assert solution.status == "infeasible" and solution.certificate.infeasible
    else:
        assert (solution.status, solution.bound_kind) == ("optimal", "verified") and solution.objective == pytest.approx(best[0])
        assert solution.bound == pytest.approx(best[0]) and solution.statistics["limits_tried"] >= 0


def test_limits_leave_both_ends_of_the_largest_route() -> None:
    problem = replace(plane(4, 14, 30.0, 3), objective=Objective.of("longest-route"))
    whole = wb.solve(problem, "branch-price-cut", bound_time=0)
    few = wb.solve(problem, "branch-price-cut", labels=5, bound_time=0)
    near = wb.solve(problem, "branch-price-cut", gap=0.2, bound_time=0)
    assert whole.status == "optimal" and (few.status, few.limit, few.bound_kind) == ("feasible", "memory", "verified")
    assert few.bound < whole.objective == pytest.approx(whole.bound) and near.objective - near.bound <= 0.2 * near.objective
    assert near.bound <= whole.objective <= near.objective


@pytest.mark.parametrize("feature", ["groups", "skills", "penalties", "several-loads", "pickups"])
@pytest.mark.parametrize("seed", range(4))
def test_groups_skills_penalties_and_loads_are_too(feature: str, seed: int) -> None:
    problem = replace(varied(feature, seed, 5), objective=Objective.of("total-cost + 2*penalties"))
    if BACKENDS["branch-price-cut"]().missing(problem):
        pytest.skip("other features that are drawn with it")
    solution, best = wb.solve(problem, "branch-price-cut", bound_time=0), best_values(problem)
    assert solution.status == ("infeasible" if best is None else "optimal")
    assert best is None or solution.bound == pytest.approx(best[0]) == solution.objective


def test_columns_cuts_and_labels_are_counted_for_the_log() -> None:
    events: list[dict[str, Any]] = []
    wb.solve(plane(4, 16, 30.0), "branch-price-cut", progress=events.append)
    counts = [event["counts"] for event in events if event["counts"]][-1]
    assert counts.keys() == {"columns", "cuts", "labels"} and counts["columns"] > 0 and counts["labels"] > 0
    assert counts_of({"nodes": 2, "counts": {"cuts": 1200}}) == ["2 nodes", "1,200 cuts"]
