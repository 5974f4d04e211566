"""Answers as networkx graphs."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

from .routes import Routes
from .schedule import schedule

if TYPE_CHECKING:
    from .problem import RoutingProblem


def answer_graph(problem: RoutingProblem, answer: Routes) -> Any:
    """A ``networkx.MultiDiGraph``: every site a node, with its place, demand and attributes, every move of a route an edge from the one
    to the other with ``vehicle, position, distance, duration``."""
    import networkx as nx

    sites = problem.sites
    graph = nx.MultiDiGraph(name=problem.name)
    for k, site in enumerate(sites.ids):
        place = {} if sites.coordinates is None else {"pos": tuple(sites.coordinates[k].tolist())}
        kept = {title: values[k] for title, values in sites.attributes.items()}
        graph.add_node(site, **{**kept, **place, "depot": bool(sites.depot[k]), "demand": float(sites.demand[k])})
    for name, route in zip(problem.vehicle_names(answer), answer, strict=True):
        vehicle, travel = problem.fleet[route.vehicle], problem.travel_of(route.vehicle)
        stops, plan = (vehicle.start, *route.visits, vehicle.end), schedule(problem, route)
        ends = [0.0, *plan.distance.tolist(), plan.total_distance]
        for k, (tail, head) in enumerate(itertools.pairwise(stops)):
            told = {"vehicle": name, "position": k + 1, "distance": ends[k + 1] - ends[k], "duration": float(travel.duration(tail, head))}
            graph.add_edge(sites.ids[tail], sites.ids[head], **told)
    return graph
