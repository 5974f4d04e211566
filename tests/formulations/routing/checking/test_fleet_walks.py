import itertools
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from routing_answers import Answers, best_of, drawn_evidence, drawn_statement, grown, partition
from small_routing import FEATURES, WHOLE_FAMILY, drawn
from truth.routing import Roads, RoutingTruth, best_values

from waybound import Evidence, Makespan, Objective, Penalties, Reward, RoutingProblem, TotalCost, TotalDuration, Vehicles
from waybound.formulations.checking.granularity import lift
from waybound.formulations.routing.checking.fleet_walks import Slot, cheapest, limiting, remembered
from waybound.formulations.routing.checking.relaxation import customers_moves
from waybound.formulations.routing.checking.set_partitioning_duals import check_set_partitioning_duals
from waybound.formulations.routing.checking.told_visits import told_visits
from waybound.formulations.routing.checking.vehicle_moves import VehicleMoves, relaxed_terms, value_grain
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.instance import Group, Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel

SUMS = (
    "heterogeneous-fleet", "multiple-depots", "prizes", "reward", "limited-fleet", "fixed-cost", "open-routes", "time-windows",
    "max-distance", "vehicles",
)  # fmt: skip
"""Features beside which all adds up along routes."""

PEAKS = {"objective:makespan", "objective:longest-route", "objective:latest-return"}


def sign(problem: RoutingProblem) -> float:
    return 1.0 if problem.sense == "min" else -1.0


@pytest.mark.share(6)
@pytest.mark.parametrize("feature", [*WHOLE_FAMILY, *FEATURES])
def test_nothing_that_is_priced_or_stated_proves_more_than_the_best_answer_left(feature: str) -> None:
    for seed in range(draws(10)):
        problem, rng = drawn(feature, seed), np.random.default_rng([seed, *feature.encode()])
        if rng.random() < 0.4 and not problem.sites.shipments:
            required = problem.sites.required & (rng.random(len(problem.sites)) < 0.5)
            problem = replace(problem, sites=replace(problem.sites, required=required))
        every, stops = Answers(problem).all, any(v.reloads or v.stations for v in problem.fleet)
        for trial in range(6):
            decisions = [(drawn_statement(problem, rng), bool(rng.random() < 0.6)) for _ in range(0 if stops else trial)]
            part, best = problem.restricted(decisions), best_of(problem, every, decisions)
            for ray in (False, True):
                scale = float(rng.choice([0.0, 1.0, 10.0, 100.0]))
                data = {**drawn_evidence(problem, rng, scale), "ray": ray}
                made = [statement["moves"] for statement, holds in decisions if holds and "moves" in statement]
                if rng.random() < 0.7 and len(customers_moves(part)) == len(part.needed):
                    data["needed"] = [{"moves": moves, "price": scale * float(rng.random())} for moves in made]
                bound = check_set_partitioning_duals(part, data)
                assert bound == best or sign(problem) * (bound - best) <= 1e-9 * max(1.0, abs(best)), (decisions, data)


