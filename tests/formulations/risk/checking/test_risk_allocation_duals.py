import math
from decimal import Decimal, getcontext
from typing import Any

import numpy as np
import pytest
from risk_problems import around_a_box, margins, problem, run
from scipy.optimize import minimize_scalar

from waybound import Evidence, InputError, RiskAllocation
from waybound.formulations.risk.checking.risk_allocation_duals import (
    TAIL_ERROR,
    _least_margin,
    check_risk_allocation_duals,
    density,
    least_quantile,
    tail,
)
from waybound.formulations.verified_bounds import verified_bound
from waybound.reports.benchmarks.risk_allocation import random_problem
from waybound.solvers.engines.risk.convex_allocation import ConvexAllocation


def proved(p: RiskAllocation) -> tuple[Any, float, dict[str, Any]]:
    result = run(ConvexAllocation, p)
    (evidence,) = result.evidence
    return result, verified_bound(p, evidence), evidence.data


def exact_tail(z: float) -> tuple[Decimal, Decimal]:
    """Tail and density to 50 digits, by the series of the error function."""
    getcontext().prec = 700 if z > 6 else 120
    x = Decimal(z)
    pi, term, total, k = Decimal("3.14159265358979323846264338327950288419716939937510582097494459230781640628620899"), x, x, 0
    while abs(term) > Decimal(10) ** -(getcontext().prec - 60):
        k += 1
        term *= x * x / (2 * k + 1)
        total += term
    phi = (-x * x / 2).exp() / (2 * pi).sqrt()
    return Decimal("0.5") - phi * total, phi


@pytest.mark.parametrize("z", [0.0, 1e-9, 0.1, 0.7, 1.5, 2.5, 4.0, 5.5, 6.0])
def test_tail_and_density_are_as_close_as_stated(z: float) -> None:
    above, phi = exact_tail(z)
    assert abs(Decimal(tail(z)) / above - 1) < TAIL_ERROR / 4
    assert abs(Decimal(density(z)) / phi - 1) < TAIL_ERROR / 4


@pytest.mark.parametrize("risk", [0.5, 0.49999, 0.05, 1e-3, 1e-9, 1e-15])
def test_the_quantile_errs_to_the_safe_side(risk: float) -> None:
    z = least_quantile(risk)
    assert tail(z) * (1.0 + TAIL_ERROR) >= risk
    assert tail(z) <= risk * (1.0 + 1e-11)


