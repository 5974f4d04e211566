"""Tangents: a relaxation whose duals prove its bound."""

from __future__ import annotations

from pathlib import Path

import pytest
from program_text import expected, written
from risk_problems import margins, problem

from waybound.formulations.certificate import verified_bound
from waybound.formulations.programs.exactness import Exactness
from waybound.formulations.risk.forms import tangents
from waybound.formulations.stop import Stop
from waybound.solvers.engines.risk.convex_allocation_steps.session import open_session


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


TWO = """
    {
      "waybound": 1, "kind": "risk-allocation", "name": "two", "problem": "risk-allocation", "sense": "max",
      "decisions": 2, "lower": 0,
      "quantities": {"map": [[1, 0], [0, 1]], "covariance": [1, 0.25]},
      "cost": {"decisions": [1, 3]},
      "constraints": {"decisions": [[1, 1]], "upper": 7},
      "chance": {"quantities": [[1, 0], [0, 1]], "limits": [5, 5]},
      "risk": {"total": 0.1, "each": [0.1, 0.05]}
    }
"""


def test_tangents_from_text_to_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """At three points: risks of 0.1 (0.05), 2.236e-5 (1.581e-5) and 5e-9, that is 1.281552 (1.644854), 4.081628 (4.161454) and 5.730729
    deviations. The slope is the density there over 0.05, in which risks are counted, the constant the risk over 0.05 and slope times point.
    """
    monkeypatch.setattr(tangents, "POINTS", 3)
    assert written(TWO, "tangents", tmp_path, ".json") == expected(
        """
        tangents, relaxation
        max x[x1] + 3 x[x2]
        constraint[1]: x[x1] + x[x2] <= 7
        chance[1]: x[x1] + z[1] <= 5
        chance[2]: x[x2] + 0.5 z[2] <= 5
        budget-1: risk[1] + risk[2] <= 2
        piece[1,0]: 3.50997 z[1] + risk[1] >= 6.4982
        piece[1,1]: 0.00192458 z[1] + risk[1] >= 0.00830262
        piece[1,2]: 5.89593e-07 z[1] + risk[1] >= 3.4788e-06
        piece[2,3]: 2.06271 z[2] + risk[2] >= 4.39286
        piece[2,4]: 0.001385 z[2] + risk[2] >= 0.00607984
        piece[2,5]: 5.89593e-07 z[2] + risk[2] >= 3.4788e-06
        x[x1], x[x2] >= 0
        z[1] >= 1.28155
        z[2] >= 1.64485
        0 <= risk[1] <= 2
        0 <= risk[2] <= 1
        """
    )
