"""Allocations with known optima: costs of the risks themselves as programs over cones, choices with risks, and what Boole's inequality
leaves unused."""

import math

import numpy as np
import pytest
import scipy.sparse as sp
from programs import program
from risk_problems import context, margins, problem, run
from scipy.special import ndtr, ndtri
from scipy.stats import chi2

import waybound as wb
from waybound.formulations.programs.cones import Cones
from waybound.formulations.programs.program import Program
from waybound.formulations.risk.forms.fixed_risks import fixed_margins_program, radius, uniform_risks
from waybound.formulations.risk.joint_normal import any_fails
from waybound.formulations.stop import Stop
from waybound.heuristics.risk.iterative_risk_allocation import iterative
from waybound.reports.benchmarks.risk_allocation import by_program, reference
from waybound.solvers.backend import Control, Options, RawResult
from waybound.solvers.backends.cvxpy import CVXPY, solvers_found
from waybound.solvers.backends.highs import Highs
from waybound.solvers.engines.risk.convex_allocation import ConvexAllocation
from waybound.solvers.engines.risk.convex_allocation_steps.session import open_session
from waybound.solvers.engines.risk.exact_joint import ExactJoint

CONE_SOLVERS = [
    pytest.param(name, marks=pytest.mark.skipif(name not in solvers_found(), reason="it is not installed")) for name in ("CLARABEL", "ECOS")
]
TOTAL = 0.12


def shared(weights: list[float], sense: str, kind: str, rows: list[list[float]], offset: list[float]) -> Program:
    """Shares e of the total, add up to 1 at most, and beside each a number t in a cone with it: the sum of weight times t."""
    n = len(weights)
    made = program([*[0.0] * n, *weights], [[1.0] * n + [0.0] * n], -math.inf, 1.0, [*[0.0] * n, *[-math.inf] * n], math.inf, sense=sense)
    e, t = (np.eye(2 * n)[part] for part in (slice(n), slice(n, 2 * n)))
    image = sp.csr_matrix(np.concatenate([[a * e[k] + b * t[k] for a, b in rows] for k in range(n)]))
    cones = Cones("cost", kind, 3, image.indptr, image.indices, image.data, np.tile(offset, n))
    return Program(made.name, sense, made.variables, made.rows, cones=(cones,))


def solved(made: Program, solver: str) -> RawResult:
    result = CVXPY(solver).run(made, Options(), Control())
    assert result.status == "optimal" and result.answer is not None
    return result


@pytest.mark.parametrize("solver", CONE_SOLVERS)
def test_costs_that_fall_with_the_risk_share_it_as_the_roots_of_their_weights(solver: str) -> None:
    # t e >= 1 is |(t - e, 2)| <= t + e.
    found = solved(shared([1.0, 4.0, 9.0], "min", "second-order", [[1, 1], [-1, 1], [0, 0]], [0.0, 0.0, 2.0]), solver)
    assert found.objective is not None and found.objective / TOTAL == pytest.approx(300.0, rel=1e-6)
    assert TOTAL * found.answer[:3] == pytest.approx([0.02, 0.04, 0.06], abs=1e-5)
    assert sum(weight / (TOTAL / 3.0) for weight in (1.0, 4.0, 9.0)) == pytest.approx(350.0)


@pytest.mark.parametrize("solver", CONE_SOLVERS)
def test_rewards_that_grow_with_the_logarithm_of_the_risk_share_it_as_their_weights(solver: str) -> None:
    # exp(t) <= e.
    found = solved(shared([1.0, 2.0, 3.0], "max", "exponential", [[0, 1], [0, 0], [1, 0]], [0.0, 1.0, 0.0]), solver)
    assert TOTAL * found.answer[:3] == pytest.approx([0.02, 0.04, 0.06], abs=1e-5)
    assert found.objective == pytest.approx(math.log(1 / 6) + 2 * math.log(1 / 3) + 3 * math.log(1 / 2), abs=1e-6)


def chosen(tasks: list[list[tuple[float, float]]], weight: list[float], limit: float) -> tuple[float, list[int]]:
    """The largest reward of one option a task, (risk, reward), whose weights add up to the limit at most; which options."""
    options = [option for task in tasks for option in task]
    one = np.array([[float(task == k) for task, given in enumerate(tasks) for _ in given] for k in range(len(tasks))])
    sides = [1.0] * len(tasks)
    made = program(
        [r for _, r in options], [*one, weight], [*sides, -math.inf], [*sides, limit], 0, 1, integer=range(len(options)), sense="max"
    )
    found = Highs().run(made, Options(), Control())
    assert found.status == "optimal" and found.answer is not None and found.objective is not None
    return found.objective, np.nonzero(found.answer > 0.5)[0].tolist()


