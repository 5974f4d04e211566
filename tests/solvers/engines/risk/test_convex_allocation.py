from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from risk_problems import around_a_box, margins, problem, risk_of_two_sensors, run, two_sensors

import waybound as wb
from waybound import RiskAllocation, UnsupportedError, solve
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.risk.allocation import Budget, Risk
from waybound.reports.benchmarks.risk_allocation import by_program, random_problem
from waybound.solvers.engines.risk.convex_allocation import BEYOND, ConvexAllocation, _unproved, beyond_boole, quantile, room
from waybound.solvers.engines.risk.convex_allocation_steps.successive_tangents import SuccessiveTangents


def test_it_is_better_than_where_the_iterative_method_stalls() -> None:
    solution = solve(problem(), bound_time=0)
    assert (solution.solver, solution.status, solution.bound_kind) == ("convex-allocation", "optimal", "verified")
    assert solution.objective == pytest.approx(13.731143, abs=1e-6)
    assert solve(problem(), heuristic="iterative", bound_time=0).objective == pytest.approx(13.420585, abs=1e-6)


@pytest.mark.parametrize(
    ("p", "value", "risks"),
    [
        (problem(constraints__upper=4), 11.436883, [1.19e-6, 0.0999988]),
        (margins([1.0, 3.0], 0.1), 6.268857, [0.020452, 0.079548]),
        (margins([1.0, 2.0, 5.0], 0.1), 13.808752, [0.009845, 0.022049, 0.068106]),
        (margins([2.0, 2.0, 2.0], 0.06), 3 * 2 * 2.053749, [0.02, 0.02, 0.02]),
        (margins([1.0], 0.1), 1.281552, [0.1]),
    ],
)
def test_known_allocations(p, value: float, risks: list[float]) -> None:
    result = run(ConvexAllocation, p)
    assert result.objective == pytest.approx(value, abs=1e-5)
    assert result.answer.risks == pytest.approx(risks, abs=1e-5)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("weight", [1.0, 1e9])
def test_norms_have_the_same_optimum_at_any_scale(scale: float, weight: float) -> None:
    p = problem(
        sense="min", decisions=3, lower=[-3 * scale, -5 * scale, -5 * scale], upper=[0, 0, 2 * scale], constraints=None,
        quantities={"map": [[-2, -0.7, 1], [-1, -3, -2]], "covariance": [0.0, 0.0]},
        cost={
            "decisions": [0, -3 * weight, 2 * weight],
            "terms": [{"kind": "norm", "weight": weight, "decisions": [[1, 2, -2], [2, 0, -2]], "constant": [2 * scale, 2 * scale]}],
        },
        chance__limits=[1.589585834684558 * scale, 2.4537047295429587 * scale],
    )  # fmt: skip
    result = run(ConvexAllocation, p)
    assert result.status == "optimal"
    assert result.objective == pytest.approx(1.1215169746 * scale * weight, rel=1e-7)
    assert verified_bound(p, result.evidence[0]) == pytest.approx(result.objective, rel=1e-7)


@pytest.mark.parametrize("part", [1e-9, 1e-11, 1e-14])
@pytest.mark.parametrize("unit", [2.0**-30, 1.0, 2.0**30])
def test_deviations_beyond_what_solvers_see_leave_an_answer_and_its_proof(part: float, unit: float) -> None:
    limit = 5 * unit
    p = problem(lower=0, upper=9 * unit, constraints=None, chance__limits=[limit] * 2, quantities__covariance=[(limit * part) ** 2] * 2)
    solution = solve(p, bound_time=0)
    assert solution.status == "optimal" and solution.bound_kind == "verified" and not solution.faults
    assert 20 * unit * (1 - 1e-7) < solution.objective < 20 * unit


def test_what_its_prices_do_not_prove_is_no_optimum() -> None:
    p = margins([1.0, 3.0], 0.1)
    interval = SuccessiveTangents(p).run(Stop())
    assert not _unproved(p, interval, 0.0) and interval.status == "optimal"
    interval.prices = {**interval.prices, "chance": 0.5 * interval.prices["chance"]}
    assert _unproved(p, interval, 0.0)
    assert interval.status == "feasible" and interval.bound < 0.9 * interval.value


