from pathlib import Path

import numpy as np
import pytest
from program_text import expected, written
from risk_problems import around_a_box, margins, problem
from scipy.special import ndtr, ndtri

from waybound import Exactness, solve
from waybound.formulations.risk.forms import piecewise as module
from waybound.formulations.risk.forms.piecewise import density, mean_risk, piecewise_program, points, tangents
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.engines.risk.convex_allocation_steps.session import open_session


@pytest.mark.parametrize("above", [False, True])
def test_pieces_lie_on_their_side_of_the_tail(above: bool) -> None:
    p = problem()
    piecewise = piecewise_program(p, "it", points(p, mean_risk(p), 12), above=above)
    for z in np.linspace(-ndtri(0.1), 7.0, 200):
        x = np.zeros(piecewise.program.num_variables)
        x[piecewise.z : piecewise.z + 2] = z
        x[piecewise.risk : piecewise.risk + 2] = ndtr(-z) / piecewise.unit
        rows = piecewise.program.matrix @ x
        pieces = slice(piecewise.budget + 1, None)
        short = (piecewise.program.row_lower - rows)[pieces].max()
        if above:
            assert short >= -1e-12 or x[piecewise.risk] < piecewise.program.lower[piecewise.risk]
        else:
            assert short <= 1e-12


def test_points_begin_at_the_largest_risk() -> None:
    p = problem(risk={"total": 0.1, "each": [0.1, 0.02]})
    deviations = points(p, mean_risk(p), 5)
    assert ndtr(-deviations[:, 0]) == pytest.approx([0.1, 0.02])
    assert (np.diff(deviations, axis=1) > 0).all()
    slope, constant = tangents(deviations, 1.0)
    assert constant - slope * deviations == pytest.approx(ndtr(-deviations))
    assert slope == pytest.approx(density(deviations))


def test_a_tangent_program_of_alternatives_holds_far_decisions() -> None:
    p = around_a_box()
    piecewise = piecewise_program(p, "it", points(p, mean_risk(p), 6), above=False)
    x = np.zeros(piecewise.program.num_variables)
    x[:4] = [-3.0, 0.0, 3.0, 0.0]
    x[piecewise.choice] = 1.0
    x[piecewise.z] = piecewise.program.upper[piecewise.z]
    assert piecewise.program.residual(x) <= 1e-9  # no risk is needed as far away as this


@pytest.mark.parametrize(("p", "best"), [(problem(), 13.731143), (margins([1.0, 2.0, 5.0], 0.1), 13.808752)], ids=["max", "min"])
def test_its_optimum_and_duals_bound_the_problem(p, best) -> None:
    compiled = p.compile("tangents")
    assert compiled.exactness is Exactness.RELAXATION
    solution = open_session(compiled.program).solve(Stop())
    assert p.sign * solution.value <= p.sign * best + 1e-6
    assert solution.value == pytest.approx(best, rel=2e-3)
    bound = verified_bound(p, compiled.dual_evidence(solution.duals))
    assert p.sign * solution.value - 1e-7 <= p.sign * bound <= p.sign * best + 1e-6


def test_it_says_nothing_of_joint_risk() -> None:
    compiled = problem(risk__kind="joint").compile("tangents")
    assert compiled.exactness is Exactness.NEITHER and compiled.dual_evidence is None


TWO = """
    {
      "waybound": 1, "kind": "risk-allocation", "name": "two", "problem": "risk-allocation", "sense": "max",
      "decisions": 2, "lower": 0,
      "quantities": {"map": [[1, 0], [0, 1]], "covariance": [1, 0.25]},
      "cost": {"decisions": [1, 3]},
      "constraints": {"decisions": [[1, 1]], "upper": 7},
      "chance": {"quantities": [[1, 0], [0, 1]], "limits": [5, 5]},
      "risk": {"total": 0.1, "each": [0.1, 0.05]}
    }
"""


