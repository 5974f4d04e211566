"""Nobody ignores a feature of a routing problem: what does not declare it refuses the problem by its name."""

from __future__ import annotations

import pytest
from small_routing import WHOLE_FAMILY, varied

from waybound.formulations.forms import FORMS
from waybound.formulations.routing.checking.known_features import KNOWN
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.errors import UnsupportedError
from waybound.solvers.backend import BACKENDS, Engine
from waybound.solvers.bounds import BOUNDS
from waybound.solving.listing import missing_features
from waybound.solving.solve import solve

NAMES = {"several-depots": "multiple-depots", "penalties": "objective:penalties"}
FEATURES = [NAMES.get(name, name) for name in WHOLE_FAMILY]


def problem(feature: str):
    return varied(next(k for k in WHOLE_FAMILY if NAMES.get(k, k) == feature), 1, 3)


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


@pytest.mark.parametrize("feature", ["reloads", "recharging"])
def test_bounds_that_prove_nothing_say_why(feature):
    asked = problem(feature)
    assert feature not in KNOWN
    for name in ("spanning-tree", "sifted-relaxation"):
        assert feature in BOUNDS[name].missing(asked)
