"""Risk allocations made from another one: what changes, what stays, and that the other one is left as it was."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from risk_problems import problem

from waybound.formulations.risk.risk_allocation import RiskAllocation
from waybound.formulations.risk.variants import by_allocation, choosing, convex_part, widened

ENTRIES = ("lower", "upper", "rows", "row_lower", "row_upper", "chance", "limits", "covariance", "deviation", "constraint", "caps", "open")


def mixed(**changes: Any) -> RiskAllocation:
    """Three chance constraints, of which the second has two alternatives, under a total and two budgets."""
    return problem(
        quantities={"map": [[1, 0], [0, 1]], "covariance": [[1, 0.5], [0.5, 4]]},
        cones=[{"decisions": [[1, 0], [0, 1]], "limit": 6}],
        chance={
            "quantities": [[1, 0], [-1, 0], [0, 1], [1, 1]], "limits": [5, 1, 2, 8], "constraint": [0, 1, 1, 2], "names": ["a", "b", "c"],
        },
        risk={
            "total": 0.1, "each": [0.05, 0.02, 0.03],
            "budgets": [{"name": "early", "constraints": ["a", "b"], "risk": 0.04}, {"name": "late", "constraints": ["c"], "risk": 0.06}],
        }, **changes,
    )  # fmt: skip


def entries(p: RiskAllocation) -> list[Any]:
    budgets = [(b.name, b.constraints.tolist(), b.risk) for b in p.budgets]
    return [*(np.array(getattr(p, name)).tolist() for name in ENTRIES), p.names, p.risk, budgets, *(c[3] for c in p.cones)]


@pytest.mark.parametrize(
    "change",
    [
        lambda p: widened(p, {"constraints": 1.0, "chance": 1.0, "cones": 1.0, "budgets": 0.01, "risks": 0.01}),
        lambda p: choosing(p, np.array([0, 2])),
        by_allocation,
        convex_part,
    ],
    ids=["widened", "choosing", "by-allocation", "convex-part"],
)
def test_the_other_problem_stays_as_it_was(change: Any) -> None:
    p = mixed()
    before = entries(p)
    change(p)
    assert entries(p) == before


def test_each_residual_widens_the_limits_of_its_check() -> None:
    p = mixed()
    made = widened(p, {"constraints": 0.5, "chance": 0.25, "cones": 2.0})
    assert (made.row_lower.tolist(), made.row_upper.tolist()) == ([-np.inf], [7.5])
    assert made.limits.tolist() == [5.25, 1.25, 2.25, 8.25] and made.cones[0][3] == 8.0
    assert made.caps.tolist() == [0.04, 0.02, 0.03] and [b.risk for b in made.budgets] == [0.1, 0.04, 0.06]
    assert entries(widened(p, {})) == entries(widened(p, {"bounds": 1.0})) == entries(p)


@pytest.mark.parametrize("check", ["budgets", "joint-risk"])
def test_wider_budgets_let_each_constraint_have_more_but_never_more_than_half(check: str) -> None:
    made = widened(mixed(), {check: 0.01})
    assert [b.risk for b in made.budgets] == pytest.approx([0.11, 0.05, 0.07]) and made.caps == pytest.approx([0.05, 0.03, 0.04])
    assert widened(mixed(), {check: 0.01, "risks": 0.02}).caps == pytest.approx([0.07, 0.05, 0.06])
    assert widened(mixed(), {check: 0.48}).caps.tolist() == [0.5, 0.5, 0.5]


def test_an_answer_off_its_limits_is_within_those_that_its_residuals_widen() -> None:
    p, x = mixed(), np.array([4.5, 2.75])
    assert not p.evaluate(x).feasible
    excess = float((p.chance @ x - p.limits).max())
    wide = widened(p, {"constraints": 0.25, "chance": excess + 9.0})
    assert wide.evaluate(x).feasible


def test_rows_that_are_chosen_keep_their_data_and_budgets_their_constraints() -> None:
    made = choosing(mixed(), np.array([2, 3]))
    assert made.chance.tolist() == [[0, 1], [1, 1]] and made.limits.tolist() == [2, 8]
    # Of q1, and of q0 + q1: variances 4 and 1 + 4 + 2 * 0.5, covariance 0.5 + 4.
    assert made.covariance == pytest.approx(np.array([[4.0, 4.5], [4.5, 6.0]])) and made.deviation == pytest.approx([2.0, 6.0**0.5])
    assert (made.names, made.constraint.tolist(), made.open.tolist()) == (("b", "c"), [0, 1], [True, True])
    assert made.caps.tolist() == [0.02, 0.03] and made.risk.each.tolist() == [0.02, 0.03]
    assert [(b.name, b.constraints.tolist(), b.risk) for b in made.budgets] == [
        ("total", [0, 1], 0.1), ("early", [0], 0.04), ("late", [1], 0.06),
    ]  # fmt: skip
    assert not made.disjunctive


def test_a_budget_without_constraints_is_dropped() -> None:
    made = choosing(mixed(), np.array([0, 1, 2]))
    assert [(b.name, b.constraints.tolist()) for b in made.budgets] == [("total", [0, 1]), ("early", [0, 1])]
    assert made.constraint.tolist() == [0, 1, 1] and made.disjunctive


def test_what_is_told_of_joint_risks_is_not_taken_over() -> None:
    p, x = mixed(risk__kind="joint"), np.array([1.0, 1.0])
    whole = p.joint_risk(x)["total"].value
    assert choosing(p, np.array([0])).joint_risk(x)["total"].value < whole


def test_allocated_risk_in_place_of_a_joint_one_is_a_restriction() -> None:
    p = mixed(risk__kind="joint")
    made = by_allocation(p)
    assert (made.risk.kind, made.risk.total, made.risk.each.tolist()) == ("allocated", 0.1, p.risk.each.tolist())
    assert made.budgets == p.budgets and made.caps.tolist() == p.caps.tolist()
    # Both constraints fail together now and then, so that their risks add up to more than the probability that any fails.
    x = np.array([2.5, 1.0])
    assert float(made.risks(x).sum()) > p.joint_risk(x)["total"].value


def test_the_convex_part_has_the_rows_that_are_sure_to_count() -> None:
    part, rows = convex_part(mixed())
    assert rows.tolist() == [0, 3] and part.names == ("a", "c") and not part.disjunctive
    decided = mixed().restricted([({"safest": 2}, True)])
    part, rows = convex_part(decided)
    assert rows.tolist() == [0, 2, 3] and part.limits.tolist() == [5, 2, 8] and part.names == ("a", "b", "c")


def test_the_convex_part_of_joint_risk_limits_each_constraint_alone() -> None:
    part, rows = convex_part(mixed(risk__kind="joint"))
    assert rows.tolist() == [0, 3]
    assert (part.risk.kind, part.risk.total, part.budgets) == ("allocated", None, ())
    assert part.caps.tolist() == part.risk.each.tolist() == [0.04, 0.03]