def test_tangents_from_text_to_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """At three points: risks of 0.1 (0.05), 2.236e-5 (1.581e-5) and 5e-9, that is 1.281552 (1.644854), 4.081628 (4.161454) and 5.730729
    deviations. The slope is the density there over 0.05, in which risks are counted, the constant the risk over 0.05 and slope times point.
    """
    monkeypatch.setattr(module, "POINTS", 3)
    assert written(TWO, "tangents", tmp_path, ".json") == expected("""
        tangents, relaxation
        max x[x1] + 3 x[x2]
        constraint[1]: x[x1] + x[x2] <= 7
        chance[1]: x[x1] + z[1] <= 5
        chance[2]: x[x2] + 0.5 z[2] <= 5
        budget-1: risk[1] + risk[2] <= 2
        piece[1,0]: 3.50997 z[1] + risk[1] >= 6.4982
        piece[1,1]: 0.00192458 z[1] + risk[1] >= 0.00830262
        piece[1,2]: 5.89593e-07 z[1] + risk[1] >= 3.4788e-06
        piece[2,3]: 2.06271 z[2] + risk[2] >= 4.39286
        piece[2,4]: 0.001385 z[2] + risk[2] >= 0.00607984
        piece[2,5]: 5.89593e-07 z[2] + risk[2] >= 3.4788e-06
        x[x1], x[x2] >= 0
        z[1] >= 1.28155
        z[2] >= 1.64485
        0 <= risk[1] <= 2
        0 <= risk[2] <= 1
    """)


@pytest.mark.parametrize(
    ("p", "best"), [(problem(), 13.731143), (margins([1.0, 3.0], 0.1), 6.268857), (margins([1.0, 2.0, 5.0], 0.1), 13.808752)]
)
def test_its_answers_are_near_the_optimum(p, best) -> None:
    solution = solve(p, "highs", form="secants", bound_time=0)
    assert p.compile("secants").exactness is Exactness.RESTRICTION
    assert p.sign * best - 1e-6 <= p.sign * solution.objective
    assert solution.objective == pytest.approx(best, rel=2e-3)


def test_alternatives_are_chosen_by_integers() -> None:
    solution = solve(around_a_box(), "highs", form="secants", bound_time=0)
    assert solution.answer.decision == pytest.approx([-1.328971, 0.0], abs=1e-3)
    assert solution.objective == pytest.approx(1.328971, rel=1e-3)


CORNER = """
    {
      "waybound": 1, "kind": "risk-allocation", "name": "corner", "problem": "risk-allocation",
      "decisions": 2, "lower": -3, "upper": 3,
      "quantities": {"map": [[1, 0], [0, 1]], "covariance": [0.04, 0.25]},
      "cost": {"decisions": [-1, -2]},
      "chance": {
        "quantities": [[1, 0], [0, 1], [1, 1]], "limits": [-1, -1, 4], "constraint": [0, 0, 1], "names": ["corner", "wall"]
      },
      "risk": {"total": 0.1}
    }
"""


def test_secants_from_text_to_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Chords between three points: risks over 0.05 of 2, 4.472136e-4 and 1e-7, at 1.281552, 4.081628 and 5.730729 deviations.

    A row that need not hold has the slack 3 + 5.730729 s + 1: 5.146146 where s = 0.2, 6.865365 where s = 0.5.
    """
    monkeypatch.setattr(module, "POINTS", 3)
    assert written(CORNER, "secants", tmp_path, ".json") == expected("""
        secants, restriction
        min - x[x1] - 2 x[x2]
        choose[corner]: choice[corner,0] + choice[corner,1] >= 1
        choose[wall]: choice[wall,2] >= 1
        chance[corner,0]: x[x1] + 5.14615 choice[corner,0] + 0.2 z[corner] <= 4.14615
        chance[corner,1]: x[x2] + 6.86536 choice[corner,1] + 0.5 z[corner] <= 5.86536
        chance[wall,2]: x[x1] + x[x2] + 0.538516 z[wall] <= 4
        budget-1: risk[corner] + risk[wall] <= 2
        piece[corner,0]: 0.714107 z[corner] + risk[corner] >= 2.91516
        piece[corner,1]: 0.000271126 z[corner] + risk[corner] >= 0.00155385
        piece[wall,2]: 0.714107 z[wall] + risk[wall] >= 2.91516
        piece[wall,3]: 0.000271126 z[wall] + risk[wall] >= 0.00155385
        -3 <= x[x1], x[x2] <= 3
        choice[corner,0], choice[corner,1] binary
        choice[wall,2] = 1 integer
        1.28155 <= z[corner] <= 5.73073
        z[wall] >= 1.28155
        1e-07 <= risk[corner], risk[wall] <= 2
    """)
