"""Robots and tasks out of pandas frames and graphs of networkx."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..text import an, shown
from .robot_tasks import RobotTasks

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ("name", "x", "y", "weight")


def of_frames(robots: pd.DataFrame, tasks: pd.DataFrame, metric: str, name: str) -> RobotTasks:
    """Robots and tasks of two frames.

    Parameters
    ----------
    robots, tasks : pandas.DataFrame
        Columns x, y, and perhaps name; tasks perhaps weight.
    metric, name : str

    Raises
    ------
    InputError
        For an unknown or missing column, and whatever ``RobotTasks`` refuses.
    """
    teams, places = _columns("robots", robots, COLUMNS[:3]), _columns("tasks", tasks, COLUMNS)
    given: dict[str, Any] = {}
    for key, part in (("robot_names", teams), ("task_names", places)):
        if "name" in part:
            given[key] = tuple(map(str, part["name"]))
    if "weight" in places:
        given["weights"] = _numbers("tasks", places, "weight")
    points = [np.column_stack([_numbers(what, part, axis) for axis in "xy"]) for what, part in (("robots", teams), ("tasks", places))]
    return RobotTasks.of_positions(points[0], points[1], metric, name=name, format="frame", **given)


def _columns(what: str, frame: Any, known: tuple[str, ...]) -> dict[str, list[Any]]:
    if not hasattr(frame, "columns") or not hasattr(frame, "iloc"):
        raise InputError(f"{what} must be a pandas frame", found=type(frame).__name__)
    titles = [str(column) for column in frame.columns]
    for title in titles:
        if title not in known:
            raise InputError(f"column {title!r} of {what} is unknown", expected=", ".join(known))
        if titles.count(title) > 1:
            raise InputError(f"column {title!r} of {what} stands twice")
    for title in ("x", "y"):
        if title not in titles:
            raise InputError(f"column {title!r} of {what} is missing")
    return {title: frame.iloc[:, k].tolist() for k, title in enumerate(titles)}


def _numbers(what: str, part: dict[str, list[Any]], title: str) -> Any:
    try:
        return np.array(part[title], dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"column {title!r} of {what} must hold numbers", found=shown(str(part[title][:3]))) from None


def of_graph(graph: Any, robots: Sequence[Any], tasks: Sequence[Any], weight: str) -> RobotTasks:
    """Robots and tasks at nodes of a graph; distances are shortest paths along its edges, directed ones one way.

    Parameters
    ----------
    graph : networkx graph
    robots, tasks : sequences of nodes
        A node may hold several; names are those of the nodes where they differ.
    weight : str
        Attribute with an edge's length; edges without it are 1 long.

    Raises
    ------
    InputError
        If a node does not exist, a length is negative or NaN, or no way leads from a robot to a task or between tasks.
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import dijkstra

    nodes = {node: k for k, node in enumerate(graph)}
    for what, places in (("robot", robots), ("task", tasks)):
        for node in places:
            if node not in nodes:
                raise InputError(f"{an(what)} stands at {node!r}, which is no node of the graph")
    shortest: dict[tuple[int, int], float] = {}
    for tail, head, data in graph.edges(data=True):
        try:
            length = float(data.get(weight, 1.0))
        except (TypeError, ValueError):
            length = -1.0
        if not 0.0 <= length < np.inf:
            raise InputError(f"the length of edge {tail!r} to {head!r} must be finite and not negative", found=str(data.get(weight)))
        for pair in ((nodes[tail], nodes[head]),) if graph.is_directed() else ((nodes[tail], nodes[head]), (nodes[head], nodes[tail])):
            shortest[pair] = min(length, shortest.get(pair, np.inf))
    ends = np.array(list(shortest), dtype=np.int64).reshape(-1, 2)
    # scipy takes a stored 0 for an edge of no length only where it is stored explicitly, as it is here
    arcs = csr_matrix((np.array(list(shortest.values())), (ends[:, 0], ends[:, 1])), shape=(len(nodes),) * 2)
    rows = [nodes[node] for node in (*robots, *tasks)]
    matrix = dijkstra(arcs, indices=rows)[:, rows[len(robots) :]] if rows else np.zeros((0, 0))
    lost = np.argwhere(np.isinf(matrix))
    if len(lost):
        i, j = lost[0].tolist()
        begin = f"robot {robots[i]!r}" if i < len(robots) else f"task {tasks[i - len(robots)]!r}"
        raise InputError(f"no way leads from {begin} to task {tasks[j]!r}", expected="tasks that robots can reach")
    named = [tuple(map(str, places)) if len(set(map(str, places))) == len(places) else None for places in (robots, tasks)]
    return RobotTasks(
        len(robots), len(tasks), "matrix", matrix=matrix, robot_names=named[0], task_names=named[1],
        name=str(getattr(graph, "name", "") or "graph"), format="networkx",
    )  # fmt: skip
