"""Pictures of days in the orchard."""

from typing import Any

from ....formulations.auctions.orchard_day import OrchardDay
from ..drawing import COLOURS, INK, legend_below, plot_of

PARTS = {"home with a bin": (0, 1.0), "out with a new bin": (1, 0.35), "out without one": (2, 0.35)}
"""Colour and opacity of what robots do; waiting for a bin is part of the way out."""

NAMED = 60
"""Bins up to which each is named."""


@plot_of("orchard-day")
def plot_orchard_day(ax: Any, problem: OrchardDay, answer: Any) -> str:
    """A row for each robot: from left to right its trips, the way out pale and the way home with a bin dark."""
    jobs, home = problem.jobs, problem.timetable(answer)

    def bar(robot: int, begin: int, end: int, part: str) -> None:
        colour, alpha = PARTS[part]
        drawn[part] = ax.barh(robot + 1, end - begin, left=begin, height=0.6, color=COLOURS[colour], alpha=alpha)

    drawn: dict[str, Any] = {}
    for robot, trips in enumerate(answer):
        before = int(jobs.robot_free[robot])
        for bring, fetch in trips:
            if fetch < 0:
                continue
            loaded = int(home[fetch] - jobs.home[fetch])
            bar(robot, before, loaded, "out with a new bin" if bring >= 0 else "out without one")
            bar(robot, loaded, int(home[fetch]), "home with a bin")
            if jobs.num_bins <= NAMED:
                ax.text(loaded + jobs.home[fetch] / 2, robot + 1, str(fetch + 1), ha="center", va="center", fontsize=8, color="white")
            before = int(home[fetch])
    ax.set_yticks(range(1, jobs.num_robots + 1))
    ax.invert_yaxis()
    ax.set_xlabel("step", fontsize=9, color=INK)
    ax.set_ylabel("robot", fontsize=9, color=INK)
    if drawn:
        labels = [part for part in PARTS if part in drawn]
        legend_below(ax, [drawn[part] for part in labels], labels, len(labels))
    return "bins on their way home, and the trips to them"
