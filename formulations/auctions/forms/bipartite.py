"""Form ``bipartite``: one binary a pair, whose linear program has whole vertices."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...evidence import Evidence
from ...forms import FORMS, Form
from ...programs.compiled import Compiled
from ...programs.program import Program
from ..bin_assignment import BinAssignment
from ._pairs import decoded, encoded, pair_rows, pair_variables, pairs_size

Floats = NDArray[np.float64]


def build(problem: BinAssignment) -> Compiled:
    """Robot i is sent to bin j (x_ij), K pairs in all::

        min  sum c_ij x_ij,   x binary
        robot[i]   sum_j x_ij <= 1     (= 1 where K is the number of robots)
        bin[j]     sum_i x_ij <= 1     (= 1 where K is the number of bins)
        pairs      sum_ij x_ij = K     (where it is neither)

    The matrix is totally unimodular (Hoffman and Kruskal 1956); duals of ``bin`` are prices.
    """
    n, m = problem.num_robots, problem.num_bins

    def dual_evidence(row_duals: Floats) -> Evidence:
        duals = np.asarray(row_duals, dtype=np.float64)
        level = float(duals[n + m]) if len(duals) > n + m else 0.0
        value = level * problem.pairs * (len(duals) > n + m) + float(duals[: n + m].sum())
        return Evidence("assignment-prices", "LP duals of bipartite", value, {"prices": (-duals[n : n + m]).tolist(), "level": level})

    program = Program("bipartite", "min", (pair_variables(problem, problem.cost),), pair_rows(problem))
    return Compiled(program, problem, lambda v: decoded(problem, v), lambda a: encoded(problem, a), dual_evidence)


FORMS.add("bipartite", Form("bipartite", "bin-assignment", frozenset({"objective:sum"}), build, size=pairs_size))
