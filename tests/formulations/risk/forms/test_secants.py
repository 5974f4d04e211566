"""Secants: a restriction whose points are answers."""

from __future__ import annotations

from pathlib import Path

import pytest
from program_text import expected, written
from risk_problems import STALLING_TEXT, around_a_box, margins, problem

from waybound.formulations.programs.exactness import Exactness
from waybound.formulations.risk.forms import secants
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


def test_secants_from_text_to_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # risks in twentieths; chords between risks of 0.1, 2e-5 and 5e-9
    monkeypatch.setattr(secants, "POINTS", 3)
    assert written(STALLING_TEXT, "secants", tmp_path, ".json") == expected(
        """
        secants, restriction
        max x[x1] + 3 x[x2]
        constraint[1]: x[x1] + x[x2] <= 7
        chance[1]: x[x1] + z[1] <= 5
        chance[2]: x[x2] + z[2] <= 5
        budget-1: risk[1] + risk[2] <= 2
        piece[1,0]: 0.714107 z[1] + risk[1] >= 2.91516
        piece[1,1]: 0.000271126 z[1] + risk[1] >= 0.00155385
        piece[2,2]: 0.714107 z[2] + risk[2] >= 2.91516
        piece[2,3]: 0.000271126 z[2] + risk[2] >= 0.00155385
        x[x1], x[x2] >= 0
        z[1], z[2] >= 1.28155
        1e-07 <= risk[1], risk[2] <= 2
        """
    )
