import numpy as np
import pytest
from risk_problems import around_a_box, margins, problem, run
from scipy.special import ndtri
from scipy.stats import norm

from waybound import Allocation, RiskAllocation
from waybound.formulations.risk.judge import evaluate_allocation, safest_risks
from waybound.solvers.engines.risk.convex_allocation import ConvexAllocation

UNIFORM = 5.0 + ndtri(0.05)


def test_an_answer_is_judged_by_its_risks() -> None:
    judged = evaluate_allocation(problem(), Allocation.of([UNIFORM, UNIFORM], [0.05, 0.05]))
    assert judged.feasible
    assert judged.values[0] == pytest.approx(13.420585, abs=1e-6)
    assert judged.quantities["sum_of_risks"] == pytest.approx(0.1)
    assert judged.quantities["joint_risk"] == pytest.approx(0.0975, abs=1e-7)
    assert judged.quantities["unused_share_of_risk"] == pytest.approx(0.025, abs=1e-6)


@pytest.mark.parametrize(
    ("decision", "risks", "check", "said"),
    [
        ([3.4, 3.4], [0.05, 0.05], "chance", "has the risk 0.0547992917, allowed 0.05"),
        ([UNIFORM, UNIFORM], [0.06, 0.05], "budgets", "the risk of total is 0.11, at most 0.1"),
        ([-1, 0], None, "bounds", "x1 is -1, outside its bounds"),
        ([3.6, 3.6], None, "constraints", "constraint 1 is 7.2, outside its limits"),
        ([4.5, 2.4], None, "risks", "has the risk 0.308537539, at most 0.1"),
        ([UNIFORM, 1], [0.05, -0.01], "risks", "has the risk -0.01"),
    ],
)
def test_violations_are_named(decision: list[float], risks: list[float] | None, check: str, said: str) -> None:
    judged = problem().evaluate(Allocation.of(decision, risks))
    assert check in {v.check for v in judged.violations}
    assert any(said in v.message for v in judged.violations)


@pytest.mark.parametrize("limit", [1.0, 1e7])
def test_however_far_a_limit_is_deviations_count(limit: float) -> None:
    p = problem(
        decisions=1, upper=2.0 * limit, constraints=None, cost={"decisions": [1.0]}, quantities={"map": [[1.0]], "covariance": [1.0]},
        chance={"quantities": [[1.0]], "limits": [limit]}, risk={"total": 0.001},
    )  # fmt: skip
    most = limit + float(ndtri(0.001))
    assert p.evaluate(Allocation.of([most], [0.001])).feasible or most < 0.0
    assert not p.evaluate(Allocation.of([limit + 6.0], [0.001])).feasible
    assert not p.evaluate(Allocation.of([limit - 3.08], [0.001])).feasible  # a risk of 0.001035


def test_nothing_is_known_of_a_decision_without_numbers() -> None:
    judged = problem().evaluate(Allocation.of([np.nan, 1.0]))
    assert not judged.feasible and np.isnan(judged.values[0])


def test_two_routes_are_rejected_by_boole_and_accepted_by_their_joint_risk() -> None:
    def routes(limit: float, kind: str, second: list[float]) -> RiskAllocation:
        """Loads of customers N(10, 2^2) on routes of capacity 25: nothing to decide."""
        return problem(
            sense="min", decisions=1, upper=0, constraints=None, cost={"decisions": [0]},
            quantities={"map": [[0], [0]], "offset": [20, second[0]], "covariance": [8, second[1]]}, chance__limits=[25, 25],
            risk={"total": limit, "kind": kind},
        )  # fmt: skip

    nothing = Allocation.of([0.0])
    judged = routes(0.076, "allocated", [20, 8]).evaluate(nothing)
    assert not judged.feasible
    assert judged.quantities["sum_of_risks"] == pytest.approx(0.0770999, abs=1e-7)
    assert judged.quantities["joint_risk"] == pytest.approx(0.0756138, abs=1e-7)
    assert routes(0.076, "joint", [20, 8]).evaluate(nothing).feasible
    uneven = routes(0.05, "allocated", [10, 4])
    assert uneven.evaluate(nothing).feasible
    assert not uneven.evaluate(Allocation.of([0.0], [0.025, 0.025])).feasible
    assert run(ConvexAllocation, uneven).answer is not None


def test_risks_of_margins_beside_their_uniform_split() -> None:
    p = margins([1.0, 3.0], 0.1)
    risks = np.array([0.020452, 0.079548])
    assert p.evaluate(Allocation.of(norm.isf(risks) + 1e-6, risks)).values[0] == pytest.approx(6.268857, abs=1e-4)
    assert p.evaluate(Allocation.of(norm.isf([0.05, 0.05]), [0.05, 0.05])).values[0] == pytest.approx(6.579415, abs=1e-6)


@pytest.mark.parametrize(("over", "feasible"), [(1e-9, True), (1e-3, False)])
@pytest.mark.parametrize("kind", ["allocated", "joint"])
def test_rows_without_noise_are_let_pass_alike_in_either_kind(kind: str, over: float, feasible: bool) -> None:
    p = problem(quantities__covariance=[0.0, 1.0], risk__kind=kind)
    assert p.evaluate([5.0 * (1.0 + over), 1.0]).feasible == feasible
    assert p.evaluate([5.0, 1.0]).quantities["joint_risk"] == pytest.approx(norm.sf(4.0))


def test_budgets_of_parts_are_kept_in_either_kind() -> None:
    budgets = [{"name": "second", "constraints": ["2"], "risk": 0.01}]
    x = [3.4, 5.0 + ndtri(0.02)]
    allocated = problem(risk__budgets=budgets, constraints=None).evaluate(Allocation.of(x))
    assert [v.check for v in allocated.violations] == ["budgets"]
    joint = problem(risk__budgets=budgets, risk__kind="joint", constraints=None).evaluate(Allocation.of(x))
    assert [v.message for v in joint.violations] == ["the risk of second is 0.02, at most 0.01"]


def test_a_constraint_with_alternatives_has_the_risk_of_its_safest_row() -> None:
    p = around_a_box()
    x = np.array([-1.6, 0.2])
    assert safest_risks(p, x) == pytest.approx([norm.sf((1.6 - 1.0) / 0.2)])
    assert p.evaluate(Allocation(x)).feasible
    assert not p.evaluate(Allocation.of([0.0, 0.0])).feasible
