from pathlib import Path

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from program_text import expected, written
from risk_problems import around_a_box, margins as margins_problem, problem
from scipy.stats import chi2

import waybound as wb
from waybound import Exactness, solve
from waybound.formulations.risk.forms.fixed_risks import (
    ROUNDED,
    ellipsoid_refuses,
    fixed_margins_program,
    largest,
    makes,
    margins,
    radius,
    refuses,
    spared,
    uniform_risks,
)
from waybound.formulations.risk.forms.piecewise import NEGLIGIBLE
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
    solution = open_session(fixed_margins_program(p, "it", margins(p, np.array([1.0])))).solve(Stop())
    x, choice = solution.x[:2], solution.x[-4:]
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
    compiled = p.compile(form)
    judged = p.evaluate(compiled.decode(solver_named(solver).run(compiled.program, Options(), Control()).answer))
    assert judged.feasible, judged.violations
    assert -1e-12 <= 2.0 - judged.values[0] / unit <= 6.0 * deviations.sum() + 3.0 * (ROUNDED + NEGLIGIBLE)


def test_equal_risks_of_the_stalling_problem() -> None:
    solution = solve(problem(), "highs", form="uniform", bound_time=60.0)
    assert solution.objective == pytest.approx(13.420585, abs=1e-6)
    assert solution.bound_kind == "verified" and solution.bound == pytest.approx(13.731143, abs=1e-6)
    assert problem().compile("uniform").exactness is Exactness.RESTRICTION


@pytest.mark.parametrize(("weights", "value"), [([1.0, 3.0], 6.579415), ([1.0, 2.0, 5.0], 14.671317)])
def test_equal_risks_of_margins(weights: list[float], value: float) -> None:
    assert solve(margins_problem(weights, 0.1), "highs", form="uniform", bound_time=0).objective == pytest.approx(value, abs=1e-6)


def test_the_least_of_all_budgets_counts() -> None:
    p = problem(risk={"total": 0.1, "each": [0.5, 0.01], "budgets": [{"constraints": ["1"], "risk": 0.02}]})
    assert uniform_risks(p) == pytest.approx([0.02, 0.01])
    assert np.sum(uniform_risks(problem())) <= 0.1


TERMS = """
    {
      "waybound": 1, "kind": "risk-allocation", "name": "terms", "problem": "risk-allocation",
      "decisions": 2, "lower": 0, "upper": [4, null],
      "quantities": {"map": [[1, 0], [1, 1]], "offset": [0, 0.5], "covariance": [4, 1]},
      "cost": {
        "decisions": [-1, -2], "constant": 3,
        "terms": [
          {"kind": "absolute", "weight": 2, "decisions": [[1, -1]], "constant": [-1]},
          {"kind": "norm", "weight": 0.5, "decisions": [[1, 0], [0, 1]], "constant": [0, -2]},
          {"kind": "square", "weight": 3, "decisions": [[1, 1]], "constant": [-1]}
        ]
      },
      "constraints": {"decisions": [[1, 1]], "upper": 7},
      "cones": [{"decisions": [[2, 0], [0, 1]], "constant": [0, 1], "limit": {"decisions": [0, 1], "constant": 5}}],
      "chance": {"quantities": [[1, 0], [0, 1]], "limits": [5, 6]},
      "risk": {"total": 0.1, "budgets": [{"constraints": ["2"], "risk": 0.02}]}
    }
"""


def test_uniform_from_text_to_text(tmp_path: Path) -> None:
    """Risks 0.05 and 0.02: 5 - 2 x 1.644854 and 6 - 0.5 - 2.053749. The square is 3 (x1 + x2 - 1)^2, multiplied out."""
    assert written(TERMS, "uniform", tmp_path, ".json") == expected("""
        uniform, restriction
        min - 7 x[x1] - 8 x[x2] + 2 absolute-1[0] + 0.5 norm-2[0] + 3 x[x1]^2 + 6 x[x1] x[x2] + 3 x[x2]^2 + 6
        constraint[1]: x[x1] + x[x2] <= 7
        over-1[0]: x[x1] - x[x2] - absolute-1[0] <= 1
        under-1[0]: - x[x1] + x[x2] - absolute-1[0] <= -1
        chance[1]: x[x1] <= 1.71029
        chance[2]: x[x1] + x[x2] <= 3.44625
        norm-2: |(x[x1], x[x2] - 2)| <= norm-2[0]
        cone-1: |(2 x[x1], x[x2] + 1)| <= x[x2] + 5
        0 <= x[x1] <= 4
        x[x2], absolute-1[0], norm-2[0] >= 0
    """)


def test_the_radius_is_that_of_the_noise_there_is() -> None:
    assert radius(problem(risk__total=0.05)) == pytest.approx(2.4477, abs=5e-5)
    assert radius(problem(risk__total=0.05, quantities__covariance=[[1, 1], [1, 1]])) == pytest.approx(1.96, abs=5e-5)
    assert chi2.sf(radius(problem()) ** 2, 2) == pytest.approx(0.1)


def test_it_allows_a_plan_between_none_and_equal_risks() -> None:
    p = wb.generate("risk-allocation")
    solution, even = (wb.solve(p, "highs", form=form, bound_time=0) for form in ("ellipsoid", "uniform"))
    assert solution.objective > even.objective
    assert p.evaluate(solution.answer).feasible


def test_many_constraints_in_few_dimensions_are_of_joint_risk_alone() -> None:
    walls = {"map": [[1, 0]] * 12, "covariance": [[1.0] * 12] * 12}
    chance = {"quantities": [[float(i == k) for i in range(12)] for k in range(12)], "limits": [5.0] * 12}
    allocated = problem(quantities=walls, chance=chance)
    assert any("add up" in lacking for lacking in ellipsoid_refuses(allocated))
    assert not ellipsoid_refuses(problem(quantities=walls, chance=chance, risk__kind="joint"))
    budgets = [{"constraints": ["1"], "risk": 0.01}]
    assert ellipsoid_refuses(problem(risk__budgets=budgets)) == {"budgets other than the total"}


PLANE = """
    {
      "waybound": 1, "kind": "risk-allocation", "name": "plane", "problem": "risk-allocation", "sense": "max",
      "decisions": 2, "lower": -1, "upper": 6,
      "quantities": {"map": [[1, 0], [0, 1]], "covariance": [1, 4]},
      "cost": {"decisions": [1, 3], "terms": [{"kind": "norm", "decisions": [[1, 0], [0, 2]], "constant": [1, 0]}]},
      "constraints": {"decisions": [[1, -1]], "lower": -2},
      "chance": {"quantities": [[1, 0], [0, 1], [1, 1]], "limits": [5, 5, 8], "names": ["east", "north", "wall"]},
      "risk": {"total": 0.1}
    }
"""


def test_ellipsoid_from_text_to_text(tmp_path: Path) -> None:
    """Three constraints of noise in two dimensions: rho^2 = -2 ln 0.1, so rho = 2.145966; deviations 1, 2 and the root of 5."""
    assert written(PLANE, "ellipsoid", tmp_path, ".json") == expected("""
        ellipsoid, restriction
        max x[x1] + 3 x[x2] - norm-1[0]
        constraint[1]: x[x1] - x[x2] >= -2
        chance[east]: x[x1] <= 2.85403
        chance[north]: x[x2] <= 0.708068
        chance[wall]: x[x1] + x[x2] <= 3.20147
        norm-1: |(x[x1] + 1, 2 x[x2])| <= norm-1[0]
        -1 <= x[x1], x[x2] <= 6
        norm-1[0] >= 0
    """)
