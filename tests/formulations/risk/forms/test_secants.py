"""Secants: a restriction whose points are answers."""

from __future__ import annotations

from pathlib import Path

import pytest
from program_text import expected, written
from risk_problems import around_a_box, margins, problem

from waybound.api import solve
from waybound.formulations.programs.exactness import Exactness
from waybound.formulations.risk.forms import secants


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


CORNER = """
    {
      "waybound": 1, "kind": "risk-allocation", "name": "corner", "problem": "risk-allocation",
      "decisions": 2, "lower": -3, "upper": 3,
      "quantities": {"map": [[1, 0], [0, 1]], "covariance": [0.04, 0.25]},
      "cost": {"decisions": [-1, -2]},
      "chance": {
        "quantities": [[1, 0], [0, 1], [1, 1]], "limits": [-1, -1, 4], "constraint": [0, 0, 1], "names": ["corner", "wall"]
      },
      "risk": {"total": 0.1}
    }
"""


def test_secants_from_text_to_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Chords between three points: risks over 0.05 of 2, 4.472136e-4 and 1e-7, at 1.281552, 4.081628 and 5.730729 deviations.

    A row that need not hold has the slack 3 + 5.730729 s + 1: 5.146146 where s = 0.2, 6.865365 where s = 0.5.
    """
    monkeypatch.setattr(secants, "POINTS", 3)
    assert written(CORNER, "secants", tmp_path, ".json") == expected(
        """
        secants, restriction
        min - x[x1] - 2 x[x2]
        choose[corner]: choice[corner,0] + choice[corner,1] >= 1
        choose[wall]: choice[wall,2] >= 1
        chance[corner,0]: x[x1] + 5.14615 choice[corner,0] + 0.2 z[corner] <= 4.14615
        chance[corner,1]: x[x2] + 6.86536 choice[corner,1] + 0.5 z[corner] <= 5.86536
        chance[wall,2]: x[x1] + x[x2] + 0.538516 z[wall] <= 4
        budget-1: risk[corner] + risk[wall] <= 2
        piece[corner,0]: 0.714107 z[corner] + risk[corner] >= 2.91516
        piece[corner,1]: 0.000271126 z[corner] + risk[corner] >= 0.00155385
        piece[wall,2]: 0.714107 z[wall] + risk[wall] >= 2.91516
        piece[wall,3]: 0.000271126 z[wall] + risk[wall] >= 0.00155385
        -3 <= x[x1], x[x2] <= 3
        choice[corner,0], choice[corner,1] binary
        choice[wall,2] = 1 integer
        1.28155 <= z[corner] <= 5.73073
        z[wall] >= 1.28155
        1e-07 <= risk[corner], risk[wall] <= 2
        """
    )
