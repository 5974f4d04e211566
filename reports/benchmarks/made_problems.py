"""Problems that no file of the literature holds, made of files of capacitated routing, for campaigns."""

from dataclasses import replace
from typing import Any

import numpy as np

from waybound.extending import PROBLEMS, InputError
from waybound.formulations.routing.problem import RoutingProblem
from waybound.instances.routing.sites import Group

LENGTHS = {"E-n51-k5": 521, "E-n76-k10": 830, "E-n101-k8": 815}
"""Lengths of the best routes known of some files."""


@PROBLEMS.register("two-vehicles-with-reloads")
def reloading(instance: Any, name: str, settings: dict[str, Any]) -> RoutingProblem:
    """Two vehicles that come back for more, neither of which may drive more than 1.1 times half the length of the best routes without:
    after Taillard, Laporte and Gendreau (1996), Vehicle routeing with multiple use of vehicles, J. Operational Research Society 47(8)."""
    problem = RoutingProblem.from_instance(instance, "cvrp", settings)
    vehicle = problem.fleet[0]
    if instance.name not in LENGTHS:
        raise InputError(f"no length is known of {instance.name}", "missing", expected=", ".join(LENGTHS))
    two = replace(vehicle, count=2, reloads=(vehicle.start,), max_distance=float(1.1 * LENGTHS[instance.name] // 2))
    return replace(problem, fleet=(two,))


@PROBLEMS.register("groups-of-three")
def grouped(instance: Any, name: str, settings: dict[str, Any]) -> RoutingProblem:
    """One customer in three is visited: each with those nearest to a centre, centres being as far from each other as can be, after the
    clusters of Fischetti, Salazar and Toth (1997), Operations Research 45(3)."""
    problem = RoutingProblem.from_instance(instance, "cvrp", settings)
    distances, customers = problem.travel.distances, problem.customers
    centres = [int(customers[distances[problem.fleet[0].start, customers].argmax()])]
    while 3 * len(centres) < len(customers):
        centres.append(int(customers[distances[np.array(centres)][:, customers].min(axis=0).argmax()]))
    nearest = distances[np.array(centres)][:, customers].argmin(axis=0)
    groups = tuple(Group(tuple(customers[nearest == k].tolist()), True) for k in range(len(centres)))
    required = np.zeros(len(problem.sites), dtype=bool)
    return replace(problem, sites=replace(problem.sites, groups=groups, required=required))
