import math
from dataclasses import replace

import numpy as np
import pytest
from small_routing import small

from waybound import Group, RoutingProblem, Sites, Travel, VehicleType
from waybound.solvers.bounds.routing.set_partition import lacks_route_costs, set_partition

AT = np.array([[0.0, 0], [3, 4], [6, 8], [0, 5], [9, 12]])


def made(fleet: tuple[VehicleType, ...], objective: str | None = None, **sites: object) -> RoutingProblem:
    return RoutingProblem(Sites.of(range(5), **sites), Travel("euclidean", AT), fleet, objective)


def test_vehicles_that_are_alike_are_one_type_with_as_many() -> None:
    small_one, large = VehicleType(1, 2.0), VehicleType(2, 5.0, fixed_cost=7.0)
    partition = set_partition(made((small_one, large, replace(small_one, name="other", count=2))))
    assert partition is not None and not partition.merged
    assert [one.vehicles for one in partition.types] == [((0, 1), (2, 2)), ((1, 2),)]
    assert [one.most for one in partition.types] == [3, 2] and partition.most == 4
    assert partition.types[1].cost[0, 1] - partition.types[0].cost[0, 1] == 7.0
    answer = partition.routes([(kind, np.array(nodes)) for kind, nodes in ((0, [1]), (0, [2]), (1, [3, 4]))])
    assert [(route.vehicle, route.visits) for route in answer] == [(0, (1,)), (2, (2,)), (1, (3, 4))]


def test_one_type_and_nobody_who_may_be_left_out_is_merged() -> None:
    partition = set_partition(small("time-windows", 1, "exact"))
    assert partition is not None and partition.merged and partition.constant == 0.0
    assert partition.row.tolist() == list(range(len(partition.row)))


def test_rewards_and_penalties_are_costs_of_the_moves_to_their_sites() -> None:
    optional = made((VehicleType(2),), "total-cost + 2*penalties", required=[False, True, False, True, True], penalty=[0, 0, 10, 0, 0])
    partition = set_partition(optional)
    assert partition is not None and partition.constant == 20.0 and partition.optional.tolist() == [True, False, True, False, False]
    assert partition.types[0].cost[1, 2] == pytest.approx(5.0 - 20.0) and partition.fewest == 1
    most = set_partition(made((VehicleType(1, max_distance=30.0),), "reward", required=False, reward=[1, 5, 6, 7, 8]))
    assert most is not None and most.constant == -1.0 and most.fewest == 0  # the depot's own
    assert most.types[0].cost[3, 1] == -5.0 and not most.merged


def test_members_of_a_group_have_one_row() -> None:
    partition = set_partition(made((VehicleType(2),), groups=[Group((1, 3)), Group((2, 4), required=False)]))
    assert partition.row.tolist() == [0, 1, 2, 1, 2] and partition.optional.tolist() == [True, False, True]


def test_skills_leave_moves_out() -> None:
    partition = set_partition(made((VehicleType(1), VehicleType(1, skills=frozenset({"ice"}))), skills={2: {"ice"}}))
    assert math.isinf(partition.types[0].cost[0, 2]) and math.isfinite(partition.types[1].cost[0, 2])


def test_objectives_that_are_no_sums_are_refused_by_name() -> None:
    assert lacks_route_costs(made((VehicleType(1),), "longest-route")) == {"objective:longest-route"}
    assert lacks_route_costs(made((VehicleType(1),), "reward + total-cost")) == {"objective:total-cost"}
    assert not lacks_route_costs(made((VehicleType(1),), "reward - total-cost"))
