import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import plane

from waybound import Group, Makespan, Objective, Penalties, Reward, RoutingProblem, Sites, TotalCost, TotalDuration, Vehicles, VehicleType
from waybound.formulations.routing.checking.vehicle_moves import VehicleMoves, alike, terms_of, worth_of_visits
from waybound.instances.routing.travel import Travel


def test_weights_are_those_of_a_minimisation():
    problem = plane(1, 3, 10.0)
    goal = 2.0 * TotalCost() + 3.0 * Vehicles() - 1.5 * Reward() + 4.0 * Makespan() + Penalties()
    found = terms_of(replace(problem, objective=Objective.of(goal)))
    assert (found.cost, found.vehicles, found.reward, found.peaks, found.penalties) == (2.0, 3.0, -1.5, {"makespan": 4.0}, 1.0)
    flipped = terms_of(replace(problem, objective=Objective.of(Reward() - 0.5 * TotalDuration())))
    assert flipped is not None and (flipped.reward, flipped.duration) == (-1.0, 0.5)
    for goal in (Reward() + TotalCost(), Reward() + Makespan(), TotalCost() - TotalDuration()):
        assert terms_of(replace(problem, objective=Objective.of(goal))) is None


def test_visits_are_worth_their_prices_as_far_as_they_are_known():
    sites = Sites.of("oabcde", required=[False, True, *[False] * 4], groups=[Group((3, 4)), Group((5,), required=False)])
    problem = RoutingProblem(sites, Travel("EXPLICIT", matrix=1.0 - np.eye(6)), (VehicleType(),))
    prices = np.array([2.0, -3.0, 7.0, 5.0, -4.0])
    assert worth_of_visits(problem, prices).tolist() == [2.0, -3.0, 5.0, 0.0, -4.0]
    assert worth_of_visits(problem, -prices).tolist() == [-2.0, 0.0, -7.0, 0.0, 0.0]
    surely, never = np.array([True, True, True, False, False]), np.array([False, False, False, True, True])
    assert worth_of_visits(problem, prices, surely, never).tolist() == [2.0, -3.0, 7.0, 0.0, 0.0]
    surely, never = np.array([True, False, False, False, False]), np.array([False, True, False, True, False])
    assert worth_of_visits(problem, prices, surely, never).tolist() == [2.0, 0.0, 7.0, 0.0, -4.0]


def test_types_that_differ_only_in_name_are_one():
    problem = replace(plane(1, 3, 10.0), fleet=(VehicleType(2, 9.0, name="a"), VehicleType(1, 9.0, name="b"), VehicleType(None, 4.0)))
    assert list(alike(problem).values()) == [3, 3]


def test_costs_and_limits_are_those_of_the_type():
    problem = plane(1, 3, 10.0)
    slow = VehicleType(1, 5.0, fixed_cost=7.0, unit_cost=2.0, unit_duration_cost=3.0, speed=0.5)
    terms = terms_of(problem)
    assert terms is not None
    moves = VehicleMoves.of(replace(problem, fleet=(slow,)), slow, terms, np.array([1.0, 0.0, 0.0]), {"load": 2.0})
    d, q = problem.travel.distances, problem.sites.demand
    room = float(moves.resources["load"].upper[0]) + moves.resources["load"].slack
    if math.isfinite(moves.cost[0, 1]):
        assert moves.cost[0, 1] == pytest.approx(7.0 + 2.0 * d[0, 1] + 3.0 * 2.0 * d[0, 1] - 1.0 + 2.0 * q[1] - 2.0 * room)
    assert set(moves.resources) == {"time", "load", "order"}
    assert np.isinf(np.diag(moves.cost)).all()
