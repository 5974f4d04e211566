"""Bound ``deviation-chord``: a problem with risks as one of certain durations, and the best evidence that others find for that."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ....formulations.certificate import better_bound, verified_bound
from ....formulations.evidence import Evidence
from ....formulations.routing.checking.deviation_chord import KIND, lacks_chord, without_risks
from ....formulations.stop import NEVER, Stop
from ...linear_programs import LinearPrograms
from .. import BOUNDS, BoundMethod, replaced

if TYPE_CHECKING:
    from ....formulations.problem import Problem
    from ....formulations.routing.problem import RoutingProblem

PART = 0.2
"""Of the time that is left for each method but the last one, column generation where it applies."""

BEFORE = 9
"""Methods of lower order are asked; those after them would ask these again."""


def deviation_chord_bound(
    problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None
) -> Evidence | None:
    """The best evidence that other methods find on the problem without risks.

    Parameters
    ----------
    problem : RoutingProblem
    stop : Stop
    linear : LinearPrograms, optional
    target : float, optional
        Value of a known answer.
    """
    made, others = without_risks(problem), replaced(problem)
    if made is None:
        return None
    bound = nothing = -math.inf if problem.sense == "min" else math.inf
    best: Evidence | None = None
    methods = [m for m in BOUNDS.values() if m.order < BEFORE and m.name not in others and not m.missing(made)]
    for method in sorted(methods, key=lambda m: m.order):
        if stop.reached():
            break
        within = stop if method.order == BEFORE - 1 else stop.within(PART * stop.seconds_left)
        found = method.evidence(made, within, linear or LinearPrograms(), target)
        proved = nothing if found is None else verified_bound(made, found)
        if found is None or proved == nothing or math.isnan(proved) or not better_bound(problem.sense, proved, bound):
            continue
        bound = proved
        best = Evidence(KIND, f"{found.source}, with the chord of the deviation", proved, {"kind": found.kind, "data": found.data})
        if math.isinf(proved):  # there is no answer
            break
    return best


def _prepare() -> None:
    for method in BOUNDS.values():
        if method.name in ("spanning-tree", "state-space", "column-generation"):
            method.prepare()


def _missing(problem: Problem) -> frozenset[str]:
    if problem.family != "routing":
        return frozenset({f"{problem.family} problems"})
    return lacks_chord(problem)  # type: ignore[arg-type]


BOUNDS.add(KIND, BoundMethod(KIND, _missing, deviation_chord_bound, order=BEFORE, aims=True, prepare=_prepare))
