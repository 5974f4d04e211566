"""Equal risks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from program_text import expected, written
from risk_problems import STALLING_TEXT, margins, problem

from waybound.formulations.programs.exactness import Exactness
from waybound.formulations.risk.forms.uniform import uniform_risks
from waybound.solving.solve import solve


def test_equal_risks_of_the_stalling_problem() -> None:
    found = solve(problem(), "highs", form="uniform", bound_time=1)
    assert found.objective == pytest.approx(13.420585, abs=1e-6)
    assert found.bound_kind == "verified" and found.bound == pytest.approx(13.731143, abs=1e-6)
    assert problem().compile("uniform").exactness is Exactness.RESTRICTION


@pytest.mark.parametrize(("weights", "value"), [([1.0, 3.0], 6.579415), ([1.0, 2.0, 5.0], 14.671317)])
def test_equal_risks_of_margins(weights: list[float], value: float) -> None:
    assert solve(margins(weights, 0.1), "highs", form="uniform", bound_time=0).objective == pytest.approx(value, abs=1e-6)


def test_the_least_of_all_budgets_counts() -> None:
    p = problem(risk={"total": 0.1, "each": [0.5, 0.01], "budgets": [{"constraints": ["1"], "risk": 0.02}]})
    assert uniform_risks(p) == pytest.approx([0.02, 0.01])
    assert np.sum(uniform_risks(problem())) <= 0.1


def test_uniform_from_text_to_text(tmp_path: Path) -> None:
    # 5 less the number that a standard normal one exceeds with 0.05
    assert written(STALLING_TEXT, "uniform", tmp_path, ".json") == expected(
        """
        uniform, restriction
        max x[x1] + 3 x[x2]
        constraint[1]: x[x1] + x[x2] <= 7
        chance[1]: x[x1] <= 3.35515
        chance[2]: x[x2] <= 3.35515
        x[x1], x[x2] >= 0
        """
    )
