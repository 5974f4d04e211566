"""Whatever fails after a search, and however, the answer that passed its checks is handed over and the fault is said.

Each stage up to the solution fails in turn: with a fault of the code, for want of memory, by an error of the system, by Ctrl-C.
"""

import dataclasses
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from injected import BEST, TINY, VALUE, WORSE, InterruptAt, answer_in, failing, solver_of, ways
from typer.testing import CliRunner

import waybound as wb
from waybound import CheckFailedError, Coverage, InputError, PartitionMatroid, Problem
from waybound.cli.app import app
from waybound.formulations.evidence import CHECKERS, Evidence
from waybound.solvers.backend import RawResult
from waybound.solvers.bounds import BOUNDS, replaced
from waybound.solving.method import Run


@pytest.fixture
def engine(registered: Any) -> Callable[..., str]:
    return solver_of(registered)


# -- judging ----------------------------------------------------------------------------------------------------------


@ways
@pytest.mark.parametrize("stage", ["decode", "evaluate"])
def test_a_last_word_that_cannot_be_judged_costs_no_other_answer(
    stage: str, fault: Any, words: str, monkeypatch: pytest.MonkeyPatch, engine: Any, tally: Any
) -> None:
    def work(problem: Any, options: Any, control: Any) -> RawResult:
        control.publish(BEST, VALUE)
        return RawResult("feasible", answer=WORSE)

    honest, fail = type(TINY).evaluate, failing(fault)
    if stage == "evaluate":
        monkeypatch.setattr(type(TINY), "evaluate", lambda self, a: fail() if a is WORSE else honest(self, a))
    else:
        monkeypatch.setattr(Run, "decode", lambda self, a: fail() if a is WORSE else a)
    found = wb.solve(TINY, engine(work), bound_time=0)
    assert (found.objective, found.status) == (VALUE, "feasible")
    assert words in found.message
    tally["faults injected"] += 1


def test_one_interrupt_while_judging_costs_nothing(monkeypatch: pytest.MonkeyPatch, engine: Any) -> None:
    honest, fail = type(TINY).evaluate, failing(KeyboardInterrupt, 1)
    monkeypatch.setattr(type(TINY), "evaluate", lambda self, a: fail() or honest(self, a))
    assert wb.solve(TINY, engine(), bound_time=0).objective == VALUE


def test_without_another_answer_what_kept_the_only_one_from_being_judged_is_raised(monkeypatch: pytest.MonkeyPatch, engine: Any) -> None:
    monkeypatch.setattr(type(TINY), "evaluate", failing(MemoryError))
    with pytest.raises(MemoryError):
        wb.solve(TINY, engine(), bound_time=0)


def test_a_claimed_point_that_is_no_answer_is_the_solvers_fault_and_costs_no_start() -> None:
    def no_route(x: Any) -> Any:
        raise InputError("arcs form a cycle without the depot")

    made = dataclasses.replace(TINY.compile(), decode=no_route)
    with pytest.raises(CheckFailedError, match="the optimal answer claimed by highs is no answer: arcs form a cycle"):
        wb.solve(made, "highs", bound_time=0)
    found = wb.solve(made, "highs", start=BEST, bound_time=0)
    assert (found.objective, found.status) == (VALUE, "feasible")
    assert "arcs form a cycle" in found.faults[0]


@ways
def test_a_search_that_crashes_leaves_its_incumbent(fault: Any, words: str, engine: Any, tally: Any) -> None:
    def work(problem: Any, options: Any, control: Any) -> RawResult:
        control.publish(BEST, VALUE)
        raise fault()

    found = wb.solve(TINY, engine(work), bound_time=0)
    assert (found.objective, found.status, found.limit) == (VALUE, "feasible", "none")
    assert words in found.message
    tally["faults injected"] += 1


# -- bounding and certifying ------------------------------------------------------------------------------------------


