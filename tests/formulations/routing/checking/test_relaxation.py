import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st

from waybound import Evidence, Route, Routes, RoutingProblem, Sites, VehicleType
from waybound.formulations.routing.checking.relaxation import carried_loads, fewest_carriers, needed_moves, relax
from waybound.formulations.tolerance import LIMIT
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.routing.travel import EXPLICIT, Travel


@pytest.mark.slow
@settings(max_examples=draws(60), deadline=None)
@given(seed=st.integers(0, 10**6))
def test_every_feasible_answer_is_in_the_relaxation_at_no_greater_cost(random_problem, seed):
    problem = random_problem(seed)
    relaxed = relax(problem)
    node = {int(site): k for k, site in enumerate(relaxed.customers, start=1)}
    rng = np.random.default_rng(seed)
    for _ in range(60):
        order = rng.permutation(problem.customers).tolist()
        cuts = sorted(set(rng.integers(1, len(order) + 1, 3).tolist()) | {len(order)})
        routes = [Route(tuple(order[a:b]), int(rng.integers(len(problem.fleet)))) for a, b in zip([0, *cuts], cuts, strict=False)]
        verdict = problem.evaluate(Routes(tuple(r for r in routes if r.visits)))
        if not verdict.feasible:
            continue
        driven = [r for r in routes if r.visits]
        assert relaxed.fewest <= len(driven) <= relaxed.most
        stops = [[0, *(node[i] for i in r.visits), 0] for r in driven]
        cost = math.fsum(float(relaxed.cost[i, j]) for s in stops for i, j in itertools.pairwise(s))
        assert cost <= verdict.values[0] + 1e-9
        if relaxed.grain is not None:
            grains = verdict.values[0] / relaxed.grain.size
            assert abs(grains - round(grains)) < 1e-6


def test_windows_shut_out_arcs_that_no_route_can_use():
    sites = Sites.of("oab", ready=[0, 0, 30], due=[100, 10, 40])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.full((3, 3), 5.0)), (VehicleType(),))
    cost = relax(problem).cost
    assert math.isfinite(cost[1, 2])
    assert math.isinf(cost[2, 1])


def test_loads_that_do_not_fit_together_shut_out_arcs():
    problem = RoutingProblem(Sites.of("oabc", demand=[0, 3, 3, 1]), Travel(EXPLICIT, matrix=np.ones((4, 4))), (VehicleType(capacity=4),))
    cost = relax(problem).cost
    assert math.isinf(cost[1, 2])
    assert math.isinf(cost[2, 1])
    assert math.isfinite(cost[1, 3])


def test_total_demand_sets_the_fewest_routes():
    problem = RoutingProblem(
        Sites.of("oabc", demand=[0, 2, 2, 2]), Travel(EXPLICIT, matrix=np.ones((4, 4))), (VehicleType(capacity=5, count=9),)
    )
    relaxed = relax(problem)
    assert (relaxed.fewest, relaxed.most) == (2, 3)


def test_a_late_arrival_within_the_tolerance_of_the_check_keeps_its_arc():
    matrix = np.array([[0, 10.0], [10.0, 0]])
    problem = RoutingProblem(Sites.of("oa", due=[100, 10 * (1 - 0.9 * LIMIT)]), Travel(EXPLICIT, matrix=matrix), (VehicleType(),))
    assert problem.evaluate(Routes.of([[1]])).feasible
    assert math.isfinite(relax(problem).cost[0, 1])


@pytest.mark.parametrize("opening", [1e6, 1.7e9])
def test_durations_are_known_as_closely_as_the_clock_of_their_own_depot(opening):
    """The judge's rounding is that of the second depot's times; the earliest opening of the fleet is 0."""
    matrix = np.ones((3, 3)) - np.eye(3)
    limit = 2.0 - 2e-15 * opening
    sites = Sites.of("abc", depot=[True, True, False], ready=[0, opening, opening])
    fleet = (VehicleType(start=0, end=0, max_duration=limit, max_distance=1.0), VehicleType(start=1, end=1, max_duration=limit))
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix), fleet)
    assert problem.evaluate(Routes((Route((2,), 1),))).feasible
    for kind, data in (("spanning-tree", {"multipliers": [0.0] * 3}), ("arc-multipliers", {"out": [0.0] * 3, "in": [0.0] * 3})):
        assert verified_bound(problem, Evidence(kind, "", 0.0, data)) < math.inf


