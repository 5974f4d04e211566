"""Loads ask for as many vehicles as the bound L2 says, and no more than any answer has."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from small_routing import WHOLE_FAMILY, few, plane, varied
from truth.routing import best_values

from waybound.formulations.routing.checking.vehicles_needed import check_vehicles_needed
from waybound.formulations.routing.objective import Makespan, Objective, Reward, TotalCost, Vehicles
from waybound.instances.errors import InputError


@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_no_threshold_excludes_the_optimum(feature):
    for seed in range(2):
        goal = (Vehicles(), 5.0 * Vehicles() + TotalCost(), Vehicles() + Makespan())[seed % 3]
        problem = replace(varied(feature, seed, few(feature)), objective=Objective.of(goal))
        best = best_values(problem)
        for threshold in (-1.0, 0.0, 1.0, 3.0, 5.5, 100.0) if best is not None else ():
            assert check_vehicles_needed(problem, {"threshold": threshold}) <= float(best[0]) + 1e-9


def test_large_loads_share_no_vehicle():
    problem = replace(plane(1, 4, 10.0), objective=Objective.of(Vehicles()))
    problem = replace(problem, sites=replace(problem.sites, demand=problem.sites.demand * 0 + [0, 6, 6, 6, 4]))
    assert check_vehicles_needed(problem, {"threshold": 0.0}) == 3.0
    problem = replace(problem, sites=replace(problem.sites, demand=problem.sites.demand * 0 + [0, 6, 6, 5, 5]))
    assert check_vehicles_needed(problem, {"threshold": 5.0}) == 3.0
    assert check_vehicles_needed(replace(problem, min_vehicles=4), {"threshold": 5.0}) == 4.0


def test_other_objectives_and_malformed_evidence():
    problem = plane(1, 4, 10.0)
    assert check_vehicles_needed(replace(problem, objective=Objective.of(Reward())), {"threshold": 0.0}) == math.inf
    with pytest.raises(InputError):
        check_vehicles_needed(problem, {"threshold": "x"})
