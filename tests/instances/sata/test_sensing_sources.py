import subprocess
import sys
import warnings
from typing import Any

import networkx as nx
import numpy as np
import pandas as pd
import pytest
from coded import coded
from file_cases import refused
from hypothesis import given, strategies as st

from waybound.instances.errors import InputError, UsageError
from waybound.instances.sata.sensing_graph import SensingGraph, graph_of_edges

EDGES = pd.DataFrame({"robot": ["a", "a", "b"], "action": ["p", "q", "r"], "target": ["x", "y", "x"], "weight": [1.0, 2.0, 0.5]})


# -- pandas ----------------------------------------------------------------------------------------------------------------


def test_names_are_taken_from_the_frame() -> None:
    g = SensingGraph.from_frames(EDGES, name="f")
    assert (g.robot_names, g.action_names, g.target_names) == (("a", "b"), ("p", "q", "r"), ("x", "y"))
    assert (g.weights.tolist(), g.format, g.name) == ([1.0, 2.0, 0.5], "frame", "f")


def test_a_second_frame_lists_what_sees_nothing_and_gives_the_order() -> None:
    actions = pd.DataFrame({"robot": ["c", "b", "a"], "action": [None, "s", "q"]})
    with pytest.warns(UserWarning, match="1 robot without an action that sees anything: c") as caught:
        g = SensingGraph.from_frames(EDGES, actions)
    assert caught[0].filename == __file__
    assert (g.robot_names, g.action_names) == (("c", "b", "a"), ("s", "q", "p", "r"))
    assert np.diff(g.indptr).tolist() == [0, 1, 1, 1]


@pytest.mark.parametrize("kind", [int, float, "Int64", str, "category", "string"])
def test_numbers_of_any_type_are_names_in_ascending_order(kind: Any) -> None:
    frame = pd.DataFrame({"robot": [3, 1], "action": [12, 4], "target": [7, 7]}).astype(kind)
    g = SensingGraph.from_frames(frame)
    assert (g.robot_names, g.action_names, g.target_names) == (("1", "3"), ("4", "12"), ("7",))


def test_empty_cells_of_any_sort_declare() -> None:
    frame = pd.DataFrame({"robot": ["a", "b", None], "action": ["p", np.nan, ""], "target": ["x", pd.NA, "y"]})
    with pytest.warns(UserWarning):
        g = SensingGraph.from_frames(frame)
    assert (g.num_robots, g.num_actions, g.num_targets, g.num_edges) == (2, 1, 2, 1)


@pytest.mark.parametrize(
    ("frame", "says"),
    [
        (EDGES.drop(columns="action"), "edges lacks the column 'action'; expected robot, action, target, weight; found robot"),
        (EDGES.assign(colour=1), "column 'colour' of edges is unknown"),
        (pd.concat([EDGES, EDGES[["robot"]]], axis=1), "column 'robot' of edges stands twice"),
        (EDGES.assign(weight=["1", "two", "3"]), "column 'weight' of edges must hold numbers"),
        (EDGES.assign(weight=[1, -1, 1]), "row 2 of edges: the weight must be a finite number, not negative; found -1.0"),
        (EDGES.assign(weight=[1, np.nan, 1]), "row 2 of edges: the weight must be a finite number"),
        (EDGES.assign(robot=["a", None, "b"]), "row 2 of edges: the action has no robot"),
        (EDGES.iloc[[0, 1, 0]], "row 3 of edges: the edge stands already in row 1 of edges"),
        (EDGES.to_dict(), "edges must be a pandas frame; found dict"),
        (EDGES.iloc[:0], "there is no robot"),
    ],
)  # fmt: skip
def test_a_bad_frame_is_refused_by_column_or_row(frame: Any, says: str) -> None:
    assert says in refused(SensingGraph.from_frames, frame)


def test_a_fault_in_the_second_frame_is_told_apart() -> None:
    with pytest.raises(InputError, match="row 1 of actions: the action has no robot"):
        SensingGraph.from_frames(EDGES, pd.DataFrame({"robot": [None], "action": ["p"]}))
    with pytest.raises(InputError, match="row 2 of edges: the weight"):
        SensingGraph.from_frames(EDGES.assign(weight=[1, -1, 1]), pd.DataFrame({"robot": ["z"]}))
    with pytest.raises(InputError, match="column 'target' of actions is unknown"):
        SensingGraph.from_frames(EDGES, EDGES)


def test_a_frame_holds_all_of_a_graph() -> None:
    g = graph_of_edges([1, 1], [1, 1], [2, 0], [4, 5], robots=3, targets=4)
    frame = g.to_frame()
    assert frame.columns.tolist() == ["robot", "action", "target", "weight"]
    assert frame.iloc[1].tolist() == ["2", "2.2", "1", 5.0]
    with pytest.warns(UserWarning):
        assert SensingGraph.from_frames(frame).digest() == g.digest()


