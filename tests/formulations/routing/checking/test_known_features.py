import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import WHOLE_FAMILY, few, plane, varied
from truth.routing import RoutingTruth, best_values

from waybound import Energy, Objective, TotalCost, Vehicles, VehicleType
from waybound.formulations.evidence import Evidence
from waybound.formulations.routing.checking.known_features import KNOWN, unknown_features, without_stops
from waybound.formulations.routing.fleet_need import infeasible_bound
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.features import FEATURES
from waybound.solvers.bounds import BOUNDS

INFEASIBLE = (
    "infeasible-site", "too-few-vehicles", "bin-packing", "too-little-range", "too-little-time", "sites-apart", "sites-beyond-fleet",
    "too-few-sites",
)  # fmt: skip


def drawn(feature, seed):
    """A problem at least cost, all sites required where they can be, so that there is as much to prove as may be."""
    problem = varied(feature, seed, few(feature, 4))
    sites = problem.sites
    if not sites.groups and seed % 3:
        sites = replace(sites, required=~sites.depot)
    weight = 7.0 * Vehicles() if seed % 2 else None
    goal = TotalCost() if weight is None else TotalCost() + weight
    return replace(problem, sites=sites, objective=Objective.of(goal), min_vehicles=int(seed % 5 == 0))


def multipliers(problem, rng):
    n, size = len(problem.sites), float(problem.travel.distances.max())
    for scale in (0.2, 0.5, 1.0):
        prices = [rng.uniform(-scale, scale, n) * size for _ in range(2)]
        yield "spanning-tree", {"multipliers": prices[0].tolist(), "depot": float(rng.uniform(-1, 1) * size)}
        resources = {name: (rng.uniform(0, scale, n)).tolist() for name in ("time", "load", "energy", "duration") if rng.random() < 0.5}
        # Near the shares that customers have in the cost, bounds are good.
        share = problem.travel.distances.max(axis=0) * scale
        data = {
            "out": (share + 0.1 * prices[0]).tolist(), "in": prices[1].tolist(), "fleet": float(rng.uniform(-1, 1)), "resources": resources,
        }  # fmt: skip
        yield "arc-multipliers", data


def claims(problem, rng):
    """Evidence of each kind that there is no answer, for all sites and choices of them."""
    ids = problem.sites.ids
    customers = [ids[k] for k in problem.customers]
    for site in customers:
        yield "infeasible-site", {"site": site}
    yield "too-few-vehicles", {}
    yield "too-few-sites", {}
    for threshold in (0.0, 2.0, 4.0):
        yield "bin-packing", {"threshold": threshold}
    for resource in ("travel", "duration", "distance"):
        yield "too-little-range", {"resource": resource}
    for size in range(1, len(customers) + 1):
        for chosen in itertools.combinations(customers, size):
            yield "sites-beyond-fleet", {"sites": list(chosen)}
            yield "sites-apart", {"sites": list(chosen)}
            low = float(rng.integers(0, 20))
            yield "too-little-time", {"sites": list(chosen), "from": low, "until": low + float(rng.integers(0, 40))}


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_no_evidence_proves_more_than_is_true(feature):
    rng, judged = np.random.default_rng(9), 0
    for seed in range(8):
        problem = drawn(feature, seed)
        best = RoutingTruth(problem).lenient if judged < 4 else None
        if best is None:
            continue
        judged += 1
        value = float(best[0])
        for kind, data in multipliers(problem, rng):
            assert verified_bound(problem, Evidence(kind, "", 0.0, data)) <= value + 1e-9 * abs(value), (seed, kind)
        for kind, data in claims(problem, rng):
            assert verified_bound(problem, Evidence(kind, "", infeasible_bound(problem), data)) != infeasible_bound(problem), (
                seed,
                kind,
                data,
            )
    assert judged >= 2


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", WHOLE_FAMILY)
def test_no_bound_method_finds_more_than_is_true(feature):
    methods = [m for m in BOUNDS.values() if m.name in ("spanning-tree", "infeasible-site", "too-few-vehicles", "too-small-fleet")]
    assert len(methods) == 4
    for seed in range(2):
        problem = drawn(feature, seed)
        best = RoutingTruth(problem).lenient
        value = math.inf if best is None else float(best[0])
        for method in methods:
            if not method.missing(problem):
                found = method.compute(problem, Stop(60.0), None)
                assert found is None or found.value <= value + 1e-9 * abs(value), (seed, method.name, found)


def test_every_feature_is_known_or_proves_nothing():
    assert FEATURES.keys() - KNOWN == {"reloads", "recharging"}
    for feature in ("reloads", "recharging"):
        problem = drawn(feature, 1)
        assert feature in unknown_features(problem)
        assert verified_bound(problem, Evidence("too-few-vehicles", "", 0.0, {})) == -math.inf


def test_a_feature_of_another_package_proves_nothing(monkeypatch):
    evidence = Evidence("spanning-tree", "", 0.0, {"multipliers": [0.0] * len(drawn("pickups", 1).sites)})
    assert verified_bound(drawn("pickups", 1), evidence) > 0
    monkeypatch.setitem(FEATURES, "towing", lambda data: True)
    assert verified_bound(drawn("pickups", 1), evidence) == -math.inf


@pytest.mark.share(2)
@pytest.mark.parametrize("feature", ["reloads", "recharging"])
def test_no_optimum_gets_worse(feature):
    for seed in range(4):
        problem = varied(feature, seed, 3)
        relaxed = without_stops(problem)
        assert not {"reloads", "recharging"} & relaxed.features()
        before, after = best_values(problem), best_values(replace(relaxed))
        if before is not None:
            assert after is not None
            assert float(after[0]) <= float(before[0]) if problem.sense == "min" else float(after[0]) >= float(before[0])


def test_moves_lead_over_the_depots_of_the_vehicle():
    problem = plane(1, 3, 10.0)
    assert without_stops(problem) is problem
    matrix = np.full((4, 4), 9.0)
    matrix[0] = matrix[:, 0] = 1.0
    made = without_stops(replace(problem, fleet=(VehicleType(capacity=1.0, reloads=(0,)), VehicleType(energy=Energy(3.0)))))
    first, second = made.fleet
    assert first.capacity == math.inf and not first.reloads
    assert second.energy is not None and second.travel is not None
    d = problem.travel.distances
    assert (first.travel.distances == np.minimum(d, d[:, :1] + d[:1])).all()
    assert (second.travel.distances == d).all()
