"""Heuristic ``distributed-sampling``: tasks move one by one from the dearest part to the cheapest."""

from dataclasses import dataclass

import numpy as np

from ...formulations.auctions.balanced_partition import EDGES, OBJECTIVES, BalancedPartition, Parts
from ...formulations.stop import NEVER, Stop
from ...instances.errors import UsageError
from ..heuristic import Context, Outcome, heuristic


@heuristic(
    "distributed-sampling",
    "balanced-partition",
    {*(f"objective:{objective}" for objective in OBJECTIVES), *(f"edges:{edges}" for edges in EDGES)},
    "tasks move one by one from the dearest part to the cheapest",
)
def distributed_sampling(
    problem: BalancedPartition, context: Context, *, initial: str = "nearest", most_moves: int | None = None
) -> Outcome:
    """Move the task from the dearest part to the cheapest that leaves them nearest to each other, until no move brings them nearer.

    ``initial`` is the partition to begin with where no start is given: ``nearest``, each task with the nearest robot, or ``first``, all in
    the first part. ``most_moves`` is by default ten for each task and robot. There is no guarantee. It ends by itself: with every move the
    costs of all parts, the largest first, come down in lexicographic order, or where the difference of two parts is the objective, that
    difference.

    Source: Zhang (2015), algorithm 2, repaired: differences without their sign, until nothing moves, never back
    (docs/formulations/balanced-partition.md#errata).
    """
    if initial not in ("nearest", "first"):
        raise UsageError(f"initial must be nearest or first, not {initial!r}", "unknown-name")
    if most_moves is not None and (isinstance(most_moves, bool) or not isinstance(most_moves, int) or most_moves < 0):
        raise UsageError(f"most_moves must be a whole number from 0 on, not {most_moves!r}", "out-of-range")
    stop = context.begin()
    start = _initial(problem, initial) if context.start is None else context.start
    most = 10 * problem.num_tasks * problem.num_robots if most_moves is None else most_moves
    guarded = problem.num_robots > 2 or problem.objective == "min-max"  # of two parts the difference falls with every move
    descent = single_moves(problem, start, most, stop, guarded=guarded)
    limit = descent.ended if descent.ended in ("time", "interrupt") else "none"
    return Outcome(descent.parts, statistics={"moves": len(descent.moves), "ended": descent.ended}, limit=limit)


def _initial(problem: BalancedPartition, initial: str) -> Parts:
    nearest = problem.instance.starts.argmin(axis=0).tolist() if initial == "nearest" else [0] * problem.num_tasks
    return tuple(tuple(task for task, own in enumerate(nearest) if own == robot) for robot in range(problem.num_robots))


SAME = 1e-12
"""Share of the total by which costs may differ and still count as equal."""


@dataclass(frozen=True)
class Descent:
    """A local search's final partition, its moves (task, from, to), and how it ended.

    ``ended`` is ``balanced`` (all parts cost the same), ``local`` (no move is accepted), ``cycle`` (a partition came back), or what cut it
    short: ``moves``, ``time``, ``interrupt``.
    """

    parts: Parts
    moves: tuple[tuple[int, int, int], ...]
    ended: str


def single_moves(
    problem: BalancedPartition, parts: Parts, most: int, stop: Stop = NEVER, *, signed: bool = False, guarded: bool = True
) -> Descent:
    """Move one task after the other, at most ``most`` times; the first of equal ones.

    With ``signed`` differences are compared with their sign, as the source prints it: the smallest, however far below zero. With
    ``guarded`` a move is accepted only if the costs, the largest first, come down in lexicographic order, so that no partition can come
    back.

    Source: Zhang (2015), algorithm 2, after Kim and Shell (2014); docs/formulations/balanced-partition.md#distributed-sampling.
    """
    from ...solvers.engines.auctions.task_subset_steps.part_kernels import CLIQUE, NONE, TREE, part_cost

    weights, between = np.array(problem.weights), np.array(problem.instance.between)
    kind = {"none": NONE, "clique": CLIQUE, "mst": TREE}[problem.edges]

    def cost(part: list[int]) -> float:
        return float(part_cost(weights, between, np.array(part, dtype=np.int64), kind))

    now = [sorted(part) for part in parts]
    costs = [cost(part) for part in now]
    tolerance = SAME * (float(np.abs(weights).sum()) + float(between.max(initial=0.0)) * len(weights))
    moves: list[tuple[int, int, int]] = []
    seen = {_tuples(now)}

    def ended(how: str) -> Descent:
        return Descent(_tuples(now), tuple(moves), how)

    while len(costs) > 1:
        high = max(range(len(now)), key=lambda k: (costs[k], -k))
        low = min((k for k in range(len(now)) if k != high), key=lambda k: (costs[k], k))
        apart = costs[high] - costs[low]
        if apart <= tolerance:
            return ended("balanced")
        if len(moves) >= most or stop.reached():
            return ended(stop.reached() or "moves")
        offers = []
        for task in now[high]:
            if stop.reached():
                return ended(stop.reached())
            less, more = cost([t for t in now[high] if t != task]), cost([*now[low], task])
            change = less - more if signed else abs(less - more)
            if change < apart - tolerance:
                offers.append((change, task, less, more))
        chosen = next((offer for offer in sorted(offers) if not guarded or _comes_down(costs, high, low, *offer[2:], tolerance)), None)
        if chosen is None:
            return ended("local")
        _, task, costs[high], costs[low] = chosen
        now[high].remove(task)
        now[low] = sorted([*now[low], task])
        moves.append((task, high, low))
        if _tuples(now) in seen:
            return ended("cycle")
        seen.add(_tuples(now))
    return ended("balanced")


def _comes_down(costs: list[float], high: int, low: int, less: float, more: float, tolerance: float) -> bool:
    """Whether the costs, the largest first, come down in lexicographic order when two of them change."""
    after = [less if k == high else more if k == low else cost for k, cost in enumerate(costs)]
    for new, old in zip(sorted(after, reverse=True), sorted(costs, reverse=True), strict=True):
        if abs(new - old) > tolerance:
            return new < old
    return False


def _tuples(parts: list[list[int]]) -> Parts:
    return tuple(tuple(part) for part in parts)
