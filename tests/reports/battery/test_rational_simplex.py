from fractions import Fraction

import numpy as np
import pytest
from scipy.optimize import linprog

from waybound.reports.battery.rational_simplex import minimised


@pytest.mark.parametrize("seed", range(40))
def test_it_agrees_with_floats_on_random_programs(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows, columns = (int(n) for n in rng.integers(1, 6, 2))
    matrix, limits, cost = rng.integers(-4, 7, (rows, columns)), rng.integers(-3, 12, rows), rng.integers(-6, 7, columns)
    exact = [[Fraction(int(v)) for v in row] for row in matrix]
    ours = minimised([Fraction(int(c)) for c in cost], exact, [Fraction(int(b)) for b in limits])
    theirs = linprog(cost, A_ub=matrix, b_ub=limits, bounds=(0, None))
    assert ours.status == {0: "optimal", 2: "infeasible", 3: "unbounded"}[theirs.status]
    if ours.status == "optimal":
        assert float(ours.value) == pytest.approx(theirs.fun, abs=1e-9)
        assert sum(Fraction(int(c)) * x for c, x in zip(cost, ours.point, strict=False)) == ours.value
        assert all(sum(a * x for a, x in zip(row, ours.point, strict=False)) <= int(b) for row, b in zip(exact, limits, strict=True))
