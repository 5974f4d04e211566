"""The best of the answers that several searches find for one routing problem."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....formulations.tolerance import same

if TYPE_CHECKING:
    from ....formulations.evaluation import Evaluation
    from ....formulations.routing.problem import RoutingProblem
    from ....formulations.routing.routes import Routes
    from ...backend import Control


class BestRoutes:
    """Keeps the best feasible answer, by the objective's levels in their order, and hands it out at once."""

    def __init__(self, problem: RoutingProblem, control: Control) -> None:
        self.problem, self.control = problem, control
        self.answer: Routes | None = None
        self.values: tuple[float, ...] | None = None

    def take(self, answer: Routes) -> bool:
        """Keep an answer if it is feasible and better than the one that is held."""
        verdict = self.problem.evaluate(answer)
        if not verdict.feasible or not self._better(verdict):
            return False
        self.answer, self.values = answer, tuple(verdict.values)
        self.control.publish(answer, self.claim)
        return True

    @property
    def claim(self) -> float | None:
        """Its value, where that is one number."""
        return self.values[0] if self.values is not None and len(self.values) == 1 else None

    def _better(self, verdict: Evaluation) -> bool:
        if self.values is None:
            return True
        for sense, one, other in zip(self.problem.senses, verdict.values, self.values, strict=True):
            if not same(one, other):
                return (one < other) == (sense == "min")
        return False
