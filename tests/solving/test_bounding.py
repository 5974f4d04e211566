"""Bounds of a problem: before a search, beside it and after it."""

import dataclasses
import math
import threading
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from patience import HANG

import waybound as wb
from waybound import InputError, Problem, UnsupportedError
from waybound.formulations.certificate import certify
from waybound.formulations.evidence import CHECKERS, Evidence
from waybound.formulations.verified_bounds import proved_bound
from waybound.solvers.backend import BACKENDS, Control, Engine, Options, RawResult
from waybound.solvers.bounds import BOUNDS, BoundMethod
from waybound.solvers.linear_programs import LinearPrograms
from waybound.solving import bounding, search as searching
from waybound.solving.bounding import AT_ONCE, Bounding, Goal, find_bounds, free_core
from waybound.solving.recording import Recorder

GRAPH = wb.SensingGraph.from_edges([0, 1], [0, 1], [0, 1], np.array([3.0, 2.0]))
PROBLEM = wb.WinnerTakesAllSATA(GRAPH)


def goal(problem: Problem, evidence: Sequence[Evidence] = (), gap: float = 0.0) -> Goal:
    return Goal(problem, certify(problem, None, evidence), gap)


def instead(registered: Any, name: str, compute: Any) -> None:
    registered(BOUNDS, name, dataclasses.replace(BOUNDS[name], compute=compute))


def refuse(*_: Any) -> None:
    raise InputError("HiGHS refuses the program")


def test_a_method_that_is_refused_is_named_and_the_others_are_tried(registered: Any) -> None:
    instead(registered, "linear-relaxation", refuse)
    unable: list[str] = []
    found = find_bounds(PROBLEM, 5.0, unable=unable)
    assert unable == ["no bound by linear-relaxation: HiGHS refuses the program"]
    assert [(e.kind, e.value) for e in found] == [("marginal-gains", 5.0), ("item-prices", 5.0)], "by a set, and by a tree"


def test_a_method_that_lacks_a_feature_is_passed_over_without_a_word(registered: Any) -> None:
    def lacks(*_: Any) -> None:
        raise UnsupportedError("it", {"a feature"})

    instead(registered, "linear-relaxation", lacks)
    unable: list[str] = []
    assert len(find_bounds(PROBLEM, 5.0, unable=unable)) == 2
    assert unable == []


def test_evidence_that_reaches_the_target_ends_the_search_only_if_its_checker_agrees(registered: Any) -> None:
    first = min((m for m in BOUNDS.values() if not m.missing(PROBLEM)), key=lambda m: m.order).name
    boast = Evidence("boast", "a boast", 5.0, {})
    registered(CHECKERS, "boast", refuse)
    assert proved_bound(PROBLEM, boast) is None
    instead(registered, first, lambda *_: boast)
    found = find_bounds(PROBLEM, 5.0, target=5.0, known=(boast,))
    assert found[0] is boast
    assert any(proved_bound(PROBLEM, e) == 5.0 for e in found[1:])


def test_what_proves_nothing_is_no_bound(registered: Any) -> None:
    registered(CHECKERS, "vain", lambda problem, data: math.inf)
    assert proved_bound(PROBLEM, Evidence("vain", "in vain", 5.0, {})) is None


@pytest.mark.parametrize("heuristic", ["random", "greedy", "brute-force"])
def test_weights_that_a_solver_refuses_cost_the_bound_alone(heuristic: str) -> None:
    problem = wb.BottleneckSATA(wb.SensingGraph.from_edges([0, 1], [0, 1], [0, 1], np.array([1e15, 1.0])))
    found = wb.solve(problem, heuristic=heuristic, bound_time=60.0)
    assert (found.objective, found.faults) == (1.0, ())


def test_a_method_that_searches_learns_what_it_searches_for(registered: Any) -> None:
    heard: list[Any] = []

    def hears(problem: Any, stop: Any, linear: Any, target: float | None = None) -> None:
        heard.append(target)

    instead(registered, "branching-tree", hears)
    instead(registered, "marginal-gains", lambda *_: None)
    find_bounds(PROBLEM, 5.0, target=6.0)
    find_bounds(PROBLEM, 5.0)
    find_bounds(PROBLEM, 5.0, target=6.0, searching=False)
    assert heard == [6.0, None]


