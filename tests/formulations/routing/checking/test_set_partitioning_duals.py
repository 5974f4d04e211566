import itertools
import math
import threading
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from patience import HANG
from small_routing import small
from truth.routing import best_values, routes

from waybound import InputError, Makespan, Objective, RoutingProblem, Sites, Vehicles, VehicleType
from waybound.formulations.routing.checking import set_partitioning_duals
from waybound.formulations.routing.checking.relaxation import relax
from waybound.formulations.routing.checking.set_partitioning_duals import check_set_partitioning_duals
from waybound.formulations.stop import Stop, until
from waybound.instances.routing.travel import EXPLICIT, Travel

SEEDS = st.integers(0, 10**6)
ALL = 99


def evidence(prices: Any, memory: int = ALL, **more: Any) -> dict[str, Any]:
    return {"visits": [float(p) for p in prices], "memory": memory, **more}


@settings(max_examples=draws(60), deadline=None)
@given(seed=SEEDS, scale=st.sampled_from([0.1, 1.0, 10.0, 1e3, 1e9]))
def test_no_prices_however_wrong_prove_more_than_the_optimum(random_problem, optimum, seed, scale):
    problem = random_problem(seed, customers=seed % 4 + 1)
    best, rng, n = optimum(problem), np.random.default_rng(seed), len(problem.sites)
    for ray in (False, True):
        for _ in range(6):
            data = evidence(scale * rng.normal(size=n), int(rng.integers(0, n)), ray=ray)
            assert check_set_partitioning_duals(problem, data) <= best + 1e-9 * max(1.0, abs(best))


@settings(max_examples=draws(30), deadline=None)
@given(seed=SEEDS, memory=st.integers(0, 4))
def test_bounds_stay_below_the_optimum_on_the_way_to_the_best_prices(random_problem, optimum, ascent, seed, memory):
    problem = random_problem(seed, customers=seed % 3 + 2)
    best, n = optimum(problem), len(problem.sites)
    seen = ascent(lambda v: check_set_partitioning_duals(problem, evidence(10.0 * v, memory)), n, np.random.default_rng(seed), 120)
    assert max(seen) <= best + 1e-9 * max(1.0, abs(best))


