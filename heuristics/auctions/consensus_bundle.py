"""Heuristic ``consensus-bundle``: consensus-based bundles (CBBA), an auction without an auctioneer over a communication graph."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...formulations.auctions.task_allocation import Paths, TaskAllocation
from ...formulations.stop import Stop
from ...instances.errors import UsageError
from ..heuristic import Context, Outcome, heuristic
from .auction_steps.consensus import Consensus, consensus
from .auction_steps.task_paths import ANY_OBJECTIVE, CUT_SHORT, arrays_of, completed

GRAPHS = ("complete", "ring", "line", "star")


@heuristic(
    "consensus-bundle",
    "task-allocation",
    ANY_OBJECTIVE,
    "consensus-based bundle algorithm (CBBA): an auction without an auctioneer, over a communication graph",
)
def consensus_bundle(problem: TaskAllocation, context: Context, *, communication: str = "complete", most: int | None = None) -> Outcome:
    """Robots fill bundles by what a task adds to their path, tell their neighbours, and give up what others do for less.

    ``communication`` says who hears whom, in the order of the robots: ``complete``, ``ring``, ``line``, or ``star`` around the first.
    ``most`` limits the tasks in a robot's bundle; what nobody has room for is inserted where it is cheapest afterwards. There is no
    guarantee: half of the optimum holds for gains that diminish as a bundle grows, and what a task adds to a path need not.

    Source: Choi, Brunet, How (2009), Consensus-based decentralized auctions for robust task allocation;
    docs/formulations/task-allocation.md#consensus-based-bundles.
    """
    if communication not in GRAPHS:
        raise UsageError(f"communication must be {', '.join(GRAPHS)}, not {communication!r}")
    if most is not None and (isinstance(most, bool) or not isinstance(most, int) or most < 1):
        raise UsageError(f"most must be a whole number of at least 1, not {most!r}")
    stop = context.begin()
    found = _agree(problem, communication, most, stop)
    paths = found.paths
    statistics = {"rounds": found.rounds, "messages": found.messages}
    if stop.reached():
        return Outcome(completed(problem, _once(paths)), statistics=statistics, message=CUT_SHORT, limit=stop.reached())
    left = problem.num_tasks - len({task for path in paths for task in path})
    message = "" if found.agreed else "the robots did not agree; who comes first keeps a task"
    if left:
        message = "; ".join(part for part in (message, f"{left} tasks that nobody had room for were inserted where they add least") if part)
    return Outcome(_inserted(problem, _once(paths), stop), statistics=statistics, message=message)


def graph_of(communication: str, robots: int) -> NDArray[np.bool_]:
    """Who hears whom, shape (robots, robots)."""
    number = np.arange(robots)
    apart = np.abs(number[:, None] - number)
    if communication == "complete":
        heard = apart > 0
    elif communication == "star":
        heard = (apart > 0) & ((number[:, None] == 0) | (number == 0))
    else:
        heard = (apart == 1) | ((apart == robots - 1) & (robots > 1) & (communication == "ring"))
    return np.asarray(heard)


def _agree(problem: TaskAllocation, communication: str, most: int | None, stop: Stop) -> Consensus:
    from .auction_steps.bidding_kernels import insertions

    starts, between = arrays_of(problem)
    waiting, largest = problem.objective == "mini-ave", problem.objective == "mini-max"

    def gains(robot: int, path: tuple[int, ...]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        added, place = insertions(stop.flag, starts[robot], between, np.array(path, dtype=np.int64), waiting)
        return -(added + float(problem.legs(robot, path).sum())) if largest else -added, place

    return consensus(gains, problem.num_tasks, graph_of(communication, problem.num_robots), stop, most)


def _once(paths: Paths) -> Paths:
    """The paths without the second mention of a task."""
    seen: set[int] = set()
    kept = []
    for path in paths:
        kept.append(tuple(task for task in path if task not in seen))
        seen.update(path)
    return tuple(kept)


def _inserted(problem: TaskAllocation, paths: Paths, stop: Stop) -> Paths:
    """The paths with missing tasks inserted, one after the other, where each adds least."""
    from .auction_steps.bidding_kernels import insertions

    starts, between = arrays_of(problem)
    made = [list(path) for path in paths]
    for task in sorted(set(range(problem.num_tasks)) - {task for path in paths for task in path}):
        ways = [insertions(stop.flag, starts[r], between, np.array(path, np.int64), False) for r, path in enumerate(made)]
        robot = min(range(len(made)), key=lambda r: float(ways[r][0][task]))
        made[robot].insert(int(ways[robot][1][task]), task)
    return tuple(tuple(path) for path in made)
