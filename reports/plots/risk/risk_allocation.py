"""Pictures of risk allocations: trajectories with their chance ellipses, risks under their budget, and how often constraints fail."""

import math
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....formulations.risk.allocations import Allocation, Floats
from ....formulations.risk.risk_allocation import RiskAllocation
from ....formulations.solution import Solution
from ....instances.errors import UsageError
from ....instances.risk.gaussian import Quantities
from .. import PLOTS
from ..drawing import ALARM, COLOURS, INK, LABELLED_BARS, QUIET, chart_axes, entitled, new_axes

VIEWS = ("trajectory", "risks", "violations")
SAMPLES = 20_000
LABELLED_COUNTS = 8
NAMES_IN_LINE = 60
"""Letters of all names of constraints that stand in a line below their bars."""

BAND = 1.959964
"""Deviations to either side that hold 95 % of a Gaussian number."""

ELLIPSE = math.sqrt(-2.0 * math.log(0.05))
"""Deviations of the ellipse that holds 95 % of a Gaussian point of the plane."""


def plot_risk_allocation(
    problem: RiskAllocation, answer: Any, *, ax: Any = None, solution: Solution | None = None, title: str | None = None,
    view: str | None = None,
) -> Any:  # fmt: skip
    """A decision and its risks on matplotlib axes (new ones by default), with ``solution``'s objective, bound and gap, or ``title``, above.

    ``view`` is ``trajectory`` (the default where the quantities are states of dynamics): the means, the spread of 95 %, and the limits;
    ``risks``: what each constraint is allowed, and what it has, as bars; or ``violations``: how many constraints fail at once, out of
    samples. Raises UsageError for a view that there is not.
    """
    allocation = problem.answer_of(answer)
    quantities = problem.instance.quantities
    view = view or ("trajectory" if quantities.dynamics is not None else "risks")
    if view not in VIEWS or (view == "trajectory" and quantities.dynamics is None):
        raise UsageError(
            f"a plot of risk allocation shows {', '.join(VIEWS[0 if quantities.dynamics is not None else 1 :])}, not {view!r}",
            "unknown-name",
        )
    ax = new_axes() if ax is None else ax
    draw = {"trajectory": _trajectory, "risks": _risks, "violations": _violations}[view]
    return entitled(ax, problem, allocation, solution, title, draw(ax, problem, allocation))


def _spread(quantities: Quantities, at: NDArray[np.int64]) -> Floats:
    return quantities.covariance[np.ix_(at, at)]


def _trajectory(ax: Any, problem: RiskAllocation, answer: Allocation) -> str:
    """The states named x and y as a map with ellipses, or those that have limits of their own, else the first, over time with bands."""
    quantities = problem.instance.quantities
    dynamics = quantities.dynamics
    assert dynamics is not None
    mean = (quantities.map @ answer.decision + quantities.offset).reshape(dynamics.steps, -1)
    states = len(dynamics.state_names)
    if {"x", "y"} <= set(dynamics.state_names):
        from matplotlib.patches import Ellipse

        x, y = dynamics.state_names.index("x"), dynamics.state_names.index("y")
        for t in range(dynamics.steps):
            centre = (float(mean[t, x]), float(mean[t, y]))
            values, vectors = np.linalg.eigh(_spread(quantities, np.array([t * states + x, t * states + y])))
            size = 2.0 * ELLIPSE * np.sqrt(np.maximum(values, 0.0))
            angle = math.degrees(math.atan2(vectors[1, 1], vectors[0, 1]))
            ax.add_patch(Ellipse(centre, size[1], size[0], angle=angle, facecolor=COLOURS[4], edgecolor="none", alpha=0.45, zorder=2))
        start = dynamics.start[[x, y]]
        ax.plot(*np.vstack([start, mean[:, [x, y]]]).T, color=COLOURS[0], linewidth=1.2, marker="o", markersize=3, zorder=3)
        _limits(ax, problem, {x: mean[:, y], y: mean[:, x]}, y, x)
        ax.set_xlabel("x", fontsize=9, color="#555555")
        ax.set_ylabel("y", fontsize=9, color="#555555")
        chart_axes(ax)
        return "means of the states, ellipses that hold 95 % each, and limits"
    step, alone = np.arange(1, dynamics.steps + 1), problem.instance.chance.rows.quantities
    limited = np.unique(np.nonzero(alone[np.count_nonzero(alone, axis=1) == 1])[1] % states).tolist() or [0]
    deviation = np.sqrt(np.diag(quantities.covariance)).reshape(mean.shape)
    for k, state in enumerate(limited):
        middle, band, line = mean[:, state], BAND * deviation[:, state], COLOURS[k % len(COLOURS)]
        shade = COLOURS[4] if len(limited) == 1 else line
        ax.fill_between(step, middle - band, middle + band, color=shade, alpha=0.45 / len(limited), linewidth=0, zorder=2)
        ax.plot(step, middle, color=line, linewidth=1.2, marker="o", markersize=3, zorder=3, label=dynamics.state_names[state])
        _limits(ax, problem, {state: step.astype(float)}, state, -1, ALARM if len(limited) == 1 else line)
    ax.xaxis.get_major_locator().set_params(integer=True)
    ax.set_xlabel("step", fontsize=9, color="#555555")
    if len(limited) > 1:
        ax.legend(fontsize=8, frameon=False)
    else:
        ax.set_ylabel(dynamics.state_names[limited[0]], fontsize=9, color="#555555")
    chart_axes(ax)
    return "mean, band that holds 95 %, and limits"