def test_customers_that_share_no_route_are_first_and_last_of_their_own():
    problem = RoutingProblem(Sites.of("oabc", demand=[0, 3, 3, 3]), Travel(EXPLICIT, matrix=np.ones((4, 4))), (VehicleType(capacity=5),))
    relaxed = relax(problem)
    assert relaxed.first.all() and relaxed.last.all()
    assert (relaxed.fewest, relaxed.most) == (3, 3)
    part = relax(problem.restricted([({"arc": [a, "a"]}, False) for a in "bc"]))
    assert part.first.tolist() == [True, True, True]
    wide = RoutingProblem(Sites.of("oabc"), Travel(EXPLICIT, matrix=np.ones((4, 4))), (VehicleType(),))
    part = relax(wide.restricted([({"arc": ["o", "a"]}, True), ({"arc": ["b", "o"]}, True)]))
    assert part.first.tolist() == [True, False, False] and part.last.tolist() == [False, True, False]
    assert (part.fewest, part.most) == (1, 3)


def test_routes_at_the_depot_hold_what_is_sure_and_the_cheapest_of_the_rest():
    wide = RoutingProblem(Sites.of("oabc"), Travel(EXPLICIT, matrix=np.ones((4, 4))), (VehicleType(),), min_vehicles=1)
    relaxed = relax(wide)
    surely = np.array([False, True, False])
    assert relaxed.cheapest_routes(np.array([1.0, 5.0, -2.0]), 0.0, surely) == 3.0
    assert relaxed.cheapest_routes(np.array([1.0, 5.0, -2.0]), 0.0, ~surely) == -1.0
    assert relaxed.cheapest_routes(np.array([1.0, 5.0, -2.0]), 10.0, surely) == 15.0
    assert relaxed.cheapest_routes(np.array([1.0, math.inf, -2.0]), 0.0, surely) == math.inf


def groups_of(*groups: list[int]) -> list[np.ndarray]:
    return [np.array(group) for group in groups]


def test_a_group_needs_the_fewest_vehicles_that_carry_it_the_largest_first():
    sites = Sites.of("oabcd", demand=[0, 4, 4, 4, 0])
    fleet = (VehicleType(1, 7.0, name="large"), VehicleType(2, 3.0, name="small"))
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((5, 5))), fleet)
    assert fewest_carriers(problem, groups_of([4], [1], [1, 2], [1, 2, 3], [3, 4])) == [1, 1, 2, 3, 1]
    more = replace(problem, fleet=(*fleet, VehicleType(None, 5.0, name="hired")))
    assert fewest_carriers(more, groups_of([1, 2, 3])) == [2]
    few = replace(problem, fleet=(VehicleType(1, 7.0),))
    assert fewest_carriers(few, groups_of([1], [1, 2, 3])) == [1, 2]  # all vehicles are too small: there is no answer
    assert fewest_carriers(replace(problem, fleet=(VehicleType(),)), groups_of([1, 2, 3])) == [1]
    assert fewest_carriers(problem, []) == []


def test_what_fits_but_for_rounding_needs_no_further_vehicle():
    sites = Sites.of("oabc", demand=[0, 0.1, 0.1, 0.1])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((4, 4))), (VehicleType(capacity=0.3),))
    assert problem.evaluate(Routes.of([[1, 2, 3]])).feasible
    assert fewest_carriers(problem, groups_of([1, 2, 3])) == [1]


def test_pickups_and_further_loads_need_vehicles_too():
    ones = Travel(EXPLICIT, matrix=np.ones((4, 4)))
    both = RoutingProblem(Sites.of("oabc", demand=[0, 1, 1, 1], pickup=[0, 4, 4, 4]), ones, (VehicleType(capacity=5.0),))
    assert fewest_carriers(both, groups_of([1], [1, 2], [1, 2, 3])) == [1, 2, 3]
    sites = Sites.of("oabc", demand=np.array([[0, 0], [1, 2], [1, 2], [1, 2]]))
    two = RoutingProblem(sites, ones, (VehicleType(capacity=9.0, further_capacity=(4.0,)), VehicleType(1, 2.0, further_capacity=(2.0,))))
    assert fewest_carriers(two, groups_of([1, 2], [1, 2, 3])) == [1, 2]
    assert fewest_carriers(replace(two, fleet=(VehicleType(capacity=9.0),)), groups_of([1, 2, 3])) == [1]


