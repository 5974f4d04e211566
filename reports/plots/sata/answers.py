"""Pictures of selections and max-min answers, and of the sensing graphs that both may stand on: as maps, or in two columns."""

from typing import Any

import numpy as np

from ....formulations.sata.bottleneck_sata import BottleneckSATA
from ....formulations.sata.max_min_lp import MaxMinLP
from ....formulations.sata.selections import indicator
from ....formulations.sata.submodular_selection import SubmodularSelection
from ....formulations.sata.winner_takes_all_sata import WinnerTakesAllSATA
from ....formulations.solution import Solution
from ....instances.number_arrays import Floats
from ....instances.sata.sensing_graph import SensingGraph
from .. import PLOTS
from ..drawing import ALARM, COLOURS, INK, QUIET, bare, bars, chart_axes, entitled, new_axes, rounded

BIPARTITE_NODES = 40
"""Up to this many actions and as many targets are drawn as nodes; larger graphs without positions as a chart of their targets."""

MAP_EDGES = 3000
"""More edges than this are left out of a map: they would hide it."""

NAMED_ROBOTS = 31
"""Up to this many robots, or elements, are named."""


def plot_max_min(
    problem: BottleneckSATA | MaxMinLP, answer: Any, *, ax: Any = None, solution: Solution | None = None, title: str | None = None
) -> Any:
    """A bottleneck answer as a map, a bipartite graph or a chart of the targets' coverage; a max-min program as a chart of its rows."""
    ax = new_axes() if ax is None else ax
    if isinstance(problem, MaxMinLP):
        x = np.asarray(answer, dtype=np.float64)
        matrix, what = (problem.covering, "covering row") if problem.sense == "max" else (problem.packing, "packing row")
        values = np.asarray(matrix.scipy @ x, dtype=np.float64)
        worst = float(values.min() if problem.sense == "max" else values.max())
        bars(ax, values, [str(k + 1) for k in range(matrix.rows)], what, worst=worst, ascending=True, bound=_bound(solution))
        return entitled(ax, problem, answer, solution, title, f"value of each {what}")
    graph = problem.graph
    shares = problem.shares_of(answer)
    covered = problem.coverage(shares)
    drawn = draw_graph(ax, graph, shares, covered, None)
    if not drawn:
        worst = float(covered.min(initial=np.inf))
        names = [graph.target_name(t) for t in range(graph.num_targets)]
        bars(ax, covered, names, "target", worst=worst, ascending=True, bound=_bound(solution), colours=_shades(covered, worst))
    return entitled(ax, problem, answer, solution, title, drawn or "coverage of each target, the worst covered in red")


def _shades(covered: Floats, worst: float) -> list[str]:
    """Colours of targets: the worst covered stand out."""
    return [ALARM if value <= worst * (1.0 + 1e-9) else COLOURS[0] for value in covered.tolist()]


def _bound(solution: Solution | None) -> tuple[float, str] | None:
    """The solution's bound and its kind, where it has one."""
    return (solution.bound, str(solution.bound_kind)) if solution is not None and isinstance(solution.bound, float) else None


def plot_selection(
    problem: SubmodularSelection, answer: Any, *, ax: Any = None, solution: Solution | None = None, title: str | None = None
) -> Any:
    """Winner takes all as a map, a bipartite graph or a chart of the robots' credits; other selections as value after each choice."""
    ax = new_axes() if ax is None else ax
    if not isinstance(problem, WinnerTakesAllSATA):
        _climb(ax, problem, answer, solution)
        what = "value after each choice, in their order" if answer.in_order else "value as the elements are added one by one"
        return entitled(ax, problem, answer, solution, title, what)
    graph = problem.graph
    shares = indicator(answer, graph.num_actions)
    winner = problem.winners(answer.elements)[0] if answer.winners is None else np.asarray(answer.winners)
    credit = problem.credited(answer)
    drawn = draw_graph(ax, graph, shares, credit, winner)
    if not drawn:
        _credits(ax, problem, winner, credit, solution)
    what = f"weight credited to each robot, and added up; {int((credit <= 0).sum())} of {len(credit)} targets bring nothing"
    return entitled(ax, problem, answer, solution, title, drawn or what)


def _credits(ax: Any, problem: WinnerTakesAllSATA, winner: Any, credit: Any, solution: Solution | None) -> None:
    """Chart of the credit of each robot, from the largest, and how it adds up towards the bound."""
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
    bound = _bound(solution)
    if bound is not None:
        value, kind = bound
        label = f"bound {rounded(value)} ({kind})"
        ax.axhline(value, color=ALARM, linewidth=1.2, linestyle=(0, (5, 2)), zorder=2, label=label)


def _climb(ax: Any, problem: SubmodularSelection, answer: Any, solution: Solution | None) -> None:
    values = np.concatenate([[0.0], np.cumsum(problem.gains(answer.elements))])
    places = np.arange(len(values))
    ax.bar(places[1:], np.diff(values), width=0.7, color=QUIET, zorder=1, label="gain")
    ax.plot(places, values, color=COLOURS[0], linewidth=1.8, marker="o" if len(values) <= 60 else "", markersize=4, zorder=3, label="value")
    _bound_line(ax, solution)
    if len(values) <= NAMED_ROBOTS:
        ax.set_xticks(places[1:], [problem.element_name(e) for e in answer.elements], fontsize=8, rotation=90 if len(values) > 16 else 0)
        order = "in the order of choice" if answer.in_order else "as the answer lists them"
        ax.set_xlabel(f"elements {order}", fontsize=9, color="#555555")
    else:
        ax.set_xlabel("number of elements", fontsize=9, color="#555555")
    ax.legend(loc="upper left", bbox_to_anchor=(0.0, 0.93), frameon=False, fontsize=9)
    chart_axes(ax)


# -- sensing graphs ------------------------------------------------------------------------------------------------------


def draw_graph(ax: Any, graph: SensingGraph, shares: Floats, covered: Floats, winner: Any) -> str:
    """Draw a graph that has positions or is small enough; returns what is shown, "" if nothing was drawn.

    ``shares`` of the actions and ``covered``, what each target gets; ``winner``, of shape (targets,), is the robot that is credited with
    each target, -1 for nobody, or None where all that see it count.
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


PLOTS.add("max-min", plot_max_min)
PLOTS.add("selection", plot_selection)
