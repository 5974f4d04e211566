"""Moves of single tasks from the dearest part to the cheapest, while that brings the two nearer to each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ....formulations.auctions.balanced_partition import BalancedPartition, Parts
from ....formulations.stop import NEVER, Stop

SAME = 1e-12
"""Part of what is added up by which costs may differ and count as equal."""


@dataclass(frozen=True)
class Descent:
    """What a local search did.

    Parameters
    ----------
    parts : tuple of tuples of int
        At its end.
    moves : tuple of (task, from, to)
    ended : str
        ``balanced`` (all parts cost the same), ``local`` (no move is accepted), ``cycle`` (a partition came back), or what cut it short:
        ``moves``, ``time``, ``interrupt``.
    """

    parts: Parts
    moves: tuple[tuple[int, int, int], ...]
    ended: str


def single_moves(
    problem: BalancedPartition, parts: Parts, most: int, stop: Stop = NEVER, *, signed: bool = False, guarded: bool = True
) -> Descent:
    """Move one task after the other; the first of equal ones.

    Parameters
    ----------
    problem : BalancedPartition
    parts : tuple of tuples of int
        To begin with.
    most : int
        Moves at most.
    stop : Stop
    signed : bool
        Compare differences with their sign, as the source prints it: the smallest, however far below zero.
    guarded : bool
        Accept a move only where the costs, the largest first, come down in lexicographic order: no partition can come back.

    Notes
    -----
    Source: Zhang (2015), algorithm 2, after Kim and Shell (2014); docs/formulations/balanced-partition.md#distributed-sampling.
    """
    from ....solvers.engines.auctions.task_subset_steps.part_kernels import CLIQUE, NONE, TREE, part_cost

    weights, between = np.array(problem.weights), np.array(problem.instance.between)
    kind = {"none": NONE, "clique": CLIQUE, "mst": TREE}[problem.edges]

    def cost(part: list[int]) -> float:
        return float(part_cost(weights, between, np.array(part, dtype=np.int64), kind))

    now = [sorted(part) for part in parts]
    costs = [cost(part) for part in now]
    tolerance = SAME * (float(np.abs(weights).sum()) + float(between.max(initial=0.0)) * len(weights))
    moves: list[tuple[int, int, int]] = []
    seen = {_state(now)}
    while len(costs) > 1:
        high = max(range(len(now)), key=lambda k: (costs[k], -k))
        low = min((k for k in range(len(now)) if k != high), key=lambda k: (costs[k], k))
        apart = costs[high] - costs[low]
        if apart <= tolerance:
            return Descent(_tuples(now), tuple(moves), "balanced")
        if len(moves) >= most or stop.reached():
            return Descent(_tuples(now), tuple(moves), stop.reached() or "moves")
        offers = []
        for task in now[high]:
            if stop.reached():
                return Descent(_tuples(now), tuple(moves), stop.reached())
            less, more = cost([t for t in now[high] if t != task]), cost([*now[low], task])
            change = less - more if signed else abs(less - more)
            if change < apart - tolerance:
                offers.append((change, task, less, more))
        chosen = next((offer for offer in sorted(offers) if not guarded or _comes_down(costs, high, low, *offer[2:], tolerance)), None)
        if chosen is None:
            return Descent(_tuples(now), tuple(moves), "local")
        _, task, costs[high], costs[low] = chosen
        now[high].remove(task)
        now[low] = sorted([*now[low], task])
        moves.append((task, high, low))
        if _state(now) in seen:
            return Descent(_tuples(now), tuple(moves), "cycle")
        seen.add(_state(now))
    return Descent(_tuples(now), (), "balanced")


def _comes_down(costs: list[float], high: int, low: int, less: float, more: float, tolerance: float) -> bool:
    """Whether the costs, the largest first, come down with two of them changed."""
    after = [less if k == high else more if k == low else cost for k, cost in enumerate(costs)]
    for new, old in zip(sorted(after, reverse=True), sorted(costs, reverse=True), strict=True):
        if abs(new - old) > tolerance:
            return new < old
    return False


def _state(parts: list[list[int]]) -> tuple[tuple[int, ...], ...]:
    return tuple(tuple(part) for part in parts)


def _tuples(parts: list[list[int]]) -> Parts:
    return tuple(tuple(part) for part in parts)
