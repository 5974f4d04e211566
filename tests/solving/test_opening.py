"""Heuristics that open: whose answers the default solver starts from, and what happens where they find none."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Routes
from waybound.heuristics.heuristic import HEURISTICS, Outcome
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.solvers.backend import BACKENDS, Options
from waybound.solving import opening
from waybound.solving.opening import opened, opening_heuristic
from waybound.solving.solve import solve

NAME = "safety-margins"
ALONE = Routes.of([[k] for k in range(1, 14)])


def star(risk: float | None = 0.1, customers: int = 13, team_risk: float | None = None) -> RoutingProblem:
    """Customers around a depot, two of which fit into a route."""
    angle = 2.0 * np.pi * np.arange(customers) / customers
    xy = np.concatenate([[[0.0, 0.0]], 10.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)])
    matrix = np.linalg.norm(xy[:, None] - xy[None], axis=2).round(3)
    vehicle = VehicleType(customers, risk=risk, max_duration=28.0)
    return RoutingProblem(
        Sites.of(range(customers + 1)), Travel(EXPLICIT, matrix=matrix, variances=matrix / 50), (vehicle,), team_risk=team_risk
    )


@contextmanager
def finding(answer: Any) -> Iterator[list[float]]:
    """``safety-margins`` with this answer, or this exception; tells the time limits that it was given."""
    limits: list[float] = []

    def run(problem: Any, context: Any) -> Outcome:
        limits.append(context.time_limit)
        if isinstance(answer, Exception):
            raise answer
        return Outcome(answer, message="" if answer else "no routes")

    with HEURISTICS.temporary(NAME, replace(HEURISTICS[NAME], run=run)):
        yield limits


def test_it_opens_problems_with_risks_and_more_than_a_few_customers() -> None:
    assert opening_heuristic(star(), Options()) == opening_heuristic(star(None, team_risk=0.2), Options()) == NAME
    assert opening_heuristic(star(customers=9), Options()) is None
    assert opening_heuristic(star(customers=12), Options()) is None, "all sets of sites are looked at"
    assert opening_heuristic(star(customers=6, risk=None, team_risk=0.2), Options()) is None
    assert opening_heuristic(replace(star(None), travel=replace(star().travel, variances=None)), Options()) is None
    for asked in ({"start": ALONE}, {"iterations": 5}, {"no_improvement": 5}, {"extra": {"presolve": False}}):
        assert opening_heuristic(star(), Options(**asked)) is None


def test_the_solver_gets_the_answer_and_the_time_that_is_left() -> None:
    with finding(ALONE) as limits:
        options, seconds, said = opened(star(), NAME, Options(time_limit=8.0, gap=0.1), isolate=False)
    assert (options.start, options.gap, said, limits) == (ALONE, 0.1, "", [4.0])
    assert options.time_limit == pytest.approx(8.0 - seconds)


@pytest.mark.slow
@pytest.mark.skipif(not BACKENDS["scip"].installed(), reason="SCIP is not installed")
def test_no_answer_is_worse_than_the_start() -> None:
    with finding(ALONE):
        found = solve(star(), time_limit=1.0, bound_time=0)
    assert found.answer is not None and found.objective <= 260.0 and found.form == "three-index-cones"
    assert f"{found.solver} started from the answer of {NAME}" in found.message


@pytest.mark.parametrize(("answer", "words"), [(None, "no routes"), (RuntimeError("lost"), "RuntimeError: lost")])
def test_without_a_start_the_solver_goes_on(answer: Any, words: str) -> None:
    with finding(answer):
        options, _, said = opened(star(), NAME, Options(), isolate=False)
    assert options.start is None and words in said


def test_large_problems_and_those_for_which_there_is_no_solver_are_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    with finding(ALONE) as limits:
        found = solve(star(None, 13, team_risk=0.2), time_limit=8.0, bound_time=0)
        assert (found.solver, found.status, limits) == (NAME, "feasible", [8.0])
        monkeypatch.setattr("waybound.solving.runs.LARGEST", 5)
        assert solve(star(), time_limit=8.0, bound_time=0).solver == NAME
    assert opening.LARGEST == 50


def test_few_customers_with_too_many_routes_for_an_exact_form_are_its_own() -> None:
    far = star(None, 13, team_risk=0.2)
    far = replace(far, fleet=(replace(far.fleet[0], max_duration=280.0),))
    assert "set-partitioning" not in far.forms()
    with finding(Routes.of([range(1, 14)])) as limits:
        found = solve(far, time_limit=8.0, bound_time=0)
    assert (found.solver, found.status, limits) == (NAME, "feasible", [8.0])


@pytest.mark.slow
def test_who_names_a_solver_or_a_form_gets_it_alone() -> None:
    with finding(RuntimeError("not asked")) as limits:
        for asked in ({"solver": "outer-approximation"}, {"form": "three-index-cones"}):
            solve(star(), time_limit=0.2, bound_time=0, **asked)
    assert not limits
