"""Levels of routes: which keep walks from going round for ever, and ranges without an end."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from small_routing import small

from waybound import RoutingProblem, Sites, Travel, VehicleType
from waybound.solvers.bounds.routing.arcs import arc_costs
from waybound.solvers.bounds.routing.route_levels import Level, route_levels

USABLE = ~np.eye(4, dtype=bool)


def level(weight: np.ndarray, upper: float = 9.0) -> Level:
    return Level(weight, 0.0, np.zeros(4), np.full(4, upper))


def test_a_level_grows_unless_some_cycle_of_customers_adds_nothing() -> None:
    weight = np.ones((4, 4))
    assert level(weight).grows(USABLE)
    weight[1, 2] = weight[2, 3] = 0.0
    assert level(weight).grows(USABLE)  # a way, and no cycle
    weight[3, 1] = 0.0
    assert not level(weight).grows(USABLE)
    usable = USABLE.copy()
    usable[3, 1] = False
    assert level(weight).grows(usable)


def test_ranges_without_an_end_get_one_that_no_walk_comes_to() -> None:
    weight = np.full((4, 4), 3.0)
    open_ended = replace(level(weight), upper=np.array([math.inf, 5.0, math.inf, 7.0]), lower=np.array([0.0, -math.inf, 2.0, 0.0]))
    finite = open_ended.finite(USABLE)
    assert finite.upper[[1, 3]].tolist() == [5.0, 7.0] and (finite.upper[[0, 2]] >= 7.0 + 4 * 3.0).all()
    assert finite.lower.tolist() == [0.0, 0.0, 2.0, 0.0]


def test_time_comes_first_and_visits_are_counted_where_nothing_else_ends_a_walk() -> None:
    timed = small("time-windows", 1, "exact")
    arcs = arc_costs(timed)
    assert arcs is not None
    levels = route_levels(timed, arcs, np.isfinite(arcs.cost))
    assert np.allclose(levels[0].upper[1:], arcs.resources["time"].upper[1:-1] + arcs.resources["time"].tolerance)
    free = RoutingProblem(
        Sites.of(range(5), demand=[0, 0, 0, 1, 1]), Travel("EUC_2D", np.arange(10.0).reshape(5, 2)), (VehicleType(2, 2.0),)
    )
    arcs = arc_costs(free)
    assert arcs is not None
    usable = np.isfinite(arcs.cost)
    *_, visits = route_levels(free, arcs, usable)  # customers 1 and 2 bring nothing: loads let walks go back and forth between them
    assert visits.weight[usable].tolist() == [1.0] * int(usable.sum()) and visits.upper.tolist() == [5.0] * 5
