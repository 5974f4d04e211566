import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import FEATURES, WHOLE_FAMILY, at_risk, excludes, few, small, varied
from truth.routing import best_values

import waybound as wb
from waybound import Evidence, LatestReturn, LongestRoute, Makespan, Objective, RoutingProblem, TotalCost, TotalDuration, Vehicles
from waybound.formulations.routing.checking import all_routes
from waybound.formulations.routing.checking.all_routes import MOST_ORDERS, check_all_routes, orders, put_together
from waybound.formulations.stop import Stop, until
from waybound.instances.routing.instance import Energy, Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel


@pytest.mark.share(3)
@pytest.mark.parametrize("feature", FEATURES)
@pytest.mark.parametrize("convention", ["exact", "round"])
def test_the_optimum_of_the_first_level_is_proved(feature: str, convention: str) -> None:
    for seed in range(3):
        problem = small(feature, seed, convention)
        best, bound = best_values(problem), check_all_routes(problem, {})
        if best is None:
            assert bound == (math.inf if problem.sense == "min" else -math.inf)
        else:
            assert bound == pytest.approx(float(best[0]), rel=1e-11) and not excludes(problem, bound, 1e-12, 0.0)


@pytest.mark.share(4)
@pytest.mark.parametrize("term", [LongestRoute(), Makespan(), 3.0 * Makespan()])
@pytest.mark.parametrize("feature", ["time-windows", "heterogeneous-fleet", "elapsed", "limited-fleet"])
def test_the_largest_of_all_routes_is_proved(feature: str, term) -> None:
    for seed in range(3):
        problem = replace_objective(small(feature, seed, "exact"), term)
        best = best_values(problem)
        if best is not None:
            assert check_all_routes(problem, {}) == pytest.approx(float(best[0]), rel=1e-9)


@pytest.mark.parametrize("term", [LongestRoute(), TotalCost(), LatestReturn()])
@pytest.mark.parametrize("feature", ["vehicle-travel", "vehicle-speeds", "skills", "committed-vehicles"])
def test_vehicles_of_their_own_kind_are_never_bounded_beyond_the_optimum(feature: str, term) -> None:
    for seed in range(8):
        problem = replace_objective(varied(feature, seed, few(feature)), term)
        assert not excludes(problem, check_all_routes(problem, {}), 1e-12, 0.0)


def replace_objective(problem: RoutingProblem, objective) -> RoutingProblem:
    return RoutingProblem(problem.sites, problem.travel, problem.fleet, objective)


FREE = {"max_duration": math.inf}
LIMITED = (
    {"max_duration": 18.0}, {"energy": Energy(36.0, 2.0, "elapsed")}, {"energy": Energy(17.0)},
    {"max_duration": 9.0, "speed": 2.0, "service": 0.5},
)  # fmt: skip


@pytest.mark.parametrize("limits", LIMITED)
def test_risks_of_routes_and_of_the_team_are_taken_up(limits) -> None:
    for risk in (0.3, 0.15, 0.06, 0.05, 1e-3):
        for problem in (at_risk(risk, **{**FREE, **limits}), at_risk(None, risk, **{**FREE, **limits})):
            best = best_values(problem)
            assert check_all_routes(problem, {}) == (math.inf if best is None else pytest.approx(float(best[0])))


def test_risks_among_other_features_are_never_bounded_beyond_the_optimum() -> None:
    for feature in ("route-risk", "team-risk"):
        for seed in range(12):
            problem = varied(feature, seed, few(feature))
            assert not excludes(problem, check_all_routes(problem, {}), 1e-12, 0.0)


def test_routes_asked_for_and_moves_forbidden_count() -> None:
    line = np.abs(np.subtract.outer([0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 2.0, 3.0]))
    asked = {"sites": Sites.of("oabc"), "travel": Travel(EXPLICIT, matrix=line), "fleet": (VehicleType(),)}
    assert check_all_routes(RoutingProblem(**asked), {}) == pytest.approx(6.0)
    assert check_all_routes(RoutingProblem(**asked, min_vehicles=2), {}) == pytest.approx(8.0)
    assert check_all_routes(RoutingProblem(**asked, min_vehicles=4), {}) == math.inf
    forbidden = np.zeros((4, 4), dtype=bool)
    forbidden[3, 0] = forbidden[0, 3] = True
    assert check_all_routes(RoutingProblem(**asked, forbidden=forbidden), {}) == pytest.approx(6.0)
    forbidden[[1, 2], 0] = True
    assert check_all_routes(RoutingProblem(**asked, forbidden=forbidden), {}) == math.inf


def test_many_customers_and_mixtures_with_the_largest_route_prove_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = small("capacity", 0, "exact")
    assert orders(problem) == 5 + 20 + 60 + 120 + 120
    assert check_all_routes(replace_objective(problem, TotalCost() + Makespan()), {}) == -math.inf
    monkeypatch.setattr(all_routes, "MOST_ORDERS", 300)
    monkeypatch.setattr(all_routes, "MOST", 4)  # of customers, for all sets of them
    assert check_all_routes(problem, {}) == -math.inf
    assert orders(RoutingProblem(Sites.of(range(12)), Travel(EXPLICIT, matrix=np.ones((12, 12))), (VehicleType(),))) == math.inf


