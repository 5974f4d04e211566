"""The engine of labels: claims, limits and evidence."""

from __future__ import annotations

import pytest
import risky_cases as cases

import waybound as wb
from waybound.instances.errors import UnsupportedError, UsageError
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
