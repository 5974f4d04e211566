"""D* Lite against shortest paths computed afresh at each vertex."""

from __future__ import annotations

import numpy as np
import pytest
from uncertain_graphs import random_graph

from waybound.heuristics.risk.graph_policies.d_star_lite import DStarLite
from waybound.instances.generating import generate


def walked(prepared, costs):
    """Walk to the goal; after each step the edge must begin a shortest path on what is known."""
    g, walk = prepared.graph, prepared.fresh()
    at, known = g.start, np.full(g.num_edges, np.nan)
    for _ in range(300):
        known[g.indptr[at] : g.indptr[at + 1]] = costs[g.indptr[at] : g.indptr[at + 1]]
        believed = np.where(np.isnan(known), g.mean, known)
        left = g.costs_to(g.goal, believed)
        to = walk.next_vertex(at, known)
        assert believed[g.edges_of((at, to))[0]] + left[to] == pytest.approx(left[at], abs=1e-6)
        at = to
        if at == g.goal:
            return
    raise AssertionError("the walk does not end")


@pytest.mark.parametrize("least", [0.01, 0.0])  # circles of cost 0
@pytest.mark.parametrize("seed", range(6))
def test_each_step_is_that_of_a_search_from_scratch(seed, least):
    rng = np.random.default_rng(seed)
    g = random_graph(rng, 40, 0.15) if seed % 2 else generate("prm-graph", seed, vertices=40, variance=400.0, directed=False)
    prepared = DStarLite(g)
    for _ in range(3):
        walked(prepared, np.maximum(rng.normal(g.mean, 3 * np.sqrt(g.variance) + 5), least))


def test_the_first_search_looks_no_farther_than_the_start():
    g = generate("prm-graph", 3)
    left = g.costs_to(g.goal, g.mean)
    found = DStarLite(g)._distance
    reached = np.isfinite(found)
    assert np.allclose(found[reached], left[reached])
    assert left[reached].max() <= left[g.start] + 1e-9
