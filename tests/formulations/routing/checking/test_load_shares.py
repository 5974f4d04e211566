import math
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from small_routing import WHOLE_FAMILY, drawn, enumerated, excludes, plane
from truth.routing import best_values

from waybound import Evidence, LatestReturn, RoutingProblem, Sites, VehicleType
from waybound.formulations.routing.checking.load_shares import (
    by_coordinates,
    check_load_shares,
    check_nearest_moves,
    least_moves_at,
    least_round_trips,
)
from waybound.formulations.routing.checking.vehicle_moves import terms_of
from waybound.formulations.routing.objective import Composable, Makespan, Objective, Penalties, Reward, TotalCost, TotalDuration, Vehicles
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.travel import EXPLICIT, METRICS, Travel

METRIC = [name for name in METRICS if name != "GEO"]


def spread(n: int, metric: str, convention: str = "exact", seed: int = 1) -> RoutingProblem:
    rng = np.random.default_rng(seed)
    travel = Travel(metric, rng.uniform(-60, 60, (n + 1, 2)), convention=convention)
    return RoutingProblem(Sites.of(range(n + 1), demand=[0, *rng.integers(1, 10, n)]), travel, (VehicleType(capacity=50.0, unit_cost=2.0),))


@pytest.mark.parametrize("metric", METRIC)
def test_coordinates_say_what_the_matrix_says(metric: str) -> None:
    problem = spread(40, metric)
    matrix = replace(problem, travel=Travel(EXPLICIT, matrix=problem.travel.distances))
    terms, vehicle = terms_of(problem), problem.fleet[0]
    assert terms is not None and by_coordinates(problem) and not by_coordinates(matrix)
    size = float(problem.travel.distances.max())
    for one, other in zip(least_moves_at(problem, terms), least_moves_at(matrix, terms), strict=True):
        assert np.allclose(one, other, rtol=1e-6, atol=1e-6 * size) and (one <= other * (1 + 1e-12)).all()
    trips, shortfall = least_round_trips(problem, terms, vehicle)
    assert np.allclose(trips, least_round_trips(matrix, terms, vehicle)[0], rtol=1e-6)
    assert shortfall <= 1e-5 * size


def test_ways_lead_over_other_sites_where_that_is_nearer() -> None:
    matrix = np.array([[0.0, 1.0, 9.0], [1.0, 0.0, 1.0], [9.0, 1.0, 0.0]])
    problem = RoutingProblem(Sites.of(range(3)), Travel(EXPLICIT, matrix=matrix), (VehicleType(),))
    terms = terms_of(problem)
    assert terms is not None
    assert least_round_trips(problem, terms, problem.fleet[0])[0].tolist() == [2.0, 4.0]


def test_many_sites_take_no_matrix() -> None:
    problem = spread(20_000, "euclidean")
    tracemalloc.start()
    try:
        assert check_load_shares(problem, {}) > 0 and check_nearest_moves(problem, {}) > 0
        assert tracemalloc.get_traced_memory()[1] < 1e8, "all moves would take 3.2e9 bytes"
    finally:
        tracemalloc.stop()


GOALS: tuple[Composable, ...] = (
    TotalCost(), TotalCost() + 7.0 * Vehicles(), TotalDuration(), TotalCost() - Reward(), TotalCost() + 2.0 * Penalties(),
    Reward() - 0.5 * TotalCost(), TotalCost() + 0.5 * LatestReturn(),
)  # fmt: skip
CHECKED = {"load-shares": check_load_shares, "nearest-moves": check_nearest_moves}


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", [*WHOLE_FAMILY, "prizes", "heterogeneous-fleet", "multiple-depots", "separate-durations"])
def test_no_bound_exceeds_the_optimum(feature: str) -> None:
    judged = 0
    for seed in range(4):
        problem = drawn(feature, seed)
        for k in (seed, seed + 3):
            asked = replace(problem, objective=Objective.of(GOALS[k % len(GOALS)]))
            for name, check in CHECKED.items():
                judged += enumerated(asked) is not None
                assert not excludes(asked, check(asked, {})), (name, seed, asked.objective)
    assert judged


ROUNDED = [
    (metric, convention) for metric in METRICS for convention in ("exact", "round", "trunc1", "trunc2", "ceil", "file")
    if convention != "file" or METRICS[metric].file_rounding is not None
]  # fmt: skip


