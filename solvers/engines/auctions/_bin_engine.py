"""Base of the engines of bin assignments."""

from abc import abstractmethod
from typing import cast

from ....formulations.auctions.bin_assignment import BinAssignment
from ....formulations.problem import Problem
from ....formulations.stop import Stop
from ...backend import Control, Engine, Options, RawResult


class BinEngine(Engine):
    """An engine of bin assignments on one thread that finds bounds itself."""

    honours = frozenset()
    one_thread = bounds_itself = True
    family = "bin-assignment"

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """Search, unless the data show that there are not as many pairs as are asked for."""
        stop = self.begin(problem, options, control)
        asked = cast("BinAssignment", problem)
        reason = next(asked.infeasibility_reasons(), None)
        if reason is not None and reason.evidence is not None:
            return RawResult("infeasible", message=reason.message, evidence=(reason.evidence,))
        return self.assign(asked, stop, options, control)

    @abstractmethod
    def assign(self, problem: BinAssignment, stop: Stop, options: Options, control: Control) -> RawResult:
        """Search for an assignment that exists."""
