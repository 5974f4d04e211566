"""``solve`` checks what it is given, goes on after a crash, and hands the linear programs met on the way to the solver that is named."""

from dataclasses import replace
from typing import Any

import pytest
from coded import coded
from programs import Counting
from random_sensing import random_graph

from waybound import BottleneckSATA, Routes, RoutingProblem, SearchFailedError, UnsupportedError, UsageError, VehicleType, solve
from waybound.cli.solving import exit_code
from waybound.solvers.backend import BACKENDS, Control, Options, RawResult
from waybound.solvers.backends.scip import Scip
from waybound.solvers.bounds import BOUNDS


def test_an_engine_that_crashes_without_an_incumbent_leaves_the_start(square: RoutingProblem, engine_that: Any) -> None:
    def crash(problem: Any, options: Options, control: Control) -> RawResult:
        raise ValueError("no luck")

    engine = engine_that(crash)
    for start in (None, Routes.of([[1, 2, 3, 4]])):
        with pytest.raises(SearchFailedError, match=f"^{engine} failed: ValueError: no luck$") as told:
            solve(square, engine, start=start, bound_time=0)
        assert told.value.exit_code == 1
    solution = solve(square, engine, start=Routes.of([[1, 2], [3, 4]]), bound_time=0)
    assert (solution.objective, solution.status) == (24.0, "feasible")
    assert solution.faults == (f"{engine} failed: ValueError: no luck",)
    assert "the engine failed: ValueError: no luck" in solution.message


def test_a_solver_that_ends_in_an_error_is_told_beside_the_start(square: RoutingProblem, engine_that: Any) -> None:
    engine = engine_that(lambda *given: RawResult("error", message="the library gave up"))
    alone = solve(square, engine, bound_time=0)
    assert (alone.status, alone.answer, exit_code(alone)) == ("error", None, 1)
    started = solve(square, engine, start=Routes.of([[1, 2], [3, 4]]), bound_time=0)
    assert (started.objective, started.faults, exit_code(started)) == (24.0, (f"{engine} failed: the library gave up",), 5)


@pytest.mark.parametrize(
    "wrong",
    [
        {"time_limit": 0}, {"time_limit": float("nan")}, {"time_limit": None}, {"gap": -1}, {"threads": 0}, {"threads": 1.5},
        {"threads": 10**6}, {"iterations": 0}, {"seed": -1}, {"seed": 1.5}, {"bound_time": -1}, {"memory_limit": 0},
    ],
)  # fmt: skip
def test_options_out_of_range_are_refused(square: RoutingProblem, wrong: dict[str, Any]) -> None:
    with pytest.raises(UsageError):
        solve(square, "pyvrp", **wrong)


def test_savings_gives_a_verified_answer(square: RoutingProblem) -> None:
    free = RoutingProblem(square.sites, square.travel, (VehicleType(capacity=2),))
    solution = solve(free, heuristic="savings", bound_time=60.0)
    assert solution.objective == pytest.approx(24.0, abs=1e-9)
    assert solution.certificate.feasible
    assert solution.certificate.guarantee is None
    assert "guarantees nothing" in solution.message


@pytest.mark.parametrize("thing", [None, "C101.txt", [[1, 2]]])
def test_what_is_no_problem_is_refused(thing: Any) -> None:
    with pytest.raises(UsageError, check=coded("malformed")):
        solve(thing)


def test_an_answer_of_another_type_is_refused(square: RoutingProblem) -> None:
    with pytest.raises(UsageError, match=r"Routes\.of"):
        square.evaluate([[1, 2]])  # type: ignore[arg-type]


# -- who solves linear programs on the way ----------------------------------------------------------------------------

LINEAR_WORK = [{"heuristic": "lp-rounding"}, {"heuristic": "greedy", "bound_time": 20}, {"solver": "saddle", "iterations": 2000}]


@pytest.fixture
def no_trees(registered: Any) -> None:
    """Without the bound that searches, whose bounds depend on the time it is given."""
    registered(BOUNDS, "branching-tree", replace(BOUNDS["branching-tree"], missing=lambda problem: frozenset({"time"})))


@pytest.mark.share(2)
@pytest.mark.parametrize("given", LINEAR_WORK, ids=["heuristic", "bounding", "engine"])
@pytest.mark.usefixtures("no_trees")
def test_heuristics_bounds_and_engines_use_the_lp_solver_that_is_named(registered: Any, given: dict[str, Any]) -> None:
    registered(BACKENDS, "counting", Counting)
    Counting.told.clear()
    problem = BottleneckSATA(random_graph(3), fractional=given.get("solver") == "saddle")
    own, named = solve(problem, **given), solve(problem, **given, lp_solver="counting", seed=5, threads=2)
    assert Counting.told
    threads = 1 if "solver" in given else 2  # of the engine's programs one, so that its answer does not hang on how many there are
    assert {(options.seed, options.threads) for _, options in Counting.told} == {(5, threads)}
    assert own.bound is not None and named.bound == pytest.approx(own.bound, rel=1e-6)


@pytest.mark.skipif(not Scip.installed(), reason="needs the extra scip (PySCIPOpt)")
@pytest.mark.parametrize("given", LINEAR_WORK, ids=["heuristic", "bounding", "engine"])
@pytest.mark.usefixtures("no_trees")
def test_scip_may_be_that_solver(given: dict[str, Any]) -> None:
    problem = BottleneckSATA(random_graph(3), fractional=given.get("solver") == "saddle")
    own, named = solve(problem, **given), solve(problem, **given, lp_solver="scip")
    assert own.bound is not None and named.bound == pytest.approx(own.bound, rel=1e-5)
    assert named.objective is not None


@pytest.mark.parametrize("given", [{}, {"heuristic": "savings"}])
@pytest.mark.parametrize(
    ("name", "error", "words"),
    [
        ("hihgs", UsageError, "unknown solver 'hihgs'"),
        ("pyvrp", UnsupportedError, "LP programs"),
        ("cpsat", UnsupportedError, "LP programs"),
    ],
)
def test_who_cannot_be_that_solver_is_refused_before_the_search(
    square: RoutingProblem, engine_that: Any, name: str, error: type[Exception], words: str, given: dict[str, Any],
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.setattr("waybound.solving.solve.search", lambda *_, **__: pytest.fail("searched"))
    with pytest.raises(error, match=words):
        solve(square, **(given or {"solver": engine_that(lambda *_: pytest.fail("searched"))}), lp_solver=name)
