import math

import pytest
import risky_cases as cases

import waybound as wb
from waybound import RiskyPath, UnsupportedError, UsageError
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.risk.elements import LocaleRisk
from waybound.instances.risk.traverse_elements import CollectedRisk
from waybound.solvers.backend import BACKENDS, Control, Options


def run(problem, **options):
    return BACKENDS["risk-labels"]().run(problem, Options(**options), Control())


def test_it_is_the_default_and_proves_what_it_finds():
    for problem in (cases.ring(), cases.loop("risk"), cases.mud(), cases.two_ways()):
        solution = wb.solve(problem)
        assert (solution.solver, solution.status, solution.bound_kind) == ("risk-labels", "optimal", "verified")
        assert solution.objective == pytest.approx(cases.best(problem))


def test_labels_can_be_limited_and_repeat():
    first, second = (run(cases.mud_costs(), iterations=3) for _ in range(2))
    assert first == second
    assert (first.status, first.limit, first.answer) == ("unknown", "iterations", None) and first.bound <= 5


def test_other_families_and_options_are_refused():
    with pytest.raises(UnsupportedError):
        run(wb.read("demo-c25"))
    with pytest.raises(UsageError, match="has no option 'h'"):
        run(cases.ring(), extra={"h": 1})


def enumerate_paths(problem, **options):
    return BACKENDS["path-enumeration"]().run(problem, Options(**options), Control())


@pytest.mark.parametrize("make", [cases.ring, cases.loop, cases.refusal, cases.mud, cases.two_ways, lambda: cases.two_ways(discount=0.5)])
def test_the_best_of_all_paths(make):
    problem = make()
    result = enumerate_paths(problem)
    assert result.status == "optimal" and problem.evaluate(result.answer).values[0] == pytest.approx(cases.best(problem)) == pytest.approx(
        result.bound
    )


def test_limits_are_named_and_no_optimum_claimed():
    problem = cases.lattice(4, 4)
    cut, timed = enumerate_paths(problem, iterations=500), enumerate_paths(cases.lattice(8, 8), time_limit=0.3)
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
    assert enumerate_paths(apart).status == "infeasible"
