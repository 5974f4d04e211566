"""Optima of small routing problems: what is beyond enumeration; ``test_routing`` compares those that are found."""

import numpy as np
import pytest

from waybound import CheckFailedError, RoutingProblem, Sites, Travel, UsageError, VehicleType
from waybound.reports.ratios.optimum import optimum


def test_routes_beyond_what_is_enumerated_are_refused():
    travel = Travel("euclidean", np.arange(24.0).reshape(12, 2))
    with pytest.raises(UsageError, match="11 customers are too many"):
        optimum(RoutingProblem(Sites.of(range(12)), travel, (VehicleType(),)))
    small = Travel("euclidean", np.arange(6.0).reshape(3, 2))
    with pytest.raises(UsageError, match="time-windows"):
        optimum(RoutingProblem(Sites.of(range(3), due=[9, 1, 1]), small, (VehicleType(),)))
    with pytest.raises(CheckFailedError, match="no 1 routes"):
        optimum(RoutingProblem(Sites.of(range(3), demand=[0, 1, 1]), small, (VehicleType(count=1, capacity=1.0),)))
