import math
from typing import Any

import numpy as np
import pytest

from waybound.instances.generating import generate


def made(seed: int = 4, **settings: Any) -> Any:
    return generate("uchoa", seed, **settings)


@pytest.mark.parametrize(("depot", "place"), [("C", [500, 500]), ("E", [0, 0])])
def test_the_depot_lies_where_it_is_asked_for(depot: str, place: list[int]) -> None:
    assert made(depot=depot).sites.coordinates[0].tolist() == place


def test_a_random_depot_moves_with_the_seed() -> None:
    assert made(1, depot="R").sites.coordinates[0].tolist() != made(2, depot="R").sites.coordinates[0].tolist()


@pytest.mark.parametrize("positions", ["R", "C", "RC"])
def test_all_sites_differ_and_lie_on_the_grid(positions: str) -> None:
    xy = made(customers=300, positions=positions).sites.coordinates
    assert len({tuple(p) for p in xy.tolist()}) == 301
    assert ((xy >= 0) & (xy <= 1000) & (xy == np.round(xy))).all()


@pytest.mark.parametrize("grid", [11, 3000])
def test_a_grid_of_another_size_is_filled_to_its_sides_and_not_beyond(grid: int) -> None:
    i = made(customers=30, grid=grid, positions="R", depot="C", demand="Q")
    xy = i.sites.coordinates
    assert xy[0].tolist() == [grid // 2, grid // 2]
    assert 0.75 * grid < xy.max() <= grid
    odd = (xy[1:, 0] >= grid / 2) == (xy[1:, 1] >= grid / 2)
    assert i.sites.demand[1:][odd].min() > 50 >= i.sites.demand[1:][~odd].max()


def test_clustered_customers_lie_near_their_seeds_as_the_law_of_attraction_says() -> None:
    """Under exp(-d/40) around few seeds the distance to the nearest of them has a mean of about 80 (a Gamma law of shape 2)."""
    xy = made(customers=2000, positions="C", seeds=3).sites.coordinates[1:]
    d = np.sqrt(((xy[:, None] - xy[None, :3]) ** 2).sum(axis=2)).min(axis=1)[3:]
    assert 60 < d.mean() < 95
    scattered = made(customers=2000, positions="R").sites.coordinates[1:]
    assert abs(float(scattered.mean()) - 500) < 20


def test_half_of_a_mix_is_clustered() -> None:
    xy = made(customers=1000, positions="RC", seeds=4).sites.coordinates[1:]
    seeds = xy[500:504]
    near = np.sqrt(((xy[:, None] - seeds[None]) ** 2).sum(axis=2)).min(axis=1) < 160
    assert near[504:].mean() > 0.75
    assert near[:500].mean() < 0.45


@pytest.mark.parametrize(("rule", "low", "high"), [("1-1", 1, 1), ("1-10", 1, 10), ("5-10", 5, 10), ("1-100", 1, 100), ("50-100", 50, 100)])
def test_demands_fill_their_range(rule: str, low: int, high: int) -> None:
    demand = made(customers=3000, positions="R", demand=rule).sites.demand[1:]
    assert (demand.min(), demand.max()) == (low, high)
    assert abs(float(demand.mean()) - (low + high) / 2) < 0.05 * (low + high)


def test_demands_by_quadrant_are_large_in_the_odd_ones() -> None:
    i = made(customers=500, positions="R", demand="Q")
    x, y = i.sites.coordinates[1:].T
    odd = (x >= 500) == (y >= 500)
    assert i.sites.demand[1:][odd].min() > 50
    assert i.sites.demand[1:][~odd].max() <= 50


def test_many_demands_are_small_and_few_are_large() -> None:
    for seed in range(5):
        demand = made(seed, customers=400, positions="R", demand="SL").sites.demand[1:]
        assert 0.70 <= (demand <= 10).mean() <= 0.95
        assert demand[demand > 10].min() >= 50


@pytest.mark.parametrize("length", [3.0, 6.5, 25.0])
def test_the_capacity_follows_from_the_length_of_routes(length: float) -> None:
    i = made(customers=200, demand="1-100", route_length=length)
    assert i.fleet[0].capacity == max(math.ceil(length * i.sites.demand.sum() / 200), i.sites.demand.max())
    assert i.fleet[0].count is None


def test_distances_are_those_of_tsplib() -> None:
    i = made()
    assert (i.travel.metric, i.travel.convention, i.problem) == ("EUC_2D", "file", "cvrp")
