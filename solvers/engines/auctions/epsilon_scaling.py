"""Engine ``epsilon-scaling``: assignments of the least sum by Bertsekas' auction, whose prices prove them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, cast

from ....formulations.evidence import Evidence
from ....formulations.problem import Problem
from ....formulations.tolerance import same
from ...backend import BACKENDS, Control, Engine, Options, RawResult
from .lapjv import LapjvEngine

if TYPE_CHECKING:
    from ....formulations.auctions.bin_assignment import BinAssignment


@BACKENDS.register("epsilon-scaling")
class EpsilonScalingEngine(Engine):
    """The auction of Bertsekas (1979) in whole numbers, epsilon falling to below one n-th of a step.

    The prices that it ends with prove the optimum. Where they do not, since costs of very different sizes do not fit into whole numbers of
    64 bits, shortest augmenting paths (``lapjv``) begin anew in the time that is left; few pairs go there at once, where nothing has to be
    compiled or loaded. See docs/formulations/bin-assignment.md#auctions.
    """

    name = "epsilon-scaling"
    package = "numba"
    modules = ("numba",)
    summary = "optimal assignments by Bertsekas' auction, with the prices that prove it"
    honours = frozenset()
    one_thread = bounds_itself = True
    order = 9
    family = "bin-assignment"
    features = frozenset({"objective:sum"})

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        from .assignment_steps.auction import auction
        from .assignment_steps.recovered_prices import FEW_PAIRS

        stop = self.begin(problem, options, control)
        asked = cast("BinAssignment", problem)
        reason = next(asked.infeasibility_reasons(), None)
        if reason is not None and reason.evidence is not None:
            return RawResult("infeasible", message=reason.message, evidence=(reason.evidence,))
        other = LapjvEngine()
        if len(asked.cost) <= FEW_PAIRS and not other.apart(problem):
            return other.run(problem, options, control)
        found = auction(asked, stop)
        statistics = {"bids": found.bids, "phases": found.phases}
        proofs: tuple[Evidence, ...] = ()
        if found.complete:
            judged, evidence = asked.evaluate(found.answer), found.evidence(asked, "auction prices")
            value, proofs = judged.values[0], (evidence,)
            control.publish(found.answer, value, evidence=proofs)
            if same(value, evidence.value, judged.size):
                return RawResult("optimal", answer=found.answer, objective=value, bound=value, statistics=statistics, evidence=proofs)
        if stop.reached() or other.apart(problem):
            answer = control.answer if proofs else asked.answer_at_hand()
            why = (
                "the auction's prices do not prove its assignment optimal" if proofs else "the auction was cut short: any of the most pairs"
            )
            return RawResult("feasible", stop.reached() or "none", answer, statistics=statistics, evidence=proofs, message=why)
        later = other.run(problem, replace(options, time_limit=stop.seconds_left), control)
        return replace(later, evidence=later.evidence + proofs)
