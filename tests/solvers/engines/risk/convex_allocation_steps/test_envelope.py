import numpy as np
import pytest
from risk_problems import problem
from scipy.special import ndtr

from waybound.formulations.risk.forms.piecewise import mean_risk, piecewise_program, points
from waybound.formulations.risk.risk_allocation import RiskAllocation
from waybound.formulations.stop import Stop
from waybound.reports.benchmarks.risk_allocation import random_problem, reference
from waybound.solvers.engines.risk.convex_allocation_steps.envelope import Envelope
from waybound.solvers.engines.risk.convex_allocation_steps.session import ClarabelSession, open_session


def shared() -> RiskAllocation:
    """Three constraints under a total and two budgets that share one of them; the middle one has no noise."""
    return problem(
        quantities={"map": [[1, 0], [0, 1], [1, 1]], "covariance": [1, 0, 4]}, constraints=None,
        chance={"quantities": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "limits": [5, 3, 6], "names": ["a", "b", "c"]},
        risk={
            "total": 0.1, "each": [0.05, 0.1, 0.1],
            "budgets": [{"constraints": ["a", "b"], "risk": 0.06}, {"constraints": ["b", "c"], "risk": 0.07}],
        },
    )  # fmt: skip


def tangent_rows(p: RiskAllocation, at: np.ndarray) -> float:
    """The optimum with the same tangents as rows."""
    return open_session(piecewise_program(p, "tangents", at, above=False).program).solve(Stop()).value


@pytest.mark.parametrize("p", [shared(), reference("auv"), *(random_problem(np.random.default_rng(k)) for k in range(6))], ids=str)
def test_columns_say_what_rows_do(p: RiskAllocation) -> None:
    at = points(p, mean_risk(p), 4, 0.2)
    tail = Envelope(p, 4, 0.2, 1)
    assert tail.session.solve(Stop()).value == pytest.approx(tangent_rows(p, at), rel=1e-9)
    rng = np.random.default_rng(3)
    for _ in range(3):  # between the others, at one of them, beyond all
        more = np.where(rng.random(len(at)) < 0.2, at[:, 1], at[:, 0] + rng.uniform(0.0, 1.2, len(at)) * (at.max(axis=1) - at[:, 0]))
        tail.add(np.arange(len(at)), more)
        at = np.concatenate([at, more[:, None]], axis=1)
        assert tail.session.solve(Stop()).value == pytest.approx(tangent_rows(p, at), rel=1e-9)


def test_the_parts_are_those_of_the_largest_tangent_where_risk_has_a_price() -> None:
    tail = Envelope(shared(), 4, 0.2, 1)
    tail.add(np.array([2]), np.array([2.0]))
    z, risk = tail.parts(tail.session.solve(Stop()))
    at = np.append(points(shared(), tail.unit, 4, 0.2)[2], 2.0)
    density = np.exp(-0.5 * at**2) / np.sqrt(2.0 * np.pi)
    largest = float((ndtr(-at) - density * (z[2] - at)).max())
    assert risk[2] * tail.unit == pytest.approx(largest, rel=1e-9) == 0.07
    assert risk[1] == 0.0 and risk[:2].sum() * tail.unit <= 0.06 + 1e-9  # the middle one has no noise


def test_smaller_budgets_cost_more_until_they_are_whole_again() -> None:
    tail = Envelope(shared(), 4, 0.2, 1)
    whole = tail.session.solve(Stop()).value
    tail.use(0.1)
    assert tail.session.solve(Stop()).value < whole - 1e-3  # a reward
    tail.use(0.0)
    assert tail.session.solve(Stop()).value == pytest.approx(whole, rel=1e-12)


def test_cones_have_further_columns_too() -> None:
    p = problem(cost__terms=[{"kind": "norm", "weight": 0.1, "decisions": [[1, 0], [0, 1]]}])
    tail, at = Envelope(p, 4, 0.2, 1), points(p, mean_risk(p), 4, 0.2)
    assert isinstance(tail.session, ClarabelSession)
    tail.add(np.array([0, 1]), np.array([1.9, 1.5]))
    rows_at = np.concatenate([at, [[1.9], [1.5]]], axis=1)
    assert tail.session.solve(Stop()).value == pytest.approx(tangent_rows(p, rows_at), rel=1e-7)


def test_without_noise_there_are_no_columns() -> None:
    tail = Envelope(problem(quantities__covariance=[0, 0]), 4, 0.2, 1)
    assert tail.program.num_variables == 2 and tail.session.solve(Stop()).value == pytest.approx(17.0)
    assert tail.parts(tail.session.solve(Stop()))[1].tolist() == [0.0, 0.0]
