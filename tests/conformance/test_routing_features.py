"""Nobody ignores a feature of a routing problem: what declares it solves small problems that have it, what does not refuses by its name."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache

import pytest
from small_routing import WHOLE_FAMILY, simplified, varied

from waybound.formulations.forms import FORMS
from waybound.formulations.routing.checking.known_features import KNOWN
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.errors import UnsupportedError
from waybound.reports.benchmarks.exact_routing import RoutingTruth
from waybound.reports.benchmarks.routing_variants import drawn
from waybound.reports.tables.routing_features import ROWS, declared_by_engines, declared_by_forms, declared_by_heuristics, solvers_of_forms
from waybound.solvers.backend import BACKENDS, Control, Options, solver_named
from waybound.solvers.bounds import BOUNDS
from waybound.solving.listing import missing_features
from waybound.solving.solve import solve

NAMES = {"several-depots": "multiple-depots", "penalties": "objective:penalties"}
FEATURES = [NAMES.get(name, name) for name in WHOLE_FAMILY]


def problem(feature: str, seed: int = 1, customers: int = 3):
    return varied(next(k for k in WHOLE_FAMILY if NAMES.get(k, k) == feature), seed, customers)


@pytest.mark.parametrize("feature", FEATURES)
def test_no_solver_takes_a_problem_that_none_of_its_forms_expresses(feature):
    asked = problem(feature)
    for name in BACKENDS:
        backend = BACKENDS[name]
        lacks, forms = missing_features(name, asked)
        assert lacks or all(feature in FORMS[form].features for form in forms), name
        if lacks and backend.installed():
            with pytest.raises(UnsupportedError) as error:
                solve(asked, name, time_limit=1.0)
            assert any(missing in str(error.value) for missing in lacks), (name, lacks)
    for name in HEURISTICS:
        heuristic = HEURISTICS[name]
        if heuristic.missing(asked) and "routing" in heuristic.families:
            with pytest.raises(UnsupportedError, match=name):
                solve(asked, heuristic=name)


@pytest.mark.parametrize("feature", FEATURES)
def test_engines_reach_and_keep_the_optimum_with_each_feature_they_declare(engine_name, feature):
    engine = BACKENDS[engine_name]()
    if feature not in engine.features:
        pytest.skip(f"{engine_name} does not declare {feature}")
    solved, missed = 0, 0
    for seed in range(5):
        asked = simplified(problem(feature, seed, 4), feature, engine.missing)
        if asked is None:
            continue
        truth = RoutingTruth(asked)
        result = run(engine, asked)
        if truth.lenient is None:
            assert result.answer is None, seed
            continue
        # What it may do: from the best answer it goes nowhere worse, and nowhere that the judge forbids.
        best, begun = truth.samples[0], run(engine, asked, start=truth.samples[0])
        assert asked.evaluate(best).values == pytest.approx([float(v) for v in truth.lenient])
        if begun.statistics.get("start") == "used":
            assert_value(asked, begun, truth)
        else:
            assert engine_name in HASTY, seed
        # What it finds by itself: never more than there is, and mostly all.
        solved += 1
        if result.answer is None or not reached(asked, result, truth):
            missed += 1
    assert solved > 0
    assert missed <= 1


HASTY = ("vroom",)
"""Engines that refuse some starts: VROOM holds a site out of reach where a round trip to it alone is too long."""


def run(engine, asked, start=None):
    options = {"iterations": 300} if "iterations" in engine.honours else {}
    return engine.run(asked, Options(time_limit=10.0, start=start, **options), Control())


def reached(asked, result, truth) -> bool:
    verdict = asked.evaluate(result.answer)
    assert verdict.feasible, verdict.violations
    if result.objective is not None:
        assert result.objective == pytest.approx(verdict.values[0], abs=1e-5)
    signs = [1.0 if sense == "min" else -1.0 for sense in asked.senses]
    found, best = ([sign * float(v) for sign, v in zip(signs, values, strict=True)] for values in (verdict.values, truth.lenient))
    same = found == pytest.approx(best, abs=1e-6)
    assert same or found > best
    return same


def assert_value(asked, result, truth) -> None:
    assert reached(asked, result, truth), (asked.evaluate(result.answer).values, truth.lenient)


@pytest.mark.parametrize("feature", ["reloads", "recharging"])
def test_bounds_that_prove_nothing_say_why(feature):
    asked = problem(feature)
    assert feature not in KNOWN
    for name in ("spanning-tree", "sifted-relaxation"):
        assert feature in BOUNDS[name].missing(asked)


# -- every cell of the page on who takes what --------------------------------------------------------------------------


@cache
def pool():
    """Problems of two or three sites, by their numbers."""
    problems = {number: drawn(7, number) for number in range(432)}
    return {number: p for number, p in problems.items() if len(p.customers) in (2, 3)}


@cache
def truth(number: int) -> RoutingTruth:
    return RoutingTruth(pool()[number])


def is_optimal(number: int, answer) -> bool:
    """Whether an answer, which has to be feasible, has the values of the optimum."""
    verdict = pool()[number].evaluate(answer)
    assert verdict.feasible, (number, verdict.violations)
    return verdict.values == pytest.approx([float(v) for v in truth(number).lenient], rel=1e-6, abs=1e-9)


def cover(features, missing: Callable[..., frozenset[str]], solved: Callable[[int], bool | None]) -> None:
    """Have a few problems ``solved`` that together hold all of ``features``; None is a refusal for what the numbers are."""
    able = {number: problem.features() for number, problem in pool().items() if not missing(problem)}
    left = set(features) & set(ROWS)
    while left:
        number = max(able, key=lambda k: len(able[k] & left))
        held = able.pop(number) & left
        assert held, f"no problem that can be solved has {', '.join(sorted(left))}"
        done = solved(number) if truth(number).lenient is not None else None
        assert done is not False, (number, pool()[number])
        left -= held if done else set()


@pytest.mark.parametrize("form", declared_by_forms())
@pytest.mark.parametrize("solver", sorted({name for names in solvers_of_forms().values() for name in names}))
def test_exact_solvers_find_the_optimum_with_each_feature_of_a_form(form, solver):
    if not BACKENDS[solver].installed() or not any(form in forms for forms, names in solvers_of_forms().items() if solver in names):
        pytest.skip(f"{solver} is not installed, or takes no program of this form")

    def solved(number: int) -> bool | None:
        made = pool()[number].compile(form)
        try:
            result = solver_named(solver).run(made.program, Options(time_limit=60.0), Control())
        except UnsupportedError:
            return None
        assert result.status == "optimal", (number, result)
        return is_optimal(number, made.decode(result.answer))

    cover(FORMS[form].features, FORMS[form].missing, solved)


def test_engines_find_the_optimum_with_each_feature(engine_name):
    engine = BACKENDS[engine_name]()

    def solved(number: int) -> bool:
        control = Control()
        control.goal = lambda answer, objective: is_optimal(number, answer)
        work = {"iterations": 300} if "iterations" in engine.honours else {}
        result = engine.run(pool()[number], Options(time_limit=10.0, **work), control)
        return result.answer is not None and is_optimal(number, result.answer)

    cover(engine.features, engine.missing, solved)


@pytest.mark.parametrize("name", declared_by_heuristics())
def test_heuristics_find_answers_that_pass_every_check_with_each_feature(name):
    def solved(number: int) -> bool | None:
        solution = solve(pool()[number], heuristic=name, bound_time=0.0)
        return None if solution.answer is None else pool()[number].evaluate(solution.answer).feasible

    cover(HEURISTICS[name].features, HEURISTICS[name].missing, solved)


@pytest.mark.parametrize("feature", ROWS)
def test_what_does_not_declare_a_feature_refuses_by_its_name(feature):
    asked = next(problem for problem in pool().values() if feature in problem.features())
    for form, features in declared_by_forms().items():
        if feature not in features:
            assert feature in FORMS[form].missing(asked)
            with pytest.raises(UnsupportedError, match=re.escape(feature)):
                asked.compile(form)
    for name, features in declared_by_engines().items():
        if feature not in features:
            assert feature in BACKENDS[name]().missing(asked)
            with pytest.raises(UnsupportedError, match=re.escape(feature)):
                BACKENDS[name]().run(asked, Options(), Control())
    for name, features in declared_by_heuristics().items():
        if feature not in features:
            assert feature in HEURISTICS[name].missing(asked)
            with pytest.raises(UnsupportedError, match=re.escape(feature)):
                solve(asked, heuristic=name)