def test_an_open_interval_claims_what_its_prices_prove() -> None:
    """Clarabel stops early on this one, between two values of which neither is a bound."""
    p = problem(
        decisions=2, lower=[-2, -5], upper=None, cost={
            "decisions": [-3, -1],
            "terms": [{"kind": "norm", "weight": 0.1, "decisions": [[-2, -1], [2, -1]], "constant": [-2, 0]}],
        },
        quantities={
            "map": [[-1.7925474833464532, -2], [-1.1950370868740516, -2], [-3, 3]],
            "covariance": [2.958951664510954, 3.7877310781734943, 1.801245175705491],
        },
        chance={"quantities": np.eye(3).tolist(), "limits": [1, 0, 2]}, constraints={"decisions": [[0, -1]], "upper": 7, "lower": -2},
        risk={"total": 1e-9},
    )  # fmt: skip
    result = run(ConvexAllocation, p)
    assert result.bound is not None and result.objective is not None and result.bound >= result.objective - 1e-6 * abs(result.objective)
    assert not solve(p, bound_time=0).faults
    interval = SuccessiveTangents(p).run(Stop())
    interval.status, interval.bound = "feasible", interval.value + 1.0
    _unproved(p, interval, 0.0)
    assert interval.bound == p.sign * verified_bound(p, interval.evidence(p.sign)[0])


def test_the_gap_asked_for_ends_it() -> None:
    solution = solve(wb.generate("risk-allocation"), gap=1e-3, bound_time=0)
    assert (solution.status, solution.limit) == ("feasible", "gap")
    assert solution.gap is not None and 1e-9 < solution.gap <= 1e-3


def test_squares_cones_and_norms_by_clarabel() -> None:
    square = {"kind": "square", "decisions": [[1, 0], [0, 1]], "constant": [-6, -6]}
    p = problem(
        sense="min", lower=-9, upper=9, constraints=None, cost={"decisions": [0, 0.5], "terms": [square]}, chance__limits=[5, 50],
        cones=[{"decisions": [[1, 0], [0, 1]], "limit": 5.0}],
    )  # fmt: skip
    solution = solve(p, bound_time=0)
    assert solution.bound_kind == "verified" and solution.gap is not None and solution.gap < 1e-6
    x = solution.answer.decision
    assert x @ x == pytest.approx(25.0, rel=1e-5)
    assert solve(p, "cvxpy", form="secants", bound_time=0).objective == pytest.approx(solution.objective, rel=1e-3)


def test_where_there_is_no_answer_the_constraints_are_named() -> None:
    solution = solve(problem(constraints={"decisions": [[1, 1]], "lower": 9}), bound_time=0)
    assert solution.status == "infeasible" and solution.answer is None
    assert "no decision keeps the risks of chance constraints 1, 2 within" in solution.message


def test_joint_risk_gets_an_answer_and_no_bound() -> None:
    result = run(ConvexAllocation, problem(risk__kind="joint"))
    assert result.objective == pytest.approx(13.731143, abs=1e-6)
    assert not result.evidence and result.answer.risks is None and result.holds.value == "restriction"


def test_what_it_lacks_is_said() -> None:
    with pytest.raises(UnsupportedError, match="alternatives"):
        run(ConvexAllocation, wb.generate("risk-allocation", family="obstacles", steps=2))


# -- budgets of parts ------------------------------------------------------------------------------------------------------


def with_budgets(
    p: RiskAllocation, groups: Sequence[Sequence[int]], risks: Sequence[float], *, total: float | None = None
) -> RiskAllocation:
    """The same constraints under a budget a group, and a total or none."""
    budgets = tuple(Budget(f"part {k + 1}", np.array(g), r) for k, (g, r) in enumerate(zip(groups, risks, strict=True)))
    each = np.full(len(p.names), min(0.5, max(risks)))
    return RiskAllocation(replace(p.instance, risk=Risk(p.risk.kind, total, each, budgets)))


def parts(rng: np.random.Generator, many: int) -> list[list[int]]:
    """The constraints in up to three groups, as those of robots or steps are."""
    group = rng.integers(0, 3, many)
    return [np.nonzero(group == g)[0].tolist() for g in np.unique(group)]


