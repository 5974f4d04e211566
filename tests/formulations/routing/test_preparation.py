import itertools
import math

import numpy as np
import pytest
from draws import draws
from hypothesis import HealthCheck, given, settings
from oracles import ASYM_5, SQUARE_4, TW_4, routing, small_problems
from truth.routing import routes

from waybound import Energy, Reward, RoutingProblem, TotalCost, Vehicles
from waybound.formulations.routing.preparation import leaves_cycles, prepare, waiting_is_possible


@settings(max_examples=draws(150), deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(problem=small_problems())
def test_every_feasible_route_keeps_its_arcs_and_runs_within_the_ranges(problem: RoutingProblem) -> None:
    prep = prepare(problem)
    arcs = {(int(i), int(j)): k for k, (i, j) in enumerate(zip(prep.tail, prep.head, strict=True))}
    node = {int(site): k for k, site in enumerate(prep.sites[1:-1], start=1)}
    for visits in routes(problem, problem.fleet[0]):
        order = [node[site] for site in visits]
        steps = list(itertools.pairwise((0, *order, prep.end)))
        assert all(step in arcs for step in steps), order
        assert prep.usable[order].all()
        for r in prep.resources.values():
            level = r.lower[0]
            for (_, j), arc in zip(steps, (arcs[s] for s in steps), strict=True):
                level = max(level + r.weight[arc], r.lower[j]) if r.waits else level + r.weight[arc]
                assert r.lower[j] - 1e-9 <= level <= r.upper[j] + 1e-6, (r.name, order, j)


def test_windows_shrink_to_what_can_be_reached_and_left_in_time() -> None:
    """From the depot at 0: site 4 cannot be left late enough to make site 2, and so on (TW-4)."""
    prep = prepare(routing(xy=SQUARE_4, sites=dict(TW_4), count=4))
    assert prep.time.lower[1:5].tolist() == [3.0, 5.0, 10.0, 3.0]
    assert prep.time.upper[1:5].tolist() == [20.0, 6.0, 12.0, 4.0]
    arcs = set(zip(prep.tail.tolist(), prep.head.tolist(), strict=True))
    assert (2, 1) in arcs and (1, 2) not in arcs and (3, 2) not in arcs and (3, 4) not in arcs
    assert (0, 5) not in arcs and all(i != 5 and j != 0 and i != j for i, j in arcs)


def test_bounds_use_shortest_ways_where_the_triangle_inequality_fails() -> None:
    """Way 0-1-2 is shorter than 0-2 (6 against 7), and 2-4-5-0 than 2-0: direct ways would cut off routes."""
    prep = prepare(routing(matrix=ASYM_5, count=1, sites={"due": [20, 20, 20, 20, 20, 20]}))
    assert prep.time.lower[2] == 6.0
    assert prep.time.lower[4] == 6.0
    shortest_home = {1: 5.0, 2: 6.0, 3: 3.0, 4: 7.0, 5: 4.0}
    assert {k: 20.0 - prep.time.upper[k] for k in shortest_home} == shortest_home


def test_services_stand_in_every_time_row() -> None:
    prep = prepare(routing(xy=SQUARE_4, sites={"service": [9, 1, 2, 3, 4], "due": [30, 50, 50, 50, 50]}, count=2))
    at = {(int(i), int(j)): w for i, j, w in zip(prep.tail, prep.head, prep.time.weight, strict=True)}
    assert at[0, 1] == 3.0 and at[1, 2] == 1.0 + 4.0 and at[2, 5] == 2.0 + 5.0
    assert prep.time.upper[4] == 30.0 - 4.0 - 3.0
    assert prep.service.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 0.0]


def test_loads_limits_and_energy_drop_arcs() -> None:
    def arcs(**vehicle: object) -> set[tuple[int, int]]:
        sites = {"demand": [0, 1, 2, 2, 1]}
        prep = prepare(routing(xy=SQUARE_4, sites=sites, count=4, **vehicle))
        return set(zip(prep.tail.tolist(), prep.head.tolist(), strict=True))

    assert {(2, 3), (3, 2)} & arcs() and not {(2, 3), (3, 2)} & arcs(capacity=3)
    assert (1, 4) in arcs(max_distance=12) and (1, 4) not in arcs(max_distance=11.9)
    for charge in ("travel", "elapsed", "elapsed-fixed-start", "windows"):
        assert (1, 4) in arcs(energy=Energy(24, 2.0, charge)) and (1, 4) not in arcs(energy=Energy(23.8, 2.0, charge))
    assert (1, 4) not in arcs(max_duration=11.9)


