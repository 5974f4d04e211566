"""Risk allocation: statements, answers as files, the joint risk against a simulation, and problems made of another one."""

import json
from typing import Any

import numpy as np
import pytest
from coded import check_coded, coded
from file_cases import check_refused
from risk_problems import around_a_box, problem, run

import waybound as wb
from waybound import Allocation, InputError, UsageError
from waybound.formulations.problem import problem_from_instance
from waybound.formulations.risk.risk_allocation import RiskAllocation
from waybound.solvers.engines.risk.convex_allocation import ConvexAllocation


def test_statements_on_alternatives_restrict() -> None:
    p = around_a_box()
    assert p.restricted([({"safest": 2}, True)]).open.tolist() == [False, False, True, False]
    assert p.restricted([({"safest": 0}, False), ({"safest": 0}, True)]).open.sum() == 0
    assert p.in_words({"safest": 2}, False) == "alternative 3 of box is not the safest"
    for wrong in ({"safest": 4}, {"safest": True}, {"row": 1}, 3):
        with pytest.raises(InputError, check=coded("malformed")):
            p.check_statement(wrong)


def test_answers_are_written_by_name_and_read_again() -> None:
    p = problem()
    data = json.loads(json.dumps(p.answer_to_json(Allocation.of([1, 2], [0.03, 0.04]))))
    assert data == {"kind": "allocation", "decision": {"x1": 1.0, "x2": 2.0}, "risks": {"1": 0.03, "2": 0.04}}
    again = p.answer_from_json(data)
    assert again.decision.tolist() == [1, 2] and again.risks is not None and again.risks.tolist() == [0.03, 0.04]
    for wrong in ({}, {"kind": "allocation", "decision": {"x1": 1}}, {"kind": "allocation", "decision": {"x1": "a", "x2": 1}}):
        with pytest.raises(InputError):
            p.answer_from_json(wrong)
    with pytest.raises(InputError, check=coded("foreign")):
        p.answer_of([1, 2, 3])
    assert p.answer_to_frame([1.0, 2.0]).columns.tolist() == ["constraint", "allowed", "risk"]


def test_what_is_left_of_the_total_is_shared_out() -> None:
    allocation = problem(constraints=None).allocated(np.array([3.0, 3.0]))
    assert allocation.risks is not None and allocation.risks.sum() == pytest.approx(0.1, rel=1e-12) and allocation.risks.sum() <= 0.1


def test_the_joint_risk_is_that_of_a_simulation() -> None:
    p, many, rng = wb.generate("risk-allocation"), 100_000, np.random.default_rng(3)
    d = p.instance.quantities.dynamics
    answer = run(ConvexAllocation, p, gap=1e-6).answer
    state, failed, floor = np.tile(d.start, (many, 1)), np.zeros(many, dtype=bool), -p.instance.chance.limits
    for t, u in enumerate(answer.decision.tolist()):
        state = state @ d.state.T + d.input[:, 0] * u + rng.standard_normal((many, 2)) * np.sqrt(np.diag(d.noise))
        failed |= state[:, 0] < floor[t]
    share = failed.mean()
    risk = p.joint_risk(answer.decision)["total"]
    error = np.sqrt(share * (1.0 - share) / many)
    assert abs(risk.value - share) < 4.0 * error + (risk.high - risk.low) / 2.0
    assert risk.high < p.risk.total / 3.0


@pytest.mark.parametrize(
    "changes", [{"quantities__covariance": [1e308, 1.0], "chance__quantities": [[2, 0], [0, 1]]},
                {"quantities__map": [[1e200, 0], [0, 1]], "chance__quantities": [[1e200, 0], [0, 1]]}],
)  # fmt: skip
def test_numbers_whose_products_are_none_are_refused(changes: dict[str, Any]) -> None:
    with pytest.raises(InputError, check=coded("out-of-range")):
        problem(**changes)


def test_settings_change_the_risk() -> None:
    p = wb.generate("risk-allocation", steps=3).instance
    other = problem_from_instance(p, risk="joint", total=0.2)
    assert isinstance(other, RiskAllocation)
    assert (other.risk.kind, other.risk.total, other.caps.tolist()) == ("joint", 0.2, [0.2] * 3)
    check_refused(UsageError, "has no setting 'speed'; it takes risk, total", problem_from_instance, p, speed=1)
    check_coded(UsageError, "foreign", wb.read, "demo-c25", problem="risk-allocation")


