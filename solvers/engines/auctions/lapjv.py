"""Engine ``lapjv``: assignments of the least sum by shortest augmenting paths, scipy's, with prices that prove it."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from ....formulations.problem import Problem
from ....formulations.stop import Stop
from ....formulations.tolerance import same
from ....instances.errors import UnsupportedError
from ...backend import BACKENDS, Control, Engine, Options, RawResult

if TYPE_CHECKING:
    from ....formulations.auctions.bin_assignment import BinAssignment
    from .assignment_steps.sides import Side

MOST_FILLED = 4_000_000
"""Entries of a sparse matrix that are filled in with infinity, for the dense method is the faster one."""


@BACKENDS.register("lapjv")
class LapjvEngine(Engine):
    """Shortest augmenting paths (Jonker and Volgenant 1987; Crouse 2016): ``scipy.optimize.linear_sum_assignment``.

    Large sparse data go to ``scipy.sparse.csgraph.min_weight_full_bipartite_matching``. Neither returns prices: they are found from the
    assignment by shortest paths. Both add costs in floating point, so that beside large costs they may take the wrong one of two small
    ones: an optimum is claimed only where the prices prove it.
    """

    name = "lapjv"
    package = "scipy"
    modules = ("scipy",)
    summary = "optimal assignments by shortest augmenting paths, with prices that prove it"
    interrupts = "scipy cannot be stopped: an assignment that is not found in time is left behind"
    honours = frozenset()
    one_thread = bounds_itself = True
    order = 10
    family = "bin-assignment"
    features = frozenset({"objective:sum"})

    def apart(self, problem: Problem) -> bool:
        """See ``Engine.apart``: scipy's sparse method holds Python's global lock to its end."""
        if self.missing(problem):
            return False
        asked = cast("BinAssignment", problem)
        return not asked.complete and asked.num_robots * asked.num_bins > MOST_FILLED

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        from .assignment_steps.recovered_prices import recovered_prices
        from .assignment_steps.sides import joined, sides

        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        asked = cast("BinAssignment", problem)
        reason = next(asked.infeasibility_reasons(), None)
        if reason is not None and reason.evidence is not None:
            return RawResult("infeasible", message=reason.message, evidence=(reason.evidence,))
        stop = Stop(options.time_limit)
        control.on_stop(stop.ask)
        parts = sides(asked)
        answer = joined(asked, parts, [_columns(part) for part in parts])
        judged = asked.evaluate(answer)
        value = judged.values[0]
        control.publish(answer, value)
        evidence = recovered_prices(asked, answer, "prices of the assignment, by shortest paths", stop)
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
    made = np.full(n, -1, dtype=np.int64)
    made[rows] = columns
    return made
