from dataclasses import replace

import numpy as np
import pytest
from small_routing import plane
from truth.routing import best_values

from waybound import LongestRoute, Makespan, Objective, TotalCost
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.routing.largest_route import averaged_tour, farthest_round_trip


def test_there_and_back_to_the_farthest_site():
    problem = replace(plane(1, 8, 100.0, 3), objective=Objective.of(LongestRoute()))
    evidence = farthest_round_trip(problem)
    assert verified_bound(problem, evidence) == pytest.approx(2.0 * problem.travel.distances[0].max(), rel=0.03)
    assert farthest_round_trip(problem, Stop(0.0)) is None


def test_terms_that_are_no_maximum_are_named():
    problem = plane(1, 4, 100.0)
    missing = BOUNDS["farthest-round-trip"].missing
    assert missing(problem) == {"objective:total-cost"}
    assert not missing(replace(problem, objective=Objective.of(Makespan())))
    assert missing(replace(problem, objective=Objective.of(TotalCost() + Makespan()))) == {"objective:total-cost"}


def test_the_mean_of_two_routes_is_close_to_the_longer_one():
    problem = replace(plane(2, 6, 100.0, 2), objective=Objective.of(LongestRoute()))
    evidence, best = averaged_tour(problem, Stop(60.0)), best_values(problem)
    assert 0.6 * float(best[0]) <= verified_bound(problem, evidence) <= float(best[0])


def test_sites_that_may_be_left_out_are_left_to_walks():
    problem = replace(plane(2, 5, 100.0, 2), objective=Objective.of(Makespan()))
    problem = replace(problem, sites=replace(problem.sites, required=np.arange(6) > 2))
    evidence, best = averaged_tour(problem, Stop(60.0)), best_values(problem)
    assert evidence.data["kind"] == "state-space"
    assert 0.0 < verified_bound(problem, evidence) <= float(best[0])


def test_weighted_sums_are_refused():
    problem = replace(plane(2, 5, 100.0, 2), objective=Objective.of(Makespan() + LongestRoute()))
    assert BOUNDS["averaged-tour"].missing(problem) == {"objective:weights"}
    assert not BOUNDS["farthest-round-trip"].missing(problem)
