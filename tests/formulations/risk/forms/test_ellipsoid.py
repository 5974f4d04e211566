"""The ellipsoid that the noise leaves with the total risk."""

from __future__ import annotations

from pathlib import Path

import pytest
from program_text import expected, written
from risk_problems import STALLING_TEXT, problem
from scipy.stats import chi2

import waybound as wb
from waybound.formulations.risk.forms.ellipsoid import radius, refuses


def test_the_radius_is_that_of_the_noise_there_is() -> None:
    assert radius(problem(risk__total=0.05)) == pytest.approx(2.4477, abs=5e-5)
    assert radius(problem(risk__total=0.05, quantities__covariance=[[1, 1], [1, 1]])) == pytest.approx(1.96, abs=5e-5)
    assert chi2.sf(radius(problem()) ** 2, 2) == pytest.approx(0.1)


def test_it_allows_a_plan_between_none_and_equal_risks() -> None:
    p = wb.generate("risk-allocation")
    found, even = (wb.solve(p, "highs", form=form, bound_time=0) for form in ("ellipsoid", "uniform"))
    assert found.objective > even.objective
    assert p.evaluate(found.answer).feasible


def test_many_constraints_in_few_dimensions_are_of_joint_risk_alone() -> None:
    walls = {"map": [[1, 0]] * 12, "covariance": [[1.0] * 12] * 12}
    chance = {"quantities": [[float(i == k) for i in range(12)] for k in range(12)], "limits": [5.0] * 12}
    allocated = problem(quantities=walls, chance=chance)
    assert any("add up" in lacking for lacking in refuses(allocated))
    assert not refuses(problem(quantities=walls, chance=chance, risk__kind="joint"))
    budgets = [{"constraints": ["1"], "risk": 0.01}]
    assert refuses(problem(risk__budgets=budgets)) == {"budgets other than the total"}


def test_ellipsoid_from_text_to_text(tmp_path: Path) -> None:
    # 5 less the root of what chi-square of two degrees of freedom exceeds with 0.1
    assert written(STALLING_TEXT, "ellipsoid", tmp_path, ".json") == expected(
        """
        ellipsoid, restriction
        max x[x1] + 3 x[x2]
        constraint[1]: x[x1] + x[x2] <= 7
        chance[1]: x[x1] <= 2.85403
        chance[2]: x[x2] <= 2.85403
        x[x1], x[x2] >= 0
        """
    )
