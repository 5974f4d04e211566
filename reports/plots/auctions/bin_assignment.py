"""Pictures of assignments of robots to bins."""

from typing import Any

import numpy as np

from ....formulations.auctions.bin_assignment import BinAssignment
from ....instances.number_arrays import Floats
from ..drawing import ALARM, COLOURS, INK, QUIET, bare, plot_of

NAMED = 40
"""Robots and bins together up to which each is named."""


def places(problem: BinAssignment) -> tuple[Floats, Floats]:
    """Positions of robots and bins: their own, or two columns."""
    data = problem.instance
    if data.robot_positions is not None and data.bin_positions is not None:
        return data.robot_positions, data.bin_positions
    n, m = problem.num_robots, problem.num_bins
    rows = [-np.linspace(0.0, 1.0, k) * max(n, m) if k > 1 else np.array([-max(n, m) / 2.0]) for k in (n, m)]
    return np.column_stack([np.zeros(n), rows[0]]), np.column_stack([np.full(m, 0.6 * max(n, m)), rows[1]])


@plot_of("bin-assignment")
def plot_bin_assignment(ax: Any, problem: BinAssignment, answer: Any) -> str:
    """A map, or two columns where there are no positions: robots, bins, and a line for each pair, the thicker the dearer.

    Where the largest cost is the objective, the pairs of that cost are red.
    """
    from matplotlib.collections import LineCollection

    robots, bins = places(problem)
    taken = np.array(answer)
    used = np.nonzero(taken >= 0)[0]
    costs = problem.costs_of(answer)[used]
    share = (costs - costs.min(initial=np.inf)) / max(float(np.ptp(costs)), 1e-300) if len(costs) else costs
    lines = list(np.stack([robots[used], bins[taken[used]]], axis=1))
    remark = ""
    colours = np.full(len(used), COLOURS[0], dtype=object)
    if problem.objective == "bottleneck" and len(used):
        dearest = costs >= costs.max() - 1e-9 * np.abs(costs).max()
        colours[dearest] = ALARM
        remark = ", the dearest in red"
    ax.add_collection(LineCollection(lines, colors=colours.tolist(), linewidths=0.8 + 2.0 * share, alpha=0.8, zorder=2))
    free = np.setdiff1d(np.arange(problem.num_bins), taken[used])
    idle = np.nonzero(taken < 0)[0]
    for points, marker, colour in (
        (robots[used], "o", COLOURS[2]), (robots[idle], "o", QUIET), (bins[taken[used]], "s", COLOURS[1]), (bins[free], "s", QUIET),
    ):  # fmt: skip
        ax.scatter(*points.T, s=36, marker=marker, color=colour, edgecolors=INK, linewidths=0.5, zorder=3)
    if problem.num_robots + problem.num_bins <= NAMED:
        data = problem.instance
        columns = data.robot_positions is None or data.bin_positions is None  # of which lines leave to one side only
        for count, name, at, side in ((problem.num_robots, data.robot_name, robots, -1), (problem.num_bins, data.bin_name, bins, 1)):
            text = {"xytext": (8 * side, 0), "va": "center", "ha": "right" if side < 0 else "left"} if columns else {"xytext": (5, 5)}
            for k in range(count):
                ax.annotate(name(k), at[k], textcoords="offset points", fontsize=8, color=INK, zorder=4, **text)
    ax.autoscale_view()
    bare(ax)
    detail = f"{len(used)} pairs of {problem.num_robots} robots (circles) and {problem.num_bins} bins (squares){remark}"
    return detail
