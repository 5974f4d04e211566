import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import WHOLE_FAMILY, enumerated, excludes, few, varied

from waybound import InputError, LatestReturn, LongestRoute, Makespan, Objective, RoutingProblem, Sites, TotalCost, VehicleType
from waybound.formulations.routing.checking.round_trips import check_averaged_tour, check_farthest_round_trip, totals
from waybound.instances.routing.travel import EXPLICIT, Travel

TERMS = {"makespan": Makespan(), "longest-route": LongestRoute(), "latest-return": LatestReturn()}


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_no_bound_exceeds_the_optimum(feature):
    for seed in range(2):
        problem = varied(feature, seed, few(feature))
        for term in TERMS.values():
            asked = replace(problem, objective=Objective.of(term))
            assert not excludes(asked, check_farthest_round_trip(asked, {}), 1e-12, 0.0)


@pytest.mark.parametrize(("term", "least"), [("makespan", 11.0), ("longest-route", 8.0), ("latest-return", 27.0)])
def test_ways_lead_over_other_sites_with_their_services_and_windows(term, least):
    matrix = np.array([[0, 2, 50], [2, 0, 2], [50, 2, 0]], dtype=float)
    sites = Sites.of("abc", service=[0, 1, 1], ready=[4, 0, 22])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix), (VehicleType(),), TERMS[term])
    assert check_farthest_round_trip(problem, {}) == pytest.approx(least + (1.0 if term == "latest-return" else 0.0))


def test_sites_that_may_be_left_out_and_other_objectives_prove_nothing():
    sites = Sites.of("abc", required=[False, False, False], ready=[4, 0, 0])
    travel = Travel(EXPLICIT, matrix=np.ones((3, 3)) - np.eye(3))
    problem = RoutingProblem(sites, travel, (VehicleType(),), Makespan())
    assert check_farthest_round_trip(problem, {}) == 0.0
    assert check_farthest_round_trip(replace(problem, objective=Objective.of(LatestReturn())), {}) == pytest.approx(4.0)
    assert check_farthest_round_trip(replace(problem, objective=Objective.of(TotalCost())), {}) == -math.inf
    assert check_farthest_round_trip(replace(problem, objective=Objective.of(Makespan() - LongestRoute())), {}) == -math.inf


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_no_claim_excludes_the_optimum(feature):
    rng = np.random.default_rng(5)
    for seed in range(2):
        problem = varied(feature, seed, few(feature))
        for term in (Makespan(), LongestRoute(), 2.0 * LatestReturn()):
            asked = replace(problem, objective=Objective.of(term))
            if enumerated(asked) is None:
                continue
            for scale in (0.0, 5.0, 20.0):
                prices = (scale * rng.normal(0.5, 1.0, len(asked.sites))).tolist()
                for kind, data in (
                    ("spanning-tree", {"multipliers": prices}), ("state-space", {"prices": prices, "resource": "order", "step": 1.0}),
                ):  # fmt: skip
                    assert not excludes(asked, check_averaged_tour(asked, {"kind": kind, "data": data}), 0.0)


def line(term, **vehicle):
    places = np.array([0.0, 5.0, -5.0])
    sites = Sites.of("abc", service=[0, 3, 3])
    return RoutingProblem(sites, Travel(EXPLICIT, matrix=np.abs(places[:, None] - places)), (VehicleType(**vehicle),), term)


@pytest.mark.parametrize(("term", "sum_"), [(LongestRoute(), 15.0), (Makespan(), 19.5), (LatestReturn(), 19.5)])
def test_a_sum_is_shared_by_all_vehicles(term, sum_):
    # A tree of two moves and the closing one, each 5 long and half a service of 3.
    data = {"kind": "spanning-tree", "data": {"multipliers": [0.0, 0.0, 0.0]}}
    assert check_averaged_tour(line(term, count=1), data) == pytest.approx(sum_)
    assert check_averaged_tour(line(term, count=2), data) == pytest.approx(sum_ / 2)


def test_what_is_no_single_maximum_has_no_sum():
    assert totals(line(TotalCost())) is None
    assert check_averaged_tour(line(TotalCost()), {"kind": "spanning-tree", "data": {"multipliers": [0.0] * 3}}) == -math.inf
    for wrong in ({}, {"kind": "averaged-tour", "data": {}}, {"kind": "spanning-tree", "data": [1]}):
        with pytest.raises(InputError):
            check_averaged_tour(line(Makespan()), wrong)
