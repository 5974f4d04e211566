"""Heuristic ``bins-then-requests``: the best assignment of bins, then the best of requests for robots that have their bins."""

from __future__ import annotations

import math

import numpy as np

from ...formulations.auctions.bin_assignment import BinAssignment
from ...formulations.auctions.joint_assignment import JointAssignment
from ...solvers.engines.assignment_steps.auction import auction
from ..heuristic import HEURISTICS, Context, Heuristic, Outcome


def bins_then_requests(problem: JointAssignment, context: Context) -> Outcome:
    """Zhang's order of decisions: no robot looks at requests before it knows its bin."""
    stop = context.begin()
    costs = problem.costs
    chosen = [np.full(problem.num_robots, -1)] * 2
    if problem.pickups:
        first = auction(BinAssignment.from_matrix(costs[:, :-1, -1]), stop)
        if not first.complete:
            return Outcome(None, limit=stop.reached() or "none")
        chosen[0] = np.array(first.answer)
    if problem.deliveries:
        own = costs[np.arange(problem.num_robots), chosen[0]]  # -1 is the last, which stands for none
        detour = np.where(np.isfinite(own[:, :-1]), own[:, :-1] - own[:, -1:], math.inf)
        second = auction(BinAssignment.from_matrix(detour), stop)
        if not second.complete:
            return Outcome(None, limit=stop.reached() or "none")
        chosen[1] = np.array(second.answer)
    return Outcome(tuple(zip(chosen[0].tolist(), chosen[1].tolist(), strict=True)))


HEURISTICS.add(
    "bins-then-requests",
    Heuristic(
        "bins-then-requests", ("joint-assignment",), frozenset({"triples"}), bins_then_requests,
        "the best assignment of bins, then the best of requests beside it",
    ),
)  # fmt: skip