@pytest.mark.share(4)
@pytest.mark.parametrize("seed", range(8))
def test_budgets_of_parts_are_worth_no_more_than_the_whole_and_as_much_where_they_are_those_of_the_best(seed: int) -> None:
    rng = np.random.default_rng(seed)
    p = random_problem(rng)
    best, total = run(ConvexAllocation, p), p.budgets[0].risk
    own, size = best.answer.risks, 1e-7 * abs(best.objective)
    for groups in (parts(rng, len(own)), [[k] for k in range(len(own))]):
        for shares in (np.full(len(groups), total / len(groups)), total * rng.dirichlet(np.full(len(groups), 9.0))):
            split = with_budgets(p, groups, shares.tolist())
            result = run(ConvexAllocation, split)
            assert result.objective <= best.objective + size  # a reward
            assert verified_bound(split, result.evidence[0]) >= result.objective - size
            assert split.evaluate(result.answer).feasible and p.evaluate(result.answer).feasible
            for form in ("uniform", "secants"):
                kept = by_program(split, form)
                assert kept is not None and split.evaluate(kept).feasible
                assert split.value(kept.decision)[0] <= result.objective + size
        same = with_budgets(p, groups, [max(float(own[g].sum()), 1e-12 * total) for g in groups])
        assert run(ConvexAllocation, same).objective == pytest.approx(best.objective, rel=1e-6)
        assert run(ConvexAllocation, with_budgets(p, groups, [total] * len(groups), total=total)).objective == pytest.approx(
            best.objective, rel=1e-7
        )


@pytest.mark.parametrize("solver", [pytest.param("exact-joint", marks=pytest.mark.long), "convex-allocation"])
def test_joint_budgets_of_parts_are_worth_no_more_than_the_whole(solver: str) -> None:
    p = margins([1.0, 2.0, 5.0], 0.1, kind="joint")
    whole = solve(p, solver, bound_time=0, gap=1e-5)
    own = p.risks(whole.answer.decision)
    for groups, shares in (([[0], [1, 2]], [0.03, 0.07]), ([[0, 1], [2]], [0.05, 0.05]), ([[0], [1], [2]], (own * 0.999).tolist())):
        split = with_budgets(p, groups, shares, total=0.1)
        solution = solve(split, solver, bound_time=0, gap=1e-5)
        assert solution.certificate.feasible and solution.objective >= whole.objective * (1.0 - 2e-5)
    assert solution.objective == pytest.approx(whole.objective, rel=1e-3)


@pytest.mark.parametrize(("total", "limit"), [(2e-5, 4.3), (6.5e-7, 5.0), (1e-3, 3.3)])
def test_a_plan_is_found_where_no_allocation_is(total: float, limit: float) -> None:
    p = two_sensors(total, limit)
    assert run(ConvexAllocation, p.by_allocation()).answer is None
    x = beyond_boole(p, 1, Stop())
    assert x is not None and room(p, x, 1) >= 0.0 and risk_of_two_sensors(float(x[0]), limit) <= total
    result = run(ConvexAllocation, p)
    assert result.status == "feasible" and result.bound is None and result.message == BEYOND
    assert p.evaluate(result.answer).feasible


def test_none_is_found_where_there_is_none() -> None:
    assert beyond_boole(two_sensors(1.5e-5, 4.3), 1, Stop()) is None
    solution = solve(two_sensors(1.5e-5, 4.3), "convex-allocation", bound_time=0)
    assert solution.answer is None and solution.status == "unknown"


def test_room_is_counted_in_deviations() -> None:
    p = margins([1.0, 3.0], 0.1, kind="joint")
    x = np.full(2, 2.0)
    truth = p.joint_risk(x)["total"].value
    assert room(p, x, 1) == pytest.approx(float(quantile(np.array(truth)) - quantile(np.array(0.1))))
    assert room(p, np.full(2, 1.0), 1) < 0.0


def test_alternatives_are_not_its_own() -> None:
    p = around_a_box(risk={"total": 0.05, "kind": "joint"})
    assert "alternatives" in ConvexAllocation().missing(p)
