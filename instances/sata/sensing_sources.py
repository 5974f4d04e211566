"""Sensing graphs from and to pandas frames and networkx graphs, and from positions with a sensing range."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .. import number_arrays as arrays
from ..errors import InputError, UsageError
from ..frames import columns_of, name_of, numbers_of
from ..number_arrays import Floats
from .sensing_rows import COLUMNS, Named, edges_of_rows, rows_of_graph, unless_counted, unless_usual

if TYPE_CHECKING:
    import pandas as pd

    from .sensing_graph import SensingGraph


WEIGHTS = ("binary", "inverse-distance")
KINDS = ("robot", "action", "target")


# -- pandas ----------------------------------------------------------------------------------------------------------------


def edges_from_frames(
    edges: pd.DataFrame, actions: pd.DataFrame | None = None, *, duplicates: str = "error", order: str = "names",
    name: str = "sensing-graph",
) -> dict[str, Any]:  # fmt: skip
    """The arguments of ``graph_of_edges`` for a graph with the frames' own names; parameters as of ``SensingGraph.from_frames``."""
    parts: list[tuple[str, dict[str, Any], int]] = []
    for what, frame, known, needed in (("actions", actions, KINDS[:2], KINDS[:1]), ("edges", edges, COLUMNS, KINDS)):
        if frame is not None:
            parts.append((what, columns_of(what, frame, known, needed), len(frame)))
    columns = [_named([part.get(title, np.full(rows, None)) for _, part, rows in parts]) for title in KINDS]
    weight = None
    if "weight" in edges:
        weight = np.concatenate(
            [numbers_of(what, "weight", part["weight"]) if "weight" in part else np.full(rows, np.nan) for what, part, rows in parts]
        )

    def place(k: int) -> str:
        above = parts[0][2] if len(parts) > 1 else 0
        return f"row {k + 1} of {parts[0][0]}" if k < parts[0][2] else f"row {k - above + 1} of {parts[-1][0]}"

    return edges_of_rows(
        columns[0], columns[1], columns[2], weight, place=place, order=order, duplicates=duplicates, name=name, format="frame"
    )  # fmt: skip


def _named(pieces: list[Any]) -> Named:
    """Names out of whatever values a column holds; 3 and 3.0 are both the name "3"."""
    import pandas as pd

    codes, values = pd.factorize(np.concatenate(pieces))
    again = Named.of(name_of(value) for value in values.tolist())
    return Named(np.append(again.codes, -1)[codes], again.labels)


def graph_to_frame(graph: SensingGraph) -> pd.DataFrame:
    """One row per edge: robot, action, target, weight. What no edge names has a row with empty cells, so ``from_frames`` loses
    nothing of it."""
    import pandas as pd

    rows, columns = rows_of_graph(graph), {}
    for title, label in (("robot", graph.robot_name), ("action", graph.action_labels.__getitem__), ("target", graph.target_name)):
        codes = getattr(rows, title)
        labels = np.array([*(label(k) for k in range(int(codes.max(initial=-1)) + 1)), None], dtype=object)
        columns[title] = labels[codes]
    return pd.DataFrame({**columns, "weight": rows.weight})


# -- networkx --------------------------------------------------------------------------------------------------------------


def edges_from_networkx(graph: Any, *, duplicates: str = "error", name: str | None = None) -> dict[str, Any]:
    """The arguments of ``graph_of_edges`` for a graph of networkx, directed or not; parameters as of ``SensingGraph.from_networkx``."""
    if not callable(getattr(graph, "edges", None)) or not callable(getattr(graph, "nodes", None)):
        raise InputError("not a networkx graph", found=type(graph).__name__)
    if duplicates not in ("error", "sum"):
        raise UsageError(f"duplicates must be error or sum, not {duplicates!r}", "unknown-name")
    kinds: dict[Any, str] = {}
    for node, data in graph.nodes(data=True):
        if data.get("kind") not in KINDS:
            raise InputError(
                f"node {node!r} must have a kind", "unknown-name", expected="robot, action or target", found=repr(data.get("kind"))
            )
        kinds[node] = data["kind"]
    nodes = {kind: [node for node, own in kinds.items() if own == kind] for kind in KINDS}
    number = {node: k for members in nodes.values() for k, node in enumerate(members)}
    robot_of: dict[Any, Any] = {}
    seen: dict[tuple[int, int], float] = {}
    for u, v, data in graph.edges(data=True):
        ends = {kinds[u]: u, kinds[v]: v}
        if ends.keys() == {"robot", "action"}:
            if robot_of.setdefault(ends["action"], ends["robot"]) != ends["robot"]:
                raise InputError(
                    f"action {ends['action']!r} has two robots",
                    "contradiction",
                    found=f"{robot_of[ends['action']]!r} and {ends['robot']!r}",
                )
            continue
        if ends.keys() != {"action", "target"}:
            raise InputError(
                f"edge {u!r} - {v!r} joins {kinds[u]} and {kinds[v]}", "contradiction", expected="robot and action, or action and target"
            )
        pair = number[ends["action"]], number[ends["target"]]
        if pair in seen and duplicates == "error":
            raise InputError(
                f'two edges join action {ends["action"]!r} and target {ends["target"]!r}; duplicates="sum" would add them up', "duplicate"
            )
        seen[pair] = seen.get(pair, 0.0) + _weight(data.get("weight", 1.0), f"edge {u!r} - {v!r}")
    for action in nodes["action"]:
        if action not in robot_of:
            raise InputError(f"action {action!r} has no robot", "missing", expected="an edge to a robot")
    labels = {kind: [str(graph.nodes[node].get("name", node)).strip() for node in members] for kind, members in nodes.items()}
    owner = np.array([number[robot_of[action]] for action in nodes["action"]], dtype=np.int64)
    actions = labels["action"]
    if len(set(actions)) < len(actions):
        actions = [f"{labels['robot'][r]}.{label}" for r, label in zip(owner.tolist(), actions, strict=True)]
    return {
        "robot_of_action": owner, "action": [a for a, _ in seen], "target": [t for _, t in seen], "weight": list(seen.values()),
        "robots": unless_counted(labels["robot"]), "targets": unless_counted(labels["target"]),
        "action_names": unless_usual(actions, owner, labels["robot"]), "action_positions": _pos(graph, "action", nodes["action"]),
        "target_positions": _pos(graph, "target", nodes["target"]), "name": name or str(graph.name) or "sensing-graph",
        "format": "networkx",
    }  # fmt: skip


