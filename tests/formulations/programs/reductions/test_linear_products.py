import itertools

import numpy as np
import pytest
from hypothesis import given, strategies as st

from tests.program_text import expected, program_text
from tests.programs import INF, program
from waybound.formulations.programs.reductions.linear_products import LINEAR_PRODUCTS
from waybound.formulations.programs.reductions.reduction import Irreducible
from waybound.solvers.backend import Control, Options
from waybound.solvers.backends.highs import Highs


def test_products_that_shall_be_large_are_held_from_above_and_squares_of_binaries_are_linear() -> None:
    given = program([1, 2], [[1, 1]], -INF, 3, 0, [1, 3], integer=[0], sense="max", quadratic=[[8, 5], [5, 0]])
    (step,) = LINEAR_PRODUCTS.apply(given)
    assert program_text(step.program) == expected("""
        max 5 x0 + 2 x1 + 5 product[0,1]
        row: x0 + x1 <= 3
        product_of_0[0]: - 3 x0 + product[0,1] <= 0
        product_of_1[0]: - x1 + product[0,1] <= 0
        x0 binary
        0 <= x1, product[0,1] <= 3
    """)
    assert step.encoded(np.array([1.0, 2.0])).tolist() == [1.0, 2.0, 2.0]
    assert step.vector(np.array([1.0, 2.0, 2.0])).tolist() == [1.0, 2.0]


@given(st.integers(0, 10**6))
def test_the_optimum_stays_where_it_was(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, sense = int(rng.integers(2, 5)), str(rng.choice(["min", "max"]))
    q = rng.integers(-5, 6, (n, n)).astype(float)
    q = q + q.T
    low = np.where(rng.random(n) < 0.6, 0, rng.integers(-3, 1, n))
    high = np.where(low == 0, 1, low + rng.integers(1, 5, n))
    binary = (low == 0) & (high == 1)
    q[np.ix_(~binary, ~binary)] = 0.0
    matrix = rng.integers(-2, 4, (2, n))
    p = program(
        rng.integers(-9, 10, n), matrix, -INF, matrix @ low + rng.integers(0, 9, 2), low, high, integer=range(n), sense=sense, quadratic=q
    )
    points = (np.array(x, float) for x in itertools.product(*(range(a, b + 1) for a, b in zip(low, high, strict=True))))
    values = [p.value(x) for x in points if p.residual(x) <= 1e-9]
    result = Highs().run(p, Options(), Control())
    best = min(values) if sense == "min" else max(values)
    assert result.objective == pytest.approx(best) and result.status in ("optimal", "feasible")
    worth = 1e-6 * (np.abs(p.cost).sum() + (np.abs(q) @ np.maximum(np.abs(low), np.abs(high))).sum())  # of what HiGHS takes for whole
    assert result.status == "optimal" or abs(result.bound - best) <= worth
    assert "linear-products" in [link.name for link in result.links] or not q.any()


@pytest.mark.parametrize(
    ("integer", "quadratic", "upper", "feature"),
    [
        ([0, 1], [[0, 1], [1, 0]], [2, 2], "neither variable is binary"), ([0], [[1, 1], [1, 1]], [1, 2], "squares"),
        ([0], [[0, 1], [1, 0]], [1, INF], "no bounds"),
    ],
)  # fmt: skip
def test_what_has_no_exact_linear_form_is_named(integer, quadratic, upper, feature: str) -> None:
    with pytest.raises(Irreducible, match=feature):
        LINEAR_PRODUCTS.apply(program([1, 1], [[1, 1]], 0, 1, 0, upper, integer=integer, quadratic=quadratic))


def test_continuous_and_linear_programs_are_left_alone() -> None:
    assert LINEAR_PRODUCTS.apply(program([1, 1], [[1, 1]], 0, 1, 0, 1, quadratic=[[1, 0], [0, 1]])) == ()
    assert LINEAR_PRODUCTS.apply(program([1, 1], [[1, 1]], 0, 1, 0, 1, integer=[0])) == ()
