from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from small_routing import FEATURES, WHOLE_FAMILY, small, varied

import waybound as wb
from waybound import Energy, Objective, Reward, RoutingProblem, Sites, TotalCost, VehicleType
from waybound.formulations.programs.size import TooLargeError
from waybound.formulations.routing.forms import _best_orders
from waybound.formulations.routing.forms._all_routes import MOST_ROUTES, Priced, Walk, orders_of_stops
from waybound.formulations.routing.forms._best_orders import MOST_SITES, adds_up, best_orders
from waybound.instances.routing.travel import EXPLICIT, Travel


def drawn(seed: int, customers: int = 5, **vehicle: Any) -> RoutingProblem:
    """Uncertain durations that are neither symmetric nor the distances, services, and limits that some sets break."""
    rng = np.random.default_rng(seed)
    n = customers + 1
    length, time = (np.round(rng.uniform(1, 20, (n, n)), 1) for _ in range(2))
    variances = np.round(rng.uniform(0, 9, (n, n)), 1)
    for matrix in (length, time, variances):
        np.fill_diagonal(matrix, 0.0)
    sites = Sites.of(range(n), demand=[0, *rng.integers(1, 5, customers)], service=[0, *rng.integers(0, 3, customers)])
    given: dict[str, Any] = {"capacity": 12.0, "max_duration": 60.0, **vehicle}
    team = 0.1 if seed % 3 == 1 else None
    if seed % 3 == 2:
        given["risk"] = 0.2
    if seed % 4 == 3:
        given["energy"] = Energy(70.0, 1.5)
    travel = Travel(EXPLICIT, matrix=length, duration_matrix=time, variances=variances if seed % 3 else None)
    return RoutingProblem(
        sites, travel, (VehicleType(**given), VehicleType(2, 7.0, unit_duration_cost=2.0, max_distance=45.0)), team_risk=team
    )


def fronts(routes: list[Priced], depot: Any) -> dict[Any, list[tuple[float, ...]]]:
    """By type and sites, what no other route has less of in all that a form may count."""
    found: dict[Any, list[tuple[float, ...]]] = {}
    for r in routes:
        found.setdefault((r.kind, frozenset(k for k in r.visits if not depot[k])), []).append((r.cost, r.distance, r.duration, r.overrun))
    made = {}
    for key, worths in found.items():
        rounded = sorted({tuple(round(w, 8) for w in worth) for worth in worths})
        made[key] = [w for w in rounded if not any(v != w and all(a <= b for a, b in zip(v, w, strict=True)) for v in rounded)]
    return made


def compared(problem: RoutingProblem) -> int:
    walks = [Walk(problem, kind) for kind in range(len(problem.fleet))]
    every = [r for walk in walks for r in walk.routes()]
    best = [r for walk in walks for visits in best_orders(walk) if (r := walk.given(visits)) is not None]
    truth, found = fronts(every, problem.sites.depot), fronts(best, problem.sites.depot)
    assert found.keys() == truth.keys()
    for key, worths in truth.items():
        if problem.team_risk is None:  # an overrun within its limit costs nothing
            assert sorted({w[:3] for w in found[key]}) >= [min(w[:3] for w in worths)]
            assert {min(w[k] for w in worths) for k in range(3)} == {min(w[k] for w in found[key]) for k in range(3)}
        else:
            assert found[key] == worths
    return len(every) - len(best)


@pytest.mark.parametrize("seed", range(24))
def test_the_best_of_each_set_are_among_them(seed: int) -> None:
    problem = drawn(seed)
    assert adds_up(problem)
    assert compared(problem) > 0


@pytest.mark.parametrize("feature", [*FEATURES, *WHOLE_FAMILY])
def test_of_every_feature_that_adds_up(feature: str) -> None:
    for seed in range(3):
        problem = small(feature, seed, "exact") if feature in FEATURES else varied(feature, seed)
        if adds_up(problem) and orders_of_stops(problem) <= MOST_ROUTES:
            compared(problem)


def test_what_waits_loads_on_the_way_or_should_be_large_does_not_add_up() -> None:
    assert adds_up(drawn(0, MOST_SITES)) and not adds_up(drawn(0, MOST_SITES + 1))
    for feature in ("pickups", "shipments", "several-windows", "closing-moves", "reloads", "recharging"):
        assert not any(adds_up(varied(feature, seed)) for seed in range(6)), feature
    assert not adds_up(small("time-windows", 1, "exact"))
    assert not adds_up(replace(drawn(0), objective=Objective.of(Reward() + TotalCost())))


@pytest.mark.parametrize("given", [{"risk": 0.05}, {"team_risk": 0.05}])
def test_set_partitioning_takes_ten_sites_at_risk_with_the_optimum_of_its_relatives(given: dict[str, float]) -> None:
    rng = np.random.default_rng(3)
    xy = rng.uniform(0, 100, (10, 2))
    far = np.hypot(*(xy[:, None] - xy).transpose(2, 0, 1))
    travel = Travel("euclidean", xy, variances=np.square(0.3 * rng.uniform(0, 1, far.shape) * far))
    risk = given.get("risk")
    problem = RoutingProblem(Sites.of(range(10)), travel, (VehicleType(max_duration=230.0, risk=risk),), team_risk=given.get("team_risk"))
    assert orders_of_stops(problem) > MOST_ROUTES and problem.forms()[0] == "set-partitioning"
    solution = wb.solve(problem, "highs", bound_time=0)
    assert solution.status == "optimal" and solution.evaluation is not None and solution.evaluation.feasible
    low = wb.solve(problem, "highs", form="three-index-chords", time_limit=1, bound_time=0)
    assert low.bound is None or low.bound <= solution.objective * (1 + 1e-6)


def test_too_many_orders_of_one_size_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_best_orders, "MOST_LABELS", 20)
    with pytest.raises(TooLargeError, match="more than 20 orders of 2 sites"):
        list(best_orders(Walk(drawn(1, 6), 0)))
