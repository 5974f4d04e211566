import math

import numpy as np
import pytest
from programs import program

from waybound.formulations.programs.duals import dual_value


@pytest.mark.parametrize("unit", [1.0, 1e-12, 1e12])
def test_the_value_of_duals_is_in_proportion_whatever_the_unit(unit: float) -> None:
    """min 3 x0 + 2 x1 with x0 + x1 >= 4, x0 - x1 = 1: 10.5 at (2.5, 1.5), duals (2.5, 0.5)."""
    p = program([3.0 * unit, 2.0 * unit], [[1, 1], [1, -1]], [4.0, 1.0], [math.inf, 1.0], 0.0, math.inf)
    assert dual_value(p, np.array([2.5, 0.5]) * unit) == pytest.approx(10.5 * unit, rel=1e-12)
    assert dual_value(p, np.array([2.5, 0.5 + 1e-12]) * unit) == pytest.approx(10.5 * unit, rel=1e-9)
    assert dual_value(p, np.array([2.5, 0.6]) * unit) == -math.inf
    assert dual_value(p, np.array([-2.5, 0.5]) * unit) == -math.inf
