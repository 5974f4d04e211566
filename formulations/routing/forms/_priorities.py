"""Objectives in order of priority: the levels after the first one, as further objectives of the program.

All levels are written over the same variables and rows (a term that any level holds has its own), so that the program of each differs
in its costs alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from ...programs.compiled import Compiled
from ...programs.program import FurtherLevel
from ..objective import Objective

if TYPE_CHECKING:
    from ..problem import RoutingProblem


def with_levels(problem: RoutingProblem, build: Callable[[RoutingProblem], Compiled]) -> Compiled:
    """What ``build`` makes of the first level of the objective, and the costs that it makes of the others."""
    made, levels = build(problem), problem.objective.levels()
    further = []
    for at in range(1, len(levels)):
        first = (levels[at], *levels[:at], *levels[at + 1 :])
        program = build(replace(problem, objective=Objective(first))).program
        further.append(FurtherLevel(program.sense, program.cost, program.offset))
    return replace(made, program=replace(made.program, further=tuple(further))) if further else made
