"""Without stops on the way, vehicles reach everything at no more than it cost with them, and nothing that starts anew is limited."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import plane, varied
from truth.routing import best_values

from waybound.formulations.routing.checking.stops_on_the_way import without_stops
from waybound.instances.routing.instance import Energy, VehicleType


@pytest.mark.share(2)
@pytest.mark.parametrize("feature", ["reloads", "recharging"])
def test_no_optimum_gets_worse(feature):
    for seed in range(4):
        problem = varied(feature, seed, 3)
        relaxed = without_stops(problem)
        assert not {"reloads", "recharging"} & relaxed.features()
        before, after = best_values(problem), best_values(replace(relaxed))
        if before is not None:
            assert after is not None
            assert float(after[0]) <= float(before[0]) if problem.sense == "min" else float(after[0]) >= float(before[0])


def test_moves_lead_over_the_depots_of_the_vehicle():
    problem = plane(1, 3, 10.0)
    assert without_stops(problem) is problem
    matrix = np.full((4, 4), 9.0)
    matrix[0] = matrix[:, 0] = 1.0
    made = without_stops(replace(problem, fleet=(VehicleType(capacity=1.0, reloads=(0,)), VehicleType(energy=Energy(3.0)))))
    first, second = made.fleet
    assert first.capacity == math.inf and not first.reloads
    assert second.energy is not None and second.travel is not None
    d = problem.travel.distances
    assert first.travel is not None
    assert (first.travel.distances == np.minimum(d, d[:, :1] + d[:1])).all()
    assert (second.travel.distances == d).all()
