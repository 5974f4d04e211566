"""Lines below a quadratic objective, with any duals and shares, prove no more than the optimum; it is known by enumeration in fractions."""

import math

import numpy as np
import pytest
from coded import coded
from draws import draws
from programs import INF, program

from waybound.formulations.arrays.checking import quadratic_duals
from waybound.formulations.arrays.checking.quadratic_duals import check_quadratic_duals
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.instances.errors import InputError
from waybound.reports.battery.kinds import KINDS
from waybound.reports.battery.truth import truth

SQUARE = ArrayProblem(program([-4.0], [[1.0]], -INF, 10.0, 0.0, 5.0, quadratic=[[2.0]]))
"""x^2 - 4 x over 0..5: -4 at 2."""
PRODUCT = ArrayProblem(program([1.0, 1.0], [[1.0, 1.0]], -INF, 3.0, [0, -1], [1, 2], integer=[0], quadratic=[[0, -3.0], [-3.0, 0]]))
"""x + y - 3 x y, x binary and -1 <= y <= 2: -3 at (1, 2)."""


@pytest.mark.share(3)
@pytest.mark.parametrize(("kind", "seed"), [(kind, seed) for kind in ("squares", "products") for seed in range(draws(60))])
def test_no_duals_shares_and_points_prove_more_than_is_true(kind: str, seed: int) -> None:
    rng = np.random.default_rng([seed, 7])
    problem = KINDS[kind](rng)
    known = truth(problem)
    p = problem.program  # type: ignore[attr-defined]
    count = int(np.count_nonzero(np.triu(p.quadratic.toarray(), 1)))
    sign = 1.0 if p.sense == "min" else -1.0
    price = float(np.abs(p.cost).max(initial=1.0))
    for _ in range(20):
        data = {"duals": (price * rng.normal(size=p.num_rows)).round(2).tolist(), "point": (2 * rng.normal(size=p.num_variables)).tolist()}
        if rng.random() < 0.7:
            data["shares"] = rng.uniform(-0.5, 1.5, count).tolist()
        bound = check_quadratic_duals(problem, data)
        if known.value is not None:
            assert sign * bound <= sign * float(known.value) + 1e-9 * max(price, abs(float(known.value)))
        else:
            assert bound != sign * INF


def test_the_tangent_at_the_optimum_is_worth_it() -> None:
    assert check_quadratic_duals(SQUARE, {"duals": [0.0], "point": [2.0]}) == pytest.approx(-4.0)
    assert check_quadratic_duals(SQUARE, {"duals": [0.0], "point": [2.5]}) == pytest.approx(-6.25)


@pytest.mark.parametrize(("quadratic", "convex"), [([[2, 2], [2, 2]], True), ([[2, 2.001], [2.001, 2]], False), ([[0, 1], [1, 0]], False)])
def test_a_tangent_is_below_a_convex_function_alone(quadratic: list[list[float]], convex: bool) -> None:
    problem = ArrayProblem(program([0, 0], np.zeros((0, 2)), [], [], -1.0, 1.0, quadratic=quadratic))
    assert math.isfinite(check_quadratic_duals(problem, {"duals": []})) is convex


def test_whether_a_matrix_is_semidefinite_agrees_with_its_eigenvalues() -> None:
    rng = np.random.default_rng(5)
    for _ in range(200):
        n = int(rng.integers(1, 5))
        factor = rng.integers(-2, 3, (int(rng.integers(1, n + 1)), n))
        matrix = (factor.T @ factor).astype(float)
        if rng.random() < 0.5:
            matrix[-1, -1] -= 1.0
        problem = ArrayProblem(program(np.zeros(n), np.zeros((0, n)), [], [], -1.0, 1.0, quadratic=matrix))
        convex = float(np.linalg.eigvalsh(matrix).min()) > -1e-9
        assert math.isfinite(check_quadratic_duals(problem, {"duals": []})) is convex


def test_much_work_on_a_matrix_proves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(quadratic_duals, "MOST_STEPS", 0)
    problem = ArrayProblem(program([0, 0], np.zeros((0, 2)), [], [], -1.0, 1.0, quadratic=[[2, 1], [1, 2]]))
    assert check_quadratic_duals(problem, {"duals": []}) == -INF


def test_a_fixed_factor_makes_the_product_exact() -> None:
    one = PRODUCT.restricted([({"variable": 0, "most": 0}, False)])
    none = PRODUCT.restricted([({"variable": 0, "most": 0}, True)])
    for share in (0.0, 0.3, 1.0):
        assert check_quadratic_duals(one, {"duals": [0.0], "shares": [share]}) == pytest.approx(-3.0)
        assert check_quadratic_duals(none, {"duals": [0.0], "shares": [share]}) == pytest.approx(-1.0)


def test_squares_of_integers_take_the_line_through_two_neighbours() -> None:
    problem = ArrayProblem(program([-3.0], np.zeros((0, 1)), [], [], -5.0, 5.0, integer=[0], quadratic=[[2.0]]))
    assert check_quadratic_duals(problem, {"duals": [], "shares": [], "point": [1.7]}) == pytest.approx(-2.0)  # x^2 - 3 x at 1 and 2
    concave = ArrayProblem(program([0.0], np.zeros((0, 1)), [], [], -2.0, 3.0, quadratic=[[-2.0]]))
    assert check_quadratic_duals(concave, {"duals": [], "shares": []}) == pytest.approx(-9.0)


def test_terms_without_the_limits_that_they_take_prove_nothing() -> None:
    free = ArrayProblem(program([0.0, 0.0], np.zeros((0, 2)), [], [], 0.0, [1.0, INF], integer=[0], quadratic=[[0, 1], [1, 0]]))
    assert check_quadratic_duals(free, {"duals": [], "shares": [0.5]}) == -INF


def test_limits_that_cross_leave_no_answer() -> None:
    crossed = PRODUCT.restricted([({"variable": 0, "most": -1}, True)])
    assert check_quadratic_duals(crossed, {"duals": [0.0], "shares": [0.5]}) == INF


@pytest.mark.parametrize(
    "data", [{}, {"duals": [0.0, 1.0]}, {"duals": [0.0], "shares": []}, {"duals": [0.0], "point": [1.0]}, {"duals": [True]}]
)
def test_lists_that_do_not_fit_are_refused(data: dict[str, object]) -> None:
    with pytest.raises(InputError):
        check_quadratic_duals(PRODUCT, data)


def test_a_linear_objective_has_evidence_of_another_kind() -> None:
    with pytest.raises(InputError, check=coded("foreign")):
        check_quadratic_duals(ArrayProblem(program([1.0], [[1.0]], 0, 1)), {"duals": [0.0]})