def expected(
    problem: RoutingProblem, prices: np.ndarray, rows: Sequence[Any] = (), loads: Sequence[Any] = (), needed: np.ndarray | None = None
) -> float:
    """The bound, from all routes one by one."""
    vehicle, far = problem.fleet[0], problem.travel.distances
    reduced, through = [], [math.inf]
    for visits in routes(problem, vehicle):
        stops = [vehicle.start, *visits, vehicle.end]
        moves = list(itertools.pairwise(stops))
        cost = vehicle.fixed_cost + vehicle.unit_cost * sum(float(far[i, j]) for i, j in moves) - float(prices[list(visits)].sum())
        cost -= sum(load["price"] * sum(i not in load["sites"] and j in load["sites"] for i, j in moves) for load in loads)
        cost -= sum(row["price"] * times(visits, row) for row in rows)
        reduced.append(cost)
        if needed is not None and any(needed[move] for move in moves):
            through.append(cost)
    relaxed = relax(problem)
    assert relaxed is not None
    constant = float(prices[problem.customers].sum()) + sum(row["price"] * (len(row["sites"]) // 2) for row in rows)
    constant += sum(load["price"] * max(1, math.ceil(problem.sites.demand[load["sites"]].sum() / vehicle.capacity)) for load in loads)
    least, first = min(reduced), min(reduced if needed is None else through)
    return constant + min(first + (k - 1) * least for k in range(relaxed.fewest, relaxed.most + 1))


def times(visits: Sequence[int], row: dict[str, Any]) -> int:
    """How often a route has a row, whose half is lost where it is not remembered."""
    state, found = 0, 0
    for site in visits:
        state = state if site in row["memory"] else 0
        if site in row["sites"]:
            state, found = 1 - state, found + state
    return found


def drawn_rows(problem: RoutingProblem, rng: np.random.Generator, scale: float) -> tuple[list[Any], list[Any]]:
    """Subset rows and loads."""
    customers, rows, loads = problem.customers, [], []
    for _ in range(int(rng.integers(1, 5)) if len(customers) >= 3 else 0):
        sites = rng.choice(customers, 3 if len(customers) < 5 or rng.random() < 0.8 else 5, replace=False).tolist()
        memory = {*sites, *rng.choice(customers, int(rng.integers(0, 3)), replace=False).tolist()}
        rows.append({"sites": sites, "memory": sorted(memory), "price": -scale * float(rng.random())})
    for _ in range(int(rng.integers(1, 3))):
        sites = rng.choice(customers, int(rng.integers(1, len(customers) + 1)), replace=False).tolist()
        loads.append({"sites": sites, "price": scale * float(rng.random())})
    return rows, loads


@pytest.mark.share(5)
@pytest.mark.parametrize("feature", ["capacity", "time-windows", "service-times", "depot-windows", "max-distance", "limited-fleet",
                                     "fixed-cost", "travel", "open-routes"])  # fmt: skip
@pytest.mark.parametrize("seed", range(6))
def test_where_all_are_remembered_the_bound_is_that_of_the_cheapest_route(feature: str, seed: int) -> None:
    problem, rng = small(feature, seed, "exact"), np.random.default_rng(seed)
    for scale in (5.0, 40.0, 200.0):
        prices = rng.uniform(-0.2, 1.0, len(problem.sites)) * scale
        found = check_set_partitioning_duals(problem, evidence(prices))
        if found == math.inf:  # some site is out of reach
            assert best_values(problem) is None
            continue
        assert found == pytest.approx(expected(problem, prices), rel=1e-9)
        for memory in range(5):
            assert check_set_partitioning_duals(problem, evidence(prices, memory)) <= found + 1e-9 * abs(found)


@settings(max_examples=draws(60), deadline=None)
@given(seed=SEEDS, scale=st.sampled_from([0.1, 1.0, 10.0, 1e3, 1e9]))
def test_no_prices_of_rows_and_loads_prove_more_than_the_optimum(random_problem, optimum, seed, scale):
    problem = random_problem(seed, customers=seed % 4 + 1)
    best, rng, n = optimum(problem), np.random.default_rng(seed), len(problem.sites)
    for ray in (False, True):
        for _ in range(4):
            rows, loads = drawn_rows(problem, rng, scale)
            data = evidence(scale * rng.normal(size=n), int(rng.integers(0, n)), ray=ray, rows=rows, loads=loads)
            assert check_set_partitioning_duals(problem, data) <= best + 1e-9 * max(1.0, abs(best))


@pytest.mark.share(4)
@pytest.mark.parametrize("feature", ["capacity", "time-windows", "max-distance", "limited-fleet", "fixed-cost", "open-routes"])
@pytest.mark.parametrize("seed", range(6))
def test_with_rows_loads_and_needed_moves_the_bound_is_that_of_the_cheapest_routes(feature: str, seed: int) -> None:
    problem, rng = small(feature, seed, "exact"), np.random.default_rng(seed)
    if best_values(problem) is None:
        return
    n = len(problem.sites)
    for scale in (5.0, 40.0, 200.0):
        prices = rng.uniform(-0.2, 1.0, n) * scale
        rows, loads = drawn_rows(problem, rng, scale)
        data = evidence(prices, rows=rows, loads=loads)
        found = check_set_partitioning_duals(problem, data)
        assert found == pytest.approx(expected(problem, prices, rows, loads), rel=1e-9, abs=1e-9 * scale)
        needed = rng.random((n, n)) < 0.2
        needed[np.ix_(problem.sites.depots, problem.sites.depots)] = False
        through = check_set_partitioning_duals(problem.altered(needed=(needed,)), data)
        assert through == pytest.approx(expected(problem, prices, rows, loads, needed), rel=1e-9, abs=1e-9 * scale)
        assert through >= found
        several = check_set_partitioning_duals(problem.altered(needed=(~needed, needed, needed | (rng.random((n, n)) < 0.5))), data)
        assert several >= through - 1e-9 * scale


def circle(n: int, **fleet: Any) -> RoutingProblem:
    """Customers around a depot, a unit of demand each."""
    angle = np.linspace(0.0, 2.0 * np.pi, n, endpoint=False)
    xy = np.vstack([[0.0, 0.0], 10.0 * np.column_stack([np.cos(angle), np.sin(angle)])])
    return RoutingProblem(Sites.of(range(n + 1), demand=[0, *np.ones(n)]), Travel("euclidean", xy), (VehicleType(**fleet),))


@pytest.mark.parametrize("n", [63, 64, 65, 130])
def test_more_customers_than_a_word_has_bits(n: int) -> None:
    # Two visits a route: the cheapest goes to the pair of the largest savings and prices.
    problem, prices = circle(n, capacity=2.0), np.random.default_rng(n).uniform(0.0, 30.0, n + 1)
    far = problem.travel.distances
    pairs = far[0, 1:, None] + far[1:, 1:] + far[1:, 0] - prices[1:, None] - prices[None, 1:] + np.where(np.eye(n), math.inf, 0.0)
    least = min(float(pairs.min()), float((2.0 * far[0, 1:] - prices[1:]).min()))
    bound = prices[1:].sum() + min(k * least for k in (-(-n // 2), n))
    assert check_set_partitioning_duals(problem, evidence(prices)) == pytest.approx(bound, rel=1e-9)


def test_a_walk_that_forgets_earns_the_same_price_again() -> None:
    problem = circle(4, capacity=4.0, count=1)
    prices = [0.0, 100.0, 0.0, 0.0, 0.0]
    forgetful, mindful = (check_set_partitioning_duals(problem, evidence(prices, memory)) for memory in (0, 4))
    # To 1, elsewhere, and to 1 again; against once.
    assert mindful == pytest.approx(100.0 + 2 * 10.0 - 100.0)
    assert forgetful == pytest.approx(100.0 + 2 * 10.0 + 2 * 10.0 * math.sqrt(2.0) - 200.0)


def test_a_row_closes_the_gap_of_three_customers_of_whom_two_fit() -> None:
    problem, all_three = circle(3, capacity=2.0), {"sites": [1, 2, 3], "memory": [1, 2, 3]}
    pair, best = 20.0 + 10.0 * math.sqrt(3.0), 40.0 + 10.0 * math.sqrt(3.0)  # of the linear program three halves of pairs
    assert check_set_partitioning_duals(problem, evidence([0.0, *[pair / 2] * 3])) == pytest.approx(1.5 * pair)
    data = evidence([0.0, 20.0, 20.0, 20.0], rows=[{**all_three, "price": pair - 40.0}])
    assert check_set_partitioning_duals(problem, data) == pytest.approx(best)
    assert check_set_partitioning_duals(problem, {**data, "rows": [{**all_three, "price": -10.0}]}) == pytest.approx(50.0)
    twice = {**data, "rows": 2 * [{**all_three, "price": pair / 2 - 20.0}]}
    assert check_set_partitioning_duals(problem, twice) == pytest.approx(best)


def test_a_load_counts_the_vehicles_that_enter_a_set() -> None:
    problem = replace(circle(6, capacity=2.0), objective=Objective.of(Vehicles()))
    three = {"sites": [1, 3, 5], "price": 1.0}  # two vehicles, each of which comes from outside once at least
    assert check_set_partitioning_duals(problem, evidence(np.zeros(7), loads=[three, {**three, "sites": [2, 4, 6]}])) <= 3.0
    halves = [{"sites": [1, 2, 3], "price": 1.0}, {"sites": [4, 5, 6], "price": 1.0}]
    between = problem.restricted([({"moves": {a: ["4", "5", "6"] for a in "123"} | {a: ["1", "2", "3"] for a in "456"}}, False)])
    assert check_set_partitioning_duals(problem, evidence(np.zeros(7))) == 3.0
    assert check_set_partitioning_duals(between, evidence(np.zeros(7))) == 3.0
    assert check_set_partitioning_duals(between, evidence(np.zeros(7), loads=halves)) == 4.0


def test_one_route_makes_a_needed_move() -> None:
    problem = circle(4, capacity=2.0)  # two pairs of neighbours; a pair of opposite ones costs 40
    prices, beside = [0.0, *[10.0 + 5.0 * math.sqrt(2.0)] * 4], 20.0 + 10.0 * math.sqrt(2.0)
    assert check_set_partitioning_duals(problem, evidence(prices)) == pytest.approx(2.0 * beside)
    across = problem.restricted([({"moves": {"1": ["3"], "3": ["1"], "2": ["4"], "4": ["2"]}}, True)])
    assert check_set_partitioning_duals(across, evidence(prices)) == pytest.approx(beside + 40.0)
    back = across.restricted([({"moves": {"1": ["3"], "3": ["1"]}}, False), ({"arc": ["2", "4"]}, False)])
    assert check_set_partitioning_duals(back, evidence(prices)) == pytest.approx(beside + 40.0)
    none = back.restricted([({"arc": ["4", "2"]}, False)])
    assert check_set_partitioning_duals(none, evidence(prices)) == math.inf


@pytest.mark.parametrize("apart", [False, True])
def test_a_price_of_needed_moves_is_paid_once_and_taken_off_each_of_them(apart: bool) -> None:
    problem, opposite = circle(4, capacity=2.0), {"1": ["3"], "3": ["1"], "2": ["4"], "4": ["2"]}
    across = problem.restricted([({"moves": opposite}, True)])
    prices, beside = [0.0, *[20.0] * 4], 20.0 + 10.0 * math.sqrt(2.0)
    for price in (0.0, 1.0, 7.0, 50.0):
        data = evidence(prices, needed=[{"moves": opposite, "price": price}], apart=apart)
        found, alone = check_set_partitioning_duals(across, data), 80.0 + price + 4 * min(beside - 40.0, -price)
        assert alone - 1e-9 <= found <= 80.0 + 1e-9
        assert apart or not price or found == pytest.approx(alone)
        with pytest.raises(InputError, match="none of which is needed"):
            check_set_partitioning_duals(problem, data)
    fewer = {"moves": {"1": ["3"], "3": ["1"]}, "price": 1.0}  # another pair may be the one that is opposite
    with pytest.raises(InputError, match="none of which is needed"):
        check_set_partitioning_duals(across, evidence(prices, needed=[fewer], apart=apart))


@pytest.mark.parametrize("low", [0.0, 1e-3, 10.0])
def test_what_is_claimed_of_the_least_walk_is_proved_and_no_more(low: float) -> None:
    problem, rng = circle(12, capacity=4.0), np.random.default_rng(1)
    needed = problem.restricted([({"moves": {"1": ["7", "8"], "2": ["9"]}}, True)])
    for _ in range(draws(20)):
        prices = rng.uniform(8.0, 16.0, 13)
        bound = check_set_partitioning_duals(problem, evidence(prices, 4))
        least = (bound - math.fsum(prices[1:])) / 12  # there are 12 routes at most, and prices are such that it is below 0
        assert check_set_partitioning_duals(problem, evidence(prices, 4, least=least + low)) == pytest.approx(bound)
        if low:
            claimed = check_set_partitioning_duals(problem, evidence(prices, 4, least=least - low))
            assert claimed == pytest.approx(bound - 12 * low)
        through = check_set_partitioning_duals(needed, evidence(prices, 4))
        assert check_set_partitioning_duals(needed, evidence(prices, 4, least_needed=1e6)) == through >= bound
        assert check_set_partitioning_duals(needed, evidence(prices, 4, least_needed=-1e6)) == bound
        assert check_set_partitioning_duals(needed, evidence(prices, 4, least=1e300, least_needed=1e300)) == through


def test_lists_of_who_is_remembered_say_what_a_number_of_neighbours_says() -> None:
    problem, rng = circle(9, capacity=5.0), np.random.default_rng(2)
    far = problem.travel.distances[1:, 1:]
    for memory in range(9):
        lists = [[], *([int(k) + 1 for k in np.argsort(row, kind="stable")[: memory + 1]] for row in far)]
        prices = rng.uniform(0.0, 25.0, 10)
        bound = check_set_partitioning_duals(problem, evidence(prices, memory))
        assert check_set_partitioning_duals(problem, {"visits": prices.tolist(), "remembered": lists}) == bound
        for k, row in enumerate(lists[1:], start=1):  # he himself is always remembered
            row.remove(k)
        assert check_set_partitioning_duals(problem, {"visits": prices.tolist(), "remembered": lists}) == bound


def test_bounds_are_lifted_to_what_costs_can_be() -> None:
    travel = Travel(EXPLICIT, matrix=np.array([[0.0, 2, 4], [2, 0, 4], [4, 4, 0]]))
    problem = RoutingProblem(Sites.of("abc", demand=[0, 1, 1]), travel, (VehicleType(capacity=2.0),))
    assert check_set_partitioning_duals(problem, evidence([0.0, 4.0, 5.5])) == 10.0


def test_a_ray_proves_that_one_vehicle_does_not_suffice() -> None:
    problem = circle(3, capacity=2.0)
    assert check_set_partitioning_duals(problem, evidence([0.0, 1.0, 1.0, 1.0], ray=True)) == -math.inf
    sites = Sites.of(range(4), due=[math.inf, 10.0, 10.0, 10.0])  # too far from one to the next
    short = RoutingProblem(sites, problem.travel, (VehicleType(count=2),))
    assert check_set_partitioning_duals(short, evidence([0.0, 1.0, 1.0, 1.0], ray=True)) == math.inf
    more = replace(short, fleet=(VehicleType(count=3),))
    assert check_set_partitioning_duals(more, evidence([0.0, 1.0, 1.0, 1.0], ray=True)) == -math.inf


def test_a_customer_whom_no_move_reaches_has_no_answer() -> None:
    problem = circle(3, capacity=2.0)
    alone = problem.restricted([({"arc": [a, "2"]}, False) for a in "0123"])
    assert check_set_partitioning_duals(alone, evidence(np.zeros(4))) == math.inf
    apart = problem.restricted([({"routes": 2}, True), *(({"arc": [a, b]}, False) for a in "123" for b in "123" if a != b)])
    assert check_set_partitioning_duals(apart, evidence(np.zeros(4))) == math.inf


def test_other_objectives_and_sites_that_may_be_left_out_are_not_bounded() -> None:
    problem = circle(3, capacity=2.0)
    assert check_set_partitioning_duals(replace(problem, objective=Makespan()), evidence(np.ones(4))) == -math.inf
    sites = replace(problem.sites, required=np.array([False, True, True, False]))
    assert check_set_partitioning_duals(replace(problem, sites=sites), evidence(np.ones(4))) == -math.inf
    assert math.isfinite(check_set_partitioning_duals(replace(problem, sites=sites), evidence(np.ones(4), apart=True)))


def test_a_row_that_is_said_to_weigh_less_has_no_place_in_evidence() -> None:
    """Nothing in a row says what routes may have of it: that is half of its sites, rounded down."""
    with pytest.raises(InputError, match="malformed"):
        row = {"sites": [1, 2, 3], "memory": [1, 2, 3], "price": -1.0, "most": 0}
        check_set_partitioning_duals(circle(3), evidence(np.zeros(4), rows=[row]))


def test_more_rows_than_are_read_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(set_partitioning_duals, "ROWS", 2)
    row, load = {"sites": [1, 2, 3], "memory": [1, 2, 3], "price": -1.0}, {"sites": [1], "price": 1.0}
    assert math.isfinite(check_set_partitioning_duals(circle(3), evidence(np.zeros(4), rows=2 * [row], loads=2 * [load])))
    for more in ({"rows": 3 * [row]}, {"loads": 3 * [load]}):
        with pytest.raises(InputError, match="too many"):
            check_set_partitioning_duals(circle(3), evidence(np.zeros(4), **more))


@pytest.mark.parametrize("apart", [False, True])
@pytest.mark.parametrize("name", ["LABELS", "WORK", "CUSTOMERS"])
def test_beyond_its_limits_nothing_is_proved(name: str, apart: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = circle(8, capacity=4.0)
    assert math.isfinite(check_set_partitioning_duals(problem, evidence(np.ones(9), apart=apart)))
    monkeypatch.setattr(set_partitioning_duals, name, 7)
    assert check_set_partitioning_duals(problem, evidence(np.ones(9), apart=apart)) == -math.inf


def test_walks_of_one_type_are_the_same_apart() -> None:
    rng = np.random.default_rng(3)
    for feature in ("capacity", "time-windows", "service-times", "max-distance", "limited-fleet", "fixed-cost", "open-routes"):
        problem = small(feature, 1, "exact")
        needed = problem.restricted([({"moves": {a: [b for b in "2345" if b != a] for a in "34"}}, True)])
        for scale in (5.0, 40.0):
            rows, loads = drawn_rows(problem, rng, scale)
            data = evidence(rng.uniform(-0.2, 1.0, len(problem.sites)) * scale, 2, rows=rows, loads=loads)
            for part in (problem, needed):
                together, apart = (check_set_partitioning_duals(part, {**data, "apart": apart}) for apart in (False, True))
                assert apart == pytest.approx(together, rel=1e-9, abs=1e-9 * scale)


def test_a_search_for_needed_moves_that_is_too_long_leaves_what_all_walks_prove(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = circle(8, capacity=4.0)
    needed, data = problem.restricted([({"moves": {"1": ["5"], "2": ["6"]}}, True)]), evidence(np.full(9, 12.0), apart=True)
    whole, through = check_set_partitioning_duals(problem, data), check_set_partitioning_duals(needed, data)
    assert through > whole
    for work in (2_000, 3_000, 5_000, 8_000, 12_000, 20_000, 10**6):
        monkeypatch.setattr(set_partitioning_duals, "WORK", work)
        assert check_set_partitioning_duals(needed, data) in (-math.inf, whole, through)


LISTS: list[Any] = [
    None, 8, {}, [], [[]] * 3, [[]] * 5, [[], [4], [], []], [[], [-1], [], []], [[], [0], [], []], [[1], [], [], []], [[], [1.0], [], []],
    [[], ["1"], [], []], [[], [True], [], []], [[], [2, 2], [], []], [[], 1, [], []], [[], None, [], []], [[], [10**30], [], []],
]  # fmt: skip

ROWS: list[dict[str, Any]] = [
    {"price": 1.0}, {"price": 1e-300}, {"price": math.nan}, {"price": -math.inf}, {"price": None}, {"price": "-1"}, {"price": True},
    {"sites": [1, 2]}, {"sites": [1]}, {"sites": []}, {"sites": [1, 2, 2]}, {"sites": [0, 1, 2]}, {"sites": [1, 2, 4]},
    {"sites": [-1, 1, 2]}, {"sites": [1.0, 2.0, 3.0]}, {"sites": "123"}, {"sites": None}, {"memory": [1, 2]}, {"memory": []},
    {"memory": [0, 1, 2, 3]}, {"memory": [1, 2, 3, 3]}, {"memory": None}, {"memory": [1, 2, 3, 10**30]}, {"least": 0},
]  # fmt: skip

LOADS: list[dict[str, Any]] = [
    {"price": -1.0}, {"price": math.nan}, {"price": math.inf}, {"price": []}, {"sites": []}, {"sites": [0]}, {"sites": [1, 1]},
    {"sites": [4]}, {"sites": [True]}, {"sites": 1}, {"sites": [[1]]}, {"least": 3},
]  # fmt: skip


def test_it_gives_up_when_it_is_asked_to() -> None:
    problem, stop = circle(100, capacity=50.0), Stop(HANG)
    clock = threading.Timer(0.3, stop.ask)
    clock.start()
    with until(stop):
        assert check_set_partitioning_duals(problem, evidence(np.full(101, 30.0))) == -math.inf
    assert stop.reached() == "interrupt"
    with until(Stop(0.0)):
        assert check_set_partitioning_duals(circle(5, capacity=2.0), evidence(np.ones(6))) == -math.inf
    assert math.isfinite(check_set_partitioning_duals(circle(5, capacity=2.0), evidence(np.ones(6))))


@pytest.mark.parametrize(
    "data",
    [
        {}, {"visits": [0.0] * 4}, evidence([0.0] * 3), evidence([0.0] * 5), evidence([0.0, math.nan, 0.0, 0.0]),
        evidence([0.0, math.inf, 0.0, 0.0]), evidence([0.0] * 4, -1), evidence([0.0] * 4, True), evidence([0.0] * 4, 2.0),  # type: ignore[arg-type]
        evidence([0.0] * 4, "8"), evidence([0.0] * 4, None), evidence([0.0] * 4, ray=1), evidence([0.0] * 4, apart=1),  # type: ignore[arg-type]
        evidence([0.0] * 4, apart=None), evidence([0.0] * 4, apart="yes"), evidence([0.0] * 3, apart=True), {"visits": "0000", "memory": 1},  # type: ignore[arg-type]
        {"visits": {"at": [4], "values": [1.0]}, "memory": 1}, evidence([0.0] * 4, least=math.nan), evidence([0.0] * 4, least="0"),
        evidence([0.0] * 4, least_needed=None), evidence([0.0] * 4, least=True),
        *({"visits": [0.0] * 4, "remembered": lists} for lists in LISTS), evidence([0.0] * 4, remembered=[[], [], [], []]),
        *(evidence([0.0] * 4, rows=[{"sites": [1, 2, 3], "memory": [1, 2, 3], "price": -1.0, **row}]) for row in ROWS),
        *(evidence([0.0] * 4, needed=[{"moves": {"1": ["2"]}, "price": 1.0, **more}]) for more in ({}, {"price": -1.0}, {"moves": {}})),
        *(evidence([0.0] * 4, loads=[{"sites": [1, 2], "price": 1.0, **load}]) for load in LOADS),
        *(evidence([0.0] * 4, **{key: value}) for key in ("rows", "loads", "needed") for value in ({}, 1, None, [1], [[]], [{}], "12")),
    ],
)  # fmt: skip
def test_what_is_malformed_is_refused(data: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        check_set_partitioning_duals(circle(3), data)


def test_prices_that_overflow_prove_nothing() -> None:
    assert check_set_partitioning_duals(circle(3), evidence([0.0, 1e308, -1e308, 1e308])) == -math.inf
    assert check_set_partitioning_duals(circle(3), evidence([0.0, 1e18, -1e18, 1e18])) <= 0.0


def test_memories_beyond_all_customers_are_all_of_them() -> None:
    problem, prices = circle(6, capacity=4.0), np.full(7, 20.0)
    assert check_set_partitioning_duals(problem, evidence(prices, 5)) == check_set_partitioning_duals(problem, evidence(prices, 10**30))
