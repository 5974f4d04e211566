"""Bound ``deviation-chord``: the best evidence that other methods find for the same problem with certain durations in place of risks."""

import math
from typing import Any

from ....formulations.evidence import Evidence
from ....formulations.routing.checking.deviation_chord import KIND, lacks_chord, without_risks
from ....formulations.routing.checking.route_limits import limits_of
from ....formulations.routing.problem import RoutingProblem
from ....formulations.stop import NEVER, Stop
from ....formulations.verified_bounds import better_bound, verified_bound
from ...linear_programs import LinearPrograms
from .. import BOUNDS, bound_method, of_family, replaced
from . import branch_price_cut, spanning_tree, state_space

PART = 0.2
"""Part of the time left that each method gets, but the last ones (branch, price and cut, where it applies)."""

LAST = 8
"""Order of the last methods that are asked."""

SLOW = frozenset({"state-space", "branch-price-cut"})
"""Methods that take all the time they get, and prove less from the mean durations alone."""


def _replaces(problem: Any) -> frozenset[str]:
    """The slow methods, where the chord leaves nothing of the means out: one uncertain limit a vehicle, and no windows."""
    if MISSING(problem):
        return frozenset()
    timed = problem.features() & {"time-windows", "depot-windows", "several-windows", "shifts", "closing-moves"}
    one = all(len(limits_of(problem, v).chances) == 1 or (v.energy is None and math.isinf(v.max_duration)) for v in problem.fleet)
    return SLOW if one and not timed else frozenset()


KERNELS = (*spanning_tree.KERNELS, *state_space.KERNELS, *branch_price_cut.KERNELS)

MISSING = of_family("routing", lacks_chord)


@bound_method(KIND, MISSING, order=LAST, aims=True, kernels=KERNELS, replaces=_replaces)
def deviation_chord_bound(
    problem: RoutingProblem, stop: Stop = NEVER, linear: LinearPrograms | None = None, target: float | None = None
) -> Evidence | None:
    """The best evidence of other methods on the problem without risks."""
    certain = without_risks(problem)
    if certain is None:
        return None
    others = replaced(certain)
    bound = nothing = -math.inf if problem.sense == "min" else math.inf
    best: Evidence | None = None
    methods = [m for m in BOUNDS.values() if m.order <= LAST and m.name not in others and not m.missing(certain)]
    for method in sorted(methods, key=lambda m: m.order):
        if stop.reached():
            break
        within = stop if method.order == LAST else stop.within(PART * stop.seconds_left)
        inner = method.evidence(certain, within, linear or LinearPrograms(), target)
        proved = nothing if inner is None else verified_bound(certain, inner)
        if inner is None or proved == nothing or math.isnan(proved) or not better_bound(problem.sense, proved, bound):
            continue
        bound = proved
        best = Evidence(KIND, f"{inner.source}, with the chord of the deviation", proved, {"kind": inner.kind, "data": inner.data})
        if math.isinf(proved):  # there is no answer
            break
    return best
