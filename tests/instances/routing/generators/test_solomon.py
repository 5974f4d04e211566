from typing import Any

import numpy as np
import pytest

from waybound.instances.generating import generate
from waybound.instances.routing.generators.solomon import CLASSES, _arrivals, _good_tour
from waybound.instances.routing.travel import Travel


def made(kind: str, **settings: Any) -> Any:
    return generate("solomon", 11, **{"class": kind}, **settings)


@pytest.mark.share(2)
@pytest.mark.parametrize("kind", sorted(CLASSES))
def test_a_class_has_the_figures_of_the_published_files(kind: str) -> None:
    i = made(kind)
    s = i.sites
    horizon = {"C1": 1236, "C2": 3390, "R1": 230, "R2": 1000, "RC1": 240, "RC2": 960}[kind]
    assert i.fleet[0].capacity == {"C1": 200, "C2": 700, "R1": 200, "R2": 1000, "RC1": 200, "RC2": 1000}[kind]
    assert i.fleet[0].count == 25
    assert s.due[0] == horizon if not kind.startswith("C") else s.due[0] >= horizon
    assert set(s.service[1:]) == {90 if kind.startswith("C") else 10}
    assert (i.problem, i.format, i.travel.convention) == ("vrptw", "generated", "exact")
    assert len({tuple(p) for p in s.coordinates.tolist()}) == 101
    assert np.array_equal(s.coordinates, np.round(s.coordinates))


def test_clusters_are_clusters() -> None:
    """Mean distance to the nearest neighbour: clearly smaller in clusters, in between for the mix."""

    def nearest(kind: str) -> float:
        d = made(kind).travel.distances[1:, 1:].copy()
        np.fill_diagonal(d, np.inf)
        return float(d.min(axis=1).mean())

    assert nearest("C1") < 0.6 * nearest("RC1")
    assert nearest("C1") < 0.5 * nearest("R1") * (100 / 70)


@pytest.mark.parametrize("density", [0.0, 0.25, 0.5, 1.0])
def test_the_share_of_customers_with_a_window_is_the_density(density: float) -> None:
    i = made("R1", density=density)
    away = i.travel.distance(0, i.sites.customers)
    latest = np.floor(230 - away - 10)
    free = (i.sites.ready[1:] == 0) & (i.sites.due[1:] == latest)
    assert free.sum() >= 100 - round(100 * density)
    assert (~free).sum() >= 0.9 * round(100 * density)


def test_windows_are_about_as_wide_as_asked_for() -> None:
    for width in (20, 60):
        i = made("R2", width=width, customers=400)
        assert abs(float((i.sites.due - i.sites.ready)[1:].mean()) - width) < 0.1 * width + 2
    narrow = made("R1", width=10, deviation=0)
    inner = (narrow.sites.due - narrow.sites.ready)[1:]
    assert inner.max() <= 12  # rounded outwards on both sides


@pytest.mark.parametrize("kind", ["C1", "C2"])
def test_one_vehicle_for_each_cluster_is_a_feasible_answer(kind: str) -> None:
    i = made(kind, width=0, deviation=0)
    s, size = i.sites, CLASSES[kind].cluster
    clusters = -(-100 // size)
    member = np.sort(np.arange(100) % clusters)  # clusters are numbered one after the other
    assert len(np.unique(member)) == clusters
    for c in range(clusters):
        at = np.nonzero(member == c)[0] + 1
        route = at[np.argsort(s.due[at], kind="stable")]
        assert s.demand[route].sum() <= i.fleet[0].capacity
        time, here = 0.0, 0
        for site in route:
            time = max(time + (s.service[here] if here else 0) + float(i.travel.distance(here, site)), s.ready[site])
            assert time <= s.due[site] + 1e-9
            here = site
        assert time + 90 + float(i.travel.distance(here, 0)) <= s.due[0]


def test_the_first_customers_of_a_mix_are_a_mix() -> None:
    d = made("RC1").travel.distances[1:, 1:].copy()
    np.fill_diagonal(d, np.inf)
    close = d.min(axis=1) <= np.median(d.min(axis=1))
    assert 4 <= close[:25].sum() <= 21


def test_a_good_tour_is_optimal_on_a_circle() -> None:
    angle = np.random.default_rng(3).permutation(12) * (2 * np.pi / 12)
    d = Travel("euclidean", coordinates=np.column_stack([np.cos(angle), np.sin(angle)])).distances
    tour = _good_tour(d)
    assert sorted(tour) == list(range(12)) and tour[0] == 0
    assert d[tour, np.roll(tour, -1)].sum() == pytest.approx(12 * 2 * np.sin(np.pi / 12))


def test_arrivals_count_travel_and_service() -> None:
    travel = Travel("euclidean", coordinates=[[0, 0], [1, 0], [3, 0]])  # type: ignore[arg-type]
    arrival, finish = _arrivals(travel, np.array([0, 0]), 90.0)
    assert arrival.tolist() == [1.0, 93.0]
    assert finish == 186.0
