"""Answers as networkx graphs."""

from __future__ import annotations

import pandas as pd

import waybound as wb
from waybound.formulations.routing.route_graph import answer_graph


def test_edges_are_the_moves_and_nodes_know_their_sites() -> None:
    sites = pd.DataFrame({"id": ["yard", "a", "b"], "x": [0, 3, 6], "y": [0, 4, 8], "demand": [0, 2, 3], "phone": ["-", "1", "2"]})
    problem = wb.RoutingProblem.from_frame(sites, durations=[[0, 9, 9], [9, 0, 9], [9, 9, 0]])
    graph = answer_graph(problem, wb.Routes.of([[1], [2]]))
    assert graph.number_of_edges() == 4 and graph.nodes["a"] == {"phone": "1", "pos": (3.0, 4.0), "depot": False, "demand": 2.0}
    assert graph.edges["yard", "b", 0] == {"vehicle": "vehicle 2", "position": 1, "distance": 10.0, "duration": 9.0}
    assert graph.size("distance") == problem.evaluate(wb.Routes.of([[1], [2]])).values[0]