def test_needed_moves_from_any_depot_are_moves_from_the_merged_one():
    sites = Sites.of("opab", depot=[True, True, False, False])
    fleet = (VehicleType(None, 5.0, 0, 0, name="north"), VehicleType(None, 5.0, 1, 0, name="south"))
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((4, 4))), fleet)
    part = problem.restricted([({"moves": {"p": ["a"], "a": ["b"], "b": ["o", "p"]}}, True)])
    assert [np.argwhere(moves).tolist() for moves in needed_moves(part)] == [[[0, 1], [1, 2], [2, 0]]]
    # Nobody returns to p, so that this is none of anybody's moves.
    assert [moves.sum() for moves in needed_moves(problem.restricted([({"moves": {"b": ["p"]}}, True)]))] == [0]


def test_a_set_of_needed_moves_says_nothing_where_another_is_part_of_it_or_nobody_may_be_served():
    problem = RoutingProblem(Sites.of("oab", demand=[0, 1, 1]), Travel(EXPLICIT, matrix=np.ones((3, 3))), (VehicleType(),))
    wide, narrow, other = ({"moves": moves} for moves in ({"a": ["b"], "b": ["a"]}, {"a": ["b"]}, {"o": ["a"]}))
    for statements in ([wide, narrow], [narrow, wide], [narrow, narrow], [wide, narrow, wide]):
        assert [np.argwhere(m).tolist() for m in needed_moves(problem.restricted([(s, True) for s in statements]))] == [[[1, 2]]]
    assert len(needed_moves(problem.restricted([(s, True) for s in (wide, other)]))) == 2
    depots, fleet = Sites.of("opab", depot=[True, True, False, False]), (VehicleType(2, 5.0, 0, 1, committed=True),)
    two = RoutingProblem(depots, Travel(EXPLICIT, matrix=np.ones((4, 4))), fleet)
    assert needed_moves(two.restricted([({"moves": {"o": ["p"], "a": ["b"]}}, True)])) == []


def test_where_vehicles_stop_on_their_way_no_moves_are_needed():
    sites = Sites.of("oab", demand=[0, 1, 1])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((3, 3))), (VehicleType(1, 1.0, reloads=(0,)),))
    part = problem.restricted([({"moves": {"a": ["b"]}}, True)])
    assert needed_moves(part) == [] and part.needed and fewest_carriers(part, groups_of([1, 2])) == [1]


@pytest.mark.parametrize("seed", range(draws(6)))
def test_levels_of_carried_loads_keep_to_their_limits_where_the_judge_says_so(seed):
    rng = np.random.default_rng(seed)
    n, dimensions = 4, int(rng.integers(1, 3))
    demand, pickup = (np.vstack([np.zeros(dimensions), rng.integers(0, 6, (n, dimensions))]) for _ in range(2))
    vehicle = VehicleType(capacity=11.0, further_capacity=(9.0,) * (dimensions - 1))
    sites = Sites.of(range(n + 1), demand=demand, pickup=pickup, required=False)
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((n + 1, n + 1))), (vehicle,))
    resources = carried_loads(problem, ~np.eye(n + 1, dtype=bool))
    outcomes = set()
    for size in range(1, n + 1):
        for order in itertools.permutations(range(1, n + 1), size):
            feasible = problem.evaluate(Routes((Route(order, 0),))).feasible
            outcomes.add(feasible)
            assert feasible == _keeps(resources, (0, *order, 0)), order
    assert outcomes == {True, False}


@pytest.mark.parametrize(("demand", "pickup", "capacity"), [((0, 1, 0), (0, 10, 10), 20.0), ((0, 0.1, 0), (0, 0.1 + 1e-12, 0.2), 0.3)])
def test_a_vehicle_may_be_filled_by_what_is_collected_alone(demand, pickup, capacity):
    sites = Sites.of("oab", demand=demand, pickup=pickup)
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=np.ones((3, 3))), (VehicleType(count=1, capacity=capacity),))
    assert problem.evaluate(Routes((Route((1, 2), 0),))).feasible
    assert _keeps(carried_loads(problem, ~np.eye(3, dtype=bool)), (0, 1, 2, 0))
    for apart in (False, True):
        evidence = Evidence("set-partitioning-duals", "", 0.0, {"visits": [0.0, 0.0, 0.0], "memory": 0, "apart": apart})
        assert verified_bound(problem, evidence) == 2.0  # one site alone


def _keeps(resources, walk):
    levels = {id(r): r.start for r in resources}
    for i, j in itertools.pairwise(walk):
        after = {id(r): max(levels[id(r)] + r.weight[i, j], r.lower[j]) for r in resources}
        levels = {id(r): max(after[id(r)], after.get(id(r.above), 0.0)) for r in resources}
        if any(levels[id(r)] > r.upper[j] + r.slack for r in resources):
            return False
    return True