# -- networkx --------------------------------------------------------------------------------------------------------------


def small(kind: Any = nx.Graph) -> Any:
    graph = kind(name="net")
    graph.add_nodes_from(["b", "a"], kind="robot")
    graph.add_nodes_from(["p", "q"], kind="action")
    graph.add_nodes_from(["x", "y"], kind="target")
    graph.add_edges_from([("a", "p"), ("q", "b")])
    graph.add_edge("p", "x", weight=2.5)
    graph.add_edge("y", "q")
    return graph


@pytest.mark.parametrize("kind", [nx.Graph, nx.DiGraph, nx.MultiGraph, nx.MultiDiGraph])
def test_nodes_come_in_their_order_whatever_the_direction_of_the_edges(kind: Any) -> None:
    g = SensingGraph.from_networkx(small(kind))
    assert (g.robot_names, g.action_names, g.target_names, g.name) == (("b", "a"), ("p", "q"), ("x", "y"), "net")
    assert g.robot_of_action.tolist() == [1, 0]
    assert list(zip(g.action_of_edge.tolist(), g.indices.tolist(), g.weights.tolist(), strict=True)) == [(0, 0, 2.5), (1, 1, 1.0)]


def spoilt(**changes: Any) -> Any:
    graph = small(changes.pop("of", nx.Graph))
    for node, kind in changes.pop("nodes", {}).items():
        graph.add_node(node, **({} if kind is None else {"kind": kind}))
    for u, v, weight in changes.pop("edges", ()):
        graph.add_edge(u, v, **({} if weight is None else {"weight": weight}))
    for node, pos in changes.pop("pos", {}).items():
        graph.nodes[node]["pos"] = pos
    return graph


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"nodes": {"z": None}}, "node 'z' must have a kind; expected robot, action or target; found None"),
        ({"nodes": {"z": "drone"}}, "node 'z' must have a kind; expected robot, action or target; found 'drone'"),
        ({"nodes": {"z": "action"}}, "action 'z' has no robot; expected an edge to a robot"),
        ({"edges": [("b", "p", None)]}, "action 'p' has two robots; found 'b' and 'a'"),
        ({"edges": [("a", "x", None)]}, "edge 'a' - 'x' joins robot and target; expected robot and action"),
        ({"edges": [("p", "q", None)]}, "edge 'p' - 'q' joins action and action"),
        ({"edges": [("p", "x", -1)]}, "the weight of edge 'p' - 'x' must be a finite number, not negative; found -1"),
        ({"edges": [("p", "x", float("nan"))]}, "the weight of edge 'p' - 'x'"),
        ({"edges": [("p", "x", "heavy")]}, "the weight of edge 'p' - 'x' must be a finite number, not negative; found 'heavy'"),
        ({"of": nx.MultiGraph, "edges": [("x", "p", 1)]}, "two edges join action 'p' and target 'x'"),
        ({"of": nx.DiGraph, "edges": [("x", "p", 1)]}, "two edges join action 'p' and target 'x'"),
        ({"pos": {"x": (0, 1)}}, "target 'y' has no position pos; expected one for every target, or for none"),
        ({"pos": {"x": (0, 1, 2), "y": (0, 1, 2)}}, "the position pos of target 'x' must be two numbers"),
        ({"pos": {"p": (0, 1), "q": (0, float("inf"))}}, "the position of action q must be finite"),
    ],
)  # fmt: skip
def test_a_bad_graph_is_refused_by_node_or_edge(changes: dict[str, Any], says: str) -> None:
    assert says in refused(SensingGraph.from_networkx, spoilt(**changes))


def test_what_is_no_graph_is_refused() -> None:
    for other in ([1, 2], "graph", None, pd.DataFrame()):
        with pytest.raises(InputError, check=coded("malformed")):
            SensingGraph.from_networkx(other)


def test_parallel_edges_are_added_where_asked() -> None:
    graph = spoilt(of=nx.MultiGraph, edges=[("x", "p", 1)])
    assert SensingGraph.from_networkx(graph, duplicates="sum").weights.tolist() == [3.5, 1.0]
    with pytest.raises(UsageError, check=coded("unknown-name")):
        SensingGraph.from_networkx(graph, duplicates="max")


@given(st.integers(0, 2**32 - 1), st.booleans(), st.booleans())
def test_a_graph_goes_through_networkx_unchanged(seed: int, named: bool, placed: bool) -> None:
    rng = np.random.default_rng(seed)
    owner = rng.integers(0, 4, 6)
    pairs = np.unique(rng.integers(0, 30, 12))
    further: dict[str, Any] = {"action_positions": rng.normal(size=(6, 2)), "target_positions": rng.normal(size=(5, 2))} if placed else {}
    g = graph_of_edges(
        owner, pairs // 5, pairs % 5, rng.random(len(pairs)) + 0.1, robots=["3", "1", "x", "2"] if named else 4,
        targets=["3", "1", "x", "2", "5"] if named else 5, name="g", **further,
    )  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        h = SensingGraph.from_networkx(g.to_networkx())
    assert h.digest() == g.digest()
    assert (h.robot_names, h.action_names, h.target_names, h.name) == (g.robot_names, g.action_names, g.target_names, "g")
    assert not placed or np.array_equal(h.target_positions, g.target_positions)  # type: ignore[arg-type]