def test_what_searches_nothing_comes_before_anything_is_prepared_however_little_time_there_is(registered: Any) -> None:
    said: list[str] = []

    def told(name: str, order: int) -> None:
        def compute(*_: Any) -> Evidence:
            said.append(name)
            return Evidence("item-prices", name, 0.0, {})

        prepare = (lambda: said.append(f"{name} made ready")) if order > AT_ONCE else (lambda: None)
        registered(BOUNDS, name, BoundMethod(name, lambda problem: frozenset(), compute, order, prepare))

    for name in list(BOUNDS):
        instead(registered, name, lambda *_: None)
    told("later", 1), told("first", 0)
    assert [e.source for e in find_bounds(PROBLEM, 5.0)] == ["first", "later"]
    assert said == ["first", "later made ready", "later"]
    for given in ({"bound_time": 1e-12}, {"bound_time": 5.0, "at_once": True}):
        said.clear()
        assert [e.source for e in find_bounds(PROBLEM, **given)] == said == ["first"]  # type: ignore[arg-type]


def test_what_is_to_be_prepared_is_no_method_that_is_asked_at_once() -> None:
    assert not [
        name for name in BOUNDS if (method := BOUNDS[name]).order <= AT_ONCE and (method.kernels or method.prepare.__name__ != "<lambda>")
    ]


