"""Graphs of uncertain edge costs from and to pandas frames and networkx graphs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from .uncertain_graph import Floats, UncertainGraph

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ("from", "to", "mean", "variance", "least")


def graph_of_names(
    tails: list[str], heads: list[str], costs: dict[str, Floats], start: str, goal: str, *, vertices: list[str] | None = None,
    undirected: bool = False, **further: Any,
) -> UncertainGraph:  # fmt: skip
    """A graph from the names of its vertices, one tail and one head an edge.

    Parameters
    ----------
    tails, heads : list of str
    costs : dict
        ``mean``, ``variance`` and, where it is given, ``least``: arrays of shape (edges,).
    start, goal : str
    vertices : list of str, optional
        All vertices in their order; by default, in ascending order where all are whole numbers, else as they first appear.
    undirected : bool
        Whether each edge leads both ways, at one random cost.
    **further
        To ``UncertainGraph``.
    """
    names = list(dict.fromkeys(name for ends in zip(tails, heads, strict=True) for name in ends)) if vertices is None else vertices
    if vertices is None and all(name.isascii() and name.isdigit() and len(name) < 19 for name in names):
        names.sort(key=int)
    number = {name: k for k, name in enumerate(names)}
    for what, name in (("start", start), ("goal", goal)):
        if name not in number:
            raise InputError(f"the {what} {name[:80]!r} is no vertex of any edge")
    a, b = (np.array([number[name] for name in column], dtype=np.int64) for column in (tails, heads))
    if undirected:
        further["variable"] = np.tile(np.arange(len(a), dtype=np.int32), 2)
        a, b = np.concatenate([a, b]), np.concatenate([b, a])
        costs = {key: np.tile(values, 2) for key, values in costs.items()}
    usual = names == [str(k + 1) for k in range(len(names))]
    return UncertainGraph(
        len(names), a, b, costs["mean"], costs["variance"], number[start], number[goal], least=costs.get("least"),  # type: ignore[arg-type]
        vertex_names=None if usual else tuple(names), **further,
    )  # fmt: skip


def graph_from_frame(
    edges: pd.DataFrame, *, start: Any, goal: Any, undirected: bool = False, name: str = "uncertain-graph"
) -> UncertainGraph:
    """A graph from a pandas frame, with its own names of vertices.

    Parameters
    ----------
    edges : DataFrame
        Columns ``from``, ``to``, ``mean``, ``variance`` and optionally ``least``; one row an edge.
    start, goal : str or int
    undirected : bool
        Whether each edge leads both ways, at one random cost.
    name : str

    Raises
    ------
    InputError
        Naming the column, edge or vertex that is wrong.
    """
    if not hasattr(edges, "columns") or not hasattr(edges, "iloc"):
        raise InputError("edges must be a pandas frame", found=type(edges).__name__)
    titles = [str(column) for column in edges.columns]
    for title in titles:
        if title not in COLUMNS or titles.count(title) > 1:
            raise InputError(f"column {title!r} of edges is unknown or stands twice", expected=", ".join(COLUMNS))
    for title in COLUMNS[:4]:
        if title not in titles:
            raise InputError(f"edges lack the column {title!r}", expected=", ".join(COLUMNS[:4]), found=", ".join(titles))
    ends = [[_name(value) for value in edges[title].tolist()] for title in COLUMNS[:2]]
    costs = {title: _numbers(edges[title], title) for title in COLUMNS[2:] if title in titles}
    return graph_of_names(ends[0], ends[1], costs, _name(start), _name(goal), undirected=undirected, name=name, format="frame")


def _name(value: object) -> str:
    if isinstance(value, float) and value.is_integer():
        return str(int(value))
    return str(value).strip()


def _numbers(values: Any, title: str) -> Floats:
    try:
        return np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"column {title} of edges must hold numbers", found=str(error)[:80]) from None


def graph_to_frame(graph: UncertainGraph) -> pd.DataFrame:
    """One row an edge: from, to, mean, variance, and least where the graph has it."""
    import pandas as pd

    names = np.array([graph.vertex_name(v) for v in range(graph.num_vertices)], dtype=object)
    columns = {"from": names[graph.tails], "to": names[graph.heads], "mean": graph.mean, "variance": graph.variance}
    return pd.DataFrame(columns if graph.least is None else {**columns, "least": graph.least})


def graph_from_networkx(graph: Any, *, start: Any = None, goal: Any = None, name: str | None = None) -> UncertainGraph:
    """A graph from one of networkx, whose vertices come in the order of its nodes.

    Parameters
    ----------
    graph : networkx.Graph or DiGraph
        Each edge has the attributes ``mean`` and ``variance``, and may have ``least``. An undirected edge leads both ways at one random
        cost. A node may have a position ``pos``.
    start, goal : node, optional
        The graph's attributes ``start`` and ``goal`` by default.
    name : str, optional
        The graph's own by default.

    Raises
    ------
    InputError
        Naming the node or edge that is wrong.
    """
    if not callable(getattr(graph, "edges", None)) or not callable(getattr(graph, "nodes", None)):
        raise InputError("not a networkx graph", found=type(graph).__name__)
    nodes = list(graph.nodes)
    ends = {"start": graph.graph.get("start") if start is None else start, "goal": graph.graph.get("goal") if goal is None else goal}
    for what, node in ends.items():
        if node is None or node not in graph:
            raise InputError(f"the {what} is no node of the graph", found=repr(node)[:80])
    edges = list(graph.edges(data=True))
    keys = [key for key in COLUMNS[2:] if key != "least" or any("least" in data for _, _, data in edges)]
    costs = {key: np.array([_cost(u, v, data, key) for u, v, data in edges], dtype=np.float64) for key in keys}
    given = [graph.nodes[node].get("pos") for node in nodes]
    names = {node: str(node).strip() for node in nodes}
    return graph_of_names(
        [names[u] for u, _, _ in edges], [names[v] for _, v, _ in edges], costs, names[ends["start"]], names[ends["goal"]],
        vertices=list(names.values()), undirected=not graph.is_directed(), name=name or str(graph.name) or "uncertain-graph",
        positions=None if any(pos is None for pos in given) else np.array(given, dtype=np.float64), format="networkx",
    )  # fmt: skip


def _cost(tail: Any, head: Any, data: dict[str, Any], key: str) -> float:
    try:
        return float(data[key])
    except KeyError:
        raise InputError(f"edge {tail!r} - {head!r} has no {key}", expected="mean and variance, or least of all edges") from None
    except (TypeError, ValueError):
        raise InputError(f"the {key} of edge {tail!r} - {head!r} must be a number", found=repr(data[key])[:40]) from None


def graph_to_networkx(graph: UncertainGraph) -> Any:
    """As a ``networkx.DiGraph``, or a ``Graph`` where all edges lead both ways at one cost; ``from_networkx`` reads it back."""
    import networkx as nx

    both = is_undirected(graph)
    made = nx.Graph() if both else nx.DiGraph()
    made.graph.update(name=graph.name, start=graph.vertex_name(graph.start), goal=graph.vertex_name(graph.goal))
    for v in range(graph.num_vertices):
        made.add_node(graph.vertex_name(v), **({} if graph.positions is None else {"pos": tuple(graph.positions[v].tolist())}))
    keys = [key for key in COLUMNS[2:] if getattr(graph, key) is not None]
    ends = zip(graph.tails.tolist(), graph.heads.tolist(), strict=True)
    for (tail, head), *costs in zip(ends, *(getattr(graph, key).tolist() for key in keys), strict=True):
        made.add_edge(graph.vertex_name(tail), graph.vertex_name(head), **dict(zip(keys, costs, strict=True)))
    return made


def is_undirected(graph: UncertainGraph) -> bool:
    """Whether every edge shares its random cost with the edge the other way, and with no other."""
    if graph.variable is None:
        return False
    back = graph.edges_of_pairs(graph.heads, graph.tails)
    _, counts = np.unique(graph.variable, return_counts=True)
    return bool((back >= 0).all() and (graph.variable[back] == graph.variable).all() and (counts == 2).all())
