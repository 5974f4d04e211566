import math
from typing import Any

import numpy as np
import pytest

from waybound import LongestRoute, Makespan, Reward, RoutingProblem, Shipment, Sites, TotalCost, Travel, Vehicles, VehicleType, read
from waybound.reports.benchmarks.overhead import BUNDLED, bare, cases, compare, integers, shown
from waybound.solvers.backend import BACKENDS, Control, Options


@pytest.mark.parametrize(("engine", "work"), [("pyvrp", 30), ("ortools", 30), ("vroom", 1)])
@pytest.mark.long
@pytest.mark.parametrize("name", BUNDLED)
def test_the_wrapped_library_returns_the_bare_librarys_routes(name: str, engine: str, work: int) -> None:
    row = compare(name, name, BUNDLED[name], engine, work, 1)
    assert row["same"]
    assert row["bare"] > 0


def test_the_bare_library_gets_integers_that_are_the_data() -> None:
    problem = read("demo-rc50", convention="trunc1")
    made = integers(problem)  # type: ignore[arg-type]
    assert made["distance"].dtype.kind == "i"
    assert abs(made["distance"] / 10 - problem.travel.distances).max() < 1e-9  # type: ignore[attr-defined]


def test_instances_can_be_chosen() -> None:
    assert [case[0] for case in cases(["demo-x40"])] == ["demo-x40"]


def member(kind: str) -> RoutingProblem:
    """A small problem of a family, with distances that are no whole numbers."""
    rng = np.random.default_rng(3)
    n, depots, sites, fleet, aim = 14, 1, dict[str, Any](), [dict[str, Any](count=4)], TotalCost()
    if kind == "several depots":
        depots, fleet = 2, [{"count": 3, "start": k, "end": k, "capacity": 20.0, "max_duration": 180.0} for k in range(2)]
        sites = {"demand": rng.integers(1, 9, n), "service": 2.0}
    elif kind == "pickups":
        sites, fleet = {"demand": rng.integers(0, 9, n), "pickup": rng.integers(0, 9, n)}, [{"count": 6, "capacity": 25.0}]
    elif kind == "shipments":
        pairs = [Shipment(k, k + 6, (3.0,)) for k in range(1, 7)]
        n, aim, fleet = 13, Vehicles().then(TotalCost()), [{"count": 6, "capacity": 7.0}]
        sites = {"shipments": pairs, "due": [math.inf, *[150.0] * 12]}
    elif kind in ("orienteering", "orienteering with windows"):
        sites, aim = {"reward": [0, 0, *rng.integers(1, 20, n - 2)], "required": False}, Reward()
        depots, fleet = 2, [{"count": 2, "start": 0, "end": 1, "max_distance": 120.0}]
        if kind.endswith("windows"):
            ready = np.r_[0, 0, rng.integers(0, 60, n - 2)]
            sites |= {"ready": ready, "due": np.where(np.arange(n) < 2, 200, ready + 40)}
    elif kind in ("makespan", "longest route"):
        aim = Makespan() if kind == "makespan" else LongestRoute()
    for name in ("demand", "pickup", "reward"):
        if name in sites:
            sites[name] = np.asarray(sites[name], dtype=float) * (np.arange(n) >= depots)
    made = Sites.of(range(n), depot=np.arange(n) < depots, **sites)
    vehicles = tuple(VehicleType(**given) for given in fleet)
    return RoutingProblem(made, Travel("euclidean", rng.uniform(0, 50, (n, 2))), vehicles, aim, name=kind)


KINDS = ("several depots", "pickups", "shipments", "orienteering", "orienteering with windows", "makespan", "longest route")


@pytest.mark.share(4)
@pytest.mark.parametrize(("engine", "work"), [("pyvrp", 40), ("ortools", 20), ("vroom", 1)])
@pytest.mark.parametrize("kind", [kind if k % 2 == 0 else pytest.param(kind, marks=pytest.mark.long) for k, kind in enumerate(KINDS)])
def test_each_family_gets_the_bare_librarys_routes(kind: str, engine: str, work: int) -> None:
    problem, backend = member(kind), BACKENDS[engine]()
    if backend.missing(problem) or backend.bisects(problem):
        assert engine == "vroom" or kind in ("makespan", "longest route")
        return
    limits: dict[str, Any] = {"extra": {"exploration_level": work}} if engine == "vroom" else {"iterations": work}
    found = backend.run(problem, Options(time_limit=600.0, seed=1, **limits), Control())
    assert shown([list(route.visits) for route in found.answer], engine) == shown(bare(problem, engine, work)["routes"], engine)
    assert problem.evaluate(found.answer).feasible
