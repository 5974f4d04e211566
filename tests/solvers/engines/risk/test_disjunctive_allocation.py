import itertools

import numpy as np
import pytest
from risk_problems import around_a_box, problem, run

import waybound as wb
from waybound.api import solve
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.engines.risk.convex_allocation import ConvexAllocation
from waybound.solvers.engines.risk.disjunctive_allocation import DisjunctiveAllocation


def test_the_best_side_of_a_box() -> None:
    solution = solve(around_a_box(), bound_time=0)
    assert (solution.solver, solution.status, solution.bound_kind) == ("disjunctive-allocation", "optimal", "verified")
    assert solution.objective == pytest.approx(1.0 + 0.2 * 1.644854, abs=1e-5)
    assert solution.answer.decision == pytest.approx([-1.328971, 0.0], abs=1e-5)


@pytest.mark.slow
def test_it_is_the_best_of_all_choices() -> None:
    p = wb.generate("risk-allocation", family="obstacles", steps=4, obstacles=1, seed=2)
    result = run(DisjunctiveAllocation, p)
    best = np.inf
    for choice in itertools.product(range(4), repeat=4):
        alternative = run(ConvexAllocation, p.choosing(np.arange(4) * 4 + np.array(choice)), gap=1e-6)
        best = min(best, np.inf if alternative.answer is None else alternative.objective)
    assert result.objective == pytest.approx(best, rel=3e-6)
    assert result.status == "optimal"
    assert best * (1.0 - 3e-6) <= verified_bound(p, result.evidence[0]) <= best * (1.0 + 1e-9)


def test_limits_of_work_leave_what_is_proved() -> None:
    p = wb.generate("risk-allocation", family="obstacles", steps=8, obstacles=1)
    result = run(DisjunctiveAllocation, p, iterations=3)
    assert result.limit == "iterations" and result.statistics["nodes"] <= 5
    assert verified_bound(p, result.evidence[0]) <= 1.6912511
    assert result.bound == pytest.approx(verified_bound(p, result.evidence[0]), rel=1e-6)


def test_around_two_boxes_the_tree_closes() -> None:
    result = run(DisjunctiveAllocation, wb.generate("risk-allocation", family="obstacles", seed=1))
    assert result.status == "optimal" and result.objective == pytest.approx(1.13328197, rel=2e-6)
    assert result.bound == pytest.approx(result.objective, rel=2e-6)


def test_no_side_that_can_be_kept_is_no_answer() -> None:
    solution = solve(around_a_box(lower=-1, upper=1), bound_time=0)
    assert solution.status == "infeasible" and solution.answer is None


def test_joint_risk_is_kept_by_the_best_allocation() -> None:
    result = run(DisjunctiveAllocation, around_a_box(risk__kind="joint"))
    assert result.objective == pytest.approx(1.328971, abs=1e-5) and not result.evidence


@pytest.mark.parametrize("least", [-1e9, -2e9, -3e9])
@pytest.mark.parametrize("kind", ["allocated", "joint"])
def test_no_optimum_is_claimed_that_its_own_proof_refutes(least: float, kind: str) -> None:
    """A row from ``least`` to 0 may be broken by some of ``least``, so that an answer gains more than the best one costs, which is 0."""
    p = problem(
        sense="min", decisions=1, lower=-4e9, upper=6e9, quantities={"map": [[-3], [-3], [-3], [1.25]], "covariance": [6.4e13] * 4},
        cost={"decisions": [3.0]}, constraints={"decisions": [[-2.0]], "upper": 0.0, "lower": least},
        cones=[{"decisions": [[1.0]], "limit": 2e9}],
        chance={"quantities": np.eye(4).tolist(), "limits": [3e9, 1e9, 2e9, 3e9], "names": ["a", "b"], "constraint": [0, 0, 1, 1]},
        risk={"total": 1e-100, "each": [0.01, 1e-100], "kind": kind},
    )  # fmt: skip
    solution = solve(p, "disjunctive-allocation", bound_time=0)
    assert not solution.faults and solution.answer is not None
    size, bound = solution.evaluation.size, solution.certificate.bound
    assert solution.status != "optimal" or bound is None or solution.objective >= bound - 1e-6 * size
    raw = run(DisjunctiveAllocation, p)
    if kind == "allocated":
        proved = verified_bound(p, raw.evidence[0])
        leaning = raw.objective < proved - 1e-6 * size
        assert raw.status == "feasible" and (leaning or least < -1e9)
        assert not leaning or "no optimum is claimed" in raw.message