# -- problems made of another one ----------------------------------------------------------------------------------------

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
        lambda p: p.widened({"constraints": 1.0, "chance": 1.0, "cones": 1.0, "budgets": 0.01, "risks": 0.01}),
        lambda p: p.choosing(np.array([0, 2])),
        RiskAllocation.by_allocation,
        RiskAllocation.convex_part,
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
    changed = p.widened({"constraints": 0.5, "chance": 0.25, "cones": 2.0})
    assert (changed.row_lower.tolist(), changed.row_upper.tolist()) == ([-np.inf], [7.5])
    assert changed.limits.tolist() == [5.25, 1.25, 2.25, 8.25] and changed.cones[0][3] == 8.0
    assert changed.caps.tolist() == [0.04, 0.02, 0.03] and [b.risk for b in changed.budgets] == [0.1, 0.04, 0.06]
    assert entries(p.widened({})) == entries(p.widened({"bounds": 1.0})) == entries(p)


@pytest.mark.parametrize("check", ["budgets", "joint-risk"])
def test_wider_budgets_let_each_constraint_have_more_but_never_more_than_half(check: str) -> None:
    changed = mixed().widened({check: 0.01})
    assert [b.risk for b in changed.budgets] == pytest.approx([0.11, 0.05, 0.07]) and changed.caps == pytest.approx([0.05, 0.03, 0.04])
    assert mixed().widened({check: 0.01, "risks": 0.02}).caps == pytest.approx([0.07, 0.05, 0.06])
    assert mixed().widened({check: 0.48}).caps.tolist() == [0.5, 0.5, 0.5]


def test_an_answer_off_its_limits_is_within_those_that_its_residuals_widen() -> None:
    p, x = mixed(), np.array([4.5, 2.75])
    assert not p.evaluate(x).feasible
    excess = float((p.chance @ x - p.limits).max())
    assert p.widened({"constraints": 0.25, "chance": excess + 9.0}).evaluate(x).feasible


def test_rows_that_are_chosen_keep_their_data_and_budgets_their_constraints() -> None:
    changed = mixed().choosing(np.array([2, 3]))
    assert changed.chance.tolist() == [[0, 1], [1, 1]] and changed.limits.tolist() == [2, 8]
    # Of q1, and of q0 + q1: variances 4 and 1 + 4 + 2 * 0.5, covariance 0.5 + 4.
    assert changed.covariance == pytest.approx(np.array([[4.0, 4.5], [4.5, 6.0]])) and changed.deviation == pytest.approx([2.0, 6.0**0.5])
    assert (changed.names, changed.constraint.tolist(), changed.open.tolist()) == (("b", "c"), [0, 1], [True, True])
    assert changed.caps.tolist() == [0.02, 0.03] and changed.risk.each.tolist() == [0.02, 0.03]
    assert [(b.name, b.constraints.tolist(), b.risk) for b in changed.budgets] == [
        ("total", [0, 1], 0.1), ("early", [0], 0.04), ("late", [1], 0.06),
    ]  # fmt: skip
    assert not changed.disjunctive


def test_a_budget_without_constraints_is_dropped() -> None:
    changed = mixed().choosing(np.array([0, 1, 2]))
    assert [(b.name, b.constraints.tolist()) for b in changed.budgets] == [("total", [0, 1]), ("early", [0, 1])]
    assert changed.constraint.tolist() == [0, 1, 1] and changed.disjunctive


def test_what_is_told_of_joint_risks_is_not_taken_over() -> None:
    p, x = mixed(risk__kind="joint"), np.array([1.0, 1.0])
    whole = p.joint_risk(x)["total"].value
    assert p.choosing(np.array([0])).joint_risk(x)["total"].value < whole


def test_allocated_risk_in_place_of_a_joint_one_is_a_restriction() -> None:
    p = mixed(risk__kind="joint")
    changed = p.by_allocation()
    assert (changed.risk.kind, changed.risk.total, changed.risk.each.tolist()) == ("allocated", 0.1, p.risk.each.tolist())
    assert changed.budgets == p.budgets and changed.caps.tolist() == p.caps.tolist()
    # Both constraints fail together now and then, so that their risks add up to more than the probability that any fails.
    x = np.array([2.5, 1.0])
    assert float(changed.risks(x).sum()) > p.joint_risk(x)["total"].value


def test_the_convex_part_has_the_rows_that_are_sure_to_count() -> None:
    part, rows = mixed().convex_part()
    assert rows.tolist() == [0, 3] and part.names == ("a", "c") and not part.disjunctive
    decided = mixed().restricted([({"safest": 2}, True)])
    part, rows = decided.convex_part()
    assert rows.tolist() == [0, 2, 3] and part.limits.tolist() == [5, 2, 8] and part.names == ("a", "b", "c")


def test_the_convex_part_of_joint_risk_limits_each_constraint_alone() -> None:
    part, rows = mixed(risk__kind="joint").convex_part()
    assert rows.tolist() == [0, 3]
    assert (part.risk.kind, part.risk.total, part.budgets) == ("allocated", None, ())
    assert part.caps.tolist() == part.risk.each.tolist() == [0.04, 0.03]
