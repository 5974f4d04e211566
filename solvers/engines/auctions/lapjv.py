"""Engine ``lapjv``: assignments of the least sum by shortest augmenting paths, scipy's, with prices that prove it."""

from typing import cast

import numpy as np
from numpy.typing import NDArray

from ....formulations.auctions.bin_assignment import BinAssignment
from ....formulations.problem import Problem
from ....formulations.stop import Stop
from ....formulations.tolerance import same
from ...backend import BACKENDS, Control, Options, RawResult
from ._bin_engine import BinEngine
from .assignment_steps.sides import Side

MOST_FILLED = 4_000_000
"""Entries of a sparse matrix up to which it is filled with infinity, as the dense method is faster."""


@BACKENDS.register("lapjv")
class LapjvEngine(BinEngine):
    """Shortest augmenting paths (Jonker and Volgenant 1987; Crouse 2016): ``scipy.optimize.linear_sum_assignment``.

    Large sparse data go to ``scipy.sparse.csgraph.min_weight_full_bipartite_matching``. Neither returns prices: they are found from the
    assignment by shortest paths. Both add costs in floating point, so that beside large costs they may take the wrong one of two small
    ones: an optimum is claimed only where the prices prove it.
    """

    name = "lapjv"
    package = "scipy"
    summary = "optimal assignments by shortest augmenting paths, with prices that prove it"
    interrupts = "scipy cannot be stopped: an assignment that is not found in time is left behind"
    order = 10
    features = frozenset({"objective:sum"})

    def apart(self, problem: Problem) -> bool:
        """See ``Engine.apart``: scipy's sparse method holds Python's global lock to its end."""
        if self.missing(problem):
            return False
        asked = cast("BinAssignment", problem)
        return not asked.complete and asked.num_robots * asked.num_bins > MOST_FILLED

    def assign(self, problem: BinAssignment, stop: Stop, options: Options, control: Control) -> RawResult:
        from .assignment_steps.recovered_prices import recovered_prices
        from .assignment_steps.sides import joined, sides

        parts = sides(problem)
        answer = joined(problem, parts, [_columns(part) for part in parts])
        judged = problem.evaluate(answer)
        value = judged.values[0]
        control.publish(answer, value)
        evidence = recovered_prices(problem, answer, "prices of the assignment, by shortest paths", stop)
        if same(value, evidence.value, judged.size):
            return RawResult("optimal", answer=answer, objective=value, bound=value, evidence=(evidence,))
        why = "" if stop.reached() else "the assignment was found in rounded sums, and its prices do not prove it optimal"
        return RawResult("feasible", stop.reached() or "none", answer, value, evidence=(evidence,), message=why)


def _columns(part: Side) -> NDArray[np.int64]:
    """Column of each row."""
    from scipy.optimize import linear_sum_assignment
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import min_weight_full_bipartite_matching

    n, m = part.num_rows, part.num_columns
    if part.complete or n * m <= MOST_FILLED:
        matrix = np.full((n, m), np.inf) if not part.complete else part.cost.reshape(n, m)
        if not part.complete:
            matrix[np.repeat(np.arange(n), np.diff(part.indptr)), part.columns] = part.cost
        rows, columns = linear_sum_assignment(matrix)
    else:
        low, high = float(part.cost.min()), float(part.cost.max())
        weight = part.cost if low > 0 else part.cost - low + max(high - low, 1.0)  # a stored 0 would be no pair
        rows, columns = min_weight_full_bipartite_matching(csr_matrix((weight, part.columns, part.indptr), shape=(n, m)))
    column = np.full(n, -1, dtype=np.int64)
    column[rows] = columns
    return column
