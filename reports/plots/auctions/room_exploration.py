"""Pictures of explorations: a map of rooms, doors and links, and the way of each robot."""

from typing import Any

import numpy as np

from ....formulations.auctions.room_exploration import RoomExploration
from ....instances.number_arrays import Floats
from ..drawing import COLOURS, INK, QUIET, bare, legend_below, plot_of
from ..positions import scaled_positions

NAMED = 60
"""Rooms up to which each is named."""

MAP, SEARCH = 1, 2
"""Actions of a step beside going; see ``RoomExploration``."""

HEARD = "#777777"

RADIUS = 11.0
"""Points from the middle of a room, and the lanes beside it, to its name."""

LINE = 11.0
"""Height of a line of a label in points."""

NEAR = 1.25
"""Mean lengths of a door within which one room counts as beside another."""

RUNS = 6
"""Stays of a robot in a room that are written out."""

APART = 0.09
"""Distance between ways of different robots beside each other, as a share of the mean length of a door."""


def places(problem: RoomExploration) -> Floats:
    """Positions of rooms: their own, or such that distances come close to the numbers of steps between rooms."""
    instance = problem.instance
    if instance.positions is not None:
        return instance.positions
    from scipy.sparse.csgraph import shortest_path

    steps = np.asarray(shortest_path(instance.adjacent.astype(float), unweighted=True))
    return scaled_positions(np.where(np.isfinite(steps), steps, instance.num_rooms))


@plot_of("room-exploration")
def plot_room_exploration(ax: Any, problem: RoomExploration, answer: Any) -> str:
    """Rooms and doors, dotted lines where rooms hear each other, and a line for each robot's way.

    Squares mark where a robot maps, crosses where it searches. Beside each room stand its name and, in the colour of each robot that enters
    it, the steps after which the robot is there.
    """
    from matplotlib.collections import LineCollection
    from matplotlib.lines import Line2D

    instance, at = problem.instance, places(problem)
    length = float(np.hypot(*(at[instance.doors[:, 0]] - at[instance.doors[:, 1]]).T).mean()) if len(instance.doors) else 1.0
    ax.add_collection(LineCollection(at[instance.doors], colors=QUIET, linewidths=5.0, alpha=0.6, zorder=1))  # type: ignore[arg-type]
    ax.add_collection(LineCollection(at[instance.heard], colors=HEARD, linewidths=1.2, linestyles=":", zorder=1))  # type: ignore[arg-type]
    entered = np.zeros(instance.num_rooms, dtype=bool)
    entered[instance.starts] = True
    handles: list[Any] = []
    lines = 0
    for robot, deeds in enumerate(answer):
        colour = COLOURS[robot % len(COLOURS)]
        turn = 2.0 * np.pi * (robot / instance.num_robots + 0.125)
        shift = APART * length * np.array([np.cos(turn), np.sin(turn)]) * (instance.num_robots > 1)
        rooms = [int(instance.starts[robot]), *(room for room, _ in deeds)]
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
    ax.scatter(*at[instance.base], s=620, marker="o", facecolors="none", edgecolors=INK, linewidths=1.6, zorder=2)
    if instance.num_rooms <= NAMED:
        lines = _name_rooms(ax, problem, answer, at, length)
    bare(ax)
    ax.margins(_margin(ax, lines))
    marks = [("starts here", "o"), ("maps", "s"), ("searches", "X")]
    handles += [Line2D([], [], color="#555555", linestyle="", marker=marker, label=name) for name, marker in marks]
    if instance.num_rooms <= NAMED:
        handles.append(Line2D([], [], color="#555555", linestyle="", marker="$1,3$", markersize=14, label="there after these steps"))
    handles += [
        Line2D([], [], color="#555555", linestyle="", marker="o", markerfacecolor="white", markeredgewidth=1.6, label="ends here"),
        Line2D([], [], color=INK, linestyle="", marker="o", markerfacecolor="none", markersize=11, label="base"),
        Line2D([], [], color=QUIET, linewidth=5, alpha=0.6, label="door"),
        Line2D([], [], color=HEARD, linestyle=":", label="hear each other"),
    ]
    legend_below(ax, handles, [handle.get_label() for handle in handles], min(5, len(handles)), lines=1.0)
    seen = int(entered.sum())
    detail = f"{seen} of {instance.num_rooms} rooms entered by {instance.num_robots} robots in {instance.steps} steps"
    return detail


