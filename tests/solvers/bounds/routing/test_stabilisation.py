import math

import numpy as np
import pytest
from draws import draws
from patience import HANG
from small_routing import plane, small

from waybound import RoutingProblem
from waybound.formulations.stop import Stop
from waybound.solvers.bounds.routing.column_generation import ColumnGeneration, Part, Solved
from waybound.solvers.bounds.routing.restricted_master import Prices
from waybound.solvers.bounds.routing.set_partition import set_partition
from waybound.solvers.bounds.routing.stabilisation import KINDS, PATIENCE, RADIUS, Smoothing, TrustRegion, stabilised


def solved(problem: RoutingProblem, kind: str) -> Solved:
    partition = set_partition(problem)
    assert partition is not None
    columns = ColumnGeneration(problem, partition, Stop(HANG), lambda bound: False, 1, {"stabilisation": kind})
    return columns.solve(Part(columns.cost, partition.fewest, partition.most, partition.optional), None)


def at(price: float) -> Prices:
    return Prices(np.zeros(1), np.array([0.0, price]), {})


@pytest.mark.parametrize("feature", ["time-windows", "capacity", "heterogeneous-fleet", "prizes"])
@pytest.mark.parametrize("seed", range(draws(8)))
def test_all_end_at_the_same_value(feature: str, seed: int) -> None:
    ends = [solved(small(feature, seed, "exact"), kind) for kind in KINDS]
    assert len({end.status for end in ends}) == 1
    assert [end.bound for end in ends] == pytest.approx([ends[0].bound] * 3, rel=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_all_end_at_the_same_value_where_routes_are_many(seed: int) -> None:
    ends = [solved(plane(seed, 20, 40.0), kind) for kind in KINDS]
    assert {end.status for end in ends} == {"done"}
    assert [end.bound for end in ends] == pytest.approx([ends[0].bound] * 3, rel=1e-6)


def test_smoothing_looks_near_the_best_prices_and_then_at_those_of_the_linear_program() -> None:
    near = stabilised("smoothing", 1.0)
    assert isinstance(near, Smoothing)
    near.begin(None)
    assert [p.visits[1] for p in near.places(at(10.0), ())] == [10.0]
    near.told(at(5.0), 3.0, 9.0, 0)
    near.told(at(6.0), 2.0, 9.0, 0)
    assert [p.visits[1] for p in near.places(at(10.0), ())] == pytest.approx([7.0, 10.0])


def test_the_box_moves_and_grows_with_good_ascents_and_shrinks_after_several_bad_ones() -> None:
    near = stabilised("trust-region", 4.0)
    assert isinstance(near, TrustRegion)
    near.begin(at(0.0))
    near.told(at(1.0), 10.0, 30.0, 2)  # the first bound: nothing to compare it with
    assert near.centre is not None and near.centre.visits[1] == 1.0 and near.radius == RADIUS * 4.0
    near.told(at(2.0), 12.0, 30.0, 2)  # an ascent, and a small one
    assert near.centre.visits[1] == 2.0 and near.radius == RADIUS * 4.0
    near.told(at(3.0), 28.0, 30.0, 2)
    assert near.centre.visits[1] == 3.0 and near.radius == 2.0 * RADIUS * 4.0
    for _ in range(PATIENCE):
        near.told(at(4.0), 20.0, 29.0, 2)
    assert near.centre.visits[1] == 3.0 and near.radius == RADIUS * 4.0
    near.told(at(5.0), 15.0, 29.0, 0)  # what a quick search told is no measure for an exact one
    assert near.centre.visits[1] == 5.0
    near.held(at(6.0))
    assert near.centre.visits[1] == 6.0 and near.radius == 2.0 * RADIUS * 4.0


def test_without_stabilisation_there_is_no_box_and_one_place() -> None:
    near = stabilised("none", 1.0)
    near.begin(at(1.0))
    assert near.radius == math.inf and [p.visits[1] for p in near.places(at(10.0), ())] == [10.0]
