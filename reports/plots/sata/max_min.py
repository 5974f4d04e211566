"""Pictures of max-min answers: actions of robots, shares, and values of programs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.sata.bottleneck_sata import BottleneckSATA
from ....formulations.sata.max_min_lp import MaxMinLP
from .. import PLOTS
from ..drawing import ALARM, COLOURS, bars, entitled, new_axes
from .sensing import draw_graph, target_names

if TYPE_CHECKING:
    from ....formulations.solution import Solution


def plot_max_min(
    problem: BottleneckSATA | MaxMinLP, answer: Any, *, ax: Any = None, solution: Solution | None = None, title: str | None = None
) -> Any:
    """A bottleneck answer as a map, a bipartite graph or a chart of the targets' coverage; a max-min program as a chart of its rows.

    Parameters
    ----------
    problem : BottleneckSATA or MaxMinLP
    answer : Selection, or array of shares or values
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
    ax = new_axes() if ax is None else ax
    if isinstance(problem, MaxMinLP):
        x = np.asarray(answer, dtype=np.float64)
        matrix, what = (problem.covering, "covering row") if problem.sense == "max" else (problem.packing, "packing row")
        values = np.asarray(matrix.scipy @ x, dtype=np.float64)
        worst = float(values.min() if problem.sense == "max" else values.max())
        bars(ax, values, [str(k + 1) for k in range(matrix.rows)], what, worst=worst, ascending=True, bound=_bound(solution))
        return entitled(ax, problem, answer, solution, title, f"value of each {what}")
    graph = problem.graph
    shares = np.zeros(graph.num_actions)
    if problem.fractional:
        shares[:] = answer
    else:
        shares[list(answer.elements)] = 1.0
    covered = problem.coverage(shares)
    drawn = draw_graph(ax, graph, shares, covered, None)
    if not drawn:
        worst = float(covered.min(initial=np.inf))
        names = target_names(graph)
        bars(ax, covered, names, "target", worst=worst, ascending=True, bound=_bound(solution), colours=_shades(covered, worst))
    return entitled(ax, problem, answer, solution, title, drawn or "coverage of each target, the worst covered in red")


def _shades(covered: NDArray[np.float64], worst: float) -> list[str]:
    """Colours of targets: the worst covered stand out."""
    return [ALARM if value <= worst * (1.0 + 1e-9) else COLOURS[0] for value in covered.tolist()]


def _bound(solution: Solution | None) -> tuple[float, str] | None:
    """What no answer can lift the worst beyond, and on whose word."""
    return (solution.bound, str(solution.bound_kind)) if solution is not None and isinstance(solution.bound, float) else None


PLOTS.add("max-min", plot_max_min)
