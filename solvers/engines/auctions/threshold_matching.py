"""Engine ``threshold-matching``: assignments of the least largest cost, proved by the robots and bins that meet all cheaper pairs."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from ....formulations.problem import Problem
from ....formulations.stop import Stop
from ....instances.errors import UnsupportedError
from ...backend import BACKENDS, Control, Engine, Options, RawResult

if TYPE_CHECKING:
    from ....formulations.auctions.bin_assignment import BinAssignment


@BACKENDS.register("threshold-matching")
class ThresholdMatchingEngine(Engine):
    """Matchings of the most pairs among those up to a threshold, halving (Garfinkel 1971; Hopcroft and Karp 1973)."""

    name = "threshold-matching"
    package = "scipy"
    modules = ("scipy",)
    summary = "assignments of the least largest cost by matchings up to a threshold, with a proof"
    interrupts = "keeps the best assignment and the bound so far"
    honours = frozenset()
    one_thread = bounds_itself = True
    order = 10
    family = "bin-assignment"
    features = frozenset({"objective:bottleneck"})

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        from .assignment_steps.thresholds import least_threshold

        lacking = self.missing(problem)
        if lacking:
            raise UnsupportedError(self.name, lacking)
        asked = cast("BinAssignment", problem)
        reason = next(asked.infeasibility_reasons(), None)
        if reason is not None and reason.evidence is not None:
            return RawResult("infeasible", message=reason.message, evidence=(reason.evidence,))
        stop = Stop(options.time_limit)
        control.on_stop(stop.ask)
        found = least_threshold(asked, stop)
        value = asked.evaluate(found.answer).values[0]
        status, limit = ("optimal", "none") if found.complete else ("feasible", stop.reached())
        evidence = () if found.evidence is None else (found.evidence,)
        bound = value if found.complete else None
        return RawResult(status, limit, found.answer, value, bound, statistics={"matchings": found.matchings}, evidence=evidence)