@pytest.mark.parametrize("seed", range(4))
def test_the_least_margin_is_below_every_point(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(50):
        slope, price, floor = 10.0 ** rng.uniform(-6, 3), 10.0 ** rng.uniform(-6, 3), rng.choice([0.0, 1.5, 3.0])

        def value(z: float, slope: float = slope, price: float = price) -> float:
            return slope * z + price * tail(z)

        best = minimize_scalar(value, bounds=(floor, floor + 12.0), method="bounded", options={"xatol": 1e-10}).fun
        best = min(best, value(float(floor)))
        assert best * (1.0 - 1e-9) <= _least_margin(slope, price, float(floor)) <= best


@pytest.mark.parametrize("p", [problem(), margins([1.0, 2.0, 5.0], 0.1)], ids=["max", "min"])
def test_prices_prove_the_optimum(p: RiskAllocation) -> None:
    result, bound, _ = proved(p)
    assert p.sign * bound <= p.sign * result.objective
    assert bound == pytest.approx(result.objective, rel=1e-8)


@pytest.mark.parametrize("seed", range(3))
def test_no_prices_prove_too_much(seed: int) -> None:
    rng = np.random.default_rng(seed)
    p = random_problem(rng)
    result, _, data = proved(p)
    for _ in range(30):
        wild = {key: rng.normal(size=n) * 10.0 ** rng.uniform(-3, 2) for key, n in (("rows", 1), ("chance", len(p.limits)), ("budgets", 1))}
        bound = check_risk_allocation_duals(p, {key: v.tolist() for key, v in wild.items()} | {"terms": [], "cones": []})
        assert bound >= result.objective
        near = {key: v * rng.uniform(0.5, 1.5, len(v)) for key, v in _dense(p, data).items()}
        assert check_risk_allocation_duals(p, {key: v.tolist() for key, v in near.items()}) >= result.objective


@pytest.mark.parametrize("price", [0.999, 2.0, 1000.0])
@pytest.mark.parametrize("columns", [1, 2])
def test_margins_cost_what_the_rows_do_where_a_decision_has_no_bound(price: float, columns: int) -> None:
    p = margins([1.0] * columns, 0.05)
    optimum = run(ConvexAllocation, p).objective
    data = {"rows": [], "chance": [price] * columns, "budgets": [0.0], "terms": [], "cones": []}
    assert check_risk_allocation_duals(p, data) <= optimum
    assert check_risk_allocation_duals(p, {**data, "infeasible": True}) == -math.inf


def _dense(p: RiskAllocation, data: dict[str, Any]) -> dict[str, np.ndarray]:
    sizes = {"rows": len(p.row_lower), "chance": len(p.limits), "budgets": len(p.budgets), "terms": 0, "cones": 0}
    dense = {}
    for key, size in sizes.items():
        given = data[key]
        dense[key] = np.zeros(size)
        dense[key][given["at"] if isinstance(given, dict) else slice(None)] = given["values"] if isinstance(given, dict) else given
    return dense


@pytest.mark.parametrize("scale", [2.0**-40, 2.0**40])
def test_data_in_other_units_have_the_same_proof(scale: float) -> None:
    p = problem(
        cost__decisions=[scale, 3 * scale], quantities__covariance=[scale**2, scale**2], constraints__upper=7 * scale,
        chance__limits=[5 * scale, 5 * scale],
    )  # fmt: skip
    result, bound, _ = proved(p)
    assert result.objective == pytest.approx(13.731143 * scale**2, rel=1e-6)
    assert result.objective <= bound <= result.objective * (1.0 + 1e-7)


def test_prices_of_budgets_do_not_count_where_risk_is_joint() -> None:
    _, bound, data = proved(problem())
    joint = problem(risk__kind="joint")
    assert check_risk_allocation_duals(joint, data) > bound
    assert verified_bound(joint, Evidence("risk-allocation-duals", "", 0.0, data)) >= 13.765737  # the optimum for independent noise


def test_alternatives_have_no_price_until_they_are_decided() -> None:
    p = around_a_box()
    zeros = {"rows": [], "terms": [0.0, 0.0], "cones": []}
    free = check_risk_allocation_duals(p, {**zeros, "chance": [1.0, 0.0, 0.0, 0.0], "budgets": [0.01]})
    assert free <= 0.0
    decided = p.restricted([({"safest": 0}, True)])
    data = {**zeros, "terms": [-1.0, 0.0], "chance": [1.0, 0.0, 0.0, 0.0], "budgets": [4.0]}
    assert check_risk_allocation_duals(decided, data) > 1.0
    assert check_risk_allocation_duals(decided.restricted([({"safest": 0}, False)]), data) == math.inf


def test_prices_prove_that_there_is_no_answer() -> None:
    p = problem(constraints={"decisions": [[1, 1]], "lower": 9})
    result = run(ConvexAllocation, p)
    assert result.status == "infeasible"
    (evidence,) = result.evidence
    assert verified_bound(p, evidence) == -math.inf  # a reward below all
    assert p.why_none(evidence.kind, evidence.data).startswith("no decision keeps the risks of chance constraints 1, 2 ")
    feasible = problem(constraints={"decisions": [[1, 1]], "lower": 6})
    assert check_risk_allocation_duals(feasible, evidence.data) == math.inf


@pytest.mark.parametrize("data", [{}, {"rows": [0.0], "chance": [0.0], "budgets": [0.0], "terms": [], "cones": []}])
def test_malformed_evidence_is_refused(data: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="evidence"):
        check_risk_allocation_duals(problem(), data)
