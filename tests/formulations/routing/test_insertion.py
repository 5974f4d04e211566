import math

import numpy as np
import pytest
from small_routing import WHOLE_FAMILY, varied

from waybound import Energy, Route, RoutingProblem, Sites, Travel, VehicleType
from waybound.formulations.routing.insertion import LIMITS, Insertions, is_plain, judged, orders


def agree(problem, route, sites):
    """How often each limit is broken, where the two agree on all places."""
    fast, broken = Insertions(problem, route).of(np.array(sites)), dict.fromkeys(LIMITS, 0)
    for k, site in enumerate(sites):
        slow = judged(problem, [Route(visits, route.vehicle) for visits in orders(route.visits, [site])])
        late = slow.excess["time-windows"][0] > 0
        for name in LIMITS:
            mine = fast.excess.get(name, np.zeros(fast.distance.shape))[k]
            theirs = slow.excess[name][0]
            if name in ("duration", "energy"):  # where somebody is late, a lower bound
                assert (mine[late] <= theirs[late] + 1e-9).all()
                mine, theirs = mine[~late], theirs[~late]
            assert mine == pytest.approx(theirs, abs=1e-9), name
            broken[name] += int((mine > 0).sum())
        assert fast.distance[k] == pytest.approx(slow.distance[0])
        assert fast.duration[k][~late] == pytest.approx(slow.duration[0][~late])
        assert fast.finish[k][~late] == pytest.approx(slow.finish[0][~late])
    return broken


def grown(problem, kind, seed):
    """A route without stops, and with one stop more as long as one keeps all limits."""
    rng, visits = np.random.default_rng(seed), ()
    ends = {k for x in problem.sites.shipments for k in (x.pickup, x.delivery)}
    stops = [*problem.customers.tolist(), *problem.fleet[kind].stations]
    while visits is not None:
        left = [k for k in problem.customers.tolist() if k not in visits and k not in ends]
        if left:
            yield Route(visits, kind), left
        pairs = [(x.pickup, x.delivery) for x in problem.sites.shipments if not {x.pickup, x.delivery} & set(visits)]
        longer = [v for k in [*([k] for k in stops if k not in visits and k not in ends), *pairs] for v in orders(visits, k)]
        good = [v for v in longer if max(x.max() for x in judged(problem, [Route(v, kind)]).excess.values()) == 0]
        visits = good[int(rng.integers(len(good)))] if good else None


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", [f for f in WHOLE_FAMILY if f not in ("several-windows", "closing-moves", "route-risk")])
def test_every_place_is_as_the_judge_has_it(feature):
    compared = 0
    for seed in range(6):
        problem = varied(feature, seed, 5)
        assert is_plain(problem)
        for kind in range(len(problem.fleet)):
            for route, left in grown(problem, kind, seed):
                agree(problem, route, left)
                compared += len(left) * (len(route) + 1)
    assert compared > 40


@pytest.mark.share(2)
@pytest.mark.share(2)
@pytest.mark.parametrize(("charge", "store"), [("travel", 60), ("elapsed", 80), ("elapsed-fixed-start", 90), ("windows", 95)])
def test_windows_service_and_every_way_to_charge_a_store(charge, store):
    rng, broken = np.random.default_rng(5), dict.fromkeys(LIMITS, 0)
    for seed in range(8):
        ready = np.append(rng.integers(0, 9), rng.integers(0, 60, 7)).astype(float)
        due = np.append(170.0, ready[1:] + rng.integers(10, 60, 7))
        xy = rng.integers(0, 20, (8, 2)).astype(float)
        sites = Sites.of(range(8), ready=ready, due=due, service=rng.integers(0, 5, 8), required=False, demand=rng.integers(0, 5, 8))
        vehicle = VehicleType(1, 12, max_duration=85, max_distance=65, energy=Energy(store, charge=charge), shift=(4, 160))
        problem = RoutingProblem(sites, Travel("euclidean", xy), [vehicle])
        for route, left in grown(problem, 0, seed):
            for name, times in agree(problem, route, left).items():
                broken[name] += times
    assert all(broken[name] > 0 for name in ("load", "time-windows", "distance", "duration", "energy")), broken


def test_sites_are_put_in_by_their_order():
    assert list(orders((1, 2), (8, 9))) == [
        (8, 9, 1, 2), (8, 1, 9, 2), (8, 1, 2, 9), (1, 8, 9, 2), (1, 8, 2, 9), (1, 2, 8, 9)
    ]  # fmt: skip


def test_forbidden_moves_and_skills_are_told_by_place():
    forbidden = np.zeros((4, 4), dtype=bool)
    forbidden[1, 3] = True
    sites = Sites.of(range(4), skills={3: ["tall", "cold"]}, required=False)
    problem = RoutingProblem(
        sites, Travel("euclidean", np.arange(8.0).reshape(4, 2)), [VehicleType(skills=frozenset(["cold"]))], forbidden=forbidden
    )
    excess = Insertions(problem, Route((1, 2))).of(np.array([3])).excess
    assert excess["moves"].tolist() == [[0, 1, 0]] and excess["skills"].tolist() == [[1, 1, 1]]
    assert math.isclose(excess["load"].max(), 0.0)
