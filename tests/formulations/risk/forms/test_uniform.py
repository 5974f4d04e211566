"""Equal risks."""

from __future__ import annotations

import numpy as np
import pytest
from risk_problems import margins, problem

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
