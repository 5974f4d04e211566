"""Pictures of joint assignments: the errand of each robot over time."""

from typing import Any

from ....formulations.auctions.joint_assignment import JointAssignment
from ..drawing import COLOURS, INK, QUIET, chart_axes, legend_below, plot_of, roomy

NAMED = 40
"""Robots up to which each is named."""

KINDS = (("to the request", COLOURS[4], ""), ("to the bin", COLOURS[2], ""), ("waiting until the bin is full", QUIET, "////"))


def legs(problem: JointAssignment, robot: int, errand: tuple[int, int]) -> tuple[float, float, float]:
    """Times at which a robot reaches its request, its bin, and at which that is full; without one, the time of the event before."""
    place, request = errand
    brought = problem.cost_of(robot, -1, request)
    if place < 0:
        return brought, brought, brought
    way = problem.instance.to_bin[robot, place] if request < 0 else brought + problem.instance.between[request, place]
    return brought, float(way), problem.cost_of(robot, place, request)


@plot_of("joint-assignment")
def plot_joint_assignment(ax: Any, problem: JointAssignment, answer: Any) -> str:
    """A bar per robot: its way to a request, on to a bin, and how long it waits there until the bin is full."""
    from matplotlib.patches import Patch

    instance, few = problem.instance, problem.num_robots <= NAMED
    roomy(ax, height=1.8 + 0.3 * min(problem.num_robots, NAMED))
    for robot, (place, request) in enumerate(answer):
        begin, ends = 0.0, legs(problem, robot, (place, request))
        for end, (_, colour, hatch) in zip(ends, KINDS, strict=True):
            ax.barh(robot, end - begin, left=begin, height=0.62, color=colour, hatch=hatch, edgecolor="white", linewidth=0.6, zorder=2)
            begin = end
        names = [f"{what} {instance.name_of(what, k)}" for what, k in (("request", request), ("bin", place)) if k >= 0]
        if few:
            text = ", ".join(names) or "no errand"
            ax.annotate(text, (ends[-1], robot), xytext=(5, 0), textcoords="offset points", va="center", fontsize=8, color=INK)
    ax.set_yticks(
        range(problem.num_robots) if few else [], [instance.name_of("robot", k) for k in range(problem.num_robots)] if few else []
    )
    ax.set_ylabel("robot", fontsize=9, color="#555555")
    ax.set_xlabel("time from now", fontsize=9, color="#555555")
    ax.margins(x=0.16 if few else 0.02)
    ax.set_xlim(left=0.0)
    ax.set_ylim(problem.num_robots - 0.4, -0.6)
    chart_axes(ax)
    ax.grid(axis="y", visible=False)
    ax.grid(axis="x", color="#EEEEEE", zorder=0)
    handles = [Patch(facecolor=colour, hatch=hatch, edgecolor="white") for _, colour, hatch in KINDS]
    legend_below(ax, handles, [kind for kind, _, _ in KINDS], len(KINDS))
    detail = f"{problem.pickups} bins fetched, {problem.deliveries} requests served by {problem.num_robots} robots"
    return detail
