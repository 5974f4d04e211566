"""Loads that rise and fall, and residual energy: the rows that the three-index form writes, and the cases they are known for."""

import numpy as np
import pytest
from oracles import agrees, optimum, routing
from program_text import lines_of

from waybound import Energy, Makespan, Shipment, VehicleType

LINE = np.array([(0, 0), (1, 0), (2, 0)], dtype=float)


def test_what_is_delivered_makes_room_for_what_is_collected() -> None:
    """Site 1 takes 3 and gives 1, site 2 takes 1 and gives 3, capacity 4: 2 before 1 would have 3 + 3 on board."""
    problem = routing(xy=LINE, count=1, capacity=4.0, sites={"demand": [0, 3, 1], "pickup": [0, 1, 3]})
    assert lines_of(problem, "load", "pickup", "undelivered", "collected", "room", "before") == [
        "load[1]: 3 x[1,2,1] + 3 x[1,0,1] + x[2,1,1] + x[2,0,1] <= 4",
        "pickup[1]: x[1,2,1] + x[1,0,1] + 3 x[2,1,1] + 3 x[2,0,1] <= 4",
        "undelivered[1,2]: - 5 x[1,2,1] + undelivered[1] - undelivered[2] >= -4",
        "undelivered[2,1]: - 7 x[2,1,1] - undelivered[1] + undelivered[2] >= -4",
        "collected[1,2]: - 7 x[1,2,1] - collected[1] + collected[2] >= -4",
        "collected[2,1]: - 5 x[2,1,1] + collected[1] - collected[2] >= -4",
        "collected-least[1]: - x[1,2,1] - x[1,0,1] + collected[1] >= 0",
        "collected-least[2]: - 3 x[2,1,1] - 3 x[2,0,1] + collected[2] >= 0",
        "room[1]: - 4 x[1,2,1] - 4 x[1,0,1] + undelivered[1] + collected[1] <= 0",
        "room[2]: - 4 x[2,1,1] - 4 x[2,0,1] + undelivered[2] + collected[2] <= 0",
        "before[1]: - x[1,2,1] - x[1,0,1] + undelivered[1] <= 0",
        "before[2]: - 3 x[2,1,1] - 3 x[2,0,1] + undelivered[2] <= 0",
    ]
    agrees(problem, "three-index", 4.0)


def test_every_load_dimension_has_its_own_room() -> None:
    sites = {"shipments": [Shipment(1, 2, (2.0, 1.0))], "demand": [[0, 0], [0, 1], [0, 1]]}
    for room, value in (((2.0, (2.0,)), 4.0), ((2.0, (1.9,)), None), ((1.9, (2.0,)), None)):
        agrees(routing(xy=LINE, count=1, capacity=room[0], further_capacity=room[1], sites=sites), "three-index", value)


def test_a_vehicle_reloads_between_two_trips() -> None:
    """Each site asks for all that the vehicle carries: out and back twice, with one stop at the depot."""
    sites = {"demand": [0, 5, 5]}
    agrees(routing(xy=LINE, count=1, capacity=5.0, reloads=(0,), sites=sites), "three-index", 6.0)
    agrees(routing(xy=LINE, count=1, capacity=5.0, reloads=(0,), max_reloads=0, sites=sites), "three-index", None)
    problem = routing(xy=LINE, count=1, capacity=5.0, reloads=(0,), max_reloads=1, sites=sites)
    assert lines_of(problem, "reloads", "serves", "undelivered[0#1") == [
        "reloads[1]: x[0,0#1,1] + x[1,0#1,1] + x[2,0#1,1] <= 1",
        "serves[1]: x[0,0,1] + x[1,2,1] + x[1,0#1,1] + x[1,0,1] + x[2,1,1] + x[2,0#1,1] + x[2,0,1] >= 1",
        "undelivered[0#1,1]: - 10 x[0#1,1,1] - undelivered[1] + undelivered[0#1] >= -5",
        "undelivered[0#1,2]: - 10 x[0#1,2,1] - undelivered[2] + undelivered[0#1] >= -5",
    ]
    agrees(problem, "three-index", 6.0)


def test_residual_energy_row_by_row() -> None:
    """The site is 2 away, the station 1 from it, the depot 2 from the station; the store holds 3, and 2.5 at departure."""
    matrix = np.array([[0, 2, 9], [9, 0, 1], [2, 1, 0]], dtype=float)
    problem = recharged(matrix, 2.5)
    assert lines_of(problem, "residual", "home", "filled") == [
        "residual[1,2#1,r]: 4 x[1,2#1,1] - residual[1,r] + residual[2#1,r] <= 3",
        "residual[1,2#2,r]: 4 x[1,2#2,1] - residual[1,r] + residual[2#2,r] <= 3",
        "filled[1,r]: 2.5 x[0,1,1] + x[2#1,1,1] + x[2#2,1,1] + residual[1,r] <= 3",
        "filled[2#1,r]: residual[2#1,r] <= 3",
        "filled[2#2,r]: residual[2#2,r] <= 3",
    ]
    near = np.array([[0, 2, 9], [1, 0, 1], [2, 1, 0]], dtype=float)
    assert lines_of(recharged(near, 2.5), "home") == ["home[1,r]: - x[1,0,1] + residual[1,r] >= 0"]
    for ways, initial, value in ((matrix, 2.5, None), (matrix, 3.0, 5.0), (near, 2.5, None), (near, 3.0, 3.0)):
        for form in ("three-index", "set-partitioning"):
            agrees(recharged(ways, initial), form, value)


def recharged(matrix, initial):
    fleet = (VehicleType(1, energy=Energy(3.0, stations=(2,), initial=initial), name="r"),)
    return routing(matrix=matrix, sites={"depot": [True, False, True]}, fleet=fleet)


@pytest.mark.parametrize(("store", "value"), [(10.0, 22.0), (9.5, None)])
def test_walks_do_not_fall_apart_around_depots(store: float, value: float | None) -> None:
    """Depots at 0 and 10, sites at 1 and 11: as printed, pieces around both depots make 4, and moves between depots draw nothing."""
    xy = np.array([(0, 0), (10, 0), (1, 0), (11, 0)], dtype=float)
    sites = {"depot": [True, True, False, False]}
    problem = routing(xy=xy, sites=sites, fleet=(VehicleType(1, energy=Energy(store, stations=(0, 1))),), objective=Makespan())
    assert optimum(problem) == value
    agrees(problem, "three-index", value)
    agrees(problem, "set-partitioning", value)
