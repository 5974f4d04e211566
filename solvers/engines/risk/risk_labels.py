"""Risk labels: risky paths by labels with memory, exact for every risk element."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar

from ....formulations.problem import Problem
from ....formulations.risk.risky_path import RiskyPath, unreachable
from ...backend import BACKENDS, Control, Engine, Options, RawResult
from .risky_path_steps.least_hazard import least_hazard
from .risky_path_steps.most_reward import most_reward

FEATURES = frozenset(
    {"objective:risk", "objective:hazard", "objective:reward-per-risk", "goals", "any-end", "locale-risk", "action-risk", "traverse-risk"}
)


@BACKENDS.register("risk-labels")
class RiskLabels(Engine):
    """Labels of moves with memory: least risk, or most reward per risk. ``iterations`` counts labels; time and memory can grow
    exponentially with the states that paths would repeat, and for rewards with all states."""

    name = "risk-labels"
    package = "scipy"
    modules = ("scipy",)
    summary = "risky paths by labels with memory, exact for traverse risks"
    interrupts = "keeps the best path"
    one_thread = True
    honours = frozenset({"iterations"})
    options: ClassVar[Mapping[str, Any]] = {}
    order = 5
    family = "risky-path"
    features = FEATURES

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        """See ``Engine.run``."""
        stop = self.begin(problem, options, control)
        assert isinstance(problem, RiskyPath)
        if problem.objective == "reward-per-risk":
            return most_reward(problem, stop, options, control)
        found = least_hazard(problem, problem.graph.goals, stop, labels=options.iterations)
        bound = found.hazard if problem.objective == "hazard" else -math.expm1(-found.hazard)
        statistics = {"labels": found.labels, "guarded_states": len(found.guarded)}
        if found.path is not None:
            evidence = (found.evidence(),) if found.labels else (problem.moves.evidence(bound),)
            return RawResult("optimal", "none", found.path, bound, bound, statistics=statistics, evidence=evidence)
        if found.limit == "none":
            proof = unreachable(problem) or found.evidence()
            message = "no goal can be reached at a risk below 1"
            return RawResult("infeasible", statistics=statistics, message=message, evidence=(proof,))
        return RawResult("unknown", found.limit, None, None, bound, statistics=statistics)