def problems() -> Iterator[tuple[Problem, dict[str, Any]]]:
    """Small problems of every family that is bounded, and a method that solves each."""
    graph = wb.SensingGraph.from_edges([0, 0, 1], [0, 1, 2], [0, 1, 0], np.array([3.0, 2.0, 4.0]))
    yield TINY, {"solver": "made"}
    yield wb.BottleneckSATA(graph), {"heuristic": "greedy"}
    yield wb.WinnerTakesAllSATA(graph), {"heuristic": "random"}
    sets = Coverage.from_sets([[0, 1], [1, 2], [2]], [1.0, 2.0, 3.0])
    yield wb.SubmodularSelection(sets, PartitionMatroid.of([0, 0, 1])), {"heuristic": "random"}


PROBLEMS = list(problems())
METHODS = [
    (k, method.name)
    for k, (problem, *_) in enumerate(PROBLEMS)
    for method in sorted(BOUNDS.values(), key=lambda method: method.order)
    if method.name not in replaced(problem) and not method.missing(problem)
]
PARTS = [
    pytest.param(*method, part, marks=() if part == "compute" or k % 4 == 0 else pytest.mark.hostile)
    for k, method in enumerate(METHODS)
    for part in ("missing", "prepare", "compute")
]


@pytest.mark.share(3)
@ways
@pytest.mark.parametrize(("case", "name", "part"), PARTS)
def test_a_bound_that_fails_is_no_bound(
    case: int, name: str, part: str, fault: Any, words: str, registered: Any, engine: Any, compiled: Any, tally: Any
) -> None:
    engine()
    compiled({module for _, method in METHODS for module in BOUNDS[method].kernels})  # else bounds are looked for in another process, whole
    problem, method = PROBLEMS[case]
    for other in BOUNDS:  # the only one, else another may end the search for bounds before it
        registered(BOUNDS, other, dataclasses.replace(BOUNDS[other], compute=lambda *_: None))
    registered(BOUNDS, name, dataclasses.replace(BOUNDS[name], **{part: failing(fault)}))
    found = wb.solve(problem, **method, bound_time=0.5)
    assert found.certificate.feasible
    assert found.faults == ()
    assert words in found.message
    tally["faults injected"] += 1


def test_a_bound_that_fails_costs_no_other_bound() -> None:
    problem = wb.WinnerTakesAllSATA(wb.SensingGraph.from_edges([0, 1], [0, 1], [0, 1], np.array([3.0, 2.0])))
    names = [m.name for m in BOUNDS.values() if not m.missing(problem)]
    assert len(names) > 1
    for name in names:
        broken = dataclasses.replace(BOUNDS[name], compute=failing(MemoryError))
        with BOUNDS.temporary(name, broken), pytest.warns(RuntimeWarning, match=f"no bound by {name}: out of memory"):
            assert wb.bound(problem, bound_time=5).bound == 5.0


@pytest.mark.share(4)
@ways
@pytest.mark.parametrize("case", range(len(PROBLEMS)))
def test_evidence_whose_checker_fails_proves_nothing(case: int, fault: Any, words: str, registered: Any, engine: Any, tally: Any) -> None:
    engine()
    for kind in CHECKERS:
        registered(CHECKERS, kind, failing(fault))
    problem, method = PROBLEMS[case]
    found = wb.solve(problem, **method, bound_time=0.5)
    assert found.certificate.feasible
    assert (found.certificate.bound, found.faults) == (None, ())
    assert words in found.message
    tally["faults injected"] += 1


@pytest.mark.share(2)
@ways
def test_evidence_of_a_solver_that_proves_nothing_costs_no_bound_of_ours(fault: Any, words: str, registered: Any, engine: Any) -> None:
    registered(CHECKERS, "broken", failing(fault, 1 if fault is KeyboardInterrupt else float("inf")))
    useless = Evidence("broken", "the solver's proof", VALUE, {})
    name = engine(lambda p, o, c: RawResult("feasible", answer=BEST, evidence=(useless,)))
    found = wb.solve(TINY, name, bound_time=2)
    assert found.objective == VALUE
    assert words in found.message
    if fault is not KeyboardInterrupt:
        assert found.certificate.bound is not None