def expected(problem: RoutingProblem, data: dict[str, Any]) -> float:
    """The bound, from all routes one by one, and all numbers of them."""
    truth, sites, prices = RoutingTruth(replace(problem, needed=())), problem.sites, np.array(data["visits"])
    surely, never = (dict(zip(problem.customers.tolist(), flags.tolist(), strict=True)) for flags in told_visits(problem))
    nothing = truth.values([])[0]
    reduced, met = [list[float]() for _ in problem.fleet], set[int]()
    for kind, vehicle in enumerate(problem.fleet):
        roads = Roads(replace(problem, fleet=(replace(vehicle, count=None),), needed=()))
        for visits, driven in roads.routes(0):
            truth.driven[kind, visits] = driven
            cost = sign(problem) * float(truth.values([(kind, visits)])[0] - nothing) - float(prices[list(visits)].sum())
            moves = list(itertools.pairwise([vehicle.start, *visits, vehicle.end]))
            cost -= sum(load["price"] * sum(i not in load["sites"] and j in load["sites"] for i, j in moves) for load in data["loads"])
            cost -= sum(row["price"] * (sum(site in row["sites"] for site in visits) // 2) for row in data["rows"])
            if not any(never[site] for site in visits):
                reduced[kind].append(cost)
                met.update(visits)
    never |= {k: True for k in never if k not in met}

    def carriers(members: Sequence[int]) -> int:
        room = sorted((v.capacity for v in problem.fleet for _ in range(v.count or len(prices))), reverse=True)
        rooms, asked = itertools.accumulate(room), sum(sites.demand[k] for k in members if surely.get(k))
        return next(k for k, held in enumerate(rooms, 1) if held >= asked) if any(surely.get(k) for k in members) else 0

    fewest = max(problem.min_vehicles, carriers(problem.customers.tolist()), any(group.required for group in sites.groups))
    slots = [(min(costs), range(1 + (v.count or len(surely)))) for costs, v in zip(reduced, problem.fleet, strict=True) if costs]
    numbers = [ks for ks in itertools.product(*(ks for _, ks in slots)) if fewest <= sum(ks) <= len(surely)]
    total = min(sum(k * least for k, (least, _) in zip(ks, slots, strict=True)) for ks in numbers)
    grouped = {k for group in sites.groups for k in group.sites if not any(surely[j] for j in group.sites)}
    for k in surely:
        total += prices[k] if surely[k] else 0.0 if never[k] or k in grouped else min(prices[k], 0.0)
    for group in sites.groups:
        if grouped & {*group.sites}:
            total += min([float(prices[k]) for k in group.sites if not never[k]] + [0.0] * (not group.required))
    total += sum(load["price"] * carriers(load["sites"]) for load in data["loads"])
    total += sum(row["price"] * (len(row["sites"]) // 2) for row in data["rows"])
    terms = relaxed_terms(problem)[1]
    assert terms is not None
    return lift(sign(problem) * total + float(nothing), problem.sense, value_grain(problem, terms))


@pytest.mark.share(4)
@pytest.mark.parametrize("feature", SUMS)
@pytest.mark.parametrize("seed", range(4))
def test_where_all_are_remembered_the_bound_is_that_of_the_cheapest_routes_of_each_type(feature: str, seed: int) -> None:
    problem, rng = drawn(feature, seed, "exact"), np.random.default_rng(seed)
    if best_values(problem) is None:
        return
    if seed % 2 and not problem.sites.groups:
        must, loose = problem.sites.required & (rng.random(len(problem.sites)) < 0.5), problem.customers[:2].tolist()
        must[loose] = False
        problem = replace(problem, sites=replace(problem.sites, required=must, groups=(Group(tuple(loose), seed % 4 > 1),)))
    for scale in (1.0, 20.0, 60.0):
        data = {"loads": [], "rows": [], **drawn_evidence(problem, rng, scale), "remembered": _lists(problem)}
        for key in ("memory", "least", "least_needed"):
            data.pop(key, None)
        for row in data["rows"]:
            row["memory"] = problem.customers.tolist()
        found = check_set_partitioning_duals(problem, data)
        assert abs(found - expected(problem, data)) <= 1e-9 * max(1.0, abs(found), 10 * scale)
        visited = problem.restricted([({"visited": problem.sites.ids[rng.choice(problem.customers)]}, True)])
        further = check_set_partitioning_duals(visited, data)
        if math.isfinite(further):
            assert abs(further - expected(visited, data)) <= 1e-9 * max(1.0, abs(further), 10 * scale)
        assert sign(problem) * (further - found) >= -1e-9 * max(1.0, abs(found), 10 * scale)


def _lists(problem: RoutingProblem) -> list[list[int]]:
    return [[] if depot else problem.customers.tolist() for depot in problem.sites.depot]


@pytest.mark.share(4)
@pytest.mark.parametrize("feature", [*SUMS[:5], "penalties", "skills", "groups", "vehicle-speeds", "vehicle-travel"])
def test_trees_of_visits_types_and_moves_prove_the_optimum(feature: str) -> None:
    proved = 0
    for seed in range(draws(15)):
        problem = drawn(feature, seed)
        if problem.features() & {*PEAKS, "recharging", "reloads", "shipments"}:
            continue
        values = best_values(problem)
        best = sign(problem) * math.inf if values is None else values[0]
        relaxed = partition(problem)
        found = check_set_partitioning_duals(problem, {"visits": relaxed.prices, "remembered": _lists(problem), "apart": True})
        assert sign(problem) * found >= relaxed.value - 1e-6 * max(1.0, abs(relaxed.value)) or math.isinf(relaxed.value)
        tree = Evidence("branching-tree", "", 0.0, {"nodes": grown(problem, best)})
        assert verified_bound(problem, tree) == pytest.approx(best, rel=1e-6)
        proved += 1
    assert proved


@settings(max_examples=draws(200), deadline=None)
@given(
    slots=st.lists(st.tuples(st.integers(-9, 9), st.integers(0, 3)), max_size=3), fewest=st.integers(0, 6), more=st.integers(0, 4)
)  # fmt: skip
def test_the_cheapest_numbers_of_routes_are_those_of_all(slots: list[tuple[int, int]], fewest: int, more: int) -> None:
    every = itertools.product(*(range(count + 1) for _, count in slots))
    sums = [sum(k * least for k, (least, _) in zip(ks, slots, strict=True)) for ks in every if fewest <= sum(ks) <= fewest + more]
    assert cheapest([Slot(*slot) for slot in slots], fewest, fewest + more) == min(sums, default=None)


def two_types(**sites: Any) -> RoutingProblem:
    """Three customers around a depot at 10 each, 12 from each other; one small cheap vehicle, one large dear one."""
    matrix = np.full((4, 4), 12.0)
    matrix[0], matrix[:, 0] = 10.0, 10.0
    np.fill_diagonal(matrix, 0.0)
    fleet = (VehicleType(1, 1.0, name="small"), VehicleType(1, 3.0, unit_cost=2.0, fixed_cost=7.0, name="large"))
    return RoutingProblem(Sites.of("oabc", demand=[0, 1, 1, 1], **sites), Travel(EXPLICIT, matrix=matrix), fleet)


def bound(problem: RoutingProblem, prices: Sequence[float], **more: Any) -> float:
    return check_set_partitioning_duals(problem, {"visits": [0.0, *prices], "memory": 3, "apart": True, **more})


Decisions = list[tuple[dict[str, Any], bool]]


def test_each_type_pays_its_own_moves() -> None:
    problem = two_types()
    # The small vehicle takes one of them for 20; the large one takes one for 47, two for 71, three for 95.
    assert best_values(problem) == (91.0,)
    assert bound(problem, [0.0, 0.0, 0.0]) == 20.0
    assert bound(problem, [24.0, 24.0, 24.0]) == 72.0 - 4.0
    third = 95.0 / 3.0
    assert bound(problem, [third] * 3) == 84.0  # of 83.3, for all costs are whole
    assert check_set_partitioning_duals(problem, {"visits": [0.0, *[third] * 3], "memory": 3}) < 60.0  # merged, cheap and large
    assert bound(replace(problem, min_vehicles=2), [0.0, 0.0, 0.0]) == 20.0 + 47.0
    assert bound(problem.restricted([({"visited": "a", "by": [0]}, True)]), [35.5] * 3) == 91.0


def test_signs_are_those_of_a_minimisation() -> None:
    reward = replace(two_types(reward=[5.0, 30.0, 40.0, 50.0], required=False), objective=Reward() - TotalCost())
    assert reward.sense == "max" and best_values(reward) == (5.0 + 30.0,)  # the small vehicle fetches c
    assert bound(reward, [0.0, 0.0, 0.0]) == 5.0 + 30.0 + 25.0
    assert bound(reward, [0.0, 0.0, -25.0]) == 5.0 + 25.0 + 20.0
    assert bound(reward, [0.0, -7.5, -17.5]) == 42.0  # 42.5, rounded as whole values are
    assert bound(reward, [100.0, 0.0, 0.0]) == 5.0 + 110.0 + 125.0  # nobody has to earn it
    assert bound(reward.restricted([({"visited": "a"}, True)]), [100.0, 0.0, 0.0]) == 5.0 + 110.0 + 125.0 - 100.0
    assert bound(reward.restricted([({"visited": "b"}, False)]), [0.0, 50.0, 0.0]) == 5.0 + 30.0 + 9.0
    lost = replace(two_types(penalty=[0.0, 30.0, 15.0, 45.0], required=False), objective=TotalCost() + Penalties())
    assert best_values(lost) == (65.0,)
    assert bound(lost, [0.0, 0.0, 0.0]) == 90.0 - 25.0 - 4.0


def test_of_alternatives_the_cheapest_counts_or_the_one_who_is_visited() -> None:
    problem, prices = two_types(groups=[Group((1, 2))]), [30.0, 10.0, 20.0]
    assert bound(problem, prices) == 10.0 + 20.0 - 10.0
    stated: list[tuple[Decisions, float]] = [
        ([({"visited": "a"}, True)], 30.0 + 20.0 - 10.0), ([({"visited": "a"}, False)], 10.0 + 20.0), ([({"visited": "b"}, True)], 30.0),
        ([({"visited": "a"}, True), ({"visited": "b"}, True)], math.inf),
        ([({"visited": "a"}, False), ({"visited": "b"}, False)], math.inf),
    ]  # fmt: skip
    for decisions, value in stated:
        assert bound(problem.restricted(decisions), prices) == value
    loose = two_types(groups=[Group((1, 2), required=False)])
    assert bound(loose, prices) == 20.0 - 10.0 and bound(loose, [-5.0, -3.0, 20.0]) == 20.0 - 5.0


def test_who_is_surely_visited_asks_for_vehicles() -> None:
    free = replace(two_types(required=False), fleet=(VehicleType(3, 1.0), VehicleType(1, 1.0, unit_cost=3.0)))
    assert bound(free, [0.0, 0.0, 0.0]) == 0.0
    two: Decisions = [({"visited": "a"}, True), ({"visited": "c", "by": [0, 1]}, True)]
    assert bound(free.restricted(two), [0.0, 0.0, 0.0]) == 40.0
    around = [{"sites": [1, 2, 3], "price": 20.0}]
    assert bound(free.restricted(two), [0.0, 0.0, 0.0], loads=around) == 40.0
    assert bound(free.restricted(two[:1]), [0.0, 0.0, 0.0], loads=around) == 20.0
    assert bound(free, [0.0, 0.0, 0.0], loads=around) == 0.0
    assert bound(free.restricted([({"visited": "a", "by": [1]}, True)]), [60.0, 0.0, 0.0]) == 60.0
    first = two_types().restricted([({"moves": {"a": ["b", "c"], "b": ["c"], "c": ["b"]}}, False)])
    assert bound(first, [0.0, 0.0, 0.0]) == 67.0  # b and c both come first


def test_one_route_of_some_type_makes_a_needed_move() -> None:
    problem = two_types(required=False)
    across: Decisions = [({"moves": {"a": ["b"], "b": ["c"], "c": ["a"]}}, True)]
    assert bound(problem, [0.0, 0.0, 0.0]) == 0.0
    assert bound(problem.restricted(across), [0.0, 0.0, 0.0]) == 71.0  # no other route is needed
    assert bound(replace(problem, min_vehicles=2).restricted(across), [0.0, 0.0, 0.0]) == 71.0 + 20.0
    assert bound(problem.restricted(across), [30.0, 30.0, 30.0]) == 5.0 - 10.0  # and the small one for one of them
    assert bound(problem.restricted([({"arc": ["a", "b"]}, True)]), [30.0, 30.0, 30.0]) == 60.0 + 5.0 - 10.0
    beside: Decisions = [({"moves": {"a": ["b"], "c": ["a"]}}, True)]  # by the large one, which then is not there for b and c alone
    assert bound(problem.restricted(beside), [0.0, 60.0, 60.0]) == (95.0 - 120.0) + (20.0 - 60.0)
    small = replace(problem, fleet=(problem.fleet[0],))
    assert bound(small.restricted(across), [0.0, 0.0, 0.0]) == math.inf


def test_there_is_no_answer_where_nobody_may_visit() -> None:
    problem = replace(two_types(required=False), objective=Makespan())  # whatever the objective
    none: list[Decisions] = [
        [({"visited": "a"}, True), ({"visited": "a"}, False)],
        [({"visited": "a", "by": [0]}, True), ({"visited": "a", "by": [0]}, False)],
        [({"visited": "a", "by": [0]}, True), ({"visited": "a", "by": [1]}, True)],
        [({"visited": "a", "by": [0, 1]}, False), ({"arc": ["a", "b"]}, True)],
    ]
    for decisions in none:
        assert bound(problem.restricted(decisions), [0.0, 0.0, 0.0], ray=True) == math.inf
    both: Decisions = [({"visited": "a", "by": [0]}, True), ({"visited": "b", "by": [0]}, True)]  # it has room for one
    assert bound(problem.restricted(both), [1.0, 1.0, 0.0], ray=True) == math.inf
    assert bound(problem.restricted(both), [1.0, 1.0, 0.0]) == -math.inf  # nothing is known of the largest route
    assert bound(problem.restricted(both[:1]), [1.0, 1.0, 0.0], ray=True) == -math.inf
    assert (
        bound(replace(problem, fleet=problem.fleet[:1]).restricted([({"visited": s}, True) for s in "ab"]), [0.0] * 3, ray=True) == math.inf
    )


@pytest.mark.parametrize("objective", [Makespan(), TotalCost() + Makespan(), Reward() + TotalCost()])
def test_largest_routes_and_costs_of_which_more_is_better_are_not_bounded(objective: Any) -> None:
    problem = replace(two_types(), objective=Objective.of(objective))
    assert abs(bound(problem, [0.0, 0.0, 0.0])) == math.inf
    assert math.isfinite(bound(replace(problem, objective=TotalDuration() + 3.0 * Vehicles()), [0.0, 0.0, 0.0]))


def test_types_of_very_different_costs_share_their_prices() -> None:
    problem = two_types()
    dear = replace(problem, fleet=(problem.fleet[0], replace(problem.fleet[1], unit_cost=math.pi * 1e9)))
    best = best_values(dear)
    price = (best[0] - 20.0) / 2
    found = bound(dear.restricted([({"visited": "a", "by": [0]}, True)]), [price] * 3)
    assert found <= best[0] and found == pytest.approx(best[0], rel=1e-9)


def test_an_empty_answer_is_one_where_nobody_can_be_visited() -> None:
    closed = two_types(required=False, penalty=[0.0, 1.0, 2.0, 3.0])
    closed = replace(closed, objective=TotalCost() + Penalties()).restricted([({"visited": s}, False) for s in "abc"])
    assert bound(closed, [7.0, -7.0, 0.0]) == 6.0
    assert bound(replace(closed, min_vehicles=1), [0.0, 0.0, 0.0]) == math.inf


def test_numbers_that_cannot_be_added_up_prove_nothing() -> None:
    assert bound(two_types(), [1e308, -1e308, 1e308]) == -math.inf
    assert bound(replace(two_types(), objective=1e300 * TotalCost()), [0.0, 0.0, 0.0]) <= 2e301
    large = replace(two_types(penalty=1e140, required=False), objective=TotalCost() + 1e200 * Penalties())
    assert bound(large, [0.0, 0.0, 0.0]) == -math.inf


def test_time_limits_walks_where_windows_or_shifts_do() -> None:
    problem = two_types()
    terms = relaxed_terms(problem)[1]
    assert terms is not None
    for change, names in (({}, 1), ({"max_distance": 40.0}, 2), ({"shift": (0.0, 50.0)}, 2)):
        alone = replace(problem, fleet=(replace(problem.fleet[1], **change),))
        moves = VehicleMoves.of(alone, alone.fleet[0], terms, np.zeros(3), {})
        assert len(limiting(alone, moves.resources, np.isfinite(moves.cost))) == names
    late = bound(replace(problem, fleet=(VehicleType(shift=(0.0, 31.0)),)), [20.0, 20.0, 20.0])
    assert late == 60.0  # one at a time: two of them take 32


def test_the_nearest_are_remembered_or_those_who_are_listed() -> None:
    problem, usable = two_types(), ~np.eye(4, dtype=bool)
    lists = np.array([[-1], [2], [1], [1]], np.int32)
    assert remembered(problem, usable, lists) is lists
    assert remembered(problem, usable, 1).tolist() == [[-1], [2], [1], [1]]
    usable[1, 2] = usable[2, 1] = False
    assert remembered(problem, usable, 1).tolist() == [[-1], [3], [3], [1]]