def _weight(value: Any, edge: str) -> float:
    try:
        weight = float(value)
    except (TypeError, ValueError):
        weight = math.nan
    if not (weight >= 0 and math.isfinite(weight)):
        raise InputError(f"the weight of {edge} must be a finite number, not negative", "out-of-range", found=repr(value)[:40])
    return weight


def _pos(graph: Any, kind: str, nodes: list[Any]) -> Any:
    """Positions of all nodes of a kind, or None where none has one."""
    places = [graph.nodes[node].get("pos") for node in nodes]
    if all(pos is None for pos in places):
        return None
    for node, pos in zip(nodes, places, strict=True):
        if pos is None:
            raise InputError(f"{kind} {node!r} has no position pos", "missing", expected=f"one for every {kind}, or for none")
        if np.shape(pos) != (2,):
            raise InputError(f"the position pos of {kind} {node!r} must be two numbers", "wrong-shape", found=repr(pos)[:40])
    return places


def graph_to_networkx(graph: SensingGraph) -> Any:
    """A ``networkx.Graph`` whose nodes are pairs such as ``("robot", "1")``, with the attributes ``kind``, ``name`` and, where there
    are positions, ``pos``; ``from_networkx`` makes the same graph of it."""
    import networkx as nx

    result = nx.Graph(name=graph.name)
    every: tuple[tuple[str, int, Callable[[int], str], Floats | None], ...] = (
        ("robot", graph.num_robots, graph.robot_name, None),
        ("action", graph.num_actions, graph.action_labels.__getitem__, graph.action_positions),
        ("target", graph.num_targets, graph.target_name, graph.target_positions),
    )
    nodes: dict[str, list[tuple[str, str]]] = {}
    for kind, count, label, points in every:
        nodes[kind] = [(kind, label(k)) for k in range(count)]
        for k, node in enumerate(nodes[kind]):
            result.add_node(node, kind=kind, name=node[1], **({} if points is None else {"pos": tuple(points[k].tolist())}))
    robots, actions, targets = (nodes[kind] for kind in KINDS)
    result.add_edges_from((robots[r], actions[a]) for a, r in enumerate(graph.robot_of_action.tolist()))
    columns = graph.action_of_edge.tolist(), graph.indices.tolist(), graph.weights.tolist()
    result.add_weighted_edges_from((actions[a], targets[t], w) for a, t, w in zip(*columns, strict=True))
    return result


# -- positions -------------------------------------------------------------------------------------------------------------


def edges_from_positions(
    action_positions: ArrayLike,
    robot_of_action: ArrayLike,
    target_positions: ArrayLike,
    sensing_range: float,
    *,
    weight: str = "binary",
    closest: float = 0.01,
    robots: int | Iterable[str] | None = None,
    targets: Iterable[str] | None = None,
    action_names: Iterable[str] | None = None,
    name: str = "sensing-graph",
) -> dict[str, Any]:
    """The arguments of ``graph_of_edges`` for a graph in which an action sees what is near.

    Parameters as of ``SensingGraph.from_positions``.
    """
    from scipy.spatial import cKDTree

    if weight not in WEIGHTS:
        raise UsageError(f"weight must be one of {', '.join(WEIGHTS)}, not {weight!r}", "unknown-name")
    for what, value in (("sensing_range", sensing_range), ("closest", closest)):
        if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not 0 < value < math.inf:
            raise InputError(f"{what} must be a positive, finite number", "out-of-range", found=repr(value)[:40])
    owner = arrays.whole_numbers("robot_of_action", robot_of_action, "numbers from 0")
    here, there = _points("action", action_positions, len(owner)), _points("target", target_positions, None)
    pairs = np.zeros(0, dtype=[("i", np.int64), ("j", np.int64), ("v", np.float64)])
    if len(here) and len(there):
        pairs = cKDTree(here).sparse_distance_matrix(cKDTree(there), float(sensing_range), output_type="ndarray")
    shares = np.ones(len(pairs)) if weight == "binary" else 1.0 / np.maximum(pairs["v"], float(closest))
    return {
        "robot_of_action": owner, "action": pairs["i"], "target": pairs["j"], "weight": shares, "robots": robots,
        "targets": len(there) if targets is None else targets, "action_names": action_names, "action_positions": here,
        "target_positions": there, "name": name, "format": "positions",
    }  # fmt: skip


def _points(what: str, points: ArrayLike, count: int | None) -> Floats:
    array = arrays.reals(f"{what} positions", points)
    if array.size == 0:
        array = array.reshape(0, 2)
    checked = arrays.positions(what, array, len(array) if count is None else count)
    assert checked is not None
    return checked
