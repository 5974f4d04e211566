"""Fleets that are too small are proved so before any search."""

from __future__ import annotations

import math

import numpy as np
import pytest

from waybound.formulations.certificate import verified_bound
from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.stop import Stop
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import Travel
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing import fleet_need
from waybound.solvers.bounds.routing.fleet_need import fleet_need_evidence


def apart(count: int) -> RoutingProblem:
    """Four sites in four directions, all due when they can just be reached."""
    xy = np.array([[0, 0], [10, 0], [-10, 0], [0, 10], [0, -10]], dtype=float)
    return RoutingProblem(Sites.of(range(5), due=[math.inf, *[10] * 4]), Travel("euclidean", xy), (VehicleType(count),))


def test_sites_that_share_no_route_prove_a_fleet_too_small():
    problem = apart(3)
    found = fleet_need_evidence(problem, Stop(60.0))
    assert found is not None
    assert (found.kind, verified_bound(problem, found)) == ("sites-apart", math.inf)
    assert fleet_need_evidence(apart(4), Stop(60.0)) is None


def test_large_instances_are_left_alone(monkeypatch):
    monkeypatch.setattr(fleet_need, "MOST_SITES", 4)
    assert fleet_need_evidence(apart(3), Stop(60.0)) is None


@pytest.mark.parametrize("seconds", [0.0, -1.0])
def test_no_budget_means_no_search(seconds):
    assert fleet_need_evidence(apart(3), Stop(seconds)) is None


def test_it_comes_before_any_search_and_after_single_sites():
    assert BOUNDS["too-small-fleet"].order == 0
    names = [m.name for m in sorted(BOUNDS.values(), key=lambda m: m.order)]
    assert names.index("infeasible-site") < names.index("too-small-fleet")
