"""The threshold that asks for most vehicles is found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from small_routing import plane

from waybound.formulations.certificate import verified_bound
from waybound.formulations.routing.objective import Objective, TotalCost, Vehicles
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.vehicles_needed import vehicles_needed


def test_large_loads_raise_the_number_beyond_the_sum():
    problem = replace(plane(1, 5, 10.0), objective=Objective.of(Vehicles().then(TotalCost())))
    problem = replace(problem, sites=replace(problem.sites, demand=np.array([0.0, 6, 6, 6, 5, 1])))
    evidence = vehicles_needed(problem)
    assert evidence is not None
    assert verified_bound(problem, evidence) == evidence.value == 4.0
    assert BOUNDS["vehicles-needed"].missing(plane(1, 5, 10.0))


def test_a_fleet_without_limit_of_load_needs_one() -> None:
    problem = replace(plane(1, 5, np.inf), objective=Objective.of(Vehicles().then(TotalCost())))
    evidence = vehicles_needed(problem)
    assert evidence is not None
    assert verified_bound(problem, evidence) == evidence.value == 1.0
