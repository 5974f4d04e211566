"""Rows over arcs and times: closing moves, and what differs between load dimensions."""

from __future__ import annotations

import math

import numpy as np
from oracles import agrees, routing
from program_text import program_text

from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import EXPLICIT, Travel


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
