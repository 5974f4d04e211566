"""``solve`` believes no engine: liars of every kind are caught, and what was checked is returned."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from programs import Counting
from random_sensing import random_graph

from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.max_min.bottleneck_sata import BottleneckSATA
from waybound.formulations.routing.objective import Objective, TotalCost
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Routes
from waybound.instances.errors import CheckFailedError, UnsupportedError, UsageError
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import Travel
from waybound.solvers.backend import BACKENDS, Control, Engine, Options, RawResult
from waybound.solvers.backends.scip import Scip
from waybound.solvers.bounds import BOUNDS
from waybound.solving.solve import solve

XY = np.array([(0, 0), (3, 0), (3, 4), (0, 4), (-3, 0)], dtype=float)


@pytest.fixture
def square() -> RoutingProblem:
    """SQUARE-4 with capacity 2 of unit demands: optimum 24."""
    sites = Sites.of(range(5), demand=[0, 1, 1, 1, 1], coordinates=XY)
    return RoutingProblem(sites, Travel("euclidean", coordinates=XY), (VehicleType(count=2, capacity=2),), name="square")


@pytest.fixture
def engine_that(registered: Any) -> Callable[[Callable[..., RawResult]], str]:
    """Registers an engine with the given behaviour for one test."""
    names: list[str] = []

    def make(behaviour: Callable[..., RawResult]) -> str:
        class Fake(Engine):
            name = f"fake-{len(names)}"
            package = "numpy"
            modules = ("numpy",)
            summary = "a fake"
            family = "routing"
            features = frozenset({"capacity", "limited-fleet", "objective:total-cost", "objective:priorities"})

            def run(self, problem: Any, options: Options, control: Control) -> RawResult:
                return behaviour(problem, options, control)

        registered(BACKENDS, Fake.name, Fake)
        names.append(Fake.name)
        return Fake.name

    return make


def test_a_claimed_answer_that_breaks_a_constraint_is_an_error(square: RoutingProblem, engine_that: Any) -> None:
    liar = engine_that(lambda p, o, c: RawResult("feasible", answer=Routes.of([[1, 2, 3, 4]]), objective=18.0))
    with pytest.raises(CheckFailedError, match="carries 4, capacity 2"):
        solve(square, liar)


def test_an_honest_best_effort_that_breaks_a_constraint_is_no_answer(square: RoutingProblem, engine_that: Any) -> None:
    honest = engine_that(lambda p, o, c: RawResult("unknown", answer=Routes.of([[1, 2, 3, 4]])))
    solution = solve(square, honest, bound_time=0)
    assert solution.answer is None
    assert solution.status == "unknown"
    assert "carries 4" in solution.message


def test_a_claimed_objective_better_than_the_answers_is_a_fault_beside_the_answer(square: RoutingProblem, engine_that: Any) -> None:
    engine = engine_that(lambda p, o, c: RawResult("optimal", answer=Routes.of([[1, 2], [3, 4]]), objective=1.0))
    solution = solve(square, engine, bound_time=0)
    assert (solution.objective, solution.status) == (24.0, "feasible")
    assert len(solution.faults) == 1
    assert "claims the objective 1.0, the answer's value recomputed from the data is 24.0" in solution.faults[0]
    assert solution.to_json()["faults"] == list(solution.faults)
    assert solution.faults[0] in str(solution)
    assert solution.faults[0] in repr(solution)


def test_a_claimed_objective_worse_than_the_answers_contradicts_nothing(square: RoutingProblem, engine_that: Any) -> None:
    engine = engine_that(lambda p, o, c: RawResult("feasible", answer=Routes.of([[1, 2], [3, 4]]), objective=99.0))
    solution = solve(square, engine, bound_time=0)
    assert (solution.objective, solution.faults) == (24.0, ())


def test_a_broken_claim_costs_neither_an_earlier_incumbent_nor_the_start(square: RoutingProblem, engine_that: Any) -> None:
    def liar(problem: Any, options: Options, control: Control) -> RawResult:
        control.publish(Routes.of([[1, 2], [3, 4]]), 24.0)
        return RawResult("feasible", answer=Routes.of([[1, 2, 3, 4]]), objective=18.0)

    for start, behaviour in ((None, liar), (Routes.of([[1, 2], [3, 4]]), lambda p, o, c: liar(p, o, Control()))):
        solution = solve(square, engine_that(behaviour), start=start, bound_time=0)
        assert (solution.objective, solution.status) == (24.0, "feasible")
        assert "carries 4, capacity 2" in solution.faults[0]


def test_an_engine_that_crashes_without_an_incumbent_leaves_the_start(square: RoutingProblem, engine_that: Any) -> None:
    def crash(problem: Any, options: Options, control: Control) -> RawResult:
        raise ValueError("no luck")

    engine = engine_that(crash)
    with pytest.raises(ValueError, match="no luck"):
        solve(square, engine, bound_time=0)
    with pytest.raises(ValueError, match="no luck"):
        solve(square, engine, start=Routes.of([[1, 2, 3, 4]]), bound_time=0)
    solution = solve(square, engine, start=Routes.of([[1, 2], [3, 4]]), bound_time=0)
    assert (solution.objective, solution.status, solution.faults) == (24.0, "feasible", ())
    assert "the engine failed: ValueError: no luck" in solution.message


def test_the_better_of_start_and_answer_is_returned(square: RoutingProblem, engine_that: Any) -> None:
    worse = Routes.of([[1, 3], [2, 4]])
    engine = engine_that(lambda p, o, c: RawResult("feasible", answer=worse))
    solution = solve(square, engine, start=Routes.of([[1, 2], [3, 4]]), bound_time=0)
    assert solution.objective == 24.0


def test_bounds_are_verified_and_can_prove_optimality(square: RoutingProblem, engine_that: Any) -> None:
    engine = engine_that(lambda p, o, c: RawResult("feasible", answer=Routes.of([[1, 2], [3, 4]])))
    solution = solve(square, engine, bound_time=5)
    assert solution.certificate.bound is not None
    assert solution.certificate.bound <= 24.0 + 1e-6
    assert solution.bound_kind == "verified"


def test_a_claimed_bound_ahead_of_a_proved_optimum_does_not_hide_the_proof(registered: Any) -> None:
    """Costs that differ by less than a solver sees: its optimum is 1e-8 above the least, which the prices prove."""
    answer, value = (0, 1), 2.0 + 2e-8

    class Fake(Engine):
        name, package, modules, summary, family = "short-sighted", "numpy", ("numpy",), "a fake", "bin-assignment"
        features = frozenset(BACKENDS["lapjv"].features)

        def run(self, problem: Any, options: Options, control: Control) -> RawResult:
            return RawResult("optimal", answer=answer, objective=value, bound=value)

    registered(BACKENDS, Fake.name, Fake)
    problem = BinAssignment.from_matrix([[1.0 + 2e-8, 1.0], [1.0, 1.0]])
    alone = solve(problem, Fake.name, bound_time=1)
    assert (alone.status, alone.bound_kind, alone.certificate.bound) == ("optimal", "claimed", pytest.approx(2.0, rel=1e-12))
    assert "optimal according to short-sighted" in str(alone)
    started = solve(problem, Fake.name, start=(1, 0), bound_time=1)
    assert (started.objective, started.bound_kind, started.faults) == (2.0, "verified", ())
    assert started.gap is not None and started.gap <= 1e-9
    assert "optimal: the verified bound meets the objective" in str(started)


def test_a_missing_feature_names_solvers_that_have_it(square: RoutingProblem, engine_that: Any) -> None:
    engine = engine_that(lambda p, o, c: RawResult("unknown"))
    sites = Sites.of(range(5), demand=[0, 1, 1, 1, 1], due=[100, 50, 50, 50, 50], coordinates=XY)
    windows = RoutingProblem(sites, square.travel, square.fleet)
    with pytest.raises(UnsupportedError, match=r"time-windows.*can take it: .*pyvrp"):
        solve(windows, engine)


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


def test_an_unknown_solver_is_named_with_the_choices(square: RoutingProblem) -> None:
    with pytest.raises(UsageError, match=r"unknown solver .cplex.; choose from .*highs"):
        solve(square, "cplex")


def test_a_heuristic_checks_its_parameters(square: RoutingProblem) -> None:
    with pytest.raises(UsageError, match="savings has no option 'shap'; it takes shape"):
        solve(square, heuristic="savings", shap=2)


def test_savings_gives_a_verified_answer(square: RoutingProblem) -> None:
    free = RoutingProblem(square.sites, square.travel, (VehicleType(capacity=2),))
    solution = solve(free, heuristic="savings", bound_time=2)
    assert solution.objective == pytest.approx(24.0, abs=1e-9)
    assert solution.certificate.feasible
    assert solution.certificate.guarantee is None
    assert "guarantees nothing" in solution.message


@pytest.mark.parametrize("thing", [None, "C101.txt", [[1, 2]]])
def test_what_is_no_problem_is_refused(thing: Any) -> None:
    with pytest.raises(UsageError, match="takes a problem or a program"):
        solve(thing)


def test_an_answer_of_another_type_is_refused(square: RoutingProblem) -> None:
    with pytest.raises(UsageError, match=r"Routes\.of"):
        square.evaluate([[1, 2]])  # type: ignore[arg-type]


def test_a_variant_without_a_name_is_refused(square: RoutingProblem) -> None:
    with pytest.raises(UsageError, match="names no solver within pulp"):
        solve(square, "pulp:")


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
    assert {(options.seed, options.threads) for _, options in Counting.told} == {(5, 2)}
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


@pytest.mark.slow
def test_a_bound_has_all_levels_where_there_is_no_answer(square: RoutingProblem, engine_that: Callable[..., str]) -> None:
    name = engine_that(lambda problem, options, control: RawResult("unknown"))
    solution = solve(replace(square, objective=Objective.of(TotalCost().then(TotalCost()))), name, bound_time=2.0)
    assert solution.answer is None
    assert solution.bound == [pytest.approx(24.0), None]