@pytest.mark.parametrize(("total", "boole", "independent"), [(0.15, 13, 13), (0.195, 13, 16), (0.2, 16, 16)])
def test_choices_of_two_tasks_with_risks_added_up_or_multiplied_out(total: float, boole: int, independent: int) -> None:
    tasks = [[(0.0, 0.0), (0.05, 5.0), (0.1, 8.0)]] * 2
    risk = np.array([0.0, 0.05, 0.1] * 2)
    for weight, limit, best in ((risk, total, boole), (-np.log1p(-risk), -math.log1p(-total), independent)):
        reward, options = chosen(tasks, weight.tolist(), limit)
        assert reward == pytest.approx(best)
        assert best < 16 or 1.0 - np.prod(1.0 - risk[options]) == pytest.approx(0.19)


def test_a_budget_takes_the_plan_that_no_price_of_risk_does() -> None:
    plans = [(0.0, 0.0), (0.3, 4.0), (0.5, 10.0)]
    risk = [r for r, _ in plans]
    assert chosen([plans], risk, 0.3) == (pytest.approx(4.0), [1])
    assert chosen([plans], risk, 0.5) == (pytest.approx(10.0), [2])
    for price in np.linspace(0.0, 40.0, 81).tolist():
        assert max(range(3), key=lambda k: plans[k][1] - price * plans[k][0]) != 1


def test_limits_of_each_that_multiply_out_to_the_total_leave_none_of_it() -> None:
    each = 1.0 - math.sqrt(0.9)
    p = problem(
        sense="min", decisions=2, lower=None, quantities={"map": [[1, 0], [0, 1]], "covariance": [1.0, 1.0]}, cost={"decisions": [1, 3]},
        constraints=None, chance={"quantities": [[-1, 0], [0, -1]], "limits": [0.0, 0.0]}, risk={"each": each},
    )  # fmt: skip
    found = run(ConvexAllocation, p)
    assert found.objective == pytest.approx(6.528875, abs=1e-6)
    assert p.joint_risk(found.answer.decision)["total"].value == pytest.approx(0.1, abs=1e-8)


def test_independent_noise_shares_the_risk_otherwise_than_boole() -> None:
    p = margins([1.0, 3.0], 0.1, kind="joint")
    own = p.risks(run(ExactJoint, p).answer.decision)
    assert own == pytest.approx([0.022022, 0.079734], abs=1e-4)  # the cost is flat: 1e-8 of it is 1e-5 of a risk
    assert 1.0 - np.prod(1.0 - own) == pytest.approx(0.1, abs=1e-6)


def test_routes_of_which_one_needs_all_the_risk() -> None:
    """Loads of customers N(10, 2^2), two on one route of capacity 25, one on the other, and a total of 0.05."""
    p = problem(
        sense="min", decisions=1, lower=0, upper=1, constraints=None, cost={"decisions": [0]},
        quantities={"map": [[0], [0]], "offset": [20, 10], "covariance": [8, 4]}, chance__limits=[25, 25], risk={"total": 0.05},
    )  # fmt: skip
    assert p.risks(np.zeros(1)) == pytest.approx([0.0385499, 3.2e-14], rel=5e-3)
    assert wb.solve(p, "highs", form="uniform", bound_time=0).answer is None
    assert run(ConvexAllocation, p).status == "optimal"
    assert "no plan with equal risks" in wb.solve(p, heuristic="iterative", bound_time=0).message


@pytest.mark.parametrize("total", [0.01, 0.05, 0.1, 0.5, 0.9])
def test_what_boole_leaves_unused_of_equal_independent_risks(total: float) -> None:
    many = 24
    found = any_fails(np.full(many, -ndtri(total / many)), np.eye(many))
    assert found.exact and found.value == pytest.approx(-math.expm1(many * math.log1p(-total / many)), rel=1e-13)
    assert 1.0 - (1.0 - total / 1e6) ** 1e6 == pytest.approx(-math.expm1(-total), rel=1e-5)
    assert found.value < total


@pytest.mark.parametrize(("many", "quantile"), [(1, 1.6449), (4, 2.2414), (10, 2.5758), (100, 3.2905)])
def test_the_quantile_of_equal_risks(many: int, quantile: float) -> None:
    assert -ndtri(uniform_risks(margins([1.0] * many, 0.05))) == pytest.approx(quantile, abs=5e-5)


@pytest.mark.parametrize(("many", "quantile"), [(4, 2.2340), (10, 2.5679), (100, 3.2834)])
def test_the_quantile_of_equal_independent_risks(many: int, quantile: float) -> None:
    """Where the risks of independent noise multiply out to the total, each is 1 - (1 - total)^(1/N)."""
    assert any_fails(np.full(many, quantile), np.eye(many)).value == pytest.approx(0.05, abs=2e-5 * many)


