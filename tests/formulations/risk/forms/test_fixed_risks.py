"""Programs with a margin for each chance row."""

from __future__ import annotations

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings
from hypothesis import strategies as st
from risk_problems import around_a_box, problem

from waybound.formulations.risk.forms._fixed_risks import ROUNDED, fixed_margins_program, largest, makes, margins, refuses, spared
from waybound.formulations.risk.forms._piecewise import NEGLIGIBLE
from waybound.formulations.stop import Stop
from waybound.solvers.backend import Control, Options, solver_named
from waybound.solvers.engines.risk.convex_allocation_steps.session import open_session


def test_margins_stand_on_the_right_side() -> None:
    p = problem(quantities__covariance=[4, 0])
    margin = margins(p, np.array([2.0, np.inf]))
    assert margin.tolist() == [4.0, 0.0]
    program = fixed_margins_program(p, "it", margin)
    assert program.row_upper.tolist() == [7.0, 1.0, 5.0]
    assert program.row_name(1) == "chance[1]"


def test_one_alternative_is_chosen() -> None:
    p = around_a_box()
    assert makes(p) == {"integers"} and not refuses(p)
    assert largest(p).tolist() == [3.0] * 4
    made = open_session(fixed_margins_program(p, "it", margins(p, np.array([1.0])))).solve(Stop())
    x, choice = made.x[:2], made.x[-4:]
    assert choice.sum() == pytest.approx(1.0) and choice[0] == pytest.approx(1.0)
    assert x == pytest.approx([-1.2, 0.0], abs=1e-6)
    assert refuses(around_a_box(lower=None)) == {"alternatives of decisions without bounds"}


def test_restrictions_leave_a_part_of_each_limit_with_noise_to_rounding() -> None:
    assert spared(problem(quantities__covariance=[4, 0], chance__limits=[-5, 7])).tolist() == [5 * ROUNDED, 0.0]


@pytest.mark.parametrize("solver", ["highs", "cvxpy"])
@pytest.mark.parametrize("form", ["uniform", "ellipsoid", "secants"])
@settings(max_examples=draws(30), deadline=None)
@given(scale=st.integers(-30, 30), a=st.floats(-15, -1), b=st.floats(-15, -1), total=st.sampled_from([0.1, 1e-6]))
def test_answers_of_restrictions_keep_their_risks_at_any_scale(
    solver: str, form: str, scale: int, a: float, b: float, total: float
) -> None:
    """However small the deviations, here 10**a and 10**b of a limit, they lose what their margins take and no more."""
    unit, deviations = 2.0**scale, np.array([10.0**a, 10.0**b])
    p = problem(
        lower=0, upper=9 * unit, constraints=None, cost={"decisions": [1, 1]}, chance__limits=[unit, unit],
        quantities__covariance=((unit * deviations) ** 2).tolist(),
        risk={"total": total, "kind": "joint" if form == "ellipsoid" else "allocated"},
    )  # fmt: skip
    made = p.compile(form)
    judged = p.evaluate(made.decode(solver_named(solver).run(made.program, Options(), Control()).answer))
    assert judged.feasible, judged.violations
    assert -1e-12 <= 2.0 - judged.values[0] / unit <= 6.0 * deviations.sum() + 3.0 * (ROUNDED + NEGLIGIBLE)
