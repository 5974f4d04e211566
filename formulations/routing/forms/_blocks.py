"""Programs that are written block after block, and what all forms of routing write alike."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ....instances.errors import InputError
from ...programs.compiled import Compiled
from ...programs.program import Floats, FurtherLevel, Program, Rows, Variables
from ...programs.reductions.units import scaled
from ...programs.rows import Ints, Part, rows
from ..objective import Objective

if TYPE_CHECKING:
    from ..problem import RoutingProblem


class Blocks:
    """Columns and rows of a program, block after block."""

    def __init__(self, problem: RoutingProblem) -> None:
        self.problem = problem
        self.variables: list[Variables] = []
        self.rows: list[Rows] = []
        self.columns = 0

    def add_columns(
        self, name: str, keys: tuple[Ints, ...], labels: tuple[Any, ...], lower: Any, upper: Any, cost: Any = 0.0, integer: bool = False
    ) -> int:
        """Write a block of columns; returns the first of them."""
        size, first = len(keys[0]) if keys else 1, self.columns
        spread = [np.array(np.broadcast_to(np.asarray(v, dtype=np.float64), size)) for v in (lower, upper, cost)]
        self.variables.append(Variables(name, keys, labels, lower=spread[0], upper=spread[1], cost=spread[2], integer=integer))
        self.columns += size
        return first

    def add_groups(self, parts: Iterable[Part]) -> None:
        """At most one site of each group is visited, and exactly one where it is required; ``parts`` are the visits by group."""
        least = np.array([float(g.required) for g in self.problem.sites.groups])
        self.rows.append(rows("group", len(least), list(parts), least, 1.0, (np.arange(1, len(least) + 1),), (None,)))


def point_of(program: Program, x: Floats) -> Floats:
    """``x``, if it keeps all rows; else raises InputError."""
    excess = scaled(program).residual(x)
    if excess > 1e-5:
        raise InputError("the answer is no point of the program", found=f"a row exceeded by {excess:g}")
    return x


def with_levels(problem: RoutingProblem, build: Callable[[RoutingProblem], Compiled]) -> Compiled:
    """The program that ``build`` makes of the first level of the objective, with the costs that it makes of the others.

    All levels are written over the same variables and rows: a term that any level holds has its own.
    """
    compiled, levels = build(problem), problem.objective.levels()
    further = []
    for at in range(1, len(levels)):
        first = (levels[at], *levels[:at], *levels[at + 1 :])
        program = build(replace(problem, objective=Objective(first))).program
        further.append(FurtherLevel(program.sense, program.cost, program.offset))
    return replace(compiled, program=replace(compiled.program, further=tuple(further))) if further else compiled
