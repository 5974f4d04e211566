"""The best of the answers that several searches find for one routing problem, and the line to each of these searches."""

import threading
from typing import Any

from ....formulations.evaluation import Evaluation
from ....formulations.evidence import Evidence
from ....formulations.routing.problem import RoutingProblem
from ....formulations.routing.routes import Routes
from ....formulations.tolerance import same
from ...backend import Control


class BestRoutes:
    """Keeps the best feasible answer, by the objective's levels in their order, and hands it out at once. Thread-safe."""

    def __init__(self, problem: RoutingProblem, control: Control) -> None:
        self.problem, self.control = problem, control
        self.answer: Routes | None = None
        self.values: tuple[float, ...] | None = None
        self._lock = threading.Lock()

    def take(self, answer: Routes) -> bool:
        """Keep an answer if it is feasible and better than the one that is held."""
        verdict = self.problem.evaluate(answer)
        with self._lock:
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


class PartControl(Control):
    """The line to one of several searches: its answers go to ``best``, a wish to end comes from whoever asks them all.

    Of set-up only the first search tells: when the others begin, nobody waits for a first answer any more.
    """

    def __init__(self, best: BestRoutes, first: bool) -> None:
        super().__init__()
        self._best, self._first = best, first
        best.control.on_stop(self.stop)

    @property
    def best(self) -> BestRoutes:
        """The keeper of the best answer of all searches."""
        return self._best

    def begin_set_up(self) -> None:
        if self._first:
            super().begin_set_up()
            self._best.control.begin_set_up()

    def end_set_up(self, seconds: float) -> None:
        super().end_set_up(seconds)
        self._best.control.end_set_up(seconds)

    def publish(
        self, answer: Any = None, objective: float | None = None, bound: float | None = None, evidence: tuple[Evidence, ...] = ()
    ) -> None:
        super().publish(answer, objective, bound, evidence)
        if answer is not None and self._best.take(answer):
            self.taken()

    def taken(self) -> None:
        """An answer of this search is the best one so far."""
