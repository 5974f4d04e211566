"""Pictures of explorations of rooms: a map of doors and links, and the way of each robot."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...formulations.auctions.room_exploration import RoomExploration
from . import PLOTS
from .drawing import COLOURS, INK, QUIET, bare, entitled, legend_below, new_axes
from .maps import scaled_positions

if TYPE_CHECKING:
    from ...formulations.solution import Solution

Floats = NDArray[np.float64]

NAMED = 60
"""Up to so many rooms are named."""

MAP, SEARCH = 1, 2
"""Actions of a step beside going; see ``RoomExploration``."""

HEARD = "#777777"

APART = 0.09
"""By how much ways of different robots run beside each other, in parts of the mean length of a door."""


def places(problem: RoomExploration) -> Floats:
    """Where rooms are drawn: their positions, or such that rooms are as far apart as steps lead from one to the other."""
    given = problem.instance
    if given.positions is not None:
        return given.positions
    from scipy.sparse.csgraph import shortest_path

    steps = np.asarray(shortest_path(given.adjacent.astype(float), unweighted=True))
    return scaled_positions(np.where(np.isfinite(steps), steps, given.num_rooms))


def plot_room_exploration(
    problem: RoomExploration, answer: Any, *, ax: Any = None, solution: Solution | None = None, title: str | None = None
) -> Any:
    """Rooms and doors, dotted where rooms hear each other; a line a robot along its way from room to room, with squares where it maps and
    crosses where it searches.

    Parameters
    ----------
    problem : RoomExploration
    answer : tuple of tuples of (int, int)
        Room and action of each step of each robot.
    ax : matplotlib axes, optional
        New ones by default.
    solution : Solution, optional
        For objective, bound and gap in the title.
    title : str, optional
        Instead of the one made.

    Returns
    -------
    matplotlib.axes.Axes
    """
    from matplotlib.collections import LineCollection
    from matplotlib.lines import Line2D

    ax = new_axes() if ax is None else ax
    given, at = problem.instance, places(problem)
    length = float(np.hypot(*(at[given.doors[:, 0]] - at[given.doors[:, 1]]).T).mean()) if len(given.doors) else 1.0
    ax.add_collection(LineCollection(at[given.doors], colors=QUIET, linewidths=5.0, alpha=0.6, zorder=1))  # type: ignore[arg-type]
    ax.add_collection(LineCollection(at[given.heard], colors=HEARD, linewidths=1.2, linestyles=":", zorder=1))  # type: ignore[arg-type]
    entered = np.zeros(given.num_rooms, dtype=bool)
    entered[given.starts] = True
    handles = []
    for robot, deeds in enumerate(answer):
        colour = COLOURS[robot % len(COLOURS)]
        turn = 2.0 * np.pi * (robot / given.num_robots + 0.125)
        shift = APART * length * np.array([np.cos(turn), np.sin(turn)]) * (given.num_robots > 1)
        rooms = [int(given.starts[robot]), *(room for room, _ in deeds)]
        entered[rooms] = True
        ax.plot(*(at[rooms] + shift).T, color=colour, linewidth=1.6, zorder=3, solid_joinstyle="round")
        ax.scatter(*(at[rooms[:1]] + shift).T, s=42, marker="o", color=colour, edgecolors="white", linewidths=0.8, zorder=5)
        ax.scatter(*(at[rooms[-1:]] + shift).T, s=120, marker="o", color="white", edgecolors=colour, linewidths=1.6, zorder=4)
        for action, marker in ((MAP, "s"), (SEARCH, "X")):
            done = [room for room, what in deeds if what == action]
            ax.scatter(
                *(at[done] + shift).reshape(-1, 2).T, s=34, marker=marker, color=colour, edgecolors="white", linewidths=0.6, zorder=6
            )
        handles.append(Line2D([], [], color=colour, linewidth=1.6, label=f"robot {robot + 1}"))
    for some, face in ((entered, "#DCE6F2"), (~entered, "white")):
        ax.scatter(*at[some].T, s=420, marker="o", color=face, edgecolors="#999999", linewidths=0.8, zorder=2)
    ax.scatter(*at[given.base], s=620, marker="o", facecolors="none", edgecolors=INK, linewidths=1.6, zorder=2)
    if given.num_rooms <= NAMED:
        for room in range(given.num_rooms):
            ax.annotate(
                given.room_name(room), at[room], xytext=(11, 11), textcoords="offset points", fontsize=8, color=INK, zorder=6,
                bbox={"boxstyle": "round,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.7},
            )  # fmt: skip
    bare(ax)
    ax.margins(0.1)
    marks = [("starts here", "o"), ("maps", "s"), ("searches", "X")]
    handles += [Line2D([], [], color="#555555", linestyle="", marker=marker, label=name) for name, marker in marks]
    handles += [
        Line2D([], [], color="#555555", linestyle="", marker="o", markerfacecolor="white", markeredgewidth=1.6, label="ends here"),
        Line2D([], [], color=INK, linestyle="", marker="o", markerfacecolor="none", markersize=11, label="base"),
        Line2D([], [], color=QUIET, linewidth=5, alpha=0.6, label="door"),
        Line2D([], [], color=HEARD, linestyle=":", label="hear each other"),
    ]
    legend_below(ax, handles, [handle.get_label() for handle in handles], min(5, len(handles)), lines=1.0)
    seen = int(entered.sum())
    detail = f"{seen} of {given.num_rooms} rooms entered by {given.num_robots} robots in {given.steps} steps"
    return entitled(ax, problem, answer, solution, title, detail)


PLOTS.add("room-exploration", plot_room_exploration)
