from __future__ import annotations

from dataclasses import replace

import numpy as np

from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.routing.instance import Group, Shipment, Sites, VehicleType
from waybound.instances.routing.travel import Travel
from waybound.solvers.engines.routing.routing_shipments import entangled

TRAVEL = Travel("euclidean", np.arange(10.0).reshape(5, 2))


def problem(*shipments: Shipment, **sites: object) -> RoutingProblem:
    made = Sites.of(range(5), **sites)  # type: ignore[arg-type]
    return RoutingProblem(replace(made, shipments=shipments), TRAVEL, (VehicleType(),))


def test_ends_of_one_shipment_alone_are_not_entangled() -> None:
    assert not entangled(problem(Shipment(1, 2, (1.0,)), Shipment(3, 4, (1.0,))))
    assert not entangled(problem())


def test_what_else_ends_have_is_named() -> None:
    assert entangled(problem(Shipment(1, 2, (1.0,)), Shipment(1, 3, (1.0,)))) == {"several shipments of one site"}
    assert entangled(problem(Shipment(1, 2, (1.0,)), demand=[0, 0, 3, 0, 0])) == {"shipments of sites with demands or pickups"}
    assert not entangled(problem(Shipment(1, 2, (1.0,)), demand=[0, 0, 0, 3, 0]))
    optional = problem(Shipment(1, 2, (1.0,)), required=[False] * 5)
    assert entangled(replace(optional, sites=replace(optional.sites, groups=(Group((2, 3)),)))) == {"shipments of groups"}
