import numpy as np
import pytest
from risk_problems import problem

from waybound.api import solve
from waybound.solvers.engines.risk.convex_allocation_steps.units import Units


def test_ordinary_problems_are_left_as_they_are() -> None:
    p = problem()
    units = Units.of(p)
    assert units.cost == 1.0 and (units.columns == 1.0).all()
    assert np.array_equal(units.problem.chance, p.chance) and np.array_equal(units.problem.limits, p.limits)


def test_extraordinary_ones_have_the_same_risks_and_a_known_cost() -> None:
    small = 2.0**-60
    p = problem(lower=0, upper=6 * small, quantities__covariance=[small**2] * 2, chance__limits=[5 * small] * 2,
                constraints__upper=7 * small, cost__terms=[{"kind": "norm", "weight": 3, "decisions": [[1, 1]]}])  # fmt: skip
    units = Units.of(p)
    x = np.array([3.0, 4.0]) * small
    inside = x / units.columns
    assert np.array_equal(units.problem.risks(inside), p.risks(x))
    assert units.problem.value(inside)[0] == units.cost * p.value(x)[0]
    assert 1e-3 <= units.problem.limits.min() <= units.problem.limits.max() <= 1e5
    prices = units.prices({"rows": np.ones(1), "chance": np.ones(2), "budgets": np.ones(1), "terms": np.ones(1), "cones": np.zeros(0)})
    assert prices["budgets"] == pytest.approx(1.0 / units.cost)
    assert prices["chance"] == pytest.approx(units.chance / units.cost)


@pytest.mark.parametrize("kind", ["absolute", "norm", "square"])
def test_terms_far_from_one_are_counted_in_units_of_their_own(kind: str) -> None:
    term = {"kind": kind, "weight": 2.0**-20, "decisions": [[2.0**40, -(2.0**41)], [0.0, 2.0**40]], "constant": [2.0**42, 0.0]}
    p = problem(cost__terms=[term])
    units = Units.of(p)
    (_, _, rows, constant) = units.problem.terms[0]
    assert 1.0 <= max(np.abs(rows).max(), np.abs(constant).max()) < 8.0
    x, duals = np.array([1.0, 3.0]), np.array([0.25, -0.5])
    inside = x / units.columns
    assert units.problem.value(inside)[0] == units.cost * p.value(x)[0]
    back = units.prices({"rows": np.ones(1), "chance": np.ones(2), "budgets": np.ones(1), "terms": duals, "cones": np.zeros(0)})["terms"]
    assert back @ (p.terms[0][2] @ x + p.terms[0][3]) * units.cost == duals @ (rows @ inside + constant)


def test_a_decision_that_only_the_cost_knows_is_counted_like_the_largest_other() -> None:
    """Its price would be nothing beside theirs, and an endless cost an optimum."""
    p = problem(
        sense="min", lower=None, upper=None, constraints=None, quantities__covariance=[1e14] * 2, cost={"decisions": [2, -3]},
        chance={"quantities": [[0, 1]], "limits": [2.0**32]},
    )  # fmt: skip
    units = Units.of(p)
    assert units.columns[0] == units.columns[1] > 1.0
    assert solve(p, bound_time=0).status == "unbounded"
