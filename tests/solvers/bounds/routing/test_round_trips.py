"""The farthest round trip is found for maxima, and for nothing else."""

from __future__ import annotations

from dataclasses import replace

import pytest
from small_routing import plane

from waybound.formulations.certificate import verified_bound
from waybound.formulations.routing.objective import LongestRoute, Makespan, Objective, TotalCost
from waybound.formulations.stop import Stop
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.round_trips import farthest_round_trip


def test_there_and_back_to_the_farthest_site():
    problem = replace(plane(1, 8, 100.0, 3), objective=Objective.of(LongestRoute()))
    evidence = farthest_round_trip(problem)
    assert evidence is not None
    assert verified_bound(problem, evidence) == pytest.approx(2.0 * problem.travel.distances[0].max(), rel=0.03)
    assert farthest_round_trip(problem, Stop(0.0)) is None


def test_terms_that_are_no_maximum_are_named():
    problem = plane(1, 4, 100.0)
    missing = BOUNDS["farthest-round-trip"].missing
    assert missing(problem) == {"objective:total-cost"}
    assert not missing(replace(problem, objective=Objective.of(Makespan())))
    assert missing(replace(problem, objective=Objective.of(TotalCost() + Makespan()))) == {"objective:total-cost"}
