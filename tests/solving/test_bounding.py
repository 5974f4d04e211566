"""Bounds within a budget: what fails costs itself alone."""

from __future__ import annotations

import dataclasses
import math
import threading
from typing import Any

import numpy as np
import pytest

import waybound as wb
from waybound.formulations.evidence import CHECKERS, Evidence
from waybound.instances.errors import InputError, UnsupportedError
from waybound.solvers.backend import Control, RawResult
from waybound.solvers.bounds import BOUNDS, BoundMethod
from waybound.solving import search as searching
from waybound.solving.bounding import AT_ONCE, find_bounds, proved

GRAPH = wb.SensingGraph.from_edges([0, 1], [0, 1], [0, 1], np.array([3.0, 2.0]))
PROBLEM = wb.WinnerTakesAllSATA(GRAPH)


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
    assert proved(PROBLEM, boast) is None
    instead(registered, first, lambda *_: boast)
    found = find_bounds(PROBLEM, 5.0, target=5.0, known=(boast,))
    assert found[0] is boast
    assert any(proved(PROBLEM, e) == 5.0 for e in found[1:])


def test_what_proves_nothing_is_no_bound(registered: Any) -> None:
    registered(CHECKERS, "vain", lambda problem, data: math.inf)
    assert proved(PROBLEM, Evidence("vain", "in vain", 5.0, {})) is None


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
    assert found.result.answer, "of the others"