@pytest.mark.parametrize(("metric", "convention"), ROUNDED)
def test_no_rounding_of_any_metric_makes_it_too_much(metric: str, convention: str) -> None:
    for seed in range(6):
        rng = np.random.default_rng(seed)
        scale = (0.6, 3.0, 30.0)[seed % 3]  # where roundings weigh much, and little
        xy = rng.uniform(0, scale, (6, 2))
        xy[3] = xy[2]  # two in one place
        fleet = (VehicleType(None, 9.0), VehicleType(2, 14.0, fixed_cost=scale, unit_cost=1.2, unit_duration_cost=0.3, speed=2.0))
        sites = Sites.of(range(6), demand=[0, *rng.integers(1, 9, 5)], service=rng.integers(0, 2, 6))
        problem = RoutingProblem(sites, Travel(metric, xy, convention=convention), fleet[: 1 + seed % 2])
        best = best_values(problem)
        assert best is not None
        for name, check in CHECKED.items():
            assert check(problem, {}) <= float(best[0]) * (1 + 1e-9), (name, seed)


def test_what_it_proves_of_a_star_is_what_it_costs() -> None:
    # Four sites 10 away in one place, each with half a load: two routes out and back.
    xy = np.array([[0.0, 0.0]] + [[6.0, 8.0]] * 4)
    sites = Sites.of(range(5), demand=[0, 5, 5, 5, 5])
    problem = RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(capacity=10.0, fixed_cost=3.0),))
    assert verified_bound(problem, Evidence("load-shares", "", 0.0, {})) == pytest.approx(46.0)
    assert verified_bound(problem, Evidence("nearest-moves", "", 0.0, {})) == pytest.approx(26.0), "half of two first and two last moves"


@pytest.mark.parametrize("power", [-300, -30, 30, 300])
def test_data_of_another_scale_give_the_same_bound(power: int) -> None:
    problem = plane(3, 8, 20.0)
    assert problem.travel.coordinates is not None
    plain = replace(problem, travel=Travel("euclidean", problem.travel.coordinates))
    scaled = replace(problem, travel=Travel("euclidean", problem.travel.coordinates * 2.0**power))
    for check in CHECKED.values():
        assert check(scaled, {}) == pytest.approx(check(plain, {}) * 2.0**power, rel=1e-12)


@pytest.mark.parametrize("vehicle", [{"unit_cost": 1e150}, {"fixed_cost": 1e150}, {"unit_duration_cost": 1e150, "speed": 1e-100}])
def test_numbers_beyond_all_doubles_prove_nothing_or_what_is_true(vehicle: dict[str, float]) -> None:
    level = Objective.of(1e150 * TotalCost())
    problem = replace(plane(1, 5, 20.0), fleet=(VehicleType(None, 20.0, **vehicle),), objective=level)  # type: ignore[arg-type]
    for check in CHECKED.values():
        bound = check(problem, {})
        assert not math.isnan(bound) and bound < math.inf


def test_other_objectives_prove_nothing() -> None:
    problem = plane(1, 5, 20.0)
    for check in CHECKED.values():
        assert check(replace(problem, objective=Objective.of(Vehicles() - TotalCost())), {}) == -math.inf
        assert check(replace(problem, objective=Objective.of(Makespan())), {}) == 0.0


def by_hand(problem: RoutingProblem, routes: int) -> float:
    """One depot, one type of vehicle, at cost 1 of a unit of distance."""
    d, n = problem.travel.distances, len(problem.sites)
    paid = 0.0
    for i in range(1, n):
        pairs = [(a, b) for a in range(n) for b in range(n) if i not in (a, b) and (a != b or a == 0)]
        paid += min(d[a, i] + d[i, b] for a, b in pairs) / 2
    return paid + (sum(sorted(d[0, 1:])[:routes]) + sum(sorted(d[1:, 0])[:routes])) / 2


@pytest.mark.parametrize("seed", range(5))
def test_the_same_by_hand(seed: int) -> None:
    problem = plane(seed, 9, 15.0)
    routes = int(np.ceil(problem.sites.demand.sum() / 15.0))
    assert check_nearest_moves(problem, {}) == pytest.approx(by_hand(problem, routes), rel=1e-9)
    matrix = problem.travel.distances
    explicit = RoutingProblem(problem.sites, Travel(EXPLICIT, matrix=matrix), problem.fleet)
    assert check_nearest_moves(explicit, {}) == pytest.approx(by_hand(problem, routes), rel=1e-9), "off a matrix"


def test_one_customer_and_two() -> None:
    for customers, least in ((1, 10.0), (2, 12.0)):
        xy = np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 6.0]])[: customers + 1]
        problem = RoutingProblem(Sites.of(range(customers + 1)), Travel("euclidean", xy), (VehicleType(),))
        assert 0.0 < check_nearest_moves(problem, {}) <= least + np.hypot(3.0, 6.0) - 5.0
