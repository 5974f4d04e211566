"""Heuristic ``bins-then-requests``: the best assignment of bins, then the best of requests for robots that have their bins."""

import numpy as np

from ...formulations.auctions.bin_assignment import BinAssignment
from ...formulations.auctions.joint_assignment import JointAssignment
from ...solvers.engines.auctions.assignment_steps.auction import auction
from ..heuristic import Context, Outcome, heuristic


@heuristic("bins-then-requests", "joint-assignment", {"triples"}, "the best assignment of bins, then the best of requests beside it")
def bins_then_requests(problem: JointAssignment, context: Context) -> Outcome:
    """Decide in Zhang's order: no robot looks at requests before it knows its bin."""
    stop = context.begin()
    instance = problem.instance
    assert instance.filled is not None
    alone = np.maximum(instance.to_bin, instance.filled)
    chosen = [np.full(problem.num_robots, -1)] * 2
    if problem.pickups:
        first = auction(BinAssignment.from_matrix(alone), stop)
        if not first.complete:
            return Outcome(None, limit=stop.reached() or "none")
        chosen[0] = np.array(first.answer)
    if problem.deliveries:
        detour, has = instance.to_request.copy(), np.nonzero(chosen[0] >= 0)[0]
        own = chosen[0][has]
        by = np.maximum(instance.to_request[has] + instance.between.T[own], instance.filled[own, None])
        detour[has] = by - alone[has, own][:, None]
        second = auction(BinAssignment.from_matrix(detour), stop)
        if not second.complete:
            return Outcome(None, limit=stop.reached() or "none")
        chosen[1] = np.array(second.answer)
    return Outcome(tuple(zip(chosen[0].tolist(), chosen[1].tolist(), strict=True)))
