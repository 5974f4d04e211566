import math
from dataclasses import replace

import numpy as np

from waybound.solvers.bounds.routing.route_levels import Level, levels_of

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


def test_visits_are_counted_where_nothing_else_ends_a_walk() -> None:
    idle = level(np.zeros((4, 4)))
    (kept,) = levels_of([level(np.ones((4, 4)))], USABLE)
    assert kept.weight.all()
    *_, visits = levels_of([idle], USABLE)
    assert visits.weight[USABLE].tolist() == [1.0] * int(USABLE.sum()) and visits.upper.tolist() == [4.0] * 4
