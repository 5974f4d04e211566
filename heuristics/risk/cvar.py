"""Conditional value at risk over samples: a convex restriction of the joint risk that counts how far constraints fail, too."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...formulations.programs.program import Program, Variables
from ...formulations.programs.rows import rows
from ...formulations.risk.allocations import Allocation, Floats
from ...formulations.risk.forms._blocks import Blocks, dense_rows
from ...formulations.risk.risk_allocation import RiskAllocation
from ...instances.errors import UsageError
from ...solvers.engines.risk.convex_allocation_steps.session import open_session
from ...solvers.engines.risk.convex_allocation_steps.units import Units
from ..heuristic import Context, Outcome, heuristic
from .scenario import only_total, root

MOST_ENTRIES = 5_000_000
TRIES = 6
"""Times that the level is halved at most until the plan is allowed."""


@heuristic(
    "cvar", "risk-allocation", {"joint-risk", "quadratic-cost", "cones"},
    "the best plan by conditional value at risk over samples, validated by its true risk", refuses=only_total,
)  # fmt: skip
def cvar(problem: RiskAllocation, context: Context, *, samples: int = 1000) -> Outcome:
    """The best plan whose worst constraint, in deviations beyond its limit, has a conditional value at risk of 0 or less over samples.

    The mean of the worst share of samples, the total's, bounds their quantile, so that on the samples the risk is kept. They are finitely
    many: the plan is validated by its true probability to fail, and the share halved until that is allowed. ``samples`` are at least 10,
    and a mean over the worst share needs ``samples * total`` of 10 or so; else, and beyond what the program can hold, UsageError is raised.
    ``statistics`` hold ``samples``, ``level`` (of the last share) and ``joint_risk_high``, the upper limit of the plan's probability to
    fail, with the confidence of ``joint_normal.CONFIDENCE``.

    Source: Rockafellar and Uryasev (2000), "Optimization of conditional value-at-risk"; Nemirovski and Shapiro (2006), "Convex
    approximations of chance constrained programs"; docs/formulations/risk-allocation.md#samples.
    """
    noisy = np.nonzero(problem.deviation > 0.0)[0]
    if samples < 10 or 3 * samples * max(1, len(noisy)) > MOST_ENTRIES:
        raise UsageError(
            f"cvar: samples must lie between 10 and {MOST_ENTRIES // (3 * max(1, len(noisy)))} here, not {samples}", "out-of-range"
        )
    assert problem.risk.total is not None
    stop, units = context.begin(), Units.of(problem)
    drawn = (context.rng.standard_normal((samples, len(problem.limits))) @ root(problem.covariance).T)[:, noisy] / problem.deviation[noisy]
    level = problem.risk.total
    statistics: dict[str, Any] = {"samples": samples}
    for _ in range(TRIES):
        solved = open_session(_program(units.problem, drawn, noisy, level), context.linear.seed).solve(stop)
        statistics["level"] = level
        if solved.status != "optimal":
            message = f"the program of {samples} samples is {solved.status}"
            return Outcome(None, statistics=statistics, message=message, limit=stop.reached() or "none")
        decision = np.clip(solved.x[: problem.size] * units.columns, problem.lower, problem.upper)
        high = next(iter(problem.joint_risk(decision).values())).high
        statistics["joint_risk_high"] = high
        if high <= problem.risk.total:
            return Outcome(Allocation(decision), statistics=statistics)
        level /= 2.0
    return Outcome(None, statistics=statistics, message=f"{samples} samples are too few for this risk")


def _program(problem: RiskAllocation, drawn: Floats, noisy: NDArray[np.int64], level: float) -> Program:
    """``h_i = (a_i x - b_i) / s_i``, ``y_k >= h_i + w_ki - t``, ``t + sum of y / (level samples) <= 0``, y >= 0.

    Where the share is less than a sample, its mean is that of the worst one, which any coefficient from 1 on says.
    """
    blocks, (samples, many) = Blocks(problem), drawn.shape
    exact = np.nonzero(problem.deviation == 0.0)[0]
    if len(exact):
        blocks.rows.append(dense_rows("certain", problem.chance[exact], -math.inf, problem.limits[exact]))
    free = np.full(many, math.inf)
    beyond = blocks.add(Variables("beyond", (np.arange(many),), (), -free, free, np.zeros(many)))
    at = blocks.add(Variables("level", (), (), np.full(1, -math.inf), np.full(1, math.inf), np.zeros(1)))
    over = blocks.add(Variables("over", (np.arange(samples),), (), np.zeros(samples), np.full(samples, math.inf), np.zeros(samples)))
    scale, each = problem.deviation[noisy], np.arange(many)
    sides = problem.limits[noisy] / scale
    defined = [(each, beyond + each, -1.0)]
    blocks.rows.append(dense_rows("defined", problem.chance[noisy] / scale[:, None], sides, sides, defined))
    row = np.arange(samples * many)
    k, i = np.divmod(row, many)
    blocks.rows.append(rows("sample", len(row), [(row, over + k, 1.0), (row, at + 0 * row, 1.0), (row, beyond + i, -1.0)], drawn.ravel()))
    zero, every = np.zeros(1, dtype=np.int64), np.arange(samples)
    blocks.rows.append(rows("risk", 1, [(zero, zero + at, 1.0), (0 * every, over + every, 1.0 / max(1.0, level * samples))], upper=0.0))
    return blocks.program("cvar")
