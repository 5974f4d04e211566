import numpy as np
import pytest
from coded import coded
from uncertain_graphs import WORKED, all_paths, graph_of, named, random_graph

from waybound.heuristics.risk._graph_policies import DStarLite, Greedy, Hindsight, LeastMean
from waybound.instances.errors import InputError
from waybound.instances.generating import generate
from waybound.solvers.engines.risk.non_dominated_paths import non_dominated_paths


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
    with pytest.raises(InputError, check=coded("contradiction")):
        greedy.next_vertex(g.goal, g.mean)


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
    distances = DStarLite(g)._distance
    reached = np.isfinite(distances)
    assert np.allclose(distances[reached], left[reached])
    assert left[reached].max() <= left[g.start] + 1e-9
