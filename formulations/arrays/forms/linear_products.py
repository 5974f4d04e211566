"""The form ``linear-products`` of a program with integers and a quadratic objective: each product a variable of its own.

See ``programs.reductions.linear_products`` for the rows, which are exact where one factor is binary. Their duals say how the checker of
``quadratic-duals`` is to mix the planes below each product: it draws these up itself, from the bounds of the program.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ...evidence import Evidence
from ...forms import FORMS, Form
from ...problem import Problem
from ...programs.compiled import Compiled
from ...programs.duals import dual_value
from ...programs.exactness import Link
from ...programs.program import INTEGERS, QUADRATIC, Floats
from ...programs.reductions.linear_products import LINEAR_PRODUCTS, Linearised
from ...programs.reductions.reduction import Irreducible
from ...programs.size import ProgramSize
from ..problem import ArrayProblem
from . import arrays


def build(problem: ArrayProblem) -> Compiled:
    """The program with linear rows for its products; see the module's text."""
    (step,) = LINEAR_PRODUCTS.apply(problem.program)
    assert isinstance(step, Linearised)
    own, count, n = arrays.build(problem), len(step.pairs), step.columns
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
    """A column and at most two rows a product."""
    quadratic = problem.program.quadratic
    products = 0.0 if quadratic is None else float(quadratic.nnz) / 2.0 + 1.0
    return arrays.size(problem) + ProgramSize(products, 2.0 * products, 5.0 * products)


FORMS.add(
    "linear-products",
    Form("linear-products", "arrays", frozenset({"LP", "integer", "quadratic"}), build, refuses=_refuses, order=1, size=_size),
)
