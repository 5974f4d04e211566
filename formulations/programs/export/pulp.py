"""A program as a PuLP model."""

from __future__ import annotations

import math
from typing import Any

from ..program import Program
from ._checks import merged_rows, refuse_cones, refuse_numbers, refuse_quadratic


def to_pulp(program: Program) -> Any:
    """A ``pulp.LpProblem``.

    Parameters
    ----------
    program : Program
        Linear.

    Returns
    -------
    pulp.LpProblem
        Column j is the variable named ``x`` and j, padded with zeros, so that PuLP's order of names is that of columns; row i is the
        constraint ``r`` and i. A row with two different sides becomes two constraints (the second is ``r`` and i and ``_low``), a
        row with none is left out.

    Raises
    ------
    UnsupportedError
        If the program is quadratic or has cones.
    InputError
        If the data hold a NaN or an infinite coefficient.

    Notes
    -----
    Integers are of PuLP's category ``Integer`` with their bounds: ``Binary`` would reset these to [0, 1].
    """
    import pulp

    refuse_cones(program, "PuLP")
    refuse_quadratic(program, "PuLP")
    refuse_numbers(program)
    model = pulp.LpProblem(program.name.replace("-", "_"), pulp.LpMaximize if program.sense == "max" else pulp.LpMinimize)
    digits = len(str(max(0, program.num_variables - 1)))
    columns = zip(program.lower.tolist(), program.upper.tolist(), program.integer.tolist(), strict=True)
    x = [
        model.add_variable(
            f"x{j:0{digits}d}", low if low > -math.inf else None, high if high < math.inf else None,
            cat=pulp.LpInteger if whole else pulp.LpContinuous,
        )
        for j, (low, high, whole) in enumerate(columns)
    ]  # fmt: skip
    model.setObjective(pulp.LpAffineExpression(zip(x, program.cost.tolist(), strict=True), constant=program.offset))
    indptr, indices, data = (part.tolist() for part in merged_rows(program))
    for i, (low, high) in enumerate(zip(program.row_lower.tolist(), program.row_upper.tolist(), strict=True)):
        entries = [(x[indices[k]], data[k]) for k in range(indptr[i], indptr[i + 1])]
        sides = [(pulp.LpConstraintEQ, low, "")] if low == high else [(pulp.LpConstraintLE, high, ""), (pulp.LpConstraintGE, low, "_low")]
        for sense, side, suffix in sides:
            if math.isfinite(side):
                last = "" if suffix and high == math.inf else suffix
                model.addConstraint(pulp.LpConstraint(pulp.LpAffineExpression(entries), sense, f"r{i}{last}", side))
    return model
