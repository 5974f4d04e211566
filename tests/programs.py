"""Programs from small dense arrays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy.sparse as sp

from waybound.formulations.programs.program import Program, Rows, Variables

INF = math.inf


def program(
    cost: Any, matrix: Any, low: Any, high: Any, lower: Any = 0.0, upper: Any = INF, *, integer: Sequence[int] = (), sense: str = "min",
    offset: float = 0.0, quadratic: Any = None,
) -> Program:  # fmt: skip
    """A program with a block for each variable."""
    n = len(cost)
    a = sp.csr_matrix(np.asarray(matrix, dtype=float).reshape(-1, n))
    spread = lambda v, k: np.array(np.broadcast_to(np.asarray(v, dtype=float), k))  # noqa: E731
    low_x, high_x = spread(lower, n), spread(upper, n)
    columns = tuple(
        Variables(f"x{j}", lower=low_x[j : j + 1], upper=high_x[j : j + 1], cost=np.array([float(cost[j])]), integer=j in set(integer))
        for j in range(n)
    )
    rows = Rows("row", indptr=a.indptr, indices=a.indices, data=a.data, lower=spread(low, a.shape[0]), upper=spread(high, a.shape[0]))
    return Program("test", sense, columns, (rows,), offset, None if quadratic is None else sp.csr_matrix(np.asarray(quadratic, float)))
