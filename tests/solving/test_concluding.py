"""No engine is believed: liars of every kind are caught, and what was checked is returned."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from patience import HANG

from waybound import BinAssignment, CheckFailedError, Objective, Routes, RoutingProblem, TotalCost, read, solve
from waybound.solvers.backend import BACKENDS, Control, Options, RawResult
from waybound.solvers.bounds import BOUNDS, BoundMethod
from waybound.solving import concluding


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


def test_the_better_of_start_and_answer_is_returned(square: RoutingProblem, engine_that: Any) -> None:
    worse = Routes.of([[1, 3], [2, 4]])
    engine = engine_that(lambda p, o, c: RawResult("feasible", answer=worse))
    assert solve(square, engine, start=Routes.of([[1, 2], [3, 4]]), bound_time=0).objective == 24.0


def test_bounds_are_verified_and_can_prove_optimality(square: RoutingProblem, engine_that: Any) -> None:
    engine = engine_that(lambda p, o, c: RawResult("feasible", answer=Routes.of([[1, 2], [3, 4]])))
    solution = solve(square, engine, bound_time=60.0)
    assert solution.certificate.bound is not None
    assert solution.certificate.bound <= 24.0 + 1e-6
    assert solution.bound_kind == "verified"


def test_a_claimed_bound_ahead_of_a_proved_optimum_does_not_hide_the_proof(says: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Costs that differ by less than a solver sees: its optimum is 1e-8 above the least, which the prices prove."""
    said = RawResult("optimal", answer=(0, 1), objective=2.0 + 2e-8, bound=2.0 + 2e-8)
    name = says(said, "short-sighted", family="bin-assignment", features=frozenset(BACKENDS["lapjv"].features))
    problem = BinAssignment.from_matrix([[1.0 + 2e-8, 1.0], [1.0, 1.0]])
    monkeypatch.setattr(concluding, "heard_opinions", lambda *_: [])
    alone = solve(problem, name, bound_time=60.0)
    assert (alone.status, alone.bound_kind, alone.certificate.bound) == ("optimal", "claimed", pytest.approx(2.0, rel=1e-12))
    assert "optimal according to short-sighted" in str(alone)
    started = solve(problem, name, start=(1, 0), bound_time=60.0)
    assert (started.objective, started.bound_kind, started.faults) == (2.0, "verified", ())
    assert started.gap is not None and started.gap <= 1e-9
    assert "optimal: the verified bound meets the objective" in str(started)


@pytest.mark.slow
def test_a_bound_has_all_levels_where_there_is_no_answer(square: RoutingProblem, engine_that: Callable[..., str]) -> None:
    name = engine_that(lambda problem, options, control: RawResult("unknown"))
    problem = replace(square, objective=Objective.of(TotalCost().then(TotalCost())))
    solution = solve(problem, name, bound_time=60.0, iterations=1)  # else the bounding comes across an answer
    assert solution.answer is None
    assert solution.bound == [pytest.approx(24.0), None]


def test_a_hash_that_fails_costs_no_answer(square: RoutingProblem, monkeypatch: pytest.MonkeyPatch) -> None:
    def digest(problem: RoutingProblem) -> str:
        raise MemoryError

    monkeypatch.setattr(RoutingProblem, "digest", digest)
    solution = solve(square, heuristic="savings", bound_time=0)
    assert solution.answer is not None and solution.certificate.feasible and solution.certificate.instance_hash == ""


def test_large_costs_are_hashed_when_the_hash_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    hashed: list[int] = []
    inside = BinAssignment.digest
    monkeypatch.setattr(BinAssignment, "digest", lambda self: (hashed.append(1), inside(self))[1])
    solution = solve(BinAssignment.from_matrix(np.arange(16.0).reshape(4, 4)))
    assert solution.status == "optimal" and not hashed
    assert solution.certificate.instance_hash.startswith("sha256:") and hashed == [1]


def test_the_evidence_of_a_heuristic_leaves_better_bounds_to_be_looked_for() -> None:
    cover = read("cover-30")
    free, bounded = (solve(cover, heuristic="greedy", bound_time=seconds) for seconds in (0.0, 20.0))
    assert free.certificate.evidence and isinstance(free.bound, float) and isinstance(bounded.bound, float)
    assert bounded.bound < free.bound and bounded.bound_source != free.bound_source


def test_an_answer_that_bounding_comes_across_competes_with_that_of_an_engine(
    square: RoutingProblem, engine_that: Any, registered: Any
) -> None:
    def found(problem: Any, stop: Any, linear: Any, answer: Any, on_answer: Any) -> None:
        on_answer(Routes.of([[1, 2, 3, 4]]), 18.0)  # carries too much
        on_answer(Routes.of([[1, 2], [3, 4]]), 24.0)

    registered(BOUNDS, "finder", BoundMethod("finder", lambda problem: frozenset(), found, starts=True))
    engine = engine_that(lambda p, o, c: RawResult("feasible", answer=Routes.of([[1, 3], [2, 4]])))
    solution = solve(square, engine, bound_time=HANG)
    assert (solution.objective, solution.events[-1].objective) == (24.0, (24.0,))
    assert "found while its bound was looked for" in solution.message
    for limits in ({"iterations": 5}, {"bound_time": 0}):
        alone = solve(square, engine_that(lambda p, o, c: RawResult("feasible", answer=Routes.of([[1, 3], [2, 4]]))), **limits)
        assert alone.objective > 24.0