@pytest.mark.share(2)
@pytest.mark.parametrize(("total", "left"), [(0.01, 0.00995), (0.05, 0.04877), (0.1, 0.09516), (0.5, 0.39347), (0.9, 0.59343)])
def test_many_equal_independent_risks_fail_as_the_exponential_says(total: float, left: float) -> None:
    many = 400
    found = any_fails(np.full(many, -ndtri(total / many)), np.eye(many))
    assert found.value == pytest.approx(left, rel=2e-3)


@pytest.mark.parametrize(("dimensions", "rho", "worth"), [(1, 1.9600, 2.0), (2, 2.4477, 6.96), (3, 2.7955, 19.3), (10, 4.2787, 5319)])
def test_an_ellipsoid_is_worth_its_radius_from_so_many_constraints_on(dimensions: int, rho: float, worth: float) -> None:
    found = radius(margins([1.0] * dimensions, 0.05))
    assert found == pytest.approx(rho, abs=5e-5)
    assert 0.05 / ndtr(-found) == pytest.approx(worth, rel=1e-3)


@pytest.mark.parametrize(("family", "value", "low", "high"), [("auv", 5.28840, 0.0095, 0.0115), ("corridor", 1.37414, 4e-5, 1e-4)])
def test_equal_risks_of_the_two_problems_of_the_literature(family: str, value: float, low: float, high: float) -> None:
    p = reference(family)
    found = by_program(p, "uniform")
    assert found is not None and p.evaluate(found).values[0] == pytest.approx(value, abs=5e-6)
    assert low < p.joint_risk(found.decision)["total"].value < high


@pytest.mark.parametrize(("family", "low", "high"), [("auv", 5.22936, 5.23121), ("corridor", 1.35925, 1.35928)])
def test_the_optimum_lies_between_a_relaxation_and_a_restriction_of_60_pieces(family: str, low: float, high: float) -> None:
    found = run(ConvexAllocation, reference(family), gap=1e-5)
    assert low - 5e-6 <= found.bound <= found.objective <= high + 5e-6


@pytest.mark.parametrize(
    ("alpha", "decay", "rounds", "value"),
    [(0.3, 1.0, 11, 5.24289), (0.7, 1.0, 29, 5.24367), (0.9, 1.0, 81, 5.24407), (0.7, 0.98, 21, 5.24366)],
)
def test_rounds_of_the_iterative_method_above_the_sea_floor(alpha: float, decay: float, rounds: int, value: float) -> None:
    p = reference("auv")
    found = iterative(p, context(), alpha=alpha, decay=decay)
    assert found.statistics["rounds"] == rounds and p.evaluate(found.answer).values[0] == pytest.approx(value, abs=6e-6)
    if (alpha, decay) == (0.7, 1.0):
        assert found.statistics["values"][:5] == pytest.approx([5.2884, 5.2735, 5.26412, 5.25778, 5.25345], abs=6e-6)


@pytest.mark.parametrize(
    ("family", "quantile", "value"), [("auv", 0.0, 3.58726), ("corridor", 0.0, 1.29122), ("auv", 40, 8.14715), ("corridor", 80, None)]
)
def test_no_margin_and_that_of_the_ellipsoid_of_the_whole_trajectory(family: str, quantile: float, value: float | None) -> None:
    """An ellipsoid of all states, steps times their number of degrees of freedom, takes more than one of the constraints' noise does."""
    p = reference(family)
    margin = math.sqrt(chi2.isf(p.budgets[0].risk, quantile)) if quantile else 0.0
    found = open_session(fixed_margins_program(p, "margins", p.deviation * margin)).solve(Stop())
    if value is None:
        assert found.status == "infeasible"
    else:
        assert found.value == pytest.approx(value, abs=6e-6)
    if (family, quantile) == ("auv", 0.0):
        drawn = any_fails(p.limits - p.chance @ found.x[: p.size], p.covariance, points=2_000_000)
        assert drawn.value == pytest.approx(0.765, abs=1e-3)


def test_decisions_of_the_two_variables() -> None:
    flat = run(ConvexAllocation, margins([1.0, 3.0], 0.1)).answer.decision  # 1e-9 of the cost is 1e-4 of a margin
    assert flat == pytest.approx([2.04451, 1.40812], abs=1e-4)
    tight = problem(constraints__upper=4)
    assert run(ConvexAllocation, tight).answer.decision[1] == pytest.approx(3.718442, abs=1e-6)
    even = by_program(tight, "uniform")
    assert even is not None and even.decision == pytest.approx([0.644854, 3.355146], abs=1e-6)
