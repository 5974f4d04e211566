import networkx as nx
import numpy as np
import pandas as pd
import pytest
from uncertain_graphs import CROSSED, WORKED, graph_of, named

from waybound.instances.errors import InputError
from waybound.instances.risk.uncertain_graph import UncertainGraph


def made(**changes):
    given = {
        "num_vertices": 3, "tails": [0, 1], "heads": [1, 2], "mean": [1.0, 2.0], "variance": [0.0, 3.0], "start": 0, "goal": 2,
    }  # fmt: skip
    return UncertainGraph(**{**given, **changes})


def test_edges_are_put_in_order_with_all_that_belongs_to_them():
    g = made(tails=[1, 0], heads=[2, 1], least=[5.0, 6.0], variable=[7, 8])
    assert (g.tails.tolist(), g.mean.tolist(), g.least.tolist(), g.variable.tolist()) == ([0, 1], [2.0, 1.0], [6.0, 5.0], [8, 7])


def test_edges_are_found_by_their_ends():
    g = graph_of(CROSSED)
    path = tuple(g.vertex_numbers[name] for name in ("S", "b", "a", "G"))
    assert named(g, path) == "S-b-a-G"
    assert [float(g.mean[e]) for e in g.edges_of(path)] == [2.0, 1.0, 2.0]
    assert g.edges_of((g.goal, g.start, 99)).tolist() == [-1, -1]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"variance": [0.0, -1e-9]}, r"the variance of edge 2 -> 3 must be from 0 to 1e\+150; found -1e-09"),
        ({"mean": [-1.0, 0.0]}, "the mean of edge 1 -> 2 must be from 0"),
        ({"mean": [np.nan, 0.0]}, "the mean of edge 1 -> 2 must be from 0"),
        ({"variance": [1e200, 0.0]}, "the variance of edge 1 -> 2"),
        ({"least": [0.0, -1.0]}, "the least cost of edge 2 -> 3"),
        ({"mean": [1.0]}, "one mean an edge; expected 2"),
        ({"heads": [1, 1]}, "an edge leads from 2 to itself"),
        ({"tails": [0, 0], "heads": [1, 1]}, "edge 1 -> 2 stands twice"),
        ({"heads": [1, 3]}, "the head of edge 2 does not exist"),
        ({"heads": [1, 0]}, "no path leads from 1 to 3; found 0 other vertices lead there"),
        ({"goal": 0}, "start and goal are the same vertex"),
        ({"goal": 3}, "the goal must be a vertex; expected 0 to 2"),
        ({"goal": 1.5}, "the goal must be a vertex"),
        ({"variable": [4, 4]}, "edges 1 -> 2 and 2 -> 3 share one random cost, but are not the two directions of one"),
        (
            {"tails": [0, 1, 1], "heads": [1, 0, 2], "mean": [1, 2, 1], "variance": [1] * 3, "variable": [0, 0, 1]},
            "edges 1 -> 2 and 2 -> 1 share one random cost, but differ in mean",
        ),
        ({"variable": [4]}, "one variable an edge"),
        ({"vertex_names": ("a", "b", "b")}, "two vertices have the name 'b'"),
        ({"num_vertices": 2**31}, "num_vertices must be a whole number"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(changes, message):
    with pytest.raises(InputError, match=message):
        made(**changes)


def test_least_costs_to_a_vertex_are_those_of_shortest_paths():
    g = graph_of(WORKED)
    costs = {g.vertex_name(v): cost for v, cost in enumerate(g.costs_to(g.goal, g.mean).tolist())}
    assert costs == {"S": 150.0, "A": 75.0, "G": 0.0, "B": 101.0, "C": 61.0, "D": 33.0, "E": 24.0}
    assert np.isinf(g.costs_to(g.start, g.mean)[g.goal])


def test_the_graph_from_elsewhere_knows_what_was_observed():
    g = graph_of(WORKED)
    seen = g.seen_from(g.vertex_numbers["B"], g.mean + 1.0, np.zeros(g.num_edges))
    assert (seen.vertex_name(seen.start), seen.variance.max(), seen.mean[0]) == ("B", 0.0, g.mean[0] + 1.0)


def test_the_digest_covers_what_values_depend_on():
    assert graph_of(WORKED).digest() == graph_of(WORKED, name="other", least=np.ones(10)).digest()
    assert graph_of(WORKED).digest() != graph_of([*WORKED[:-1], ("E", "G", 24, 3)]).digest()


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
    assert UncertainGraph.from_frame(frame, start=10, goal=1).vertex_names == ("1", "2", "10")


def test_an_undirected_edge_leads_both_ways_at_one_cost():
    frame = pd.DataFrame({"from": ["a", "b"], "to": ["b", "c"], "mean": [1.0, 2.0], "variance": [3.0, 4.0], "least": [0.5, 0.6]})
    g = UncertainGraph.from_frame(frame, start="c", goal="a", undirected=True)
    there, back = g.edges_of((0, 1, 0))
    assert g.undirected
    assert g.variable[there] == g.variable[back]
    assert g.num_edges == 4
    assert not graph_of(WORKED).undirected


@pytest.mark.parametrize(
    ("frame", "message"),
    [
        (FRAME.drop(columns="variance"), "edges lacks the column 'variance'"),
        (FRAME.assign(colour=1), "column 'colour' of edges is unknown"),
        (FRAME.assign(mean="much"), "column 'mean' of edges must hold numbers"),
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
    assert g.undirected == (kind is nx.Graph)


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