def test_a_route_of_exactly_its_limit_survives_rounding() -> None:
    """0.1 + 0.2 is a little more than 0.3."""
    matrix = np.array([[0, 0.1, 9], [9, 0, 0.2], [0.0, 9, 0]])
    prep = prepare(routing(matrix=matrix, count=1, max_distance=0.3, sites={"demand": [0, 0.1, 0.2]}, capacity=0.3))
    arcs = set(zip(prep.tail.tolist(), prep.head.tolist(), strict=True))
    assert {(0, 1), (1, 2), (2, 3)} <= arcs


def test_infinite_due_times_become_a_horizon_that_no_schedule_needs_to_exceed() -> None:
    prep = prepare(routing(xy=SQUARE_4, sites={"ready": [0, 50, 0, 0, 0], "service": 1.0}, count=1))
    assert math.isfinite(prep.time.upper.max())
    assert prep.time.upper[-1] >= 50 + 18 + 4
    assert (prep.time.lower <= prep.time.upper).all()


def test_sites_that_no_route_can_visit_have_no_arcs_and_finite_ranges() -> None:
    prep = prepare(routing(xy=SQUARE_4, sites={"due": [math.inf, 20, 4.9, 20, 20]}, count=2))
    assert prep.usable.tolist() == [True, True, False, True, True, True]
    assert not ((prep.tail == 2) | (prep.head == 2)).any()
    assert np.isfinite(prep.time.lower).all() and np.isfinite(prep.time.upper).all()


def test_fleet_is_at_most_one_vehicle_a_customer() -> None:
    assert prepare(routing(xy=SQUARE_4)).fleet == 4
    assert prepare(routing(xy=SQUARE_4, count=99)).fleet == 4
    assert prepare(routing(xy=SQUARE_4, count=3)).fleet == 3


def test_costs_are_the_arcs_shares_in_the_objective() -> None:
    sites = {"reward": [7, 1, 2, 3, 4]}
    objective = Reward() - 0.5 * TotalCost() - 10 * Vehicles()
    prep = prepare(routing(xy=SQUARE_4, sites=sites, count=2, fixed_cost=4.0, unit_cost=2.0, objective=objective))
    cost = {(int(i), int(j)): c for i, j, c in zip(prep.tail, prep.head, prep.cost, strict=True)}
    assert cost[0, 1] == pytest.approx(1 - 0.5 * (4 + 2 * 3) - 10)
    assert cost[1, 2] == pytest.approx(2 - 0.5 * 2 * 4)
    assert cost[2, 5] == pytest.approx(-0.5 * 2 * 5)


def test_cycles_of_no_weight_are_found() -> None:
    xy = np.array([(0, 0), (3, 4), (3, 4), (6, 8)], dtype=float)
    prep = prepare(routing(xy=xy, count=2, sites={"demand": [0, 0, 1, 1]}, capacity=3))
    assert leaves_cycles(prep, [prep.time])
    assert not leaves_cycles(prep, [prep.time, prep.resources["load"]])
    apart = prepare(routing(xy=SQUARE_4, count=2))
    assert not leaves_cycles(apart, [apart.time])
    one_way = np.array([[0, 1, 1, 1], [1, 0, 0, 1], [1, 1, 0, 1], [1, 1, 1, 0]], dtype=float)
    line = prepare(routing(matrix=one_way, count=2))
    assert not leaves_cycles(line, [line.time])


def test_waiting_is_possible_where_a_site_opens_after_the_depot() -> None:
    assert waiting_is_possible(routing(xy=SQUARE_4, sites=dict(TW_4)))
    assert not waiting_is_possible(routing(xy=SQUARE_4, sites={"due": [20, 5, 5, 5, 5]}))
    assert not waiting_is_possible(routing(xy=SQUARE_4, sites={"ready": [7, 7, 7, 0, 7]}))
