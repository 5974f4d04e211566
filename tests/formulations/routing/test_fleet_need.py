import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from truth.routing import best_values

from waybound import RoutingProblem, Sites, Travel, VehicleType
from waybound.formulations.routing.fleet_need import bin_packing_bound, fleet_conflicts


def problem(demand, *, count, capacity=10.0, ready=0.0, due=np.inf, service=0.0, xy=None, min_vehicles=0):
    n = len(demand) + 1
    xy = np.column_stack([np.arange(n), np.zeros(n)]) if xy is None else np.asarray(xy, dtype=float)
    pad = lambda v: np.concatenate([[0.0], np.broadcast_to(v, n - 1)])  # noqa: E731
    window = np.concatenate([[np.inf], np.broadcast_to(due, n - 1)])
    sites = Sites.of(range(n), demand=pad(demand), ready=pad(ready), due=window, service=pad(service), coordinates=xy)
    return RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(count, capacity),), min_vehicles=min_vehicles)


def reasons(asked):
    return [found.source for found in fleet_conflicts(asked)]


def test_a_total_demand_beyond_the_fleet_is_told_with_both_amounts():
    (reason,) = reasons(problem([6, 6, 6], count=1, capacity=17))[:1]
    assert "18" in reason
    assert "17" in reason


def test_demands_that_fit_in_sum_but_not_in_bins_are_found():
    assert any("at least 3 vehicles" in r for r in reasons(problem([6, 6, 6], count=2, capacity=10)))


def test_sites_due_at_one_time_far_apart_need_a_vehicle_each():
    xy = [(0, 0), (10, 0), (-10, 0), (0, 10), (0, -10)]
    assert any("no two of these 4 sites" in r and "1, 2, 3, 4" in r for r in reasons(problem([1, 1, 1, 1], count=3, due=11.0, xy=xy)))


def test_more_routes_than_sites_are_refused():
    assert any("at least 4 routes" in r for r in reasons(problem([1, 1, 1], count=5, min_vehicles=4)))


@pytest.mark.parametrize("count", [None, 3])
def test_a_fleet_that_suffices_raises_no_conflict(count):
    assert reasons(problem([5, 5, 5, 5, 5], count=count)) == []


def test_two_customers_at_one_address_share_a_route():
    xy = [(0, 0), (3, 4), (3, 4)]
    assert reasons(problem([1, 1], count=1, due=[5, 6], xy=xy)) == []
    assert reasons(problem([1, 1], count=1, due=[5, 5], service=1, xy=xy)) == [
        "no two of these 2 sites fit on one route, and the fleet has 1 vehicle: 1, 2"
    ]


def test_a_depot_is_no_way_station():
    """From 1 to 2 it is 9; over the depot, where no route passes, it would be 2."""
    matrix = np.array([[0, 1, 1], [1, 0, 9], [1, 9, 0]], dtype=float)
    sites = Sites.of("oab", due=[math.inf, 5, 5])
    asked = RoutingProblem(sites, Travel("EXPLICIT", matrix=matrix), (VehicleType(1),))
    assert reasons(asked) == ["no two of these 2 sites fit on one route, and the fleet has 1 vehicle: a, b"]


def test_sites_that_only_few_vehicles_can_serve_are_told_with_the_type():
    asked = problem([5, 5, 5, 1], count=1)
    small, large = VehicleType(9, 4.0, name="small"), VehicleType(2, 9.0, name="large")
    (reason,) = reasons(replace(asked, fleet=(small, large)))
    assert (
        reason
        == "no two of these 3 sites fit on one route, and only vehicles of type large, of which there are 2, can serve any of them: 1, 2, 3"
    )


def test_work_beyond_the_hours_of_the_fleet_is_told():
    asked = problem([1, 1, 1, 1], count=2, service=5.0)
    assert "driving and service" in reasons(replace(asked, fleet=(VehicleType(2, max_duration=12.0),)))[0]


@pytest.mark.slow
def test_too_many_sites_before_one_hour_are_told():
    """Fourteen at one place, 10 away, served in 1 each and due at 21.5: the last would begin at 23."""
    asked = problem([1] * 14, count=1, capacity=99.0, due=21.5, service=1.0, xy=[(0, 0), *[(10, 0)] * 14])
    assert reasons(asked) == [
        "these 14 sites can only be begun from 10 to 21.5, and keep 1 vehicle busy for longer than that: "
        + ", ".join(map(str, range(1, 15)))
    ]
    assert reasons(replace(asked, fleet=(VehicleType(2),))) == []


