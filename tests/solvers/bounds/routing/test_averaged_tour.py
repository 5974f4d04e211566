"""The better of a tree and of walks is shared by all vehicles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from small_routing import plane
from truth.routing import best_values

from waybound.formulations.certificate import verified_bound
from waybound.formulations.routing.objective import LongestRoute, Makespan, Objective
from waybound.formulations.stop import Stop
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.averaged_tour import averaged_tour


def test_the_mean_of_two_routes_is_close_to_the_longer_one():
    problem = replace(plane(2, 6, 100.0, 2), objective=Objective.of(LongestRoute()))
    evidence, best = averaged_tour(problem, Stop(60.0)), best_values(problem)
    assert evidence is not None and best is not None
    assert 0.6 * float(best[0]) <= verified_bound(problem, evidence) <= float(best[0])


def test_sites_that_may_be_left_out_are_left_to_walks():
    problem = replace(plane(2, 5, 100.0, 2), objective=Objective.of(Makespan()))
    problem = replace(problem, sites=replace(problem.sites, required=np.arange(6) > 2))
    evidence, best = averaged_tour(problem, Stop(60.0)), best_values(problem)
    assert evidence is not None and best is not None
    assert evidence.data["kind"] == "state-space"
    assert 0.0 < verified_bound(problem, evidence) <= float(best[0])


def test_weighted_sums_are_refused():
    problem = replace(plane(2, 5, 100.0, 2), objective=Objective.of(Makespan() + LongestRoute()))
    assert BOUNDS["averaged-tour"].missing(problem) == {"objective:weights"}
    assert not BOUNDS["farthest-round-trip"].missing(problem)
