"""Forms of a problem that is given as arrays: the arrays themselves, and ``linear-products`` with a variable for each product.

    min/max  c x + x' Q x / 2 + offset,   L <= A x <= U,   l <= x <= u,   some x integer

Without a quadratic part, cones and circuits, row duals y of its linear relaxation are evidence ``lp-dual``: every x has the value of at
least sum_i min over r in [L_i, U_i] of y_i r  +  sum_j min over x_j in [l_j, u_j] of (c - A' y)_j x_j  (minimisation).

``linear-products`` is for programs with integers and a quadratic objective; ``programs.reductions.linear_products`` has its rows, which
are exact where one factor is binary. Their duals say how the checker of ``quadratic-duals`` is to mix the planes below each product: it
draws these up itself, from the bounds of the program. See docs/formulations/arrays.md.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np

from ....instances.errors import InputError
from ...evidence import Evidence
from ...forms import FORMS, Form
from ...problem import Decision, Problem
from ...programs.compiled import Compiled
from ...programs.duals import dual_value
from ...programs.exactness import Link
from ...programs.program import INTEGERS, QUADRATIC, Floats
from ...programs.reductions.linear_products import LINEAR_PRODUCTS, Linearised
from ...programs.reductions.reduction import Irreducible
from ...programs.size import ProgramSize
from ..problem import ArrayProblem


def build(problem: ArrayProblem) -> Compiled:
    """The problem's own program, with answers that are vectors; see the module's text."""
    program = problem.program

    def encode(answer: Floats) -> Floats:
        x = np.asarray(answer, dtype=np.float64)
        if x.shape != (program.num_variables,):
            expected = f"({program.num_variables},)"
            raise InputError("the start is no vector with one number a variable", "wrong-shape", expected=expected, found=str(x.shape))
        return x

    def dual_evidence(row_duals: Floats, of: Problem = problem) -> Evidence:
        program = of.program  # type: ignore[attr-defined]
        # Solvers disagree on the sign of a maximisation's duals (HiGHS' interior point without crossover reverses it).
        sign = 1.0 if program.sense == "min" else -1.0
        duals = max((np.asarray(row_duals, dtype=np.float64) * s for s in (1.0, -1.0)), key=lambda y: sign * dual_value(program, y))
        return Evidence("lp-dual", "LP relaxation of the program", dual_value(program, duals), {"duals": [float(y) for y in duals]})

    def ray_evidence(ray: Floats) -> Evidence:
        none = math.inf if program.sense == "min" else -math.inf
        return Evidence("lp-dual", "a ray of the program's rows", none, {"ray": [float(y) for y in ray]})

    def at_most(column: int, most: int) -> Decision:
        return {"variable": column, "most": most}, True

    linear = program.quadratic is None and not program.cones and not program.circuits
    compiled = Compiled(replace(program, name="arrays"), problem, lambda x: x, encode, ray_evidence=ray_evidence, at_most=at_most)
    return replace(compiled, dual_evidence=dual_evidence) if linear else compiled


def size(problem: ArrayProblem) -> ProgramSize:
    """Size of the joined arrays and of a solver's copy; the program itself is there already."""
    program = problem.program
    return ProgramSize(program.num_variables, program.num_rows, float(len(program.data)) + sum(len(c.data) for c in program.cones))


def build_products(problem: ArrayProblem) -> Compiled:
    """The MIQP as a MILP: each product of a binary and another variable becomes a variable with two rows; see the module's text."""
    (step,) = LINEAR_PRODUCTS.apply(problem.program)
    assert isinstance(step, Linearised)
    own, count, n = build(problem), len(step.pairs), step.columns
    weight = np.abs(step.program.cost[n:])
    order = np.lexsort((step.pairs.max(axis=1), step.pairs.min(axis=1)))
    # The planes change places where an upper limit is mixed and the binary factor is the second.
    upper = (step.program.cost[n:] > 0) == (step.program.sense == "max")
    turned = upper & (step.pairs[:, 0] > step.pairs[:, 1])

    def dual_evidence(row_duals: Floats, of: Problem = problem) -> Evidence:
        duals = np.asarray(row_duals, dtype=np.float64)
        second = np.clip(np.abs(duals[step.rows + count :]) / weight, 0.0, 1.0)
        shares = np.where(turned, second, 1.0 - second)[order]
        data: dict[str, Any] = {"duals": duals[: step.rows].tolist(), "shares": shares.tolist()}
        program = step.program.with_bounds(
            np.concatenate([of.program.lower, step.program.lower[n:]]),  # type: ignore[attr-defined]
            np.concatenate([of.program.upper, step.program.upper[n:]]),  # type: ignore[attr-defined]
        )
        return Evidence("quadratic-duals", "LP relaxation of linear-products", dual_value(program, duals), data)

    def ray_evidence(ray: Floats) -> Evidence:
        assert own.ray_evidence is not None
        return own.ray_evidence(ray[: step.rows])

    assert own.encode is not None
    encode = own.encode
    return Compiled(
        replace(step.program, name="linear-products"), problem, step.vector, lambda answer: step.encoded(encode(answer)), dual_evidence,
        links=(Link("linear-products", step.exactness, step.told),), ray_evidence=ray_evidence, at_most=own.at_most,
    )  # fmt: skip


def _refuses(problem: ArrayProblem) -> frozenset[str]:
    if problem.program.features() != INTEGERS | QUADRATIC:
        return frozenset({"programs other than MIQP"})
    try:
        LINEAR_PRODUCTS.apply(problem.program)
    except Irreducible as fault:
        return frozenset({str(fault)})
    return frozenset()


def _size(problem: ArrayProblem) -> ProgramSize:
    """Size with a column and at most two rows a product."""
    quadratic = problem.program.quadratic
    products = 0.0 if quadratic is None else float(quadratic.nnz) / 2.0 + 1.0
    return size(problem) + ProgramSize(products, 2.0 * products, 5.0 * products)


FEATURES = frozenset({"LP", "integer", "quadratic", "cones", "circuits"})

FORMS.enter(Form("arrays", "arrays", FEATURES, build, makes=lambda problem: problem.program.features(), size=size))
FORMS.enter(
    Form("linear-products", "arrays", frozenset({"LP", "integer", "quadratic"}), build_products, refuses=_refuses, order=1, size=_size),
)
