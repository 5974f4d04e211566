"""Pictures of selections."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ....formulations.sata.submodular_selection import SubmodularSelection
from ....formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from .. import PLOTS
from ..drawing import ALARM, COLOURS, QUIET, chart_axes, entitled, new_axes, rounded
from .sensing import draw_graph

if TYPE_CHECKING:
    from ....formulations.solution import Solution

NAMED_ROBOTS = 31
"""Up to this many robots are named."""


def plot_selection(
    problem: SubmodularSelection, answer: Any, *, ax: Any = None, solution: Solution | None = None, title: str | None = None
) -> Any:
    """Winner takes all as a map, a bipartite graph or a chart of the robots' credits; other selections as value after each choice.

    Parameters
    ----------
    problem : SubmodularSelection
    answer : Selection
    ax, solution, title
        See ``plot_max_min``.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = new_axes() if ax is None else ax
    if not isinstance(problem, WinnerTakesAllSATA):
        _climb(ax, problem, answer, solution)
        what = "value after each choice, in their order" if answer.in_order else "value as the elements are added one by one"
        return entitled(ax, problem, answer, solution, title, what)
    graph = problem.graph
    shares = np.zeros(graph.num_actions)
    shares[list(answer.elements)] = 1.0
    winner = problem.winners(answer.elements)[0] if answer.winners is None else np.asarray(answer.winners)
    credit = problem.credited(answer)
    drawn = draw_graph(ax, graph, shares, credit, winner)
    if not drawn:
        _credits(ax, problem, winner, credit, solution)
    what = f"weight credited to each robot, and added up; {int((credit <= 0).sum())} of {len(credit)} targets bring nothing"
    return entitled(ax, problem, answer, solution, title, drawn or what)


def _credits(ax: Any, problem: WinnerTakesAllSATA, winner: Any, credit: Any, solution: Solution | None) -> None:
    """What each robot is credited with, from the largest, and how it adds up towards the bound."""
    graph = problem.graph
    brings = np.bincount(winner[winner >= 0], weights=credit[winner >= 0], minlength=graph.num_robots)
    order = np.argsort(-brings, kind="stable")
    places = np.arange(1, len(order) + 1)
    few = len(order) <= NAMED_ROBOTS
    colours = [COLOURS[robot % len(COLOURS)] for robot in order.tolist()] if few else QUIET
    ax.bar(places, brings[order], width=0.7 if few else 1.0, color=colours, zorder=2, label="credited to the robot")
    total = np.concatenate([[0.0], np.cumsum(brings[order])])
    ax.plot(
        np.arange(len(total)), total, color=COLOURS[0], linewidth=1.8, marker="o" if few else "", markersize=4, zorder=3, label="added up"
    )
    _bound_line(ax, solution)
    if few:
        ax.set_xticks(places, [graph.robot_name(r) for r in order.tolist()], fontsize=8, rotation=90 if len(order) > 16 else 0)
    ax.set_xlabel("robots, by what they are credited with", fontsize=9, color="#555555")
    ax.legend(loc="center right", frameon=False, fontsize=9)
    chart_axes(ax)


def _bound_line(ax: Any, solution: Solution | None) -> None:
    if solution is not None and isinstance(solution.bound, float):
        label = f"bound {rounded(solution.bound)} ({solution.bound_kind})"
        ax.axhline(solution.bound, color=ALARM, linewidth=1.2, linestyle=(0, (5, 2)), zorder=2, label=label)


def _climb(ax: Any, problem: SubmodularSelection, answer: Any, solution: Solution | None) -> None:
    values = np.concatenate([[0.0], np.cumsum(problem.gains(answer.elements))])
    places = np.arange(len(values))
    ax.bar(places[1:], np.diff(values), width=0.7, color=QUIET, zorder=1, label="gain")
    ax.plot(places, values, color=COLOURS[0], linewidth=1.8, marker="o" if len(values) <= 60 else "", markersize=4, zorder=3, label="value")
    _bound_line(ax, solution)
    if len(values) <= 31:
        ax.set_xticks(places[1:], [problem.element_name(e) for e in answer.elements], fontsize=8, rotation=90 if len(values) > 16 else 0)
        order = "in the order of choice" if answer.in_order else "as the answer lists them"
        ax.set_xlabel(f"elements {order}", fontsize=9, color="#555555")
    else:
        ax.set_xlabel("number of elements", fontsize=9, color="#555555")
    ax.legend(loc="upper left", bbox_to_anchor=(0.0, 0.93), frameon=False, fontsize=9)
    chart_axes(ax)


PLOTS.add("selection", plot_selection)