@ways
def test_a_certificate_that_fails_leaves_the_judges_verdict(fault: Any, words: str, monkeypatch: Any, engine: Any, tally: Any) -> None:
    monkeypatch.setattr("waybound.solving.concluding.certify", failing(fault))
    monkeypatch.setattr(type(TINY), "digest", failing(MemoryError))
    found = wb.solve(TINY, engine(), bound_time=0)
    assert (found.objective, found.certificate.objective, found.certificate.feasible, found.faults) == (VALUE, VALUE, True, ())
    assert words in found.message
    assert found.to_json()["instance_hash"] is None
    tally["faults injected"] += 1


@pytest.mark.parametrize("bound", [2 * VALUE, np.inf])
def test_a_bound_that_contradicts_the_answer_is_withheld_and_said(bound: float, registered: Any, engine: Any, tmp_path: Path) -> None:
    registered(CHECKERS, "false", lambda problem, data: bound)
    proof = Evidence("false", "a false proof", bound, {})
    name = engine(lambda p, o, c: RawResult("optimal", answer=BEST, objective=VALUE, bound=VALUE, evidence=(proof,)))
    found = wb.solve(TINY, name, bound_time=0)
    assert (found.objective, found.status, found.bound, found.certificate.bound) == (VALUE, "feasible", None, None)
    assert len(found.faults) == 1
    assert "a false proof" in found.faults[0]
    out = tmp_path / "a.json"
    result = CliRunner().invoke(app, ["solve", "demo-tiny", "--solver", "made", "--bound-time", "0", "-q", "--json", "--out", str(out)])
    assert result.exit_code == 5
    assert "a false proof" in result.stderr
    assert answer_in(result.stdout) == answer_in(out.read_text()) == BEST


@ways
def test_a_guarantee_that_fails_leaves_the_heuristics_answer(fault: Any, words: str, monkeypatch: pytest.MonkeyPatch, tally: Any) -> None:
    problem = PROBLEMS[1][0]
    whole = wb.solve(problem, heuristic="local", bound_time=0)
    monkeypatch.setattr("waybound.heuristics.sata.local._guarantee", failing(fault))
    found = wb.solve(problem, heuristic="local", bound_time=0)
    assert found.objective == whole.objective
    assert words in found.message
    tally["faults injected"] += 1


@pytest.mark.parametrize(("heuristic", "part"), [("greedy", "best_prefix"), ("lazy-greedy", "best_prefix")])
def test_evidence_that_a_heuristic_cannot_make_leaves_its_answer(heuristic: str, part: str, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = PROBLEMS[2][0]
    whole = wb.solve(problem, heuristic=heuristic, bound_time=0)
    monkeypatch.setattr(f"waybound.heuristics.sata.greedy_steps.outcomes.{part}", failing(MemoryError))
    found = wb.solve(problem, heuristic=heuristic, bound_time=0)
    assert found.objective == whole.objective
    assert found.certificate.guarantee == whole.certificate.guarantee
    assert "out of memory" in found.message


def test_an_interrupt_at_any_line_after_the_search_costs_no_answer(engine: Any, tally: Any) -> None:
    name, line, met = engine(), 0, True
    names = (
        "_verdict", "last_word", "_consider", "hear", "best", "_certified", "_gather", "certify", "_best_bound", "_status", "_versions",
    )  # fmt: skip
    while met:
        line += 1
        with InterruptAt(names, line) as interrupt:
            found = wb.solve(TINY, name, bound_time=0)
        met = interrupt.reached
        assert (found.objective, found.certificate.feasible, found.faults) == (VALUE, True, ())
        tally["lines interrupted"] += 1
    assert line > 50
