"""Bound ``assignment-prices``: prices of an auction for sums of costs; robots and bins that meet all cheap pairs for the largest cost."""

from ....formulations.auctions.bin_assignment import BinAssignment
from ....formulations.evidence import Evidence
from ....formulations.stop import Stop
from ...engines.auctions.assignment_steps.auction import auction
from ...engines.auctions.threshold_matching import least_threshold
from ...linear_programs import LinearPrograms
from .. import bound_method, of_family

KERNELS = (
    "waybound.solvers.engines.auctions.assignment_steps.auction_kernels",
    "waybound.solvers.engines.auctions.assignment_steps.price_kernels",
)


@bound_method("assignment-prices", of_family("bin-assignment"), order=1, kernels=KERNELS)
def compute(problem: BinAssignment, stop: Stop, linear: LinearPrograms) -> Evidence | None:
    """Evidence of the least sum or the least largest cost; None where it was stopped, or where not as many pairs as asked for exist."""
    if problem.pairs > int((problem.largest >= 0).sum()):
        return next((reason.evidence for reason in problem.infeasibility_reasons()), None)
    if problem.objective == "bottleneck":
        return least_threshold(problem, stop).evidence
    ended = auction(problem, stop)
    return ended.evidence(problem, "auction prices") if ended.complete else None