ADDS_UP = ("capacity", "max-distance", "travel", "limited-fleet", "heterogeneous-fleet", "fixed-cost", "multiple-depots", "open-routes",
           "separate-durations", "prizes", "reward")  # fmt: skip


@pytest.fixture
def by_sets(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(all_routes, "MOST_ORDERS", 0)


@pytest.mark.usefixtures("by_sets")
@pytest.mark.share(3)
@pytest.mark.parametrize("feature", [*FEATURES, *(name for name in WHOLE_FAMILY if name not in FEATURES)])
def test_no_more_is_proved_than_is_true(feature: str) -> None:
    for seed in range(5):
        problem = small(feature, seed, "exact") if feature in FEATURES else varied(feature, seed, few(feature, 4))
        if seed % 2 and problem.sense == "min" and len(problem.senses) == 1:
            goal = (TotalDuration() + 3.0 * Vehicles(), TotalCost() + 0.5 * TotalDuration())[seed % 4 == 1]
            problem = replace(problem, objective=Objective.of(goal))
        best, bound, sign = best_values(problem), check_all_routes(problem, {}), 1.0 if problem.sense == "min" else -1.0
        if best is None:
            continue
        assert sign * bound <= sign * float(best[0]) + 1e-11 * abs(best[0]), (seed, problem)
        if feature in ADDS_UP:
            assert bound == pytest.approx(float(best[0]), rel=1e-9), (seed, problem)


@pytest.mark.usefixtures("by_sets")
@pytest.mark.parametrize("team", [False, True])
@pytest.mark.parametrize("seed", range(12))
def test_risks_of_routes_and_of_the_team_are_proved(seed: int, team: bool) -> None:
    rng = np.random.default_rng(seed)
    n = 5
    matrix, variances = rng.integers(2, 20, (n, n)).astype(float), rng.integers(0, 30, (n, n)).astype(float)
    np.fill_diagonal(matrix, 0.0)
    np.fill_diagonal(variances, 0.0)
    risk = float(rng.choice([0.02, 0.1, 0.3]))
    vehicle = VehicleType(
        None if seed % 2 else 2, 9.0, max_duration=float(rng.integers(35, 70)), risk=None if team else risk, fixed_cost=4.0
    )
    sites = Sites.of(range(n), demand=[0, *rng.integers(1, 5, n - 1)], service=[0, *rng.integers(0, 3, n - 1)])
    problem = RoutingProblem(
        sites, Travel(EXPLICIT, matrix=matrix, variances=variances), (vehicle,), team_risk=risk if team else None, min_vehicles=seed % 3
    )
    best, bound = best_values(problem), check_all_routes(problem, {})
    assert bound == (math.inf if best is None else pytest.approx(float(best[0]), rel=1e-9))


@pytest.mark.usefixtures("by_sets")
def test_ten_sites_at_risk_are_proved_optimal(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(all_routes, "MOST_ORDERS", MOST_ORDERS)
    rng = np.random.default_rng(5)
    xy = rng.uniform(0, 100, (9, 2))
    far = np.hypot(*(xy[:, None] - xy).transpose(2, 0, 1))
    travel = Travel("euclidean", xy, variances=np.square(0.4 * rng.uniform(0, 1, far.shape) * far))
    for given in ({"risk": 0.05}, {"team_risk": 0.05}):
        vehicle = VehicleType(max_duration=260.0, risk=given.get("risk"))
        problem = RoutingProblem(Sites.of(range(9)), travel, (vehicle,), team_risk=given.get("team_risk"))
        assert orders(problem) > MOST_ORDERS
        found = wb.solve(problem, "highs", form="set-partitioning", bound_time=0)
        assert check_all_routes(problem, {}) == pytest.approx(found.objective, rel=1e-9)


@pytest.mark.usefixtures("by_sets")
def test_numbers_of_routes_count_where_they_are_limited() -> None:
    def front(*rows: tuple[float, float]) -> np.ndarray:
        return np.array(rows)

    found = [{0b01: front((1.0, 0.0)), 0b10: front((1.0, 0.0)), 0b11: front((5.0, 0.0))}]
    for risk in (math.inf, 1.0):
        assert put_together(found, 2, 0, 2, risk)[0b11, 1] == 2.0, "any number"
        assert put_together(found, 2, 0, 1, risk) == {(0, 0): 0.0, (1, 1): 1.0, (2, 1): 1.0, (3, 1): 5.0}
        assert put_together(found, 2, 2, 2, risk)[0b11, 2] == 2.0
    shared = [{0b01: front((1.0, 0.7), (3.0, 0.2)), 0b10: front((1.0, 0.7))}]
    assert put_together(shared, 2, 0, 2, 1.0)[0b11, 1] == 4.0, "one of them the safer way"


@pytest.mark.usefixtures("by_sets")
def test_it_gives_up_when_asked() -> None:
    problem = small("capacity", 1, "exact")
    with until(Stop(0.0)):
        assert check_all_routes(problem, {}) == -math.inf
    assert Evidence("all-routes", "", 0.0, {}).kind == "all-routes" and check_all_routes(problem, {}) > 0
