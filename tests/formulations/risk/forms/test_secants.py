"""Secants: a restriction whose points are answers."""

from __future__ import annotations

import pytest
from risk_problems import around_a_box, margins, problem

from waybound.formulations.programs.exactness import Exactness
from waybound.solving.solve import solve


@pytest.mark.parametrize(
    ("p", "best"), [(problem(), 13.731143), (margins([1.0, 3.0], 0.1), 6.268857), (margins([1.0, 2.0, 5.0], 0.1), 13.808752)]
)
def test_its_answers_are_near_the_optimum(p, best) -> None:
    found = solve(p, "highs", form="secants", bound_time=0)
    assert p.compile("secants").exactness is Exactness.RESTRICTION
    assert p.sign * best - 1e-6 <= p.sign * found.objective
    assert found.objective == pytest.approx(best, rel=2e-3)


def test_alternatives_are_chosen_by_integers() -> None:
    found = solve(around_a_box(), "highs", form="secants", bound_time=0)
    assert found.answer.decision == pytest.approx([-1.328971, 0.0], abs=1e-3)
    assert found.objective == pytest.approx(1.328971, rel=1e-3)
