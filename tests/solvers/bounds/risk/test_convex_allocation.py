import pytest
from risk_problems import around_a_box, problem

import waybound as wb
from waybound.solvers.bounds import BOUNDS


@pytest.mark.parametrize(
    ("p", "bound"),
    [
        (problem(), 13.731143),
        (problem(risk__kind="joint"), 7.0 + 2.0 * (5.0 - 1.281552)),  # x2 with all of the risk, and x1 = 7 - x2
        (around_a_box(), 0.0),
    ],
    ids=["allocated", "joint", "alternatives"],
)
def test_it_is_verified(p, bound: float) -> None:
    assert wb.bound(p, bound_time=60.0).bound == pytest.approx(bound, abs=1e-5)


def test_it_stands_for_the_linear_relaxation() -> None:
    method = BOUNDS["convex-allocation"]
    assert method.replaces(problem()) == {"linear-relaxation"}
    assert method.missing(wb.read("demo-c25")) == {"routing problems"}
    assert not method.replaces(wb.read("demo-c25"))
