"""The form of a problem that is given as arrays: the arrays themselves.

    min/max  c x + x' Q x / 2 + offset,   L <= A x <= U,   l <= x <= u,   some x integer

Without a quadratic part, cones and circuits, row duals y of its linear relaxation are evidence ``lp-dual``: every x has the value of at
least sum_i min over r in [L_i, U_i] of y_i r  +  sum_j min over x_j in [l_j, u_j] of (c - A' y)_j x_j  (minimisation).
See docs/formulations/arrays.md.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ....instances.errors import InputError
from ...evidence import Evidence
from ...forms import FORMS, Form
from ...problem import Decision, Problem
from ...programs.compiled import Compiled
from ...programs.duals import dual_value
from ...programs.program import Floats
from ...programs.size import ProgramSize
from ..problem import ArrayProblem


def build(problem: ArrayProblem) -> Compiled:
    """The problem's own program, with answers that are vectors; see the module's text."""
    given = problem.program

    def encode(answer: Floats) -> Floats:
        x = np.asarray(answer, dtype=np.float64)
        if x.shape != (given.num_variables,):
            raise InputError("the start is no vector with one number a variable", expected=f"({given.num_variables},)", found=str(x.shape))
        return x

    def dual_evidence(row_duals: Floats, of: Problem = problem) -> Evidence:
        program = of.program  # type: ignore[attr-defined]
        # Solvers disagree on the sign of a maximisation's duals (HiGHS' interior point without crossover reverses it).
        sign = 1.0 if given.sense == "min" else -1.0
        duals = max((np.asarray(row_duals, dtype=np.float64) * s for s in (1.0, -1.0)), key=lambda y: sign * dual_value(program, y))
        return Evidence("lp-dual", "LP relaxation of the program", dual_value(program, duals), {"duals": [float(y) for y in duals]})

    def ray_evidence(ray: Floats) -> Evidence:
        none = math.inf if given.sense == "min" else -math.inf
        return Evidence("lp-dual", "a ray of the program's rows", none, {"ray": [float(y) for y in ray]})

    def at_most(column: int, most: int) -> Decision:
        return {"variable": column, "most": most}, True

    linear = given.quadratic is None and not given.cones and not given.circuits
    made = Compiled(replace(given, name="arrays"), problem, lambda x: x, encode, ray_evidence=ray_evidence, at_most=at_most)
    return replace(made, dual_evidence=dual_evidence) if linear else made


def size(problem: ArrayProblem) -> ProgramSize:
    """The program is there: what is joined of it and a solver's copy come to it."""
    given = problem.program
    return ProgramSize(given.num_variables, given.num_rows, float(len(given.data)) + sum(len(c.data) for c in given.cones))


FORMS.add(
    "arrays",
    Form(
        "arrays",
        "arrays",
        frozenset({"LP", "integer", "quadratic", "cones", "circuits"}),
        build,
        makes=lambda problem: problem.program.features(),
        size=size,
    ),
)
