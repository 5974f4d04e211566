import numpy as np
import pytest
from coded import coded
from program_text import expected, program_text
from programs import INF, program

from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.stop import NEVER
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.errors import InputError, UnsupportedError
from waybound.reports.battery.kinds import KINDS
from waybound.reports.battery.truth import truth
from waybound.solvers.linear_session import LinearSession


def test_arrays_from_text_to_text() -> None:
    given = program(
        cost=[3, 2, -1], matrix=[[2, 3, 0], [1, 0, -1]], low=[-INF, 1], high=[10.5, 4], lower=[0, 0, -2], upper=[4, 1, INF],
        integer=[0, 1], sense="max", offset=7, quadratic=[[-2, 1, 0], [1, 0, 0], [0, 0, 0]],
    )  # fmt: skip
    compiled = ArrayProblem(given).compile("arrays")
    assert program_text(compiled.program) == expected("""
        max 3 x0 + 2 x1 - x2 - x0^2 + x0 x1 + 7
        row[0]: 2 x0 + 3 x1 <= 10.5
        row[1]: 1 <= x0 - x2 <= 4
        0 <= x0 <= 4 integer
        x1 binary
        x2 >= -2
    """)


def test_the_form_gives_the_program_its_name_and_changes_no_number() -> None:
    given = program([3, 2], [[2, 3]], -INF, 10.5, 0, [4, 5], integer=[0, 1], sense="max")
    compiled = ArrayProblem(given).compile("arrays").program
    assert compiled.name == "arrays"
    assert program_text(compiled) == program_text(given)


def test_row_duals_of_either_sign_prove_the_relaxation() -> None:
    """max 3 x0 + 2 x1 with 2 x0 + 3 x1 <= 10.5 in [0,4] x [0,5]: 12 + 2 (2.5 / 3) with the price 2/3."""
    problem = ArrayProblem(program([3, 2], [[2, 3]], -INF, 10.5, 0, [4, 5], sense="max"))
    compiled = problem.compile("arrays")
    assert compiled.dual_evidence is not None
    for duals in (np.array([2 / 3]), np.array([-2 / 3])):
        evidence = compiled.dual_evidence(duals)
        assert evidence.kind == "lp-dual"
        assert verified_bound(problem, evidence) == pytest.approx(12 + 5 / 3)


def test_duals_of_a_quadratic_program_are_no_evidence() -> None:
    assert ArrayProblem(program([1], [[1]], 0, 1, quadratic=[[2]])).compile("arrays").dual_evidence is None


def test_a_start_of_another_shape_is_refused() -> None:
    compiled = ArrayProblem(program([1, 1], [[1, 1]], 0, 1)).compile("arrays")
    assert compiled.encode([0, 1]).tolist() == [0.0, 1.0]
    with pytest.raises(InputError, check=coded("wrong-shape")):
        compiled.encode([1, 2, 3])


GIVEN = ArrayProblem(program([1, 2], [[1, 1]], -INF, 3, [0, -1], [1, 2], integer=[0], sense="max", offset=4, quadratic=[[6, 3], [3, 0]]))


def test_linear_products_from_text_to_text() -> None:
    assert program_text(GIVEN.compile("linear-products").program) == expected("""
        max 4 x0 + 2 x1 + 3 product[0,1] + 4
        row: x0 + x1 <= 3
        product_of_0[0]: - 2 x0 + product[0,1] <= 0
        product_of_1[0]: x0 - x1 + product[0,1] <= 1
        x0 binary
        -1 <= x1, product[0,1] <= 2
    """)


def test_answers_are_vectors_of_the_program_itself() -> None:
    compiled = GIVEN.compile("linear-products")
    x = compiled.encode(np.array([1.0, 2.0]))
    assert x.tolist() == [1.0, 2.0, 2.0]
    assert compiled.program.value(x) == GIVEN.program.value(np.array([1.0, 2.0]))
    assert compiled.decode(x).tolist() == [1.0, 2.0]


@pytest.mark.parametrize("seed", range(40))
def test_duals_of_the_relaxation_prove_all_of_its_value_and_no_more_than_the_optimum(seed: int) -> None:
    problem = KINDS["products"](np.random.default_rng([seed, 11]))
    known = truth(problem)
    if known.value is None or "linear-products" not in problem.forms():
        return
    compiled = problem.compile("linear-products")
    relaxed = compiled.relaxed().program
    result = LinearSession(relaxed).solve(NEVER)
    evidence = compiled.dual_evidence(result.duals)
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
