"""Nobody ignores a feature of a routing problem: what does not declare it refuses the problem by its name."""

from __future__ import annotations

import pytest
from exact_routing import RoutingTruth
from small_routing import WHOLE_FAMILY, simplified, varied

from waybound.formulations.forms import FORMS
from waybound.formulations.routing.checking.known_features import KNOWN
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.errors import UnsupportedError
from waybound.solvers.backend import BACKENDS, Control, Engine, Options
from waybound.solvers.bounds import BOUNDS
from waybound.solving.listing import missing_features
from waybound.solving.solve import solve

NAMES = {"several-depots": "multiple-depots", "penalties": "objective:penalties"}
FEATURES = [NAMES.get(name, name) for name in WHOLE_FAMILY]


def problem(feature: str, seed: int = 1, customers: int = 3):
    return varied(next(k for k in WHOLE_FAMILY if NAMES.get(k, k) == feature), seed, customers)


@pytest.mark.parametrize("feature", FEATURES)
def test_forms_engines_and_heuristics_name_what_they_do_not_declare(feature):
    asked = problem(feature)
    assert feature in asked.features()
    declaring = [*FORMS.values(), *(b for b in BACKENDS.values() if issubclass(b, Engine)), *HEURISTICS.values()]
    for method in declaring:
        family = getattr(method, "family", "routing") == "routing" and "routing" in getattr(method, "families", ("routing",))
        if family and feature not in method.features:
            made = method() if isinstance(method, type) else method
            assert feature in made.missing(asked), method


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
