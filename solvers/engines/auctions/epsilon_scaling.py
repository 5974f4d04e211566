"""Engine ``epsilon-scaling``: assignments of the least sum by Bertsekas' auction, whose prices prove them."""

from dataclasses import replace

from ....formulations.auctions.bin_assignment import BinAssignment
from ....formulations.evidence import Evidence
from ....formulations.stop import Stop
from ....formulations.tolerance import same
from ...backend import BACKENDS, Control, Options, RawResult
from ._bin_engine import BinEngine
from .lapjv import LapjvEngine


@BACKENDS.register("epsilon-scaling")
class EpsilonScalingEngine(BinEngine):
    """The auction of Bertsekas (1979) in whole numbers, epsilon falling to below one n-th of a step.

    The prices that it ends with prove the optimum. Where they do not, since costs of very different sizes do not fit into whole numbers of
    64 bits, shortest augmenting paths (``lapjv``) begin anew in the time that is left; few pairs go there at once, where nothing has to be
    compiled or loaded. See docs/formulations/bin-assignment.md#auctions.
    """

    name = "epsilon-scaling"
    package = "numba"
    summary = "optimal assignments by Bertsekas' auction, with the prices that prove it"
    order = 9
    features = frozenset({"objective:sum"})

    def assign(self, problem: BinAssignment, stop: Stop, options: Options, control: Control) -> RawResult:
        from .assignment_steps.auction import auction
        from .assignment_steps.recovered_prices import FEW_PAIRS

        other = LapjvEngine()
        if len(problem.cost) <= FEW_PAIRS and not other.apart(problem):
            return other.run(problem, options, control)
        ended = auction(problem, stop)
        statistics = {"bids": ended.bids, "phases": ended.phases}
        proofs: tuple[Evidence, ...] = ()
        if ended.complete:
            judged, evidence = problem.evaluate(ended.answer), ended.evidence(problem, "auction prices")
            value, proofs = judged.values[0], (evidence,)
            control.publish(ended.answer, value, evidence=proofs)
            if same(value, evidence.value, judged.size):
                return RawResult("optimal", answer=ended.answer, objective=value, bound=value, statistics=statistics, evidence=proofs)
        if stop.reached() or other.apart(problem):
            answer = control.answer if proofs else problem.answer_at_hand()
            why = (
                "the auction's prices do not prove its assignment optimal" if proofs else "the auction was cut short: any of the most pairs"
            )
            return RawResult("feasible", stop.reached() or "none", answer, statistics=statistics, evidence=proofs, message=why)
        later = other.run(problem, replace(options, time_limit=stop.seconds_left), control)
        return replace(later, evidence=later.evidence + proofs)
