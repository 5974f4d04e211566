"""Pictures of risky paths: maps with the path coloured by the risk run until then, or charts of the risk at each state."""

import itertools
from typing import Any

import numpy as np

from ....formulations.risk.risky_path import RiskyPath
from ....formulations.solution import Solution
from .. import PLOTS
from ..drawing import ALARM, COLOURS, INK, QUIET, bare, chart_axes, entitled, new_axes

FEW_STATES = 4000
"""Most states that are drawn one by one."""


def plot_risky_path(
    problem: RiskyPath, answer: Any, *, ax: Any = None, solution: Solution | None = None, title: str | None = None
) -> Any:  # fmt: skip
    """A path on its map, coloured by the risk until then; where states have no places, the risk along the path as a chart."""
    ax = new_axes() if ax is None else ax
    frame = problem.answer_to_frame(answer)
    if problem.graph.positions is None:
        _chart(ax, frame)
        return entitled(ax, problem, answer, solution, title, "risk until each state, and of each element there")
    _map(ax, problem, answer, frame["risk"].to_numpy())
    dots = "; dots: the risk of each place, the darker the more" if problem.graph.num_states <= FEW_STATES else ""
    return entitled(ax, problem, answer, solution, title, f"path coloured by the risk run until then{dots}")


def _map(ax: Any, problem: RiskyPath, path: Any, risk: Any) -> None:
    from matplotlib.collections import LineCollection
    from matplotlib.patches import Rectangle

    graph = problem.graph
    assert graph.positions is not None
    at = graph.positions[:, :2]
    for box in () if graph.obstacles is None else graph.obstacles.tolist():
        half = len(box) // 2
        ax.add_patch(Rectangle(box[:2], box[half] - box[0], box[half + 1] - box[1], color=QUIET, linewidth=0.0, zorder=1))
    locale = np.zeros(graph.num_states)
    for element in graph.elements:
        if element.category == "locale":
            every = np.arange(graph.num_states)
            none = np.full(graph.num_states, -1)
            locale = 1.0 - (1.0 - locale) * (1.0 - graph.least_risks(element, none, none, every))
    if graph.num_states <= FEW_STATES:
        ax.scatter(*at.T, c=locale, cmap="YlOrRd", s=14, linewidths=0.0, vmin=0.0, vmax=max(float(locale.max()), 1e-9), zorder=2)
        rewarding = np.nonzero(problem.rewards)[0]
        sizes = 30.0 + 120.0 * problem.rewards[rewarding] / max(float(problem.rewards.max()), 1e-300)
        ax.scatter(*at[rewarding].T, s=sizes, facecolors="none", edgecolors=COLOURS[2], linewidths=1.2, zorder=3)
    route = at[list(path)]
    if len(route) > 1:
        lines = LineCollection(list(itertools.pairwise(route)), cmap="viridis_r", linewidths=3.0, zorder=4, capstyle="round")
        lines.set_array(risk[1:])
        ax.add_collection(lines)
        ax.figure.colorbar(lines, ax=ax, shrink=0.7, label="risk until then")
    for tether in (t for t in (getattr(element, "tether", None) for element in graph.elements) if t is not None):
        contacts, _ = tether.along(graph.positions[list(path)].tolist())[-1]
        ax.plot(*np.array([*contacts, route[-1]]).T, color=ALARM, linewidth=1.2, linestyle="--", zorder=5)
    for state, marker in ((graph.start, "s"), *((goal, "*") for goal in graph.goals)):
        ax.scatter(*at[state], marker=marker, s=90, color=INK, zorder=6)
    ax.autoscale_view()
    bare(ax)


def _chart(ax: Any, frame: Any) -> None:
    labels = [title for title in frame.columns if title not in ("state", "risk", "reward", "x", "y", "z")]
    bottom, places = np.zeros(len(frame)), np.arange(len(frame))
    for k, title in enumerate(labels):
        ax.bar(places, frame[title], bottom=bottom, color=COLOURS[k % len(COLOURS)], label=title, zorder=2)
        bottom += frame[title].to_numpy()
    ax.plot(places, frame["risk"], color=INK, linewidth=1.5, marker="o", markersize=3.5, label="until then", zorder=3)
    ax.set_xticks(places, frame["state"], fontsize=7.5, rotation=90 if len(frame) > 20 else 0)
    ax.legend(fontsize=8, frameon=False)
    chart_axes(ax)


PLOTS.add("risky-path", plot_risky_path)
