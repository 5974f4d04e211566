"""The ascent meets the maximum of concave functions, and says where it has none."""

import math

import numpy as np
import pytest

from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.bounds.routing.subgradient_ascent import ascend


def test_a_roof_is_climbed():
    def look(x):
        return float(7.0 - np.abs(x - [3.0, -1.0]).sum()), -np.sign(x - [3.0, -1.0])

    price, value = ascend(look, np.zeros(2), 1e-3, 1e9, NEVER)
    assert value == pytest.approx(7.0, abs=1e-6)
    assert price == pytest.approx([3.0, -1.0], abs=1e-6)


def test_it_ends_in_time_and_where_values_rise_for_ever():
    assert ascend(lambda x: (float(x[0]), np.ones(1)), np.zeros(1), 1.0, 100.0, NEVER)[1] > 100.0
    assert ascend(lambda x: (math.inf, np.ones(1)), np.zeros(1), 1.0, 100.0, NEVER)[1] == math.inf
    assert ascend(lambda x: (-float(x @ x), -2.0 * x), np.ones(1), 1.0, 100.0, Stop(0.0))[1] == -1.0
