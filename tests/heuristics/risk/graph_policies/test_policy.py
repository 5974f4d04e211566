"""Policies that need no more than shortest paths, or the least observed edge."""

from __future__ import annotations

import numpy as np
import pytest
from uncertain_graphs import WORKED, all_paths, graph_of, named, random_graph

from waybound.heuristics.risk.graph_policies.policy import Greedy, Hindsight, LeastMean
from waybound.instances.errors import InputError
from waybound.solvers.engines.risk.path_search.non_dominated_paths import non_dominated_paths


def walk(policy, costs):
    """The walk where the costs of leaving edges are seen, and all that was seen stays known."""
    g, at, known = policy.graph, policy.graph.start, np.full(policy.graph.num_edges, np.nan)
    path = [at]
    while at != g.goal and len(path) <= g.num_vertices:
        here = slice(g.indptr[at], g.indptr[at + 1])
        known[here] = costs[here]
        at = policy.next_vertex(at, known)
        path.append(at)
    return tuple(path)


def test_the_least_mean_is_walked_whatever_is_observed():
    g = graph_of(WORKED)
    assert named(g, walk(LeastMean(g), np.full(10, 1e9))) == "S-A-G"


def test_hindsight_is_the_cheapest_of_all_paths():
    rng = np.random.default_rng(1)
    for _ in range(10):
        g = random_graph(rng, 7)
        costs = rng.uniform(0, 9, g.num_edges)
        cheapest = min(costs[g.edges_of(path)].sum() for path in all_paths(g))
        assert costs[g.edges_of(walk(Hindsight(g, costs), costs))].sum() == pytest.approx(cheapest)


def test_greedy_takes_the_least_observed_edge_by_which_a_path_goes_on():
    g = graph_of([*WORKED, ("B", "A", 0, 0)])
    costs = g.mean.copy()
    costs[g.edges_of_pairs(np.array([g.vertex_numbers["C"]]), np.array([g.vertex_numbers["G"]]))] = 12.0
    greedy = Greedy(g, non_dominated_paths(graph_of(WORKED)))
    assert named(g, walk(greedy, costs)) == "S-B-C-G"
    assert named(g, walk(greedy.fresh(), g.mean)) == "S-B-C-D-E-G"


def test_who_leaves_the_paths_is_told():
    g = graph_of(WORKED)
    greedy = Greedy(g, non_dominated_paths(g))
    with pytest.raises(InputError, match="the walk left the path that was chosen"):
        greedy.next_vertex(g.goal, g.mean)
