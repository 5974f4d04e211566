"""What a cheap verified bound says before a search: that there is nothing to find, or when nothing is left to gain."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ..formulations.certificate import certify
from ..formulations.evidence import Evidence
from ..formulations.problem import Problem
from ..formulations.tolerance import gap, same
from ..solvers.backend import Control, RawResult
from ..solvers.linear_programs import LinearPrograms
from .bounding import find_bounds
from .search import search

SECONDS = 1.0
"""What may be spent on it, though no more than the budget for bounding."""

LARGEST = 500
"""Problems of a larger ``size`` have bounds that no answer reaches, and whose verification takes as long as finding them: what is there at
once is all that is looked for before the search."""


def first_evidence(
    problem: Problem, seconds: float, linear: LinearPrograms | None = None, most: float = 0.0, uncompiled: list[str] | None = None
) -> tuple[list[Evidence], Goal | None]:
    """Evidence found within ``seconds``, and the goal that it sets, ``most`` being the gap that is asked for; large problems set none.

    Nothing is compiled for it: ``uncompiled`` receives the names of the methods that this leaves out.
    """
    large = problem.size > LARGEST
    try:

        def find(control: Control) -> RawResult:
            found = find_bounds(
                problem, seconds, control=control, linear=linear, searching=False, at_once=large, compiling="never", uncompiled=uncompiled
            )
            return RawResult("unknown", answer=found)

        found = search(find, Control(), seconds)
        evidence = found.result.answer or []
        return evidence, None if large else Goal(problem, evidence, most)
    except (Exception, KeyboardInterrupt):  # whatever fails here will be told by the bounding that follows the search, and costs no answer
        return [], None


class Goal:
    """Ends a search, through its ``Control``, whose incumbent reaches a verified bound, or comes as near to it as is asked for.

    Parameters
    ----------
    problem : Problem
    evidence : sequence of Evidence
    most : float
        Relative gap at which the search ends.
    """

    def __init__(self, problem: Problem, evidence: Sequence[Evidence], most: float = 0.0) -> None:
        self.problem, self.most, self.limit, self.reached = problem, most, "none", False
        self.first = tuple(evidence)
        self.learn(())

    def learn(self, evidence: Sequence[Evidence]) -> None:
        """Take more evidence into account."""
        certificate = certify(self.problem, None, [*self.first, *evidence])
        self.infeasible, self.first_level, self.source = bool(certificate.infeasible), certificate.bound, str(certificate.bound_source)
        self.bound = certificate.bound if isinstance(certificate.bound, float) and len(self.problem.senses) == 1 else None

    def told(self) -> dict[str, Any]:
        """The event of the best bound that was checked so far."""
        worst = math.inf if self.problem.sense == "min" else -math.inf
        if self.infeasible:
            return {"bound": worst, "kind": "verified", "source": self.source}
        return {"bound": self.first_level, "kind": "verified", "source": self.source}

    def __call__(self, answer: Any, objective: float | None) -> bool:
        """Whether ``answer``, of this ``objective`` by its engine's count, leaves nothing to gain."""
        if self.bound is not None and objective is not None and self._close(objective):
            judged = self.problem.evaluate(answer)
            if judged.feasible and self._close(judged.values[0]) and not self.reached:  # of several threads the first one decides
                self.limit, self.reached = "none" if self.met(judged.values[0]) else "gap", True
        return self.reached

    def met(self, value: float | None) -> bool:
        """Whether ``value`` is that of the bound, or nobody can have any."""
        known = self.first_level if self.bound is None else self.bound
        return self.infeasible or (value is not None and known is not None and same(value, known))

    def _close(self, value: float) -> bool:
        assert self.bound is not None
        return same(value, self.bound) or gap(value, self.bound) <= self.most