def _name_rooms(ax: Any, problem: RoomExploration, answer: Any, at: Floats, length: float) -> int:
    """Write the name of each room, and when robots are there, on the side far from its doors; returns the lines of the longest label."""
    from matplotlib.offsetbox import AnnotationBbox, TextArea, VPacker

    instance, apart = problem.instance, APART * length * (problem.instance.num_robots > 1)
    visits: list[list[tuple[str, str]]] = [[] for _ in range(instance.num_rooms)]
    for robot, deeds in enumerate(answer):
        steps: dict[int, list[int]] = {}
        for step, room in enumerate([int(instance.starts[robot]), *(room for room, _ in deeds)]):
            steps.setdefault(room, []).append(step)
        for room, own in steps.items():
            visits[room].append((_runs(own), COLOURS[robot % len(COLOURS)]))
    links = np.concatenate([instance.doors, instance.heard]) if len(instance.heard) else instance.doors
    for room in range(instance.num_rooms):
        near = np.hypot(*(at - at[room]).T) <= NEAR * length  # whose labels may come from the other side
        near[links[(links == room).any(axis=1)].ravel()] = True
        near[room] = False
        middle, half = _free_side(at[near] - at[room])
        towards = np.array([np.cos(middle), np.sin(middle)])
        x, y = (0.5 if abs(part) < 0.3 else float(part < 0) for part in towards)  # where the text is tied
        reach = RADIUS + 3.0 * (room == instance.base)
        texts = [
            TextArea(text, textprops={"fontsize": size, "color": colour})
            for text, colour, size in [(instance.room_name(room), INK, 8.0), *((*visit, 7.5) for visit in visits[room])]
        ]
        ax.add_artist(AnnotationBbox(
            VPacker(children=list(texts), align=("left", "center", "right")[round(2 * x)], pad=0, sep=1),
            at[room] + towards * apart / max(np.sin(half), 0.4), xybox=(reach * towards[0], reach * towards[1]), boxcoords="offset points",
            box_alignment=(x, y), frameon=False, pad=0, zorder=7, annotation_clip=False,
        ))  # fmt: skip
    return 1 + max(map(len, visits))


def _margin(ax: Any, lines: int) -> float:
    """Margin of the map, as a share of it, that leaves room for labels of so many lines."""
    height = 0.65 * ax.get_window_extent().height * 72.0 / ax.figure.dpi  # titles and legends take the rest
    part = min((3.0 * RADIUS + LINE * lines) / height, 0.3)
    return max(0.1, float(part / (1.0 - 2.0 * part)))


def _free_side(others: Floats) -> tuple[float, float]:
    """Middle and half width, at most a right angle, of the widest angle without ways and rooms; to the upper right if it may choose."""
    angles = np.unique(np.arctan2(others[:, 1], others[:, 0])) if len(others) else np.zeros(0)
    if not len(angles):
        return np.pi / 4, np.pi / 2
    width = np.diff(angles, append=angles[0] + 2 * np.pi)
    if len(angles) == 1:
        return float(angles[0] + np.pi + (-np.pi / 4 if np.cos(angles[0] + np.pi) < -0.5 else np.pi / 4)), np.pi / 2
    middle = angles + width / 2
    best = max(range(len(angles)), key=lambda k: (round(float(width[k]), 6), float(np.cos(middle[k] - np.pi / 4))))
    return float(middle[best]), float(min(width[best], np.pi) / 2)


def _runs(steps: list[int]) -> str:
    """Numbers as text, runs of consecutive ones as ``2-4``."""
    runs: list[list[int]] = []
    for step in steps:
        if runs and step == runs[-1][1] + 1:
            runs[-1][1] = step
        else:
            runs.append([step, step])
    texts = [str(first) if first == last else f"{first}-{last}" for first, last in runs[:RUNS]]
    return ", ".join([*texts, *["..."] * (len(runs) > RUNS)])