def test_what_takes_no_compiler_is_there_before_what_does(registered: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def noting(name: str) -> Any:
        compute = BOUNDS[name].compute

        def noted(*given: Any, **more: Any) -> Any:
            asked.append(name)
            return compute(*given, **more)

        return noted

    for name in ("marginal-gains", "linear-relaxation"):
        instead(registered, name, noting(name))
    monkeypatch.setattr(BoundMethod, "compiled", lambda self: self.name != "marginal-gains")
    late: list[str] = []
    control = Control()
    orders = {how: find_bounds(PROBLEM, 60.0, compiling=how, uncompiled=late, control=control) for how in ("never", "last", "first")}
    assert asked == ["linear-relaxation", "linear-relaxation", "marginal-gains", "marginal-gains", "linear-relaxation"]
    assert late == ["marginal-gains"] * 3
    assert "marginal-gains" not in [e.kind for e in orders["never"]]
    kinds = [[e.kind for e in orders[how]] for how in ("last", "first")]
    assert kinds[0] == kinds[1] and kinds[0][0] == "marginal-gains", "in the order of the methods, whenever they had their turn"


def test_a_method_that_never_comes_back_costs_nothing_that_was_proved(registered: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """As compiling may: what was published before stays."""
    monkeypatch.setattr(BoundMethod, "compiled", lambda self: self.name != "marginal-gains")
    hanging = threading.Event()
    instead(registered, "marginal-gains", lambda *_: hanging.wait())
    monkeypatch.setattr(searching, "GRACE", 0.1)
    control = Control()

    def find(control: Control) -> RawResult:
        return RawResult("unknown", answer=find_bounds(PROBLEM, 0.2, control=control))

    found = searching.search(find, control, 0.2, overtime=0.2)
    hanging.set()
    assert "did not stop when asked" in found.result.message
    assert found.result.evidence, "of the others"


@pytest.mark.share(2)
@pytest.mark.parametrize("solver", ["pyvrp", "ortools"])
def test_an_answer_that_reaches_a_verified_bound_ends_the_search(solver: str) -> None:
    problem = wb.generate("random", seed=1, customers=4)
    solution = wb.solve(problem, solver, time_limit=HANG)  # whose end would be told as the limit
    assert (solution.status, solution.limit, solution.bound_kind) == ("optimal", "none", "verified")


@pytest.mark.parametrize("solver", ["pyvrp", "ortools"])
def test_where_the_data_prove_that_there_is_no_answer_none_is_searched(solver: str) -> None:
    problem = wb.generate("random", seed=1, customers=6, vehicles=1, capacity=10)
    solution = wb.solve(problem, solver, time_limit=40)
    assert solution.seconds["solve"] < 20
    assert (solution.status, solution.answer) == ("infeasible", None)
    assert solution.certificate.infeasible


@pytest.mark.share(2)
@pytest.mark.parametrize("given", [{"iterations": 50}, {"time_limit": 1.0, "bound_time": 0.0}])
def test_nothing_is_proved_before_a_run_that_shall_repeat_or_that_asks_for_no_bound(monkeypatch, given) -> None:
    monkeypatch.setattr("waybound.solving.bounding.first_evidence", lambda *_: pytest.fail("asked"))
    if "bound_time" in given:
        monkeypatch.setattr(
            "waybound.solving.bounding.first_evidence",
            lambda problem, seconds, linear, gap, uncompiled: ([], None) if seconds == 0 else pytest.fail("asked"),
        )
    assert wb.solve(wb.read("demo-tiny"), "pyvrp", **given).answer is not None


@pytest.mark.parametrize("fault", [InputError("too large"), MemoryError(), KeyboardInterrupt()])
def test_a_bound_that_fails_costs_no_answer(monkeypatch, fault) -> None:
    def fails(*given, **named):
        raise fault

    monkeypatch.setattr(bounding, "find_bounds", fails)
    assert bounding.first_evidence(wb.read("demo-tiny"), 1.0) == ([], None)


def test_what_one_thread_saw_reached_stays_so_whatever_another_sees() -> None:
    problem = wb.generate("random", seed=1, customers=4)
    best = wb.solve(problem, "highs")
    made = Goal(problem, dataclasses.replace(certify(problem, None), bound=best.objective))
    worse = wb.Routes(tuple(best.answer)[:-1])
    assert made(best.answer, best.objective)
    assert made(worse, best.objective)
    assert (made.reached, made.limit) == (True, "none")


def test_large_problems_set_no_goal_but_have_the_bound_that_is_there_at_once(monkeypatch) -> None:
    monkeypatch.setattr(bounding, "LARGEST", 3)
    problem = wb.generate("random", seed=1, customers=6)
    monkeypatch.setattr("waybound.solving.bounding._late", lambda *_: pytest.fail("made ready"))
    evidence, aim = bounding.first_evidence(problem, 5.0)
    assert aim is None and {e.kind for e in evidence} == {"load-shares", "nearest-moves"}


class Waits(Engine):
    """Publishes what it was told to, and waits until it is asked to stop, or for its time."""

    name, family, package, modules, summary, features = "waits", "routing", "waybound", ("json",), "for tests", frozenset()
    answer: Any = None

    def missing(self, problem: Problem) -> frozenset[str]:
        return frozenset()

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        if self.answer is not None:
            control.publish(self.answer, problem.evaluate(self.answer).values[0])
        end = time.perf_counter() + options.time_limit
        while not control.stopped and time.perf_counter() < end:
            time.sleep(0.01)
        return RawResult("unknown", "time")


@pytest.fixture
def waits(registered, monkeypatch):
    """The engine, on a machine with a free core, with nothing proved before its search."""
    registered(BACKENDS, "waits", Waits)
    monkeypatch.setattr(bounding, "free_core", lambda threads: True)
    monkeypatch.setattr(bounding, "first_evidence", lambda problem, seconds, linear, gap, uncompiled: ([], goal(problem, [], gap)))
    return Waits


@pytest.mark.slow
def test_a_search_ends_when_the_bound_beside_it_meets_its_answer(waits, monkeypatch):
    problem = wb.generate("random", seed=1, customers=4)
    monkeypatch.setattr(waits, "answer", wb.solve(problem, "highs").answer)
    solution = wb.solve(problem, "waits", time_limit=600)
    assert (solution.status, solution.limit, solution.bound_kind) == ("optimal", "none", "verified")


@pytest.mark.slow
def test_a_search_ends_when_it_is_proved_beside_it_that_there_is_no_answer(waits):
    problem = wb.generate("random", seed=1, customers=6, vehicles=1, capacity=10)
    solution = wb.solve(problem, "waits", time_limit=600)
    assert (solution.status, solution.limit, solution.certificate.infeasible) == ("infeasible", "none", True)


def test_what_fails_beside_a_search_costs_no_answer(waits, monkeypatch):
    problem = wb.read("demo-tiny")
    monkeypatch.setattr(waits, "answer", wb.solve(problem, "highs").answer)
    monkeypatch.setattr("waybound.solving.bounding.run_in_process", lambda *_, **__: 1 / 0)
    solution = wb.solve(problem, "waits", time_limit=0.5, bound_time=HANG)
    assert solution.objective == pytest.approx(384.7341401)
    assert solution.bound_kind == "verified"  # found after the search, as where no core is free


def test_who_has_a_bound_does_not_wait_for_what_is_compiled_beside_the_search(waits, monkeypatch):
    problem = wb.read("demo-tiny")
    evidence = find_bounds(problem, HANG, at_once=True)
    monkeypatch.setattr(waits, "answer", wb.solve(problem, heuristic="savings", bound_time=0).answer)
    monkeypatch.setattr(
        bounding, "first_evidence", lambda problem, seconds, linear, gap, uncompiled: (evidence, goal(problem, evidence, gap))
    )
    release = threading.Event()
    monkeypatch.setattr("waybound.solving.bounding.run_in_process", lambda *_, **__: release.wait(10 * HANG))
    solution = wb.solve(problem, "waits", time_limit=0.1, bound_time=1.5)
    assert not release.is_set() and solution.bound_kind == "verified" and solution.gap > 0.0
    release.set()


def test_no_bound_is_waited_for_once_the_answer_is_proved(waits, monkeypatch):
    problem = wb.generate("random", seed=1, customers=4)
    evidence = find_bounds(problem, HANG, target=wb.solve(problem, "highs", bound_time=0).objective)
    monkeypatch.setattr(waits, "answer", wb.solve(problem, "highs").answer)
    monkeypatch.setattr(
        bounding, "first_evidence", lambda problem, seconds, linear, gap, uncompiled: (evidence, goal(problem, evidence, gap))
    )
    release = threading.Event()
    monkeypatch.setattr("waybound.solving.bounding.run_in_process", lambda *_, **__: release.wait(10 * HANG))
    solution = wb.solve(problem, "waits", time_limit=100 * HANG)
    release.set()
    assert (solution.status, solution.limit) == ("optimal", "none")
    assert solution.seconds["bound"] < HANG


def test_what_bounding_beside_a_search_finds_and_lacks_is_told(waits, monkeypatch):
    problem = wb.read("demo-tiny")
    found = find_bounds(problem, HANG, target=384.7341400721996)

    def bounds(work, options, control, **_):
        control.publish(evidence=tuple(found))
        return RawResult("unknown", statistics={"unable": ["no bound by magic: there is none"]})

    monkeypatch.setattr("waybound.solving.bounding.run_in_process", bounds)
    monkeypatch.setattr(waits, "answer", wb.solve(problem, "highs").answer)
    events: list[dict[str, Any]] = []
    solution = wb.solve(problem, "waits", time_limit=1.0, bound_time=1.5, progress=events.append)
    assert "no bound by magic: there is none" in solution.message
    assert [e["bound"] for e in events if e["phase"] == "bound"] == [found[-1].value]


def test_an_answer_that_bounding_comes_across_beside_a_search_ends_it_where_it_is_the_best(waits, monkeypatch):
    problem = wb.read("demo-tiny")
    best = wb.solve(problem, "highs")
    found = find_bounds(problem, HANG, target=best.objective)

    def bounds(work, options, control, **_):
        control.publish(evidence=tuple(found))
        control.publish(best.answer, best.objective)
        return RawResult("unknown")

    monkeypatch.setattr("waybound.solving.bounding.run_in_process", bounds)
    solution = wb.solve(problem, "waits", time_limit=100 * HANG)
    assert (solution.status, solution.limit, solution.objective) == ("optimal", "none", pytest.approx(best.objective))
    assert "found while its bound was looked for" in solution.message


def test_the_end_of_a_wait_ends_the_bounding(waits):
    problem = wb.read("demo-tiny")
    beside = Bounding(problem, 10 * HANG, LinearPrograms(), Recorder(problem.senses))
    beside.begin(Control(), Options())
    assert beside.beside
    control = Control()
    control.stop()
    began = time.perf_counter()
    beside.found_beside(control)
    assert time.perf_counter() - began < HANG


def test_a_core_is_free_where_threads_are_fewer_than_cores():
    assert free_core(0)
    assert not free_core(10**6)
