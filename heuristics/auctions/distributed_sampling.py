"""Distributed sampling: tasks move one by one from the dearest part to the cheapest."""

from __future__ import annotations

from ...formulations.auctions.balanced_partition import EDGES, OBJECTIVES, BalancedPartition, Parts
from ...instances.errors import UsageError
from ..heuristic import HEURISTICS, Context, Heuristic, Outcome
from .partition_steps.single_moves import single_moves


def distributed_sampling(
    problem: BalancedPartition, context: Context, *, initial: str = "nearest", most_moves: int | None = None
) -> Outcome:
    """From the dearest part to the cheapest moves the task that leaves them nearest to each other, until none brings them nearer.

    Parameters
    ----------
    problem : BalancedPartition
    context : Context
        ``start`` stands instead of ``initial`` where it is given.
    initial : str
        ``nearest``: each task in the part of the robot that stands nearest, the first of equal ones. ``first``: all in the first part.
    most_moves : int, optional
        By default ten for each task and robot.

    Returns
    -------
    Outcome
        No guarantee. It ends by itself: the costs of all parts, the largest first, come down in lexicographic order with every move, or,
        where the difference of two parts is the objective, that difference.

    Raises
    ------
    UsageError
        For another initial partition, or a number of moves below 0.

    Notes
    -----
    Source: Zhang (2015), algorithm 2, repaired: differences without their sign, until nothing moves, never back
    (docs/formulations/balanced-partition.md#errata).
    """
    if initial not in ("nearest", "first"):
        raise UsageError(f"initial must be nearest or first, not {initial!r}")
    if most_moves is not None and (isinstance(most_moves, bool) or not isinstance(most_moves, int) or most_moves < 0):
        raise UsageError(f"most_moves must be a whole number from 0 on, not {most_moves!r}")
    stop = context.begin()
    start = _initial(problem, initial) if context.start is None else context.start
    most = 10 * problem.num_tasks * problem.num_robots if most_moves is None else most_moves
    guarded = problem.num_robots > 2 or problem.objective == "min-max"  # of two parts the difference falls with every move
    found = single_moves(problem, start, most, stop, guarded=guarded)
    limit = found.ended if found.ended in ("time", "interrupt") else "none"
    return Outcome(found.parts, statistics={"moves": len(found.moves), "ended": found.ended}, limit=limit)


def _initial(problem: BalancedPartition, initial: str) -> Parts:
    nearest = problem.instance.starts.argmin(axis=0).tolist() if initial == "nearest" else [0] * problem.num_tasks
    return tuple(tuple(task for task, own in enumerate(nearest) if own == robot) for robot in range(problem.num_robots))


HEURISTICS.add(
    "distributed-sampling",
    Heuristic(
        name="distributed-sampling",
        families=("balanced-partition",),
        features=frozenset({*(f"objective:{objective}" for objective in OBJECTIVES), *(f"edges:{edges}" for edges in EDGES)}),
        run=distributed_sampling,
        summary="tasks move one by one from the dearest part to the cheapest",
    ),
)
