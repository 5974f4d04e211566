"""Two-stage: the best reward per risk among the least risky paths to all states."""

import numpy as np

from ...formulations.evidence import Guarantee
from ...formulations.risk.marked_paths import CutShortError, risky_path
from ...formulations.risk.risky_path import Path, RiskyPath
from ...formulations.stop import Stop, Stopped
from ..heuristic import Context, Outcome, heuristic
from .look_back import exact_for, least_risky_paths

SOURCE = "Xiao (2019), algorithm 3; the ratio: docs/formulations/risky-path.md#two-stages"


@heuristic(
    "two-stage", "risky-path", {"objective:reward-per-risk", "goals", "any-end", "locale-risk", "action-risk", "traverse-risk"},
    "best reward per risk among the least risky paths to all states",
    "all rewards over the least on a least risky path to one (1 where the last alone counts), without traverse risks",
)  # fmt: skip
def run(problem: RiskyPath, context: Context, *, steps: int = 2) -> Outcome:
    """The candidates of look-back, the start alone among them, compared by reward per risk.

    A guarantee holds where risks are of locale and action elements alone and no walk of least risk comes to a state twice: the optimum
    where the last reward alone counts; where all count and the end is free, the total reward over the least that is collected on the way to
    any state with one. ``steps`` is that of look-back.
    """
    stop = context.begin()
    try:
        paths, looped = least_risky_paths(problem, steps, stop)
    except Stopped:
        alone = (problem.graph.start,)
        answer = alone if problem.evaluate(alone).feasible else None
        return Outcome(answer, message="cut short before any other state was reached", limit=stop.reached() or "none")
    ends = problem.graph.goals or tuple(range(problem.graph.num_states))
    judged = [(problem.evaluate(paths[end]), paths[end]) for end in ends if end in paths]
    able = [(verdict.values[0], path) for verdict, path in judged if verdict.feasible]
    if not able:
        return _any_ratio(problem, stop)
    value, best = max(able, key=lambda pair: pair[0])
    statistics = {"steps": steps, "candidates": len(able), "walks_with_loops": len(looped)}
    return Outcome(best, _guarantee(problem, steps, paths, looped, value), statistics=statistics)


def _any_ratio(problem: RiskyPath, stop: Stop) -> Outcome:
    """Some path with a risk, where the least risky ones have none, and so no ratio."""
    try:
        path = risky_path(problem, stop)
    except CutShortError as cut:
        return Outcome(None, message="no least risky path has a risk, so that none has a ratio", limit=str(cut))
    return Outcome(path, message="" if path is not None else "no path may end where it has a risk between 0 and 1")


def _guarantee(problem: RiskyPath, steps: int, paths: dict[int, Path], looped: frozenset[int], value: float) -> Guarantee | None:
    """Guarantee of the best of ``paths``; None where none holds.

    A best path may end where it collects its last reward. Its risk is at least that of the least risky path there, so its ratio is at most
    its reward, all there is, over what that path collects, times the ratio of that path.
    """
    graph = problem.graph
    rewarding = [state for state in np.nonzero(problem.rewards)[0].tolist() if state in paths and state != graph.start]
    assumptions = (*exact_for(problem, steps), "no walk of least risk comes to a state twice")
    if looped or len(assumptions) == 1 or value <= 0.0:
        return None
    if graph.discount == 0.0:
        return Guarantee(1.0, "most reward per risk", (*assumptions, "the last reward alone counts"), SOURCE)
    if graph.discount < 1.0 or graph.goals or not rewarding:
        return None
    collected = min(float(problem.rewards[list(paths[state][1:])].sum()) for state in rewarding)
    ratio = max(1.0, float(problem.rewards[rewarding].sum()) / collected)
    statement = "OPT / U <= reward of a best path / reward on the least risky path to its end"
    return Guarantee(ratio, statement, (*assumptions, "all rewards count in full", "a path may end anywhere"), SOURCE)
