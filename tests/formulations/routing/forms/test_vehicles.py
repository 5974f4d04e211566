import math
from dataclasses import replace

import numpy as np
import pytest
from oracles import SQUARE_4, agrees, optimum, routing
from program_text import program_text

from waybound import Energy, Makespan, RoutingProblem, Sites, TotalCost, VehicleType
from waybound.formulations.routing.forms._vehicles import vehicle_columns
from waybound.instances.routing.travel import EXPLICIT, Travel

LINE = np.array([(0, 0), (1, 0), (2, 0), (5, 0)], dtype=float)
TWO_DEPOTS = {"depot": [True, False, False, True]}


def test_nodes_are_customers_and_copies_of_depots() -> None:
    problem = routing(xy=LINE, sites=TWO_DEPOTS, fleet=(VehicleType(2, energy=Energy(9.0, stations=(3,))),))
    kind = vehicle_columns(problem, 0, 0, 0)
    assert kind.names == ["0", "1", "2", "3#1", "3#2", "3#3", "3#4", "0"]
    assert kind.clock == len(kind.tail) * 2 and kind.end == kind.clock + 8 * 2
    program = problem.compile("three-index").program
    names = [program.variable_name(k) for k in range(program.num_variables)]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize(
    ("limits", "may"),
    [
        ({}, True), ({"max_distance": 4.9}, False), ({"max_distance": 5.0}, True), ({"max_duration": 4.9}, False),
        ({"shift": (0.0, 4.9)}, False), ({"energy": Energy(9.0, 2.0)}, False), ({"energy": Energy(10.0, 2.0)}, True),
    ],
)  # fmt: skip
def test_a_committed_vehicle_drives_home_where_it_can(limits, may) -> None:
    """5 long; where it may not, all must serve somebody, which no limit allows either."""
    vehicle = VehicleType(1, start=0, end=3, committed=True, **limits)
    problem = routing(xy=LINE, sites={**TWO_DEPOTS, "required": False}, fleet=(vehicle,), objective=TotalCost() + Makespan())
    assert vehicle_columns(problem, 0, 0, 0).may_idle is may
    expected = optimum(problem)
    assert expected == (10.0 if may else None)
    for form in ("three-index", "set-partitioning"):
        agrees(problem, form, expected)


def test_each_type_has_its_own_way_to_travel() -> None:
    """Twice as fast, or along ways of its own: the second type takes less time, or less distance."""
    first = VehicleType(1, name="slow")
    fast = replace(first, speed=2.0, name="fast", fixed_cost=1.0)
    problem = routing(xy=SQUARE_4, fleet=(first, fast), objective=Makespan())
    assert [line for line in program_text(problem.compile("three-index").program).splitlines() if line.startswith("worked")][1].startswith(
        "worked[2]: 1.5 x[0,1,2]"
    )
    agrees(problem, "three-index", optimum(problem))
    ways = Travel(EXPLICIT, matrix=np.ones((5, 5)))
    agrees(routing(xy=SQUARE_4, fleet=(first, replace(first, travel=ways, name="drone"))), "three-index", 5.0)
    closing = np.full((5, 5), math.inf)
    closing[0] = -1.0
    closed = replace(first, travel=Travel(EXPLICIT, matrix=np.ones((5, 5)), closing=closing), name="drone")
    agrees(routing(xy=SQUARE_4, fleet=(first, closed)), "three-index", 18.0)


def test_a_move_begins_before_it_closes() -> None:
    """Each site opens at 5 and takes 1; from 1 to 2 one must leave by 8, from 2 to 1 by 5.5: never."""
    closing = np.full((3, 3), math.inf)
    closing[1, 2], closing[2, 1] = 8.0, 5.5
    matrix = np.array([[0, 2, 2], [2, 0, 4], [2, 4, 0]], dtype=float)
    sites = Sites.of(range(3), ready=[0, 5, 5], due=[30, 20, 20], service=[0, 1, 1])
    problem = RoutingProblem(sites, Travel(EXPLICIT, matrix=matrix, closing=closing), (VehicleType(1),))
    lines = program_text(problem.compile("three-index").program).splitlines()
    assert [line for line in lines if line.startswith("closing")] == ["closing[1,2,1]: 7 x[1,2,1] + t[1,1] <= 14"]
    assert not any("x[2,1,1]" in line for line in lines)
    agrees(problem, "three-index", 8.0)


def test_each_load_dimension_has_a_row_a_vehicle() -> None:
    problem = routing(
        xy=np.array([(0, 0), (1, 0), (2, 0)], dtype=float), count=1, capacity=9.0, further_capacity=(4.0,),
        sites={"demand": [[0, 0], [3, 1], [2, 4]], "required": False},
    )  # fmt: skip
    lines = program_text(problem.compile("three-index").program).splitlines()
    assert [line for line in lines if line.startswith("load")] == [
        "load[1]: 3 x[1,0,1] + 2 x[2,0,1] <= 9",
        "load-2[1]: x[1,0,1] + 4 x[2,0,1] <= 4",
    ]
    assert not any("x[1,2,1]" in line for line in lines)
