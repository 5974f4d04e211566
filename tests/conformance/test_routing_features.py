"""Nobody ignores a feature of a routing problem: what declares it solves small problems that have it, what does not refuses by its name."""

import itertools
import re
from collections.abc import Callable
from functools import cache

import pytest
from draws import ALL
from small_routing import WHOLE_FAMILY, simplified, varied
from truth.routing import RoutingTruth

from waybound import UnsupportedError, solve
from waybound.formulations.forms import FORMS
from waybound.formulations.routing.checking.known_features import KNOWN
from waybound.heuristics.heuristic import HEURISTICS
from waybound.reports.benchmarks.routing_variants import drawn, risky, with_features
from waybound.reports.tables.routing.routing_features import (
    ROWS,
    declared_by_engines,
    declared_by_forms,
    declared_by_heuristics,
    solvers_of_forms,
)
from waybound.solvers.backend import BACKENDS, Control, Options, solver_named
from waybound.solvers.bounds import BOUNDS
from waybound.solving.method import missing_features

NAMES = {"several-depots": "multiple-depots", "penalties": "objective:penalties"}
FEATURES = [NAMES.get(name, name) for name in WHOLE_FAMILY]


def problem(feature: str, seed: int = 1, customers: int = 3):
    return varied(next(k for k in WHOLE_FAMILY if NAMES.get(k, k) == feature), seed, customers)


@pytest.mark.share(3)
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


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", FEATURES)
def test_engines_reach_and_keep_the_optimum_with_each_feature_they_declare(engine_name, feature):
    engine = BACKENDS[engine_name]()
    if feature not in engine.features:
        pytest.skip(f"{engine_name} does not declare {feature}")
    solved, missed = 0, 0
    customers, seeds = (3, 2) if feature in ("recharging", "initial-energy") else (4, 4)  # enumeration of stops takes long
    for seed in range(seeds):
        asked = simplified(problem(feature, seed, customers), feature, engine.missing)
        if asked is None:
            continue
        if solved == ENOUGH:
            break
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


ENOUGH = 4 if ALL else 1
"""Problems that an engine solves of each feature."""

HASTY = ("vroom",)
"""Engines that refuse some starts: VROOM holds a site out of reach where a round trip to it alone is too long."""


def run(engine, asked, start=None):
    options = {"iterations": 120} if "iterations" in engine.honours else {}
    for seconds in (0.4, 8.0, 60.0) if start is not None else (0.4,):  # on a busy machine a start takes longer to be read
        result = engine.run(asked, Options(time_limit=seconds, start=start, **options), Control())
        if result.answer is not None:
            break
    return result


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
    """Problems of two or three sites, by their names; some with risks."""
    every = [*(drawn(7, number) for number in range(432)), *(risky(7, number) for number in range(60))]
    every += [p for seed in range(20) if (p := with_features(["forbidden-moves"], seed)) is not None]
    return {p.name: p for p in every if len(p.customers) in (2, 3)}


@cache
def truth(problem) -> RoutingTruth:
    return RoutingTruth(problem)


def is_optimal(problem, answer) -> bool:
    """Whether an answer, which has to be feasible, has the values of the optimum."""
    verdict = problem.evaluate(answer)
    assert verdict.feasible, (problem.name, verdict.violations)
    return verdict.values == pytest.approx([float(v) for v in truth(problem).lenient], rel=1e-6, abs=1e-9)


def narrow(feature: str, features):
    """Problems with a feature and little else, for what takes few; with a risk too, for what may ask for one: of time, or of energy where
    a vehicle may have to wait."""
    goals = sorted(name for name in features if name.startswith("objective:"))
    risks = (("route-risk",), ("energy:travel", "route-risk"), ()) if "route-risk" in features else ((),)
    wanted = [dict.fromkeys((feature, goal, *more)) for goal in goals for more in risks]
    drawn_for = (with_features(names, seed) for seed in range(40) for names in wanted)
    return (problem for problem in drawn_for if problem is not None and len(problem.customers) in (2, 3))


def cover(features, missing: Callable[..., frozenset[str]], solved: Callable[..., bool | None]) -> None:
    """Have a few problems ``solved`` that together hold all of ``features``; None is a refusal for what the numbers are."""

    def done(problem) -> bool:
        said = None if missing(problem) or truth(problem).lenient is None else solved(problem)
        assert said is not False, problem.name
        return bool(said)

    able = [problem for problem in pool().values() if not missing(problem)]
    left = set(features) & set(ROWS)
    while able and left:
        problem = max(able, key=lambda p: len(p.features() & left))
        able.remove(problem)
        if not problem.features() & left:
            break
        left -= problem.features() if done(problem) else set()
    for feature in sorted(left):
        assert any(done(problem) for problem in narrow(feature, features)), feature


def pairs():
    for forms, names in solvers_of_forms().items():
        for form, name in itertools.product(forms, names):
            yield pytest.param(form, name, id=f"{name}-{form}")


@pytest.mark.slow
@pytest.mark.parametrize(("form", "solver"), [*pairs()])
def test_exact_solvers_find_the_optimum_with_each_feature_of_a_form(form, solver):
    if not BACKENDS[solver].installed():
        pytest.skip(f"{solver} is not installed")

    def solved(problem) -> bool | None:
        made = problem.compile(form)
        try:
            result = solver_named(solver).run(made.program, Options(time_limit=60.0), Control())
        except UnsupportedError:
            return None
        assert result.status == "optimal", (problem.name, result)
        return is_optimal(problem, made.decode(result.answer))

    cover(FORMS[form].features, FORMS[form].missing, solved)


@pytest.mark.slow
def test_engines_find_the_optimum_with_each_feature(engine_name):
    engine, missed = BACKENDS[engine_name](), []

    def solved(problem) -> bool | None:
        control = Control()
        control.goal = lambda answer, objective: is_optimal(problem, answer)
        work = {"iterations": 300} if "iterations" in engine.honours else {}
        result = engine.run(problem, Options(time_limit=10.0, **work), control)
        if result.answer is not None and is_optimal(problem, result.answer):
            return True
        missed.append(problem.name)
        return None

    cover(engine.features, engine.missing, solved)
    assert len(missed) <= 1, missed  # they promise nothing


@pytest.mark.share(2)
@pytest.mark.parametrize("name", declared_by_heuristics())
def test_heuristics_find_answers_that_pass_every_check_with_each_feature(name):
    def solved(problem) -> bool | None:
        solution = solve(problem, heuristic=name, bound_time=0.0)
        return None if solution.answer is None else problem.evaluate(solution.answer).feasible

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
