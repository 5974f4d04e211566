"""The normal tail in pieces: tangents below it, secants above."""

from __future__ import annotations

import numpy as np
import pytest
from risk_problems import around_a_box, problem
from scipy.special import ndtr, ndtri

from waybound.formulations.risk.forms._piecewise import density, mean_risk, piecewise_program, points, tangents


@pytest.mark.parametrize("above", [False, True])
def test_pieces_lie_on_their_side_of_the_tail(above: bool) -> None:
    p = problem()
    made = piecewise_program(p, "it", points(p, mean_risk(p), 12), above=above)
    for z in np.linspace(-ndtri(0.1), 7.0, 200):
        x = np.zeros(made.program.num_variables)
        x[made.z : made.z + 2] = z
        x[made.risk : made.risk + 2] = ndtr(-z) / made.unit
        rows = made.program.matrix @ x
        pieces = slice(made.budget + 1, None)
        short = (made.program.row_lower - rows)[pieces].max()
        if above:
            assert short >= -1e-12 or x[made.risk] < made.program.lower[made.risk]
        else:
            assert short <= 1e-12


def test_points_begin_at_the_largest_risk() -> None:
    p = problem(risk={"total": 0.1, "each": [0.1, 0.02]})
    made = points(p, mean_risk(p), 5)
    assert ndtr(-made[:, 0]) == pytest.approx([0.1, 0.02])
    assert (np.diff(made, axis=1) > 0).all()
    slope, constant = tangents(made, 1.0)
    assert constant - slope * made == pytest.approx(ndtr(-made))
    assert slope == pytest.approx(density(made))


def test_a_tangent_program_of_alternatives_holds_far_decisions() -> None:
    p = around_a_box()
    made = piecewise_program(p, "it", points(p, mean_risk(p), 6), above=False)
    x = np.zeros(made.program.num_variables)
    x[:4] = [-3.0, 0.0, 3.0, 0.0]
    x[made.choice] = 1.0
    x[made.z] = made.program.upper[made.z]
    assert made.program.residual(x) <= 1e-9  # no risk is needed as far away as this
