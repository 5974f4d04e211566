"""Heuristic ``online-greedy``: one robot after the other takes its cheapest free bin."""

from collections.abc import Sequence

import numpy as np

from ...formulations.auctions.bin_assignment import BinAssignment
from ...formulations.evidence import Guarantee
from ...instances.errors import UsageError
from ..heuristic import Context, Outcome, heuristic
from .conflict_auction import QUADRANGLE, changes_message, completed, cut_short, quadrangle

MOST = 1000
"""Robots up to which 2^n - 1 is a floating-point number."""

SOURCE = "Kalyanasundaram and Pruhs (1993), Online weighted matching; Khuller, Mitchell and Vazirani (1994)"


@heuristic(
    "online-greedy",
    "bin-assignment",
    {"objective:sum", "objective:bottleneck"},
    "one robot after the other takes its cheapest bin that is left",
    "2^n - 1 for n robots, no fewer bins, and costs that keep the quadrangle inequality",
)
def online_greedy(problem: BinAssignment, context: Context, *, order: str | Sequence[int] = "id") -> Outcome:
    """Serve robots in turn, first come, first served.

    ``order`` is ``id`` (as they are numbered), ``random``, or the numbers of all robots from 0. Where pairs are forbidden it may match
    fewer than possible; then as few robots as possible get other bins.

    Source: Zhang (2015), section 3.4.1, on the costs of the auction; docs/formulations/bin-assignment.md#auctions. 2^n - 1 is attained on a
    line for every n, and holds where there is a bin for each robot: otherwise those served first may not be the ones to serve.
    """
    from .conflict_kernels import serial_choice

    n, stop = problem.num_robots, context.begin()
    if isinstance(order, str):
        if order not in ("id", "random"):
            raise UsageError(f"order must be id, random, or the numbers of all robots, not {order!r}", "unknown-name")
        turns = np.arange(n) if order == "id" else context.rng.permutation(n)
    else:
        try:
            turns = np.array(list(order), dtype=np.int64)
        except (TypeError, ValueError, OverflowError):
            turns = np.zeros(0, dtype=np.int64)
        if sorted(turns.tolist()) != list(range(n)):
            raise UsageError(f"order must name each of the {n} robots once, as numbers from 0", "malformed")
    data = problem.indptr.astype(np.int64), problem.bins.astype(np.int64), problem.cost
    taken, whole = serial_choice(stop.flag, *data, problem.num_bins, turns)
    if not whole:
        return cut_short(problem, stop)
    answer, changed = completed(problem, taken, stop)
    guarantee = None
    if problem.objective == "sum" and n <= min(problem.num_bins, MOST) and quadrangle(problem, stop):
        guarantee = Guarantee(2.0**n - 1.0, f"cost <= (2^{n} - 1) OPT", (QUADRANGLE, "a bin for each robot"), SOURCE)
    return Outcome(answer, guarantee, (), {"changed": changed} if changed else {}, changes_message(changed))
