"""Programs with rows and variables of every sort, and what a reader makes of their files."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp
from oracles import SQUARE_4, TW_4, routing

from waybound.formulations.programs.program import Program, Rows, Variables


def rows_of(name: str, matrix: Any, lower: Any, upper: Any) -> Rows:
    m = sp.csr_matrix(np.atleast_2d(np.asarray(matrix, dtype=float)))
    return Rows(
        name, indptr=m.indptr.astype(np.int32), indices=m.indices.astype(np.int32), data=m.data,
        lower=np.asarray(lower, dtype=float), upper=np.asarray(upper, dtype=float),
    )  # fmt: skip


def variables(name: str, lower: Any, upper: Any, cost: Any, integer: bool = False) -> Variables:
    low, high, price = (np.asarray(v, dtype=float) for v in (lower, upper, cost))
    return Variables(name, lower=low, upper=high, cost=price, integer=integer)


def everything(sense: str = "max", quadratic: bool = False) -> Program:
    """Ranges, equalities, one-sided and free rows; free, fixed, negative, half-open and integer variables; a constant.

    Maximisation of -(its minimisation), so that both senses have the optimum of opposite sign.
    """
    sign = 1.0 if sense == "min" else -1.0
    x = variables("x", [-math.inf, 2.5, -7.0, -math.inf], [math.inf, 2.5, -3.0, 4.0], sign * np.array([1.0, 2.0, -1.0, -0.5]))
    k = variables("k", [0.0, -5.0, 2.0], [1.0, math.inf, 9.0], sign * np.array([-3.0, 1.0, 0.0]), integer=True)
    rows = (
        rows_of("range", [[1, 0, 1, 0, 1, 0, 0]], [-6.0], [5.5]),
        rows_of("sides", [[0, 1, 0, 1, 0, 1, 0], [2, 0, 0, 1, 0, 0, 1]], [-math.inf, 1 / 3], [8.1, math.inf]),
        rows_of("equal", [[1, 0, 0, 0, 0, 1, -1]], [0.1], [0.1]),
        rows_of("free", [[1, 1, 1, 1, 1, 1, 1]], [-math.inf], [math.inf]),
    )
    q = None
    if quadratic:
        q = sp.csr_matrix(sign * np.diag([2.0, 0, 1.0, 0, 0, 0, 0]) + sign * sp.csr_matrix(([0.5, 0.5], ([0, 2], [2, 0])), shape=(7, 7)))
        k = variables("k", [0.0, -5.0, 2.0], [1.0, 90.0, 9.0], sign * np.array([-3.0, 1.0, 0.0]))
    return Program("everything", sense, (x, k), rows, offset=sign * 12.25, quadratic=q)


def highs_value(model: Any) -> float:
    import highspy

    model.setOptionValue("output_flag", False)
    model.setOptionValue("mip_rel_gap", 0.0)
    model.run()
    assert model.getModelStatus() == highspy.HighsModelStatus.kOptimal
    return float(model.getInfo().objective_function_value)


def read_back(path: Path) -> Any:
    import highspy

    model = highspy.Highs()
    model.setOptionValue("output_flag", False)
    assert model.readModel(str(path)) == highspy.HighsStatus.kOk
    return model


def arrays_of(model: Any) -> dict[str, Any]:
    lp = model.getLp()
    stored = sp.csr_matrix if "Rowwise" in str(lp.a_matrix_.format_) else sp.csc_matrix
    matrix = stored((lp.a_matrix_.value_, lp.a_matrix_.index_, lp.a_matrix_.start_), shape=(lp.num_row_, lp.num_col_))
    return {
        "cost": lp.col_cost_, "lower": lp.col_lower_, "upper": lp.col_upper_, "row_lower": lp.row_lower_, "row_upper": lp.row_upper_,
        "matrix": matrix.toarray(), "offset": lp.offset_, "sense": "max" if "Max" in str(lp.sense_) else "min",
        "integer": [str(v).endswith("kInteger") for v in lp.integrality_] or [False] * lp.num_col_,
    }  # fmt: skip


SQUARE = routing(xy=SQUARE_4, sites={**TW_4, "demand": [0, 1, 2, 1, 1], "service": 0.5}, count=3, capacity=3, max_duration=30.0)
PROGRAMS = {
    "everything-min": everything("min"),
    "everything-max": everything("max"),
    "mtz": routing(xy=SQUARE_4, sites={**TW_4, "demand": [0, 1, 2, 1, 1]}, count=3, capacity=3).compile("two-index-mtz").program,
    "three-index": SQUARE.compile("three-index").program,
}


def reference(program: Program) -> float:
    return highs_value(program.to_highs())
