"""Look-back: the source's approximate planner of least risk, one label for the last states of a path."""

from __future__ import annotations

import math

from ...formulations.evidence import Guarantee
from ...formulations.risk.risky_path import Path, RiskyPath
from ...formulations.stop import Stop, Stopped
from ...instances.errors import UsageError
from ...solvers.engines.risk.risky_path_steps.look_back import look_back, without_loops
from ..heuristic import HEURISTICS, Context, Heuristic, Outcome

SOURCE = "Xiao (2019), section 4.2.2.1, as Dijkstra's algorithm on moves"

MOST_STEPS = 8


def least_risky_paths(problem: RiskyPath, steps: int, stop: Stop) -> tuple[dict[int, Path], frozenset[int]]:
    """A path without repetition to each state that look-back reaches, and the states to which the walk it found was none.

    These get the better of the walk without its loops and of what a search that refuses repetition finds.
    """
    check_steps(steps)
    if steps == 2 and not problem.graph.traverse:
        reach = problem.moves.to_states()
        walks = {state: problem.moves.walk(state) for state in range(problem.graph.num_states) if math.isfinite(reach[state])}
        found = {state: walk for state, walk in walks.items() if walk is not None}
    else:
        found = {state: walk for state, (_, walk) in look_back(problem, steps, stop).items()}
    looped = frozenset(state for state, walk in found.items() if len(set(walk)) < len(walk))
    refused = look_back(problem, steps, stop, revisits=False) if looped else {}
    for state in looped:
        choices = [without_loops(found[state]), *([refused[state][1]] if state in refused else [])]
        found[state] = min(choices, key=lambda path: risk_of(problem, path))
    return found, looped


def risk_of(problem: RiskyPath, path: Path) -> float:
    """The risk of a path, by the problem's own count."""
    return problem.evaluate(path).quantities["risk"]


def check_steps(steps: int) -> None:
    """Raise UsageError unless labels of so many states are searched."""
    if not 1 <= steps <= MOST_STEPS:
        raise UsageError(f"steps must be a whole number from 1 to {MOST_STEPS}, not {steps!r}")


def exact_for(problem: RiskyPath, steps: int) -> tuple[str, ...]:
    """Why walks found with so many states to a label are least risky; empty where they need not be."""
    categories = {element.category for element in problem.graph.elements}
    if "traverse" in categories or (steps == 1 and "action" in categories):
        return ()
    return ("no traverse risks",) if steps > 1 else ("no traverse or action risks",)


def run(problem: RiskyPath, context: Context, *, steps: int = 2) -> Outcome:
    """The least risky of the labels at a goal.

    Parameters
    ----------
    problem : RiskyPath
        Of least risk or hazard.
    context : Context
    steps : int
        States that a label tells apart, from 1 (Dijkstra's algorithm, one label a state) to 8; 2 is the source's planner.

    Returns
    -------
    Outcome
        A path. It is least risky, and guaranteed to be, where no element is of category traverse (with 1 step: nor action) and the walk
        found comes to no state twice. Where it does, the walk without its loops, or what a search finds that refuses loops.

    Raises
    ------
    UsageError
        If ``steps`` is out of range.
    """
    stop = context.begin()
    try:
        paths, looped = least_risky_paths(problem, steps, stop)
    except Stopped:
        return Outcome(None, message="cut short before the goal was reached", limit=stop.reached() or "none")
    ends = [goal for goal in problem.graph.goals if goal in paths]
    if not ends:
        return Outcome(None, message="no goal was reached")
    best = min((paths[goal] for goal in ends), key=lambda path: risk_of(problem, path))
    statistics = {"steps": steps, "walks_with_loops": len(looped)}
    message = "" if not looped.intersection(ends) else "a walk of least risk comes to a state twice, and is no answer"
    reasons = exact_for(problem, steps)
    if not reasons or looped.intersection(ends):
        return Outcome(best, statistics=statistics, message=message)
    guarantee = Guarantee(1.0, "least risk", (*reasons, "the walks found come to no state twice"), SOURCE)
    return Outcome(best, guarantee, (problem.moves.evidence(0.0),), statistics)


HEURISTICS.add(
    "look-back",
    Heuristic(
        name="look-back",
        families=("risky-path",),
        features=frozenset({"objective:risk", "objective:hazard", "goals", "locale-risk", "action-risk", "traverse-risk"}),
        run=run,
        summary="one label for the last states of a path: the approximate planner of risk-aware paths",
        stated="least risk, without traverse risks and where no walk is less risky than all paths",
    ),
)
