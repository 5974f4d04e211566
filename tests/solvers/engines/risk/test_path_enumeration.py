"""The engine that walks every path."""

from __future__ import annotations

import math

import pytest
import risky_cases as cases

from waybound.formulations.certificate import verified_bound
from waybound.formulations.risk.risky_path import RiskyPath
from waybound.instances.risk.elements import LocaleRisk
from waybound.instances.risk.traverse_elements import CollectedRisk
from waybound.solvers.backend import BACKENDS, Control, Options


def run(problem, **options):
    return BACKENDS["path-enumeration"]().run(problem, Options(**options), Control())


@pytest.mark.parametrize("make", [cases.ring, cases.loop, cases.refusal, cases.mud, cases.two_ways, lambda: cases.two_ways(discount=0.5)])
def test_the_best_of_all_paths(make):
    problem = make()
    result = run(problem)
    assert result.status == "optimal" and problem.evaluate(result.answer).values[0] == pytest.approx(cases.best(problem)) == pytest.approx(
        result.bound
    )


def test_limits_are_named_and_no_optimum_claimed():
    problem = cases.lattice(4, 4)
    cut, timed = run(problem, iterations=500), run(cases.lattice(8, 8), time_limit=0.3)
    assert (cut.status, cut.limit, cut.statistics["paths"], cut.bound) == ("feasible", "iterations", 500, None)
    assert timed.limit == "time" and timed.status == ("unknown" if timed.answer is None else "feasible")


@pytest.mark.parametrize("engine", ["path-enumeration", "risk-labels"])
@pytest.mark.parametrize(("objective", "goals"), [("risk", (0,)), ("hazard", (0, 1)), ("reward-per-risk", ())])
@pytest.mark.parametrize("mud", [False, True])
def test_a_start_that_nobody_leaves_alive_is_no_answer(engine, objective, goals, mud):
    element = CollectedRisk([False, False], [[1.0, 0.0]]) if mud else LocaleRisk([1.0, 0.0])
    problem = RiskyPath(cases.graph([(0, 1)], [element], goals=goals, rewards=[1.0, 1.0], objective=objective))
    assert BACKENDS[engine]().run(problem, Options(), Control()).status == "infeasible"
    if goals:
        (reason,) = problem.infeasibility_reasons()
        assert "the start has a risk of 1 itself" in reason.message
        assert verified_bound(problem, reason.evidence) == math.inf


def test_no_way_is_told():
    apart = RiskyPath(cases.graph([(0, 1)], [LocaleRisk([0, 0, 0])], states=3, goals=(2,)))
    assert run(apart).status == "infeasible"
