"""The mean of all routes bounds the largest, whatever is claimed of their sum."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import WHOLE_FAMILY, few, varied
from truth.routing import best_values

from waybound.formulations.routing.checking.averaged_tour import check_averaged_tour, totals
from waybound.formulations.routing.objective import LatestReturn, LongestRoute, Makespan, Objective, TotalCost
from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.errors import InputError
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_no_claim_excludes_the_optimum(feature):
    rng = np.random.default_rng(5)
    for seed in range(2):
        problem = varied(feature, seed, few(feature))
        for term in (Makespan(), LongestRoute(), 2.0 * LatestReturn()):
            asked = replace(problem, objective=Objective.of(term))
            best = best_values(asked)
            if best is None:
                continue
            for scale in (0.0, 5.0, 20.0):
                prices = (scale * rng.normal(0.5, 1.0, len(asked.sites))).tolist()
                for kind, data in (
                    ("spanning-tree", {"multipliers": prices}), ("state-space", {"prices": prices, "resource": "order", "step": 1.0}),
                ):  # fmt: skip
                    assert check_averaged_tour(asked, {"kind": kind, "data": data}) <= float(best[0]) + 1e-9


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
