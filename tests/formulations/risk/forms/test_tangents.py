"""Tangents: a relaxation whose duals prove its bound."""

from __future__ import annotations

import pytest
from risk_problems import margins, problem

from waybound.formulations.certificate import verified_bound
from waybound.formulations.programs.exactness import Exactness
from waybound.formulations.stop import Stop
from waybound.solvers.engines.convex_allocation_steps.session import open_session


@pytest.mark.parametrize(("p", "best"), [(problem(), 13.731143), (margins([1.0, 2.0, 5.0], 0.1), 13.808752)], ids=["max", "min"])
def test_its_optimum_and_duals_bound_the_problem(p, best) -> None:
    made = p.compile("tangents")
    assert made.exactness is Exactness.RELAXATION
    found = open_session(made.program).solve(Stop())
    assert p.sign * found.value <= p.sign * best + 1e-6
    assert found.value == pytest.approx(best, rel=2e-3)
    assert made.dual_evidence is not None
    bound = verified_bound(p, made.dual_evidence(found.duals))
    assert p.sign * found.value - 1e-7 <= p.sign * bound <= p.sign * best + 1e-6


def test_it_says_nothing_of_joint_risk() -> None:
    made = problem(risk__kind="joint").compile("tangents")
    assert made.exactness is Exactness.NEITHER and made.dual_evidence is None
