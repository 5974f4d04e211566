"""Heuristics that open: whose answers the default solver starts from, and what happens where they find none."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Routes
from waybound.heuristics.heuristic import HEURISTICS, Outcome
from waybound.instances.errors import UsageError
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel
from waybound.solvers import interrupts
from waybound.solvers.backend import BACKENDS, Control, Engine, Options, RawResult
from waybound.solving import opening
from waybound.solving.opening import opened, opening_heuristic
from waybound.solving.runs import default_run
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


class Deaf(Engine):
    """An engine that takes every problem before all others, and comes back when it is told to."""

    name, package, modules, summary = "deaf", "waybound", ("json",), "for tests"
    family, features, order = "routing", frozenset[str](), -1
    honours = frozenset({"iterations"})
    needed, seconds = 0.0, 0.0

    def missing(self, problem: Any) -> frozenset[str]:
        return frozenset() if problem.family == self.family else frozenset({"routes"})

    def memory(self, problem: Any) -> float:
        return self.needed

    def set_up_seconds(self, problem: Any) -> float:
        return self.seconds

    def run(self, problem: Any, options: Options, control: Control) -> RawResult:
        return RawResult("unknown")


@contextmanager
def default(**what: Any) -> Iterator[None]:
    """With ``Deaf`` as the default solver, changed like this."""
    with BACKENDS.temporary("deaf", type("Deaf", (Deaf,), what)):
        yield


def test_what_opens_is_judged_and_told_before_the_engine_begins() -> None:
    told: list[dict[str, Any]] = []
    known: list[Any] = []

    def run(self: Any, problem: Any, options: Options, control: Control) -> RawResult:
        control.begin_set_up()
        control.end_set_up(2.46)
        known.extend([options.start, [(e["phase"], e["objective"], e["found_by"]) for e in told if e["objective"] is not None]])
        return RawResult("unknown")

    with finding(ALONE), default(run=run):
        found = solve(star(), time_limit=8.0, bound_time=0, progress=told.append)
    assert known == [ALONE, [("check", 260.0, NAME)]]
    assert (found.answer, found.objective) == (ALONE, 260.0)
    assert f"deaf started from the answer of {NAME}, worth 260; deaf took 2.5 s to set up" in found.message


@pytest.mark.parametrize("signalled", [False, True])
def test_an_engine_that_never_comes_back_costs_no_answer_whether_the_clock_or_a_signal_ends_it(
    signalled: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("waybound.solving.search.OVERTIME", 0.0)
    monkeypatch.setattr("waybound.solving.search.GRACE", 0.0)
    release = threading.Event()

    def run(self: Any, problem: Any, options: Options, control: Control) -> RawResult:
        control.begin_set_up()
        if signalled:
            interrupts.note()
        release.wait(60)
        return RawResult("feasible", answer=Routes.of([range(1, 14)]))

    try:
        with finding(ALONE), default(run=run):
            found = solve(star(), time_limit=600.0 if signalled else 0.01, bound_time=0)
    finally:
        release.set()
        interrupts.reset()
    assert (found.answer, found.objective, found.limit) == (ALONE, 260.0, "interrupt" if signalled else "time")
    assert "did not stop when asked while it was still setting up, and had published no answer" in found.message


def test_a_work_limit_is_the_engines_alone() -> None:
    starts: list[Any] = []

    def run(self: Any, problem: Any, options: Options, control: Control) -> RawResult:
        starts.append((options.start, options.time_limit))
        return RawResult("feasible", answer=ALONE)

    with finding(RuntimeError("not asked")) as limits, default(run=run):
        for _ in range(2):
            solve(star(), time_limit=8.0, bound_time=0, iterations=5)
    assert (starts, limits) == ([(None, 8.0)] * 2, [])


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ({"needed": 1e18}, "deaf needs 931,322,575 GiB for a problem of size 14, more than the "),
        ({"seconds": 9.0}, "it takes some 9 s to set up for a problem of size 14"),
    ],
)
def test_an_engine_without_the_memory_or_the_time_for_its_model_is_not_begun(what: dict[str, float], words: str) -> None:
    with finding(ALONE) as limits, default(**what):
        found = solve(star(), time_limit=8.0, bound_time=0)
        assert (found.solver, found.objective, limits) == (NAME, 260.0, [8.0])
        assert f"deaf was not used: {words}" in found.message
        if "needed" in what:
            with pytest.raises(UsageError, match="deaf needs"):
                solve(star(), "deaf", time_limit=8.0, bound_time=0)


def scattered(customers: int) -> RoutingProblem:
    """Customers anywhere, some ten of which fit into a route."""
    rng = np.random.default_rng(customers)
    sites = Sites.of(range(customers + 1), demand=[0, *rng.integers(1, 10, customers)])
    return RoutingProblem(sites, Travel("euclidean", coordinates=rng.uniform(0, 1000, (customers + 1, 2))), (VehicleType(None, 50.0),))


def test_savings_open_where_engines_are_slow_to_begin() -> None:
    assert opening_heuristic(scattered(1_499), Options()) is None
    assert opening_heuristic(scattered(1_500), Options()) == "savings"
    assert opening_heuristic(scattered(1_500), Options(iterations=3)) is None


@pytest.mark.slow
@pytest.mark.skipif(not BACKENDS["pyvrp"].installed(), reason="PyVRP is not installed")
def test_thousands_of_customers_are_begun_by_savings_and_work_limits_repeat() -> None:
    problem = scattered(1_600)
    run = default_run(problem, Options(time_limit=60.0), isolate=False)
    assert (run.name, run.opening) == ("pyvrp", "savings")
    once, again = (solve(problem, iterations=2, bound_time=0, time_limit=600.0) for _ in range(2))
    assert once.solver == "pyvrp" and once.answer == again.answer and "savings" not in once.message
    assert once.statistics["iterations"] == 2
