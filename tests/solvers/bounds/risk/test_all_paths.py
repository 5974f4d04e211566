"""The bound of all paths that could earn more."""

from __future__ import annotations

import pytest
import risky_cases as cases

from waybound.formulations.stop import NEVER
from waybound.solvers.bounds import BOUNDS

BOUND = BOUNDS["all-paths"]


def test_it_proves_the_value_of_a_best_path():
    problem = cases.two_ways()
    for target in (None, 27.0, cases.best(problem)):
        assert BOUND.evidence(problem, NEVER, None, target).value == pytest.approx(cases.best(problem))


def test_least_risks_are_not_its_business():
    assert BOUND.missing(cases.ring()) == {"objective:risk"}
