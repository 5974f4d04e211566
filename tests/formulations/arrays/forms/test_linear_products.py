"""Products written with linear rows: what they are, and evidence from their duals."""

from __future__ import annotations

import numpy as np
import pytest
from program_text import expected, program_text
from programs import INF, program

from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import verified_bound
from waybound.formulations.stop import NEVER
from waybound.instances.errors import UnsupportedError
from waybound.reports.battery.kinds import KINDS
from waybound.reports.battery.truth import truth
from waybound.solvers.linear_session import LinearSession

GIVEN = ArrayProblem(program([1, 2], [[1, 1]], -INF, 3, [0, -1], [1, 2], integer=[0], sense="max", offset=4, quadratic=[[6, 3], [3, 0]]))


def test_linear_products_from_text_to_text() -> None:
    assert program_text(GIVEN.compile("linear-products").program) == expected(
        """
        max 4 x0 + 2 x1 + 3 product[0,1] + 4
        row: x0 + x1 <= 3
        product_of_0[0]: - 2 x0 + product[0,1] <= 0
        product_of_1[0]: x0 - x1 + product[0,1] <= 1
        x0 binary
        -1 <= x1, product[0,1] <= 2
        """
    )


def test_answers_are_vectors_of_the_program_itself() -> None:
    made = GIVEN.compile("linear-products")
    assert made.encode is not None
    x = made.encode(np.array([1.0, 2.0]))
    assert x.tolist() == [1.0, 2.0, 2.0]
    assert made.program.value(x) == GIVEN.program.value(np.array([1.0, 2.0]))
    assert made.decode(x).tolist() == [1.0, 2.0]


@pytest.mark.parametrize("seed", range(40))
def test_duals_of_the_relaxation_prove_all_of_its_value_and_no_more_than_the_optimum(seed: int) -> None:
    problem = KINDS["products"](np.random.default_rng([seed, 11]))
    known = truth(problem)
    if known.value is None or "linear-products" not in problem.forms():
        return
    made = problem.compile("linear-products")
    relaxed = made.relaxed().program
    result = LinearSession(relaxed).solve(NEVER)
    assert made.dual_evidence is not None
    evidence = made.dual_evidence(result.duals)
    bound, sign = verified_bound(problem, evidence), 1.0 if problem.sense == "min" else -1.0
    size = max(abs(result.value), float(np.abs(relaxed.cost).sum()))
    assert sign * bound >= sign * result.value - 1e-6 * size
    assert sign * bound <= sign * float(known.value) + 1e-9 * size


@pytest.mark.parametrize(
    ("cost", "integer", "quadratic", "lacking"),
    [([1, 1], [], [[2, 0], [0, 2]], "MIQP"), ([1, 1], [0], None, "MIQP"), ([1, 1], [0], [[0, 0], [0, 2]], "squares of variables")],
)
def test_other_programs_are_refused_by_name(cost, integer, quadratic, lacking) -> None:
    problem = ArrayProblem(program(cost, [[1, 1]], 0, 1, 0, 1, integer=integer, quadratic=quadratic))
    assert problem.forms() == ["arrays"]
    with pytest.raises(UnsupportedError, match=lacking):
        problem.compile("linear-products")
