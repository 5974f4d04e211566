"""Programs with a margin for each chance row."""

from __future__ import annotations

import numpy as np
import pytest
from risk_problems import around_a_box, problem

from waybound.formulations.risk.forms._fixed_risks import fixed_margins_program, largest, makes, margins, refuses
from waybound.formulations.stop import Stop
from waybound.solvers.engines.convex_allocation_steps.session import open_session


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
