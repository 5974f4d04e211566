"""LP rounding: the largest shares of the linear relaxation become whole."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...formulations.evidence import Evidence
from ...formulations.forms import FORMS
from ...formulations.programs.exactness import Exactness
from ...formulations.programs.program import INTEGERS
from ...formulations.programs.reductions.units import scaled
from ...formulations.sata.bottleneck_sata import BottleneckSATA
from ...formulations.sata.selections import Selection
from ...formulations.sata.submodular_selection import SubmodularSelection
from ...instances.errors import UnsupportedError
from ..heuristic import HEURISTICS, Context, Heuristic, Outcome
from .greedy_steps.limits import FORMULATED, FUNCTIONS, first_allowed, not_whole
from .rounding import by_share, check_ties


def lp_rounding(problem: SubmodularSelection | BottleneckSATA, context: Context, *, ties: str = "last") -> Outcome:
    """Solve the linear relaxation of the problem's first linear form, and take the elements of largest share, of equal ones by ``ties``.

    Robots: each takes its action of largest share. Cardinality limit and partition matroid: the largest shares that there is room for.
    Others: in order of share, what is still allowed. The LP's bound is the evidence. No guarantee: none is true for a bottleneck, whose
    rounded value can be 0 beside an LP value of 1.2.

    Source: Sung (2019), 3.4.1; where it fails: docs/formulations/bottleneck.md#whole-actions-from-shares.
    """
    check_ties(ties)
    stop = context.begin()
    linear = [f for f in problem.forms() if FORMS[f].exactness is Exactness.EXACT and FORMS[f].makes(problem) <= INTEGERS]
    if not linear:
        raise UnsupportedError("lp-rounding", {"a linear form of the problem"})
    compiled = problem.compile(linear[0], relax=True)
    program = compiled.program
    units = scaled(program)
    result = context.linear.solve(units.program, stop)
    statistics: dict[str, Any] = {"form": compiled.form, "lp_status": result.status}
    if result.answer is None or result.status != "optimal":
        message = f"the LP was not solved in time: {result.message or result.status}"
        return Outcome(None, statistics=statistics, message=message, limit=stop.reached() or "none")
    n = program.variables[0].size  # every form's first block has one variable an element, named x
    point = units.vector(np.asarray(result.answer, dtype=np.float64))
    shares = point[:n]
    statistics["lp_value"] = program.value(point)
    answer = Selection(tuple(first_allowed(problem, by_share(shares, ties, context.rng))))
    context.publish(answer)  # which outlives a fault in its evidence
    evidence: tuple[Evidence, ...] = ()
    if result.row_duals is not None and compiled.dual_evidence is not None:
        evidence = (compiled.dual_evidence(units.duals(result.row_duals)),)
    return Outcome(answer, evidence=evidence, statistics=statistics)


HEURISTICS.add(
    "lp-rounding",
    Heuristic(
        name="lp-rounding",
        families=("selection", "max-min"),
        features=FUNCTIONS | FORMULATED | {"sensing", "whole-actions"},
        run=lp_rounding,
        summary="the largest shares of the linear relaxation, whose bound comes with the answer",
        stated="no guarantee (none is true for a bottleneck)",
        refuses=not_whole,
    ),
)
