"""Engines of risky paths, exact for every risk element: ``risk-labels`` and ``path-enumeration``."""

import math

from ....formulations.problem import Problem
from ....formulations.risk.moves import Memories
from ....formulations.risk.risky_path import Path, RiskyPath, unreachable
from ....formulations.stop import Stop
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
    summary = "risky paths by labels with memory, exact for traverse risks"
    interrupts = "keeps the best path"
    one_thread = True
    honours = frozenset({"iterations"})
    order = 5
    family = "risky-path"
    features = FEATURES

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        stop = self.begin(problem, options, control)
        assert isinstance(problem, RiskyPath)
        if problem.objective == "reward-per-risk":
            return most_reward(problem, stop, options, control)
        search = least_hazard(problem, problem.graph.goals, stop, labels=options.iterations)
        bound = search.hazard if problem.objective == "hazard" else -math.expm1(-search.hazard)
        statistics = {"labels": search.labels, "guarded_states": len(search.guarded)}
        if search.path is not None:
            evidence = (search.evidence(),) if search.labels else (problem.moves.evidence(bound),)
            return RawResult("optimal", "none", search.path, bound, bound, statistics=statistics, evidence=evidence)
        if search.limit == "none":
            proof = unreachable(problem) or search.evidence()
            message = "no goal can be reached at a risk below 1"
            return RawResult("infeasible", statistics=statistics, message=message, evidence=(proof,))
        return RawResult("unknown", search.limit, None, None, bound, statistics=statistics)


LOOK = 1024
"""Paths between two looks at the clock."""


@BACKENDS.register("path-enumeration")
class PathEnumeration(Engine):
    """Depth first, survival and reward carried on from move to move. The number of paths is exponential in the states: 78 on a grid of
    3 x 3, 2110 of 4 x 4, 10^11 of 8 x 8. ``iterations`` counts paths.

    Source: Xiao (2019), algorithm 1, with the start as a path of its own and rewards carried on instead of undone, which divides by the
    discount; docs/formulations/risky-path.md#enumeration.
    """

    name = "path-enumeration"
    package = "scipy"
    summary = "every path without repetition: exact, exponential, for small graphs"
    interrupts = "keeps the best path"
    one_thread = True
    honours = frozenset({"iterations"})
    order = 200
    family = "risky-path"
    features = FEATURES

    def run(self, problem: Problem, options: Options, control: Control) -> RawResult:
        stop = self.begin(problem, options, control)
        assert isinstance(problem, RiskyPath)
        best, value, paths, limit = _enumerate(problem, stop, options.iterations, control)
        statistics = {"paths": paths}
        if best is None:
            status = "infeasible" if limit == "none" else "unknown"
            return RawResult(status, limit, statistics=statistics, message="no path reaches an end alive" if limit == "none" else "")
        if limit != "none":
            return RawResult("feasible", limit, best, value, statistics=statistics)
        return RawResult("optimal", limit, best, value, value, statistics=statistics)


def _enumerate(problem: RiskyPath, stop: Stop, most: int | None, control: Control) -> tuple[Path | None, float, int, str]:
    """Best path, its value, the number of paths walked, and the limit that ended it."""
    graph, moves, memories = problem.graph, problem.moves, Memories(problem.graph)
    head, rewards, begin = graph.head.tolist(), problem.rewards.tolist(), len(graph.tail)
    ratio, ends = problem.objective == "reward-per-risk", frozenset(graph.goals)
    best: Path | None = None
    value, paths = -math.inf if ratio else math.inf, 0
    # path, hazard, reward, last move, memory
    ahead: list[tuple[Path, float, float, int, int]] = [((graph.start,), moves.start_hazard, rewards[graph.start], begin, memories.begin)]
    while ahead:
        path, hazard, reward, move, memory = ahead.pop()
        paths += 1
        if paths % LOOK == 0 and (limit := stop.reached()):
            return best, value, paths, limit
        if most is not None and paths > most:
            return best, value, paths - 1, "iterations"
        if hazard < math.inf and (not ends or path[-1] in ends):
            risk = -math.expm1(-hazard)
            worth = (reward / risk if risk > 0.0 else -math.inf) if ratio else hazard if problem.objective == "hazard" else risk
            if worth > value if ratio else worth < value:
                best, value = path, worth
                control.publish(path, value)
        longer = []
        for after, own in zip(*moves.successors[move], strict=True):
            reached = head[after]
            if reached not in path:
                carried, more = memories.step(memory, path[-1], reached) if memories.elements else (memory, 0.0)
                if hazard + own + more < math.inf:
                    kept = graph.discount * reward if len(path) > 1 else 0.0
                    longer.append(((*path, reached), hazard + own + more, kept + rewards[reached], after, carried))
        ahead.extend(reversed(longer))
    return best, value, paths, "none"
