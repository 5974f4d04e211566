"""Pictures of paths through graphs of uncertain edge costs."""

from typing import Any

import numpy as np

from ....formulations.risk.uncertain_path import UncertainPath
from ....formulations.solution import Solution
from ....formulations.stop import Stop
from ....instances.risk.uncertain_graph import Floats, UncertainGraph
from ....solvers.engines.risk.non_dominated_paths import non_dominated_paths
from .. import PLOTS
from ..drawing import COLOURS, INK, QUIET, bare, entitled, new_axes

MAP_EDGES = 4000
"""Most edges that are drawn: more would hide the map."""

NAMED = 30
"""Most vertices that are named."""

PATIENCE = 1.0
"""Seconds that the non-dominated paths behind an answer may take."""


def places(graph: UncertainGraph) -> Floats:
    """Places at which vertices are drawn, shape (vertices, 2): their positions, or columns by the number of edges from the start."""
    if graph.positions is not None:
        return graph.positions
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import dijkstra

    matrix = csr_matrix((np.ones(graph.num_edges), graph.heads, graph.indptr), shape=(graph.num_vertices,) * 2)
    hops = dijkstra(matrix, indices=graph.start, unweighted=True)
    column = np.where(np.isfinite(hops), hops, hops[np.isfinite(hops)].max() + 1.0)
    column[graph.goal] = column.max() + (float((column == column.max()).sum()) > 1)
    row = np.zeros(graph.num_vertices)
    for level in np.unique(column):
        members = np.nonzero(column == level)[0]
        row[members] = (len(members) - 1) / 2.0 - np.arange(len(members)) + 0.35 * (level % 2)  # edges within a row stay visible
    return np.column_stack([column, row])


def plot_uncertain_path(
    problem: UncertainPath, answer: Any, *, ax: Any = None, solution: Solution | None = None, title: str | None = None
) -> Any:
    """A map: the path, the other non-dominated paths, and all edges, the darker the more uncertain their costs."""
    ax = new_axes() if ax is None else ax
    graph = problem.graph
    at = places(graph)
    draw_edges(ax, graph, at)
    others = non_dominated_paths(graph, stop=Stop(PATIENCE)).paths
    for path in others:
        ax.plot(*at[list(path)].T, color=COLOURS[1], linewidth=1.2, alpha=0.8, zorder=2)
    ax.plot(*at[list(answer)].T, color=COLOURS[0], linewidth=2.6, solid_capstyle="round", zorder=3)
    draw_vertices(ax, graph, at)
    bare(ax)
    return entitled(
        ax, problem, answer, solution, title, f"the path, and {len(others)} non-dominated ones; edges of a large variance stand out"
    )


def draw_edges(ax: Any, graph: UncertainGraph, at: Floats) -> None:
    """Draw all edges, unless they are too many, the darker the more uncertain."""
    from matplotlib.collections import LineCollection

    if graph.num_edges > MAP_EDGES:
        return
    share = graph.variance / max(float(graph.variance.max()), 1e-300)
    colours = np.column_stack([np.repeat([[0.35, 0.35, 0.35]], graph.num_edges, axis=0), 0.06 + 0.4 * share])
    ax.add_collection(LineCollection(list(np.stack([at[graph.tails], at[graph.heads]], axis=1)), colors=colours, linewidths=0.6, zorder=1))


def draw_vertices(ax: Any, graph: UncertainGraph, at: Floats) -> None:
    """Draw vertices, start and goal, with names where there are few."""
    ax.scatter(*at.T, s=10, color="white", edgecolors=QUIET if graph.num_vertices > NAMED else INK, linewidths=0.6, zorder=4)
    for vertex, marker in ((graph.start, "o"), (graph.goal, "s")):
        ax.scatter(*at[vertex], s=70, marker=marker, color=COLOURS[2], edgecolors="white", zorder=5)
    named = range(graph.num_vertices) if graph.num_vertices <= NAMED else (graph.start, graph.goal)
    for vertex in named:
        ax.annotate(graph.vertex_name(vertex), at[vertex], xytext=(5, 5), textcoords="offset points", fontsize=8, color=INK, zorder=6)


PLOTS.add("uncertain-path", plot_uncertain_path)
