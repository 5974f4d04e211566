"""Planted liars of every sort, each caught by ``solve`` itself; and honest claims that count."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pytest
from coded import coded
from programs import program

import waybound as wb
from waybound import CheckFailedError, Evidence, Exactness, Routes, RoutingProblem, Sites, Travel, UsageError, VehicleType
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.heuristics.heuristic import HEURISTICS, Heuristic, Outcome
from waybound.solvers.backend import RawResult

XY = np.array([(0, 0), (3, 0), (3, 4), (0, 4), (-3, 0)], dtype=float)
SITES = Sites.of(range(5), demand=[0, 1, 1, 1, 1], coordinates=XY)
SQUARE = RoutingProblem(SITES, Travel("euclidean", coordinates=XY), (VehicleType(count=2, capacity=2),), name="square")
BEST, WORSE, BROKEN = Routes.of([[1, 2], [3, 4]]), Routes.of([[1, 3], [2, 4]]), Routes.of([[1, 2, 3, 4]])
LOSS = SQUARE.evaluate(WORSE).values[0]

KNAPSACK = ArrayProblem(program([3.0, 2.0], [[2.0, 3.0]], -np.inf, 10.5, 0, [4, 5], integer=[0, 1], sense="max", offset=1.0))
"""13 at (4, 0); its relaxation is worth 14 2/3."""
FULL, LESS, OVER = np.array([4.0, 0.0]), np.array([3.0, 1.0]), np.array([4.0, 5.0])

COSTLY = ArrayProblem(program([3.0, 2.0], [[2.0, 3.0]], 10.5, np.inf, 0, [4, 5], integer=[0, 1], offset=4.0))
"""The least cost is 4 + 8 at (0, 4)."""
DEAR = np.array([4.0, 5.0])


@pytest.fixture
def engine(says: Callable[..., str]) -> Callable[[RawResult], str]:
    return partial(says, family="routing", features=SQUARE.features())


FALSE = [
    ("engine", RawResult("infeasible"), BEST, "claims that there is no answer, but one of value 24.0"),
    ("engine", RawResult("feasible", answer=BEST, objective=24.0, bound=30.0), None, "claims the bound 30.0, but an answer of value 24.0"),
    ("engine", RawResult("optimal", answer=WORSE, objective=LOSS), BEST, f"claims the optimum {LOSS!r}, but an answer of value 24.0"),
    ("engine", RawResult("optimal", answer=BEST, objective=20.0), None, "claims the objective 20.0, the answer's value"),
    ("engine", RawResult("feasible", answer=BROKEN, objective=18.0), BEST, "carries 4, capacity 2"),
    ("backend", RawResult("infeasible"), FULL, "claims that there is no answer, but one of value 13.0"),
    ("backend", RawResult("feasible", answer=FULL, objective=13.0, bound=12.0), None, "claims the bound 12.0"),
    ("backend", RawResult("optimal", answer=LESS, objective=12.0), FULL, "claims the optimum 12.0, but an answer of value 13.0"),
    ("backend", RawResult("optimal", answer=FULL, objective=14.0), None, "claims the objective 14.0"),
    ("backend", RawResult("optimal", answer=OVER, objective=23.0), FULL, "claims an optimal answer, but it breaks"),
]


@pytest.mark.parametrize(("kind", "said", "start", "fault"), FALSE, ids=[f"{kind}-{fault[:27]}" for kind, _, _, fault in FALSE])
def test_who_lies_is_told_so_beside_the_answer(engine: Any, says: Any, kind: str, said: RawResult, start: Any, fault: str) -> None:
    problem, name, best = (SQUARE, engine(said), 24.0) if kind == "engine" else (KNAPSACK, says(said), 13.0)
    found = wb.solve(problem, name, start=start, bound_time=0)
    assert (found.objective, found.status, found.bound) == (best, "feasible", None)
    assert any(fault in line for line in found.faults), found.faults


@pytest.mark.parametrize("kind", [pytest.param("engine", marks=pytest.mark.slow), "backend"])
def test_a_false_optimum_is_refuted_by_a_verified_bound(engine: Any, says: Any, kind: str) -> None:
    problem, make, told, best = (SQUARE, engine, 2.0, 24.0) if kind == "engine" else (KNAPSACK, says, 20.0, 13.0)
    found = wb.solve(problem, make(RawResult("optimal", objective=told)), bound_time=60)
    assert found.objective == best  # of those who were asked then
    assert any(f"claims the optimum {told}, but the verified bound is" in fault for fault in found.faults)


def test_false_evidence_of_an_engine_proves_nothing(engine: Any) -> None:
    boast = Evidence("spanning-tree", "boast", 99.0, {"multipliers": [0.0] * 5, "depot": 0.0})
    found = wb.solve(SQUARE, engine(RawResult("feasible", answer=BEST, objective=24.0, evidence=(boast,))), bound_time=0)
    assert found.certificate.bound is not None
    assert found.certificate.bound <= 24.0


def test_an_honest_proof_of_an_engine_counts_as_its_word(engine: Any) -> None:
    found = wb.solve(SQUARE, engine(RawResult("optimal", answer=BEST, objective=24.0, bound=24.0)), bound_time=0)
    assert (found.status, found.bound, found.bound_kind, found.faults) == ("optimal", 24.0, "claimed", ())


def test_an_engine_that_searches_a_restriction_claims_no_bound(engine: Any) -> None:
    said = RawResult("optimal", answer=WORSE, objective=LOSS, bound=LOSS, holds=Exactness.RESTRICTION)
    found = wb.solve(SQUARE, engine(said), start=BEST, bound_time=0)
    assert (found.objective, found.status, found.bound, found.faults) == (24.0, "feasible", None, ())


# -- every false claim, by an engine and by a backend, with a start and without, with bounds and without --------------------------------

CLAIMS = {
    "infeasible": RawResult("infeasible"), "unbounded": RawResult("unbounded"), "either": RawResult("infeasible_or_unbounded"),
    "no-answer": RawResult("optimal"), "no-answer-but-a-value": RawResult("optimal", objective=1e3),
    "too-good": RawResult("optimal", objective=1.0), "a-bound": RawResult("feasible", bound=1e3), "nothing": RawResult("feasible"),
    "error": RawResult("error", message="it broke"),
}  # fmt: skip
"""Of the least cost of a problem whose optimum is 24 or 12."""


@pytest.mark.share(2)
@pytest.mark.parametrize("said", CLAIMS.values(), ids=CLAIMS)
@pytest.mark.parametrize("started", [False, True])
@pytest.mark.parametrize(
    ("kind", "bounded"), [("engine", False), ("backend", False), ("backend", True), pytest.param("engine", True, marks=pytest.mark.slow)]
)
def test_no_false_claim_is_ever_believed_and_none_costs_the_start(
    engine: Any, says: Any, said: RawResult, started: bool, bounded: bool, kind: str
) -> None:
    """Whatever is said: what is handed over is no worse than the start, is called optimal only where that is so, and no claim stands beside
    what refutes it."""
    problem, best, start = (SQUARE, 24.0, WORSE) if kind == "engine" else (COSTLY, 12.0, DEAR)
    name = (engine if kind == "engine" else says)(said)
    try:
        found = wb.solve(problem, name, start=start if started else None, bound_time=60 if bounded else 0)
    except CheckFailedError as fault:
        assert not started and "liar claims" in str(fault) and "\n" not in str(fault)
        return
    worth = problem.evaluate(start).values[0]
    assert not started or (found.objective is not None and found.objective <= worth)
    if found.answer is not None:
        assert problem.evaluate(found.answer).feasible
        assert found.status == ("optimal" if found.objective == pytest.approx(best) and found.bound_kind == "verified" else "feasible")
        assert not started or said.status not in ("infeasible", "error") or found.faults
    if found.bound is not None:
        assert found.bound <= best + 1e-6 or (found.bound_kind, found.answer) == ("claimed", None)
    if found.status in ("infeasible", "unbounded", "infeasible_or_unbounded"):
        assert found.answer is None and not found.faults and f"{found.status.replace('_', ' ')} according to liar" in str(found)
        assert found.certificate.bound is None or found.status == "infeasible"
    if said.status in ("optimal", "feasible") and found.answer is None:
        assert "hands over no answer" in found.message or "reports a point that is not feasible" in found.message


def test_an_engine_that_claims_the_optimum_and_hands_over_nothing_makes_no_start_optimal(engine: Any) -> None:
    for said in (RawResult("optimal"), RawResult("optimal", objective=24.0, bound=24.0)):
        found = wb.solve(SQUARE, engine(said), start=WORSE, bound_time=0)
        assert (found.status, found.objective) == ("feasible", LOSS)
        assert "liar says optimal and hands over no answer" in found.message
    assert (found.bound, found.bound_kind) == (24.0, "claimed")
    told = wb.solve(SQUARE, engine(RawResult("optimal", answer=BEST)), bound_time=0)
    assert (told.status, told.bound, told.bound_kind) == ("optimal", 24.0, "claimed")


@pytest.mark.parametrize("unit", [1.0, 2.0**-40, 2.0**40])
@pytest.mark.parametrize(("told", "false"), [(1e-15, False), (0.1, True)])
def test_a_sum_that_is_off_by_rounding_at_an_optimum_of_0_is_no_lie(says: Any, unit: float, told: float, false: bool) -> None:
    nothing = ArrayProblem(program([-3.0 * unit, -2.0 * unit], [[2.0, 3.0]], -np.inf, 10.5, 0, [4, 5], integer=[0, 1], sense="max"))
    said = RawResult("optimal", answer=np.zeros(2), objective=told, bound=told)  # in the units that solvers are given
    found = wb.solve(nothing, says(said), bound_time=60)
    assert (found.objective, found.status, bool(found.faults)) == (0.0, "optimal", false)


def test_a_heuristics_broken_answer_is_none_and_its_false_evidence_proves_nothing(registered: Any) -> None:
    boast = Evidence("spanning-tree", "boast", 99.0, {"multipliers": [0.0] * 5, "depot": 0.0})
    for answer, value in ((BROKEN, None), (BEST, 24.0)):
        run = lambda problem, setting, answer=answer: Outcome(answer, evidence=(boast,))  # noqa: E731
        registered(HEURISTICS, "liar", Heuristic("liar", ("routing",), SQUARE.features(), run, "for tests"))
        found = wb.solve(SQUARE, heuristic="liar", bound_time=0)
        assert found.objective == value
        assert found.certificate.bound is not None
        assert found.certificate.bound <= 24.0


# -- what is asked for is kept to, or refused by name --------------------------------------------------------------------------


@pytest.mark.parametrize("asked", [{"iterations": 5}, {"gap": 0.1}, {"no_improvement": 5}])
def test_a_heuristic_refuses_by_name_what_it_does_not_keep_to(asked: dict[str, Any]) -> None:
    with pytest.raises(UsageError, match=f"heuristic savings .*{next(iter(asked))}", check=coded("unsupported")):
        wb.solve(SQUARE, heuristic="savings", **asked)


@pytest.mark.parametrize("solver", ["highs", "ortools"])
def test_a_solver_refuses_by_name_what_it_does_not_keep_to(solver: str) -> None:
    with pytest.raises(UsageError, match=f"{solver} does not keep to no_improvement .*solvers that do: .*pyvrp"):
        wb.solve(SQUARE, solver, no_improvement=5)


@pytest.mark.slow
def test_a_heuristic_runs_in_a_process_of_its_own_with_the_same_answer_and_guarantee() -> None:
    graph = wb.SensingGraph.from_edges([0, 1, 1], [0, 1, 2], [0, 1, 0], np.array([3.0, 2.0, 1.0]))
    problem = wb.WinnerTakesAllSATA(graph)
    here, there = (wb.solve(problem, heuristic="greedy", isolate=isolate) for isolate in (False, True))
    assert (here.objective, here.answer, here.certificate.guarantee) == (there.objective, there.answer, there.certificate.guarantee)
    assert here.certificate.guarantee is not None


def test_a_search_ends_without_improvement() -> None:
    found = wb.solve(wb.read("demo-c25"), "pyvrp", no_improvement=40, time_limit=60, bound_time=0)
    assert found.limit in ("iterations", "none")
    assert found.seconds["solve"] < 30


def test_a_search_ends_at_the_gap_that_is_asked_for() -> None:
    found = wb.solve(SQUARE, "pyvrp", gap=0.5, time_limit=20)
    assert found.limit in ("gap", "none")
    assert found.seconds["solve"] < 10
    assert found.gap is not None
    assert found.gap <= 0.5


@pytest.mark.parametrize(
    ("problem", "value"),
    [
        (ArrayProblem(program([3.0, 2.0], [[2.0, 3.0]], -np.inf, 10.5, 1, [4, 5], integer=[0, 1], sense="max")), 5.0),
        (wb.MaxMinLP([[1.0, 2.0]], [[1.0, 1.0]]), 2.0 / 3.0),
        (wb.MaxMinLP([[1.0, 2.0]], [[1.0, 4.0]], sense="min"), 3.0 / 5.0),
        (wb.generate("sata", seed=1, robots=3, actions=2, targets=4, phi=40), None),
        (wb.generate("coverage", seed=1, elements=5, items=6, k=2), 0.0),
    ],
)
def test_who_says_that_there_is_no_answer_is_refuted_by_one_that_needs_no_search(says: Any, problem: Any, value: float | None) -> None:
    solution = wb.solve(problem, says(RawResult("infeasible")), bound_time=0)
    assert (solution.status, len(solution.faults)) == ("feasible", 1)
    assert solution.evaluation.feasible
    if value is not None:
        assert solution.objective == pytest.approx(value)


def test_where_no_answer_is_at_hand_the_claim_stands() -> None:
    empty = ArrayProblem(program([1.0, 1.0], [[2.0, 2.0]], 3.0, 3.0, 0, 5, integer=[0, 1]))
    assert not empty.evaluate(empty.answer_at_hand()).feasible
    assert wb.solve(empty, "highs", bound_time=0).status == "infeasible"
