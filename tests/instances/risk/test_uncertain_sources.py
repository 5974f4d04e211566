"""Graphs of uncertain edge costs from pandas and networkx."""

from __future__ import annotations

import networkx as nx
import numpy as np
import pandas as pd
import pytest
from uncertain_graphs import WORKED, graph_of

from waybound.instances.errors import InputError
from waybound.instances.risk.uncertain_graph import UncertainGraph
from waybound.instances.risk.uncertain_sources import is_undirected

FRAME = pd.DataFrame(WORKED, columns=["from", "to", "mean", "variance"])


def same(a: UncertainGraph, b: UncertainGraph) -> bool:
    return a.digest() == b.digest() and a.vertex_names == b.vertex_names and np.array_equal(a.variables, b.variables)


def test_a_frame_gives_the_graph_and_back():
    g = UncertainGraph.from_frame(FRAME, start="S", goal="G")
    assert g.digest() == graph_of(WORKED).digest()
    again = UncertainGraph.from_frame(g.to_frame(), start="S", goal="G")
    assert again.to_frame().sort_values(["from", "to"]).to_numpy().tolist() == g.to_frame().sort_values(["from", "to"]).to_numpy().tolist()


def test_whole_numbers_are_names_in_their_order():
    frame = pd.DataFrame({"from": [10, 2], "to": [2, 1], "mean": [1, 1], "variance": [0, 0]})
    g = UncertainGraph.from_frame(frame, start=10, goal=1)
    assert g.vertex_names == ("1", "2", "10")


def test_an_undirected_edge_leads_both_ways_at_one_cost():
    frame = pd.DataFrame({"from": ["a", "b"], "to": ["b", "c"], "mean": [1.0, 2.0], "variance": [3.0, 4.0], "least": [0.5, 0.6]})
    g = UncertainGraph.from_frame(frame, start="c", goal="a", undirected=True)
    there, back = g.edges_of((0, 1, 0))
    assert is_undirected(g)
    assert g.variable[there] == g.variable[back]
    assert g.num_edges == 4
    assert not is_undirected(graph_of(WORKED))


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        (FRAME.drop(columns="variance"), "edges lack the column 'variance'"),
        (FRAME.assign(colour=1), "column 'colour' of edges is unknown"),
        (FRAME.assign(mean="much"), "column mean of edges must hold numbers"),
        (FRAME.assign(variance=-1.0), "the variance of edge S -> A must be from 0"),
        ([1, 2], "edges must be a pandas frame"),
    ],
)
def test_frames_that_hold_something_else_are_refused(frame, message):
    with pytest.raises(InputError, match=message):
        UncertainGraph.from_frame(frame, start="S", goal="G")


def test_a_start_that_no_edge_knows_is_refused():
    with pytest.raises(InputError, match="the start 'X' is no vertex of any edge"):
        UncertainGraph.from_frame(FRAME, start="X", goal="G")


@pytest.mark.parametrize("kind", [nx.Graph, nx.DiGraph])
def test_networkx_gives_the_graph_and_back(kind):
    graph = kind(name="lanes")
    graph.add_node("b", pos=(1.0, 0.0))
    graph.add_node("a", pos=(0.0, 0.0))
    graph.add_edge("a", "b", mean=2, variance=0.25, least=1)
    g = UncertainGraph.from_networkx(graph, start="a", goal="b")
    again = UncertainGraph.from_networkx(g.to_networkx())
    assert (g.name, g.vertex_names, g.positions.tolist(), g.least.max()) == ("lanes", ("b", "a"), [[1, 0], [0, 0]], 1.0)
    assert same(g, again)
    assert is_undirected(g) == (kind is nx.Graph)


@pytest.mark.parametrize(
    ("edge", "ends", "message"),
    [
        ({"mean": 1}, ("a", "b"), "edge 'a' - 'b' has no variance"),
        ({"mean": 1, "variance": "x"}, ("a", "b"), "the variance of edge 'a' - 'b' must be a number; found 'x'"),
        ({"mean": 1, "variance": 1}, ("a", "z"), "the goal is no node of the graph; found 'z'"),
        ({"mean": 1, "variance": 1}, ("b", "a"), "no path leads from b to a"),
    ],
)
def test_networkx_graphs_that_lack_something_are_refused(edge, ends, message):
    graph = nx.DiGraph()
    graph.add_edge("a", "b", **edge)
    with pytest.raises(InputError, match=message):
        UncertainGraph.from_networkx(graph, start=ends[0], goal=ends[1])


def test_parallel_edges_are_refused():
    graph = nx.MultiDiGraph()
    graph.add_edges_from([("a", "b", {"mean": 1, "variance": 1})] * 2)
    with pytest.raises(InputError, match="edge a -> b stands twice"):
        UncertainGraph.from_networkx(graph, start="a", goal="b")