def _limits(ax: Any, problem: RiskAllocation, along: dict[int, Floats], upright: int, level: int, colour: str = ALARM) -> None:
    """Limits on one state: as dots where the limit of its step stands, or as boxes where they are alternatives."""
    dynamics, chance = problem.instance.quantities.dynamics, problem.instance.chance
    assert dynamics is not None
    states = len(dynamics.state_names)
    boxes: set[tuple[float, ...]] = set()
    sides: dict[int, dict[tuple[int, float], float]] = {}
    for row, limit, constraint in zip(chance.rows.quantities, chance.limits.tolist(), chance.constraint.tolist(), strict=True):
        at = np.nonzero(row)[0]
        if len(at) != 1:
            continue
        step, state = divmod(int(at[0]), states)
        sign = float(row[at[0]])
        sides.setdefault(constraint, {})[state, math.copysign(1.0, sign)] = limit / sign
        if state == upright and np.count_nonzero(chance.constraint == constraint) == 1:
            ax.plot(along[state][step], limit / sign, marker="_", color=colour, markersize=9, markeredgewidth=1.6, zorder=4)
    for side in sides.values():
        corners = tuple(side.get(key, math.nan) for key in ((level, 1.0), (level, -1.0), (upright, 1.0), (upright, -1.0)))
        if not any(map(math.isnan, corners)):
            boxes.add(corners)
    for left, right, low, high in sorted(boxes):
        ax.fill([left, right, right, left], [low, low, high, high], color=QUIET, zorder=1)


def _risks(ax: Any, problem: RiskAllocation, answer: Allocation) -> str:
    own = problem.risks(answer.decision)
    each, allocated = np.arange(len(own)), problem.risk.kind == "allocated"  # jointly no constraint has a risk of its own to keep
    if allocated:
        ax.bar(each, own if answer.risks is None else answer.risks, width=0.8, color=QUIET, zorder=2, label="allowed")
    ax.bar(each, own, width=0.5, color=COLOURS[0], zorder=3, label="at the decision")
    if allocated and problem.risk.total is not None:
        even = problem.risk.total / len(own)
        ax.axhline(even, color=ALARM, linewidth=1.0, linestyle="--", zorder=4, label="equal shares of the total")
    if len(own) <= LABELLED_BARS:
        crowded = sum(map(len, problem.names)) > NAMES_IN_LINE
        ax.set_xticks(each, problem.names, fontsize=7 if crowded else 8, rotation=90 if crowded else 0)
    else:
        ax.set_xticks([])
    ax.set_ylabel("risk", fontsize=9, color="#555555")
    chart_axes(ax)
    ax.legend(fontsize=8, frameon=False)
    budget = "" if problem.risk.total is None else f" of {problem.risk.total:g}"
    joint = next(iter(problem.joint_risk(answer.decision).values()))
    summed, fails = f"risks of the constraints, {own.sum():.4g}", f"any fails with probability {joint.value:.4g}"
    return f"{summed}{budget} together; {fails}" if allocated else f"{summed} in sum; {fails}{budget}"


def _violations(ax: Any, problem: RiskAllocation, answer: Allocation) -> str:
    values, vectors = np.linalg.eigh(problem.covariance)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    slack = problem.limits - problem.chance @ answer.decision
    beyond = np.random.default_rng(1).standard_normal((SAMPLES, len(slack))) @ root.T > slack
    rows = np.bincount(problem.constraint)
    failed = np.zeros((SAMPLES, len(rows)))
    np.add.at(failed.T, problem.constraint, beyond.T)
    counts = np.bincount((failed == rows).sum(axis=1)) / SAMPLES
    ax.bar(np.arange(len(counts)), counts, width=0.8, color=[QUIET, *[COLOURS[0]] * (len(counts) - 1)], zorder=2)
    for k, share in enumerate(counts.tolist() if len(counts) <= LABELLED_COUNTS else ()):
        ax.annotate(f"{share:.3g}", (k, share), ha="center", va="bottom", fontsize=8, color=INK)
    ax.set_yscale("log")
    ax.yaxis.set_major_formatter(lambda share, _: f"{share:g}")
    ax.xaxis.get_major_locator().set_params(integer=True)
    ax.set_xlabel("constraints that fail at once", fontsize=9, color="#555555")
    ax.set_ylabel(f"share of {SAMPLES:,} samples", fontsize=9, color="#555555")
    chart_axes(ax)
    return f"how many constraints fail at once: {counts[1:].sum():.4g} of {SAMPLES:,} samples with any"


PLOTS.add("risk-allocation", plot_risk_allocation)
for _view in VIEWS:
    PLOTS.add(f"risk-allocation:{_view}", partial(plot_risk_allocation, view=_view))
