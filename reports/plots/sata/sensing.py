"""Sensing graphs as maps, or in two columns: what the plots of the families over them share."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....instances.sata.sensing_graph import SensingGraph
from ..drawing import ALARM, COLOURS, INK, QUIET, bare

Floats = NDArray[np.float64]

BIPARTITE_NODES = 40
"""Up to this many actions and as many targets are drawn as nodes; larger graphs without positions as a chart of their targets."""

MAP_EDGES = 3000
"""More edges than this are left out of a map: they would hide it."""


def target_names(graph: SensingGraph) -> list[str]:
    """Names of all targets."""
    return [graph.target_name(t) for t in range(graph.num_targets)]


def draw_graph(ax: Any, graph: SensingGraph, shares: Floats, covered: Floats, winner: Any) -> str:
    """Draw a graph that has positions or is small enough.

    Parameters
    ----------
    ax : matplotlib axes
    graph : SensingGraph
    shares : array of shape (actions,)
        How far each action is taken.
    covered : array of shape (targets,)
        What each target gets.
    winner : array of shape (targets,), or None
        The robot that is credited with each target, -1 for nobody; None where all that see it count.

    Returns
    -------
    str
        What is shown, "" if nothing was drawn.
    """
    if graph.action_positions is not None and graph.target_positions is not None:
        _draw(ax, graph, graph.action_positions, graph.target_positions, shares, covered, winner)
        bare(ax)
        worst = ", the worst covered in red" if winner is None else ""
        return f"chosen actions as triangles, targets as dots{worst}, uncovered ones hollow"
    if max(graph.num_actions, graph.num_targets) > BIPARTITE_NODES:
        return ""
    starts, actions = graph.by_robot
    rank = np.empty(graph.num_actions)
    rank[actions] = np.arange(graph.num_actions) + 0.8 * graph.robot_of_action[actions]  # a gap between robots
    here = np.column_stack([np.zeros(graph.num_actions), -_spread(rank)])
    there = np.column_stack([np.full(graph.num_targets, 1.0), -_spread(np.arange(graph.num_targets, dtype=np.float64))])
    _draw(ax, graph, here, there, shares, covered, winner)
    for a in range(graph.num_actions):
        ax.text(-0.03, here[a, 1], graph.action_name(a), ha="right", va="center", fontsize=8, color=INK if shares[a] > 0 else "#888888")
    for robot in range(graph.num_robots):
        own = actions[starts[robot] : starts[robot + 1]]
        if len(own):
            colour, middle = COLOURS[robot % len(COLOURS)], float(here[own, 1].mean())
            ax.text(-0.2, middle, graph.robot_name(robot), ha="right", va="center", fontsize=9, fontweight="bold", color=colour)
    for t in range(graph.num_targets):
        text = f"{graph.target_name(t)}  {covered[t]:.4g}"
        ax.text(1.04, there[t, 1], text, ha="left", va="center", fontsize=8, color=INK if covered[t] > 0 else ALARM)
    ax.set_xlim(-0.35, 1.25)
    ax.axis("off")
    return "actions, the chosen ones filled, and what each target gets"


def _spread(order: Floats) -> Floats:
    """Places from 0 to 1 in the given order; one alone stands in the middle."""
    most = float(order.max(initial=0.0))
    return order / most if most > 0 else order + 0.5


def _draw(ax: Any, graph: SensingGraph, here: Floats, there: Floats, shares: Floats, covered: Floats, winner: Any) -> None:
    """Edges, actions and targets at their places; faint what is not chosen."""
    from matplotlib.collections import LineCollection

    action = graph.action_of_edge
    used = shares[action] > 0
    if not used.all() and graph.num_edges <= MAP_EDGES:
        faint = np.stack([here[action[~used]], there[graph.indices[~used]]], axis=1)
        ax.add_collection(LineCollection(list(faint), colors=QUIET, linewidths=0.5, alpha=0.5, zorder=1))
    edges = np.nonzero(used)[0]
    if len(edges):
        robot, target = graph.robot_of_action[action[edges]], graph.indices[edges]
        strength = np.clip(shares[action[edges]], 0.15, 1.0)
        if winner is not None:
            strength *= np.where(winner[target] == robot, 1.0, 0.25)  # seen, but credited to another
        colours, lines = np.array(COLOURS)[robot % len(COLOURS)], np.stack([here[action[edges]], there[target]], axis=1)
        ax.add_collection(
            LineCollection(list(lines), colors=colours, linewidths=0.4 + 1.2 * strength, alpha=np.clip(strength, 0.2, 0.9), zorder=2)
        )
    _draw_actions(ax, graph, here, shares)
    size = 0.7 * _area(len(there))
    seen = covered > 0
    if winner is None:
        worst = covered <= covered.min(initial=0.0 if not len(covered) else np.inf) * (1 + 1e-9)
        colour = np.where(worst, ALARM, "#444444")
    else:
        colour = np.array([*COLOURS, QUIET])[np.where(winner >= 0, winner % len(COLOURS), len(COLOURS))]
    ax.scatter(there[seen, 0], there[seen, 1], s=size, color=colour[seen], edgecolors="white", linewidths=0.5, zorder=5)
    ax.scatter(there[~seen, 0], there[~seen, 1], s=size, facecolors="white", edgecolors=ALARM, linewidths=1.1, zorder=5)
    ax.autoscale_view()


def _draw_actions(ax: Any, graph: SensingGraph, here: Floats, shares: Floats) -> None:
    chosen, idle = shares > 0, shares <= 0
    size = _area(max(int(chosen.sum()), 1))
    ax.scatter(
        here[idle, 0], here[idle, 1], marker="^", s=min(0.4 * size, _area(len(here))), facecolors="white", edgecolors="#AAAAAA",
        linewidths=0.6, zorder=3,
    )  # fmt: skip
    ax.scatter(
        here[chosen, 0], here[chosen, 1], marker="^", s=size * np.clip(shares[chosen], 0.3, 1.0), zorder=4,
        color=np.array(COLOURS)[graph.robot_of_action[chosen] % len(COLOURS)], edgecolors="white", linewidths=0.4,
    )  # fmt: skip


def _area(count: int) -> float:
    """Area of a mark, smaller on crowded maps."""
    return float(np.clip(5000.0 / max(count, 1), 9.0, 75.0))
