"""A program as a PuLP model."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from ..names import column_names, row_names
from ..reductions.one_sided_rows import ONE_SIDED_ROWS
from ._checks import check_export, merged_rows

if TYPE_CHECKING:
    from ..program import Program


def to_pulp(program: Program, *, names: bool = False) -> Any:
    """A ``pulp.LpProblem``; with ``names`` its variables and constraints are named as in files.

    Without names column j is the variable named ``x`` and j, padded with zeros, so that PuLP's order of names is that of columns, and row
    i the constraint ``r`` and i. A row with two different sides becomes two constraints (the name of the second ends with ``_low``), a row
    with none is left out. Integers are of PuLP's category ``Integer`` with their bounds: ``Binary`` would reset these to [0, 1].
    """
    import pulp

    check_export(program, "PuLP", quadratic=False)
    model = pulp.LpProblem(program.name.replace("-", "_"), pulp.LpMaximize if program.sense == "max" else pulp.LpMinimize)
    digits = len(str(max(0, program.num_variables - 1)))
    columns = zip(program.lower.tolist(), program.upper.tolist(), program.integer.tolist(), strict=True)
    called = column_names(program) if names else [f"x{j:0{digits}d}" for j in range(program.num_variables)]
    rows = row_names(program) if names else [f"r{i}" for i in range(program.num_rows)]
    x = [
        model.add_variable(
            called[j], low if low > -math.inf else None, high if high < math.inf else None,
            cat=pulp.LpInteger if whole else pulp.LpContinuous,
        )
        for j, (low, high, whole) in enumerate(columns)
    ]  # fmt: skip
    model.setObjective(pulp.LpAffineExpression(zip(x, program.cost.tolist(), strict=True), constant=program.offset))
    steps = ONE_SIDED_ROWS.apply(program)
    split = steps[0].program if steps else program
    indptr, indices, data = (part.tolist() for part in merged_rows(split))
    origins = steps[0].rows.tolist() if steps else range(program.num_rows)
    for k, (i, low, high) in enumerate(zip(origins, split.row_lower.tolist(), split.row_upper.tolist(), strict=True)):
        if low == -math.inf and high == math.inf:
            continue
        sense, side = (pulp.LpConstraintEQ, low) if low == high else (pulp.LpConstraintLE, high)
        if high == math.inf:
            sense, side = pulp.LpConstraintGE, low
        entries = pulp.LpAffineExpression([(x[indices[e]], data[e]) for e in range(indptr[k], indptr[k + 1])])
        model.addConstraint(pulp.LpConstraint(entries, sense, rows[i] if k < program.num_rows else f"{rows[i]}_low", side))
    return model