# -- positions -------------------------------------------------------------------------------------------------------------

PLACES: dict[str, Any] = {
    "action_positions": [(0, 0), (2, 0), (6, 0), (4, 0)], "robot_of_action": [0, 0, 1, 1], "target_positions": [(1, 0), (5, 0), (3, 1)],
    "sensing_range": 2.5,
}  # fmt: skip


def test_targets_within_the_range_are_seen() -> None:
    g = SensingGraph.from_positions(**PLACES)
    assert list(zip(g.action_of_edge.tolist(), g.indices.tolist(), strict=True)) == [(0, 0), (1, 0), (1, 2), (2, 1), (3, 1), (3, 2)]
    assert (g.weights == 1).all()
    assert g.action_positions is not None and g.action_positions.tolist() == [[0, 0], [2, 0], [6, 0], [4, 0]]


def test_inverse_distances_are_capped_where_the_distance_vanishes() -> None:
    g = SensingGraph.from_positions(**PLACES, weight="inverse-distance")
    assert g.weights == pytest.approx([1, 1, 0.5**0.5, 1, 1, 0.5**0.5], abs=1e-15)
    at = SensingGraph.from_positions([(0, 0)], [0], [(0, 0), (0.3, 0.4), (3, 4)], 5, weight="inverse-distance", closest=0.7)
    assert at.weights == pytest.approx([1 / 0.7, 1 / 0.7, 1 / 5])


def test_the_border_of_the_range_belongs_to_it() -> None:
    assert SensingGraph.from_positions([(0, 0)], [0], [(3, 4)], 5).num_edges == 1
    with pytest.warns(UserWarning):
        assert SensingGraph.from_positions([(0, 0)], [0], [(3, 4)], 4.999999).num_edges == 0


@given(st.integers(0, 2**32 - 1))
def test_pairs_are_those_that_all_distances_give(seed: int) -> None:
    rng = np.random.default_rng(seed)
    here, there, reach = rng.uniform(0, 5, (7, 2)), rng.uniform(0, 5, (6, 2)), float(rng.uniform(0.1, 6))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        g = SensingGraph.from_positions(here, rng.integers(0, 3, 7), there, reach, robots=3, weight="inverse-distance", closest=0.5)
    lengths = np.linalg.norm(here[:, None] - there[None], axis=2)
    assert set(zip(g.action_of_edge.tolist(), g.indices.tolist(), strict=True)) == set(zip(*np.nonzero(lengths <= reach), strict=True))
    np.testing.assert_allclose(g.weights, 1 / np.maximum(lengths[g.action_of_edge, g.indices], 0.5), rtol=1e-12)


def test_nothing_to_see_is_legal() -> None:
    with pytest.warns(UserWarning):
        g = SensingGraph.from_positions([(0, 0)], [0], [], 1)
    assert (g.num_targets, g.num_edges) == (0, 0)


@pytest.mark.parametrize(
    ("changes", "error", "says"),
    [
        ({"sensing_range": 0}, InputError, "sensing_range must be a positive, finite number; found 0"),
        ({"sensing_range": float("inf")}, InputError, "sensing_range must be"),
        ({"sensing_range": "far"}, InputError, "sensing_range must be"),
        ({"closest": 0.0}, InputError, "closest must be a positive, finite number"),
        ({"closest": float("nan")}, InputError, "closest must be"),
        ({"weight": "distance"}, UsageError, "weight must be one of binary, inverse-distance, not 'distance'"),
        ({"robot_of_action": [0, 0, 1]}, InputError, "action positions must be two numbers each; expected (3, 2); found (4, 2)"),
        ({"target_positions": [(1, 0, 0)]}, InputError, "target positions must be two numbers each"),
        ({"target_positions": [(1, float("nan"))]}, InputError, "the position of target 1 must be finite"),
        ({"targets": ["a"]}, InputError, "does not exist"),
    ],
)  # fmt: skip
def test_bad_positions_are_refused(changes: dict[str, Any], error: Any, says: str) -> None:
    with pytest.raises(error) as caught:
        SensingGraph.from_positions(**{**PLACES, **changes})
    assert says in str(caught.value)


def test_heavy_packages_are_loaded_only_when_they_are_needed() -> None:
    code = (
        "import sys, waybound.instances.sata.sensing_graph as s; s.graph_of_edges([0], [0], [0]); "
        "print(*{m.split('.')[0] for m in sys.modules})"
    )
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    assert not {"pandas", "scipy", "networkx"} & set(loaded)
