"""Look-back: Dijkstra's search with one label for the last few states of a path, the source's approximate planner of least risk.

A label is priced by its own path, traverse elements included, so that these are seen and still not searched for: what a worse beginning
would save later is lost. Walks may come to a state twice, unless that is refused, which is no remedy: it can miss the best path. Source:
Xiao (2019), section 4.2.2.1, with the start's risk counted and ties broken by the fewest moves; docs/formulations/risky-path.md#look-back.
"""

import heapq
import itertools
import math
from dataclasses import dataclass

import numpy as np

from ...formulations.evidence import Guarantee
from ...formulations.risk.moves import Memories
from ...formulations.risk.risky_path import Path, RiskyPath
from ...formulations.stop import Stop, Stopped
from ...instances.errors import UsageError
from ..heuristic import Context, Outcome, heuristic

LOOK = 256


@dataclass
class _Label:
    hazard: float
    count: int
    move: int
    memory: int
    before: "_Label | None"


def look_back(problem: RiskyPath, steps: int, stop: Stop, *, revisits: bool = True) -> dict[int, tuple[float, Path]]:
    """Hazard and walk of the best label of each state that has one, the start included; raises Stopped before all labels are closed.

    A label tells the last ``steps`` states apart. ``revisits`` says whether walks may come to a state twice, other than straight back.
    """
    graph, moves, memories = problem.graph, problem.moves, Memories(problem.graph)
    head, begin, serial = graph.head.tolist(), len(graph.tail), itertools.count()

    def path_of(label: _Label | None) -> Path:
        states: list[int] = []
        while label is not None:
            states.append(graph.start if label.move == begin else head[label.move])
            label = label.before
        return tuple(reversed(states))

    first = _Label(moves.start_hazard, 0, begin, memories.begin, None)
    best: dict[Path, tuple[float, int]] = {(graph.start,): (first.hazard, 0)}
    heap: list[tuple[float, int, int, Path, _Label]] = [(first.hazard, 0, next(serial), (graph.start,), first)]
    closed: set[Path] = set()
    best_of_state: dict[int, tuple[float, Path]] = {}
    while heap:
        hazard, count, _, key, label = heapq.heappop(heap)
        if key in closed or hazard == math.inf:
            continue
        closed.add(key)
        if len(closed) % LOOK == 0 and stop.reached():
            raise Stopped
        path = path_of(label) if key[-1] not in best_of_state or not revisits else ()
        best_of_state.setdefault(key[-1], (hazard, path))
        for after, own in zip(*moves.successors[label.move], strict=True):
            reached = head[after]
            if not revisits and reached in path:
                continue
            carried, more = memories.step(label.memory, key[-1], reached) if memories.elements else (label.memory, 0.0)
            longer, priced = (*key, reached)[-steps:], (hazard + own + more, count + 1)
            if longer not in closed and priced < best.get(longer, (math.inf, 0)):
                best[longer] = priced
                heapq.heappush(heap, (*priced, next(serial), longer, _Label(*priced, after, carried, label)))
    return best_of_state


def without_loops(walk: Path) -> Path:
    """``walk`` with every way from a state back to it left out, the first one first."""
    kept: list[int] = []
    for state in walk:
        if state in kept:
            del kept[kept.index(state) :]
        kept.append(state)
    return tuple(kept)


SOURCE = "Xiao (2019), section 4.2.2.1, as Dijkstra's algorithm on moves"

MOST_STEPS = 8


def least_risky_paths(problem: RiskyPath, steps: int, stop: Stop) -> tuple[dict[int, Path], frozenset[int]]:
    """A path without repetition to each state that look-back reaches, and the states whose walk repeats one.

    These get the better of the walk without its loops and of what a search that refuses repetition comes to.
    """
    check_steps(steps)
    if steps == 2 and not problem.graph.traverse:
        reach = problem.moves.to_states()
        reached = np.nonzero(np.isfinite(reach))[0].tolist()
        walks = {state: walk for state in reached if (walk := problem.moves.walk(state)) is not None}
    else:
        walks = {state: walk for state, (_, walk) in look_back(problem, steps, stop).items()}
    looped = frozenset(state for state, walk in walks.items() if len(set(walk)) < len(walk))
    refused = look_back(problem, steps, stop, revisits=False) if looped else {}
    for state in looped:
        choices = [without_loops(walks[state]), *([refused[state][1]] if state in refused else [])]
        walks[state] = min(choices, key=lambda path: risk_of(problem, path))
    return walks, looped


def risk_of(problem: RiskyPath, path: Path) -> float:
    """The risk of a path, by the problem's own count."""
    return problem.evaluate(path).quantities["risk"]


def check_steps(steps: int) -> None:
    """Raise UsageError unless ``steps`` is from 1 to ``MOST_STEPS``."""
    if not 1 <= steps <= MOST_STEPS:
        raise UsageError(f"steps must be a whole number from 1 to {MOST_STEPS}, not {steps!r}", "out-of-range")


def exact_for(problem: RiskyPath, steps: int) -> tuple[str, ...]:
    """Why walks with ``steps`` states to a label are least risky; empty where they need not be."""
    categories = {element.category for element in problem.graph.elements}
    if "traverse" in categories or (steps == 1 and "action" in categories):
        return ()
    return ("no traverse risks",) if steps > 1 else ("no traverse or action risks",)


@heuristic(
    "look-back", "risky-path", {"objective:risk", "objective:hazard", "goals", "locale-risk", "action-risk", "traverse-risk"},
    "one label for the last states of a path: the approximate planner of risk-aware paths",
    "least risk, without traverse risks and where no walk is less risky than all paths",
)  # fmt: skip
def run(problem: RiskyPath, context: Context, *, steps: int = 2) -> Outcome:
    """The least risky of the labels at a goal.

    ``steps`` is the number of states that a label tells apart, from 1 (Dijkstra's algorithm, one label per state) to 8; 2 is the source's
    planner. The path is least risky, and guaranteed to be, where no element is of category traverse (with 1 step: nor action) and the walk
    comes to no state twice. Where it does, it is the walk without its loops, or what a search reaches that refuses loops.
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
