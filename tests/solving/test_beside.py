"""Bounds that are found beside a search end it, and are its evidence."""

from __future__ import annotations

import threading
import time
from typing import Any

import pytest
from patience import HANG

import waybound as wb
from waybound.formulations.problem import Problem
from waybound.solvers.backend import BACKENDS, Control, Engine, Options, RawResult
from waybound.solvers.linear_programs import LinearPrograms
from waybound.solving import solve
from waybound.solving.beside import Beside, BoundWork, free_core
from waybound.solving.bounding import find_bounds
from waybound.solving.goal import Goal


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
    monkeypatch.setattr(solve, "free_core", lambda threads: True)
    monkeypatch.setattr(solve, "first_evidence", lambda problem, seconds, linear, gap, uncompiled: ([], Goal(problem, [], gap)))
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
    monkeypatch.setattr("waybound.solving.beside.run_in_process", lambda *_, **__: 1 / 0)
    solution = wb.solve(problem, "waits", time_limit=0.5, bound_time=HANG)
    assert solution.objective == pytest.approx(384.7341401)
    assert solution.bound_kind == "verified"  # found after the search, as where no core is free


def test_who_has_a_bound_does_not_wait_for_what_is_compiled_beside_the_search(waits, monkeypatch):
    problem = wb.read("demo-tiny")
    evidence = find_bounds(problem, HANG, at_once=True)
    monkeypatch.setattr(waits, "answer", wb.solve(problem, heuristic="savings", bound_time=0).answer)
    monkeypatch.setattr(solve, "first_evidence", lambda problem, seconds, linear, gap, uncompiled: (evidence, Goal(problem, evidence, gap)))
    release = threading.Event()
    monkeypatch.setattr("waybound.solving.beside.run_in_process", lambda *_, **__: release.wait(10 * HANG))
    solution = wb.solve(problem, "waits", time_limit=0.1, bound_time=1.5)
    assert not release.is_set() and solution.bound_kind == "verified" and solution.gap > 0.0
    release.set()


def test_no_bound_is_waited_for_once_the_answer_is_proved(waits, monkeypatch):
    problem = wb.generate("random", seed=1, customers=4)
    evidence = find_bounds(problem, HANG, target=wb.solve(problem, "highs", bound_time=0).objective)
    monkeypatch.setattr(waits, "answer", wb.solve(problem, "highs").answer)
    monkeypatch.setattr(solve, "first_evidence", lambda problem, seconds, linear, gap, uncompiled: (evidence, Goal(problem, evidence, gap)))
    release = threading.Event()
    monkeypatch.setattr("waybound.solving.beside.run_in_process", lambda *_, **__: release.wait(10 * HANG))
    solution = wb.solve(problem, "waits", time_limit=100 * HANG)
    release.set()
    assert (solution.status, solution.limit) == ("optimal", "none")
    assert solution.seconds["bound"] < HANG


def test_what_bounding_beside_a_search_finds_and_lacks_is_told(waits, monkeypatch):
    problem = wb.read("demo-tiny")
    found = find_bounds(problem, HANG, target=384.7341400721996)

    def bounds(work, options, control, **_):
        control.publish(found)
        return RawResult("unknown", answer=found, statistics={"unable": ["no bound by magic: there is none"]})

    monkeypatch.setattr("waybound.solving.beside.run_in_process", bounds)
    monkeypatch.setattr(waits, "answer", wb.solve(problem, "highs").answer)
    events: list[dict[str, Any]] = []
    solution = wb.solve(problem, "waits", time_limit=1.0, bound_time=1.5, progress=events.append)
    assert "no bound by magic: there is none" in solution.message
    assert [e["bound"] for e in events if e["phase"] == "bound"] == [found[-1].value]


def test_the_end_of_a_wait_ends_the_bounding(waits):
    problem = wb.read("demo-tiny")
    beside = Beside(BoundWork(problem, 10 * HANG, (), LinearPrograms()), Goal(problem, []), Control())
    control = Control()
    control.stop()
    began = time.perf_counter()
    beside.found(control)
    assert time.perf_counter() - began < HANG


def test_a_core_is_free_where_threads_are_fewer_than_cores():
    assert free_core(0)
    assert not free_core(10**6)
