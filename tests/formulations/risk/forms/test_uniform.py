"""Equal risks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from program_text import expected, written
from risk_problems import margins, problem

from waybound.api import solve
from waybound.formulations.programs.exactness import Exactness
from waybound.formulations.risk.forms.uniform import uniform_risks


def test_equal_risks_of_the_stalling_problem() -> None:
    found = solve(problem(), "highs", form="uniform", bound_time=60.0)
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


TERMS = """
    {
      "waybound": 1, "kind": "risk-allocation", "name": "terms", "problem": "risk-allocation",
      "decisions": 2, "lower": 0, "upper": [4, null],
      "quantities": {"map": [[1, 0], [1, 1]], "offset": [0, 0.5], "covariance": [4, 1]},
      "cost": {
        "decisions": [-1, -2], "constant": 3,
        "terms": [
          {"kind": "absolute", "weight": 2, "decisions": [[1, -1]], "constant": [-1]},
          {"kind": "norm", "weight": 0.5, "decisions": [[1, 0], [0, 1]], "constant": [0, -2]},
          {"kind": "square", "weight": 3, "decisions": [[1, 1]], "constant": [-1]}
        ]
      },
      "constraints": {"decisions": [[1, 1]], "upper": 7},
      "cones": [{"decisions": [[2, 0], [0, 1]], "constant": [0, 1], "limit": {"decisions": [0, 1], "constant": 5}}],
      "chance": {"quantities": [[1, 0], [0, 1]], "limits": [5, 6]},
      "risk": {"total": 0.1, "budgets": [{"constraints": ["2"], "risk": 0.02}]}
    }
"""


def test_uniform_from_text_to_text(tmp_path: Path) -> None:
    """Risks 0.05 and 0.02: 5 - 2 x 1.644854 and 6 - 0.5 - 2.053749. The square is 3 (x1 + x2 - 1)^2, multiplied out."""
    assert written(TERMS, "uniform", tmp_path, ".json") == expected(
        """
        uniform, restriction
        min - 7 x[x1] - 8 x[x2] + 2 absolute-1[0] + 0.5 norm-2[0] + 3 x[x1]^2 + 6 x[x1] x[x2] + 3 x[x2]^2 + 6
        constraint[1]: x[x1] + x[x2] <= 7
        over-1[0]: x[x1] - x[x2] - absolute-1[0] <= 1
        under-1[0]: - x[x1] + x[x2] - absolute-1[0] <= -1
        chance[1]: x[x1] <= 1.71029
        chance[2]: x[x1] + x[x2] <= 3.44625
        norm-2: |(x[x1], x[x2] - 2)| <= norm-2[0]
        cone-1: |(2 x[x1], x[x2] + 1)| <= x[x2] + 5
        0 <= x[x1] <= 4
        x[x2], absolute-1[0], norm-2[0] >= 0
        """
    )
