"""Programs in which every chance constraint has a margin of its own, known beforehand."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...programs.compiled import Compiled
from ...programs.program import INTEGERS, LINEAR, QUADRATIC, Program, Variables
from ...programs.rows import rows
from ..allocations import Allocation
from ..risk_allocation import RiskAllocation
from ._blocks import Blocks, dense_rows

Floats = NDArray[np.float64]

FEATURES = frozenset({"allocated-risk", "joint-risk", "alternatives", "quadratic-cost", "cones"})


ROUNDED = 2e-8
"""Part of a limit that restrictions leave to rounding: beside small deviations it is enough to change a risk by a lot."""


def makes(problem: RiskAllocation) -> frozenset[str]:
    """What the programs of a problem need: cones and quadratic costs where it has them, integers for alternatives."""
    has = problem.features()
    cones = frozenset({"second-order-cones"}) if "cones" in has else LINEAR
    return cones | (QUADRATIC if "quadratic-cost" in has else LINEAR) | (INTEGERS if problem.disjunctive else LINEAR)


def refuses(problem: RiskAllocation) -> frozenset[str]:
    """Alternatives need bounds of all decisions."""
    endless = problem.disjunctive and not np.isfinite([problem.lower, problem.upper]).all()
    return frozenset({"alternatives of decisions without bounds"}) if endless else frozenset()


def largest(problem: RiskAllocation) -> Floats:
    """Of each chance row the largest value of its mean within the bounds of the decisions."""
    up = np.where(problem.chance > 0, problem.upper, problem.lower)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(problem.chance == 0, 0.0, problem.chance * up).sum(axis=1))


def add_choices(blocks: Blocks) -> int:
    """A binary for each row, 1 where it is the one of its constraint that holds; the column of the first."""
    p = blocks.problem
    size = len(p.constraint)
    alone = np.bincount(p.constraint)[p.constraint] == 1
    choice = Variables(
        "choice", (p.constraint, np.arange(size)), (p.names,), alone.astype(float), np.ones(size), np.zeros(size), integer=True
    )
    start = blocks.add(choice)
    blocks.rows.append(rows("choose", len(p.names), [(p.constraint, start + np.arange(size), 1.0)], 1.0, keys=(np.arange(len(p.names)),),
                            labels=(p.names,)))  # fmt: skip
    return start


def margins(problem: RiskAllocation, quantile: Floats) -> Floats:
    """``s_i z_i`` of each chance row, from the quantile of each constraint."""
    with np.errstate(invalid="ignore"):
        return np.asarray(np.where(problem.deviation == 0.0, 0.0, problem.deviation * quantile[problem.constraint]))


def spared(problem: RiskAllocation) -> Floats:
    """What a restriction takes from each limit, so that a solver's rounding breaks no chance constraint."""
    return np.asarray(np.where(problem.deviation > 0.0, ROUNDED * np.abs(problem.limits), 0.0))


def fixed_margins_program(problem: RiskAllocation, name: str, margin: Floats) -> Program:
    """``a_i x + margin_i <= b_i``, one margin a chance row; rows that are alternatives by binaries and large numbers."""
    blocks = Blocks(problem)
    limits, extra = problem.limits - margin, []
    if problem.disjunctive:
        choice, each = add_choices(blocks), np.arange(len(limits))
        slack = np.maximum(largest(problem) - limits, 0.0)
        slack[np.bincount(problem.constraint)[problem.constraint] == 1] = 0.0
        extra, limits = [(each, choice + each, slack)], limits + slack
    keys = (problem.constraint,) if not problem.disjunctive else (problem.constraint, np.arange(len(limits)))
    blocks.rows.append(dense_rows("chance", problem.chance, -math.inf, limits, extra, keys, (problem.names,)))
    return blocks.program(name)


def compiled(problem: RiskAllocation, name: str, quantile: Floats, risks: Floats) -> Compiled:
    """The program, a restriction, with the way back: its decisions, each with the given risks."""
    program, n = fixed_margins_program(problem, name, margins(problem, quantile) + spared(problem)), len(problem.lower)

    def decode(vector: Floats) -> Allocation:
        return Allocation(np.array(vector[:n]), risks if problem.risk.kind == "allocated" else None)

    return Compiled(program, problem, decode)
