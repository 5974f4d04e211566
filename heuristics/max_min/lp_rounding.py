"""LP rounding: the largest shares of the linear relaxation become whole."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...formulations.evidence import Evidence
from ...formulations.forms import FORMS
from ...formulations.problem import Problem
from ...formulations.programs.exactness import Exactness
from ...formulations.programs.program import INTEGERS
from ...formulations.programs.scaling import scaled
from ...formulations.selection.selections import Selection
from ...formulations.selection.submodular_selection import SubmodularSelection
from ...instances.errors import UnsupportedError, UsageError
from ...instances.selection.instance import Knapsack
from ..heuristic import HEURISTICS, Heuristic, Outcome, Setting
from ..selection.greedy_steps.limits import ANY_CONSTRAINT, FUNCTIONS, Limits, that_fit

ALIKE = 1e-9
"""Shares no further apart are equal: an LP solver's zeros are not exact."""


def lp_rounding(problem: Problem, setting: Setting, *, ties: str = "last") -> Outcome:
    """Solve the linear relaxation of the problem's first linear form, and take the elements of largest share.

    Parameters
    ----------
    problem : BottleneckSATA or SubmodularSelection
    setting : Setting
        Hands in the LP solver.
    ties : str
        Which of equal shares is taken: ``last`` or ``first``.

    Returns
    -------
    Outcome
        Robots: each takes its action of largest share. Cardinality limit and partition matroid: the largest shares that there is room
        for. Knapsack: in order of share, what still fits. The LP's bound is the evidence. No guarantee: none is true for a bottleneck,
        whose rounded value can be 0 beside an LP value of 1.2.

    Raises
    ------
    UsageError
        If ``ties`` is neither.

    Notes
    -----
    Source: Sung (2019), 3.4.1; where it fails: docs/formulations/bottleneck.md#whole-actions-from-shares.
    """
    if ties not in ("last", "first"):
        raise UsageError(f"ties must be last or first, not {ties!r}")
    stop = setting.begin()
    linear = [f for f in problem.forms() if FORMS[f].exactness is Exactness.EXACT and FORMS[f].makes(problem) <= INTEGERS]
    if not linear:
        raise UnsupportedError("lp-rounding", {"a linear form of the problem"})
    made = problem.compile(linear[0], relax=True)
    program = made.program
    units = scaled(program, always=True)  # the same optimum in any unit, where there are several
    result = setting.linear.solve(units.program, stop)
    statistics: dict[str, Any] = {"form": made.form, "lp_status": result.status}
    if result.answer is None or result.status != "optimal":
        message = f"the LP was not solved in time: {result.message or result.status}"
        return Outcome(None, statistics=statistics, message=message, limit=stop.reached() or "none")
    n = program.variables[0].size  # every form's first block has one variable an element, named x
    point = units.vector(np.asarray(result.answer, dtype=np.float64))
    shares = point[:n]
    statistics["lp_value"] = program.value(point)
    answer = Selection(tuple(_rounded(problem, shares, ties)))
    setting.publish(answer)  # which outlives a fault in its evidence
    evidence: tuple[Evidence, ...] = ()
    if result.row_duals is not None and made.dual_evidence is not None:
        evidence = (made.dual_evidence(units.duals(result.row_duals)),)
    return Outcome(answer, evidence=evidence, statistics=statistics)


def _rounded(problem: Any, shares: NDArray[np.float64], ties: str) -> list[int]:
    n = len(shares)
    index = np.arange(n) if ties == "first" else np.arange(n)[::-1]
    order = np.lexsort((index, -_levelled(shares)))
    if isinstance(problem, SubmodularSelection) and isinstance(problem.constraint, Knapsack):
        return that_fit(order.tolist(), problem.constraint)
    return [int(e) for e in Limits.of(problem).first(order)]


def _levelled(shares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shares in which a run of neighbours no further than ``ALIKE`` apart is one level."""
    order = np.argsort(shares, kind="stable")
    step = np.diff(shares[order], prepend=shares[order][:1])
    level = np.empty(len(shares))
    level[order] = np.cumsum(step > ALIKE)
    return level


def _refuses(problem: Any) -> frozenset[str]:
    return frozenset({f"{problem.problem} problems"}) if problem.family == "max-min" and problem.problem != "bottleneck" else frozenset()


HEURISTICS.add(
    "lp-rounding",
    Heuristic(
        name="lp-rounding",
        families=("selection", "max-min"),
        features=FUNCTIONS | ANY_CONSTRAINT | {"sensing", "whole-actions"},
        run=lp_rounding,
        summary="the largest shares of the linear relaxation, whose bound comes with the answer",
        stated="no guarantee (none is true for a bottleneck)",
        refuses=_refuses,
    ),
)