def three_at_once(**fleet):
    """Three customers of which any two, but not all three, fit on one route."""
    angles = np.deg2rad([0.0, 120.0, 240.0])
    xy = np.vstack([[0.0, 0.0], 10.0 * np.column_stack([np.cos(angles), np.sin(angles)])])
    return problem([1, 1, 1], ready=10.0, due=30.0, xy=xy, **fleet)


def test_three_sites_of_which_any_two_fit_are_told_together():
    assert reasons(three_at_once(count=1)) == ["no choice of routes lets 1 vehicle serve these 3 sites: 1, 2, 3"]
    assert reasons(three_at_once(count=2)) == []


@pytest.mark.slow
def test_the_few_sites_to_blame_are_found_among_many():
    asked = three_at_once(count=1)
    far = Sites.of(
        range(16), ready=[0, 10, 10, 10, *[0] * 12], due=[np.inf, 30, 30, 30, *[np.inf] * 12],
        coordinates=np.vstack([asked.sites.coordinates, np.zeros((12, 2))]),
    )  # fmt: skip
    assert reasons(replace(asked, sites=far, travel=Travel("euclidean", far.coordinates))) == [
        "no choice of routes lets 1 vehicle serve these 3 sites: 1, 2, 3"
    ]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", [1e9, 1e20, 1e300, 1.7e308])
def test_large_numbers_meant_as_unlimited_hide_no_reason_and_make_none(size):
    fleet = (VehicleType(1, size, max_duration=size, max_distance=size),)
    apart = problem([1, 1, 1], count=1, due=[11, 11, size], xy=[(0, 0), (10, 0), (-10, 0), (0, 10)])
    assert reasons(replace(apart, fleet=fleet)) == ["no two of these 2 sites fit on one route, and the fleet has 1 vehicle: 1, 2"]
    assert reasons(replace(problem([1, 1, 1], count=1, due=[size, size, 11]), fleet=fleet)) == []


@pytest.mark.filterwarnings("error")
def test_numbers_as_large_as_an_instance_takes_are_added_up():
    xy = np.array([[0, 0], [1, 0], [0, 1], [1, 1]]) * 1e150
    assert reasons(problem([1, 1, 1], count=1, xy=xy)) == []
    too_much = reasons(problem([1e150] * 4, count=2, capacity=1e150))
    assert too_much[0] == "the required sites demand 4e+150 in total, 2 vehicles can carry 2e+150"


def fits(demand, bins, capacity):
    """Whether the demands fit, by trying every assignment."""
    return any(
        all(sum(d for d, b in zip(demand, place, strict=True) if b == k) <= capacity for k in range(bins))
        for place in itertools.product(range(bins), repeat=len(demand))
    )


def test_vehicles_without_room_need_a_bin_an_item():
    assert bin_packing_bound(np.array([1.0, 2.0]), 0.0) == (2, 0.0)
    assert bin_packing_bound(np.array([1.0, 2.0]), np.inf) == (1, 0.0)
    assert bin_packing_bound(np.array([]), np.inf) == (0, 0.0)


@given(st.lists(st.integers(1, 10), min_size=1, max_size=6))
def test_the_bin_packing_bound_never_exceeds_the_true_number_of_bins(demand):
    bound, _ = bin_packing_bound(np.array(demand, dtype=float), 10.0)
    true = next(b for b in range(1, 7) if fits(demand, b, 10))
    assert -(-sum(demand) // 10) <= bound <= true


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=draws(60), deadline=None)
def test_a_conflict_is_never_told_where_an_answer_exists(seed):
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 5))
    asked = problem(
        rng.integers(1, 7, n), count=int(rng.integers(1, 3)), ready=(r := rng.integers(0, 20, n)), due=r + rng.integers(1, 30, n),
        service=rng.integers(0, 4), xy=rng.integers(-8, 9, (n + 1, 2)), min_vehicles=0,
    )  # fmt: skip
    if reasons(asked):
        assert best_values(asked) is None
