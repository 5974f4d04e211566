"""Units: powers of two that bring a problem to the sizes that solvers count in."""

from __future__ import annotations

import numpy as np
import pytest
from risk_problems import problem

from waybound.solvers.engines.convex_allocation_steps.units import Units


def test_ordinary_problems_are_left_as_they_are() -> None:
    p = problem()
    made = Units.of(p)
    assert made.cost == 1.0 and (made.columns == 1.0).all()
    assert np.array_equal(made.problem.chance, p.chance) and np.array_equal(made.problem.limits, p.limits)


def test_extraordinary_ones_have_the_same_risks_and_a_known_cost() -> None:
    small = 2.0**-60
    p = problem(lower=0, upper=6 * small, quantities__covariance=[small**2] * 2, chance__limits=[5 * small] * 2,
                constraints__upper=7 * small, cost__terms=[{"kind": "norm", "weight": 3, "decisions": [[1, 1]]}])  # fmt: skip
    made = Units.of(p)
    x = np.array([3.0, 4.0]) * small
    inside = x / made.columns
    assert np.array_equal(made.problem.risks(inside), p.risks(x))
    assert made.problem.value(inside)[0] == made.cost * p.value(x)[0]
    assert 1e-3 <= made.problem.limits.min() <= made.problem.limits.max() <= 1e5
    prices = made.prices({"rows": np.ones(1), "chance": np.ones(2), "budgets": np.ones(1), "terms": np.ones(1), "cones": np.zeros(0)})
    assert prices["budgets"] == pytest.approx(1.0 / made.cost)
    assert prices["chance"] == pytest.approx(made.chance / made.cost)
