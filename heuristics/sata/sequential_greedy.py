"""Sequential greedy: one group after the other picks what adds most to what the ones before it have picked."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...formulations.evidence import Guarantee
from ...formulations.sata.submodular_selection import SubmodularSelection
from ...formulations.stop import Stop
from ...instances.errors import UsageError
from ...solvers.bounds.sata.growing_sets import empty_set
from ..heuristic import CUT_SHORT, Context, Outcome, heuristic
from .greedy_steps.limits import ANY_FUNCTION, Limits
from .greedy_steps.outcomes import FNW, assumptions, concluded, sentences

SOURCE = f"{FNW}; for winner takes all Sung (2019), Multi-Robot Coordination for Hazardous Environmental Monitoring, theorem 2"


@heuristic(
    "sequential-greedy", "selection", ANY_FUNCTION | {"constraint:partition"},
    "robot after robot (group after group) takes its best action; each is asked once",
    "1/2 for any order under a partition matroid, for monotone submodular functions (winner takes all is one)",
)  # fmt: skip
def sequential_greedy(problem: SubmodularSelection, context: Context, *, order: Sequence[int | str] | str | None = None) -> Outcome:
    """Each robot in its turn takes the action of largest gain over the actions taken so far, the first of equal ones.

    For partition matroids: the groups are the robots, and one with room for several elements picks them one after the other. ``order``
    holds all groups, each once, by number from 0 or by name (text separated by commas counts as names); by default as numbered. Guaranteed
    half of the optimum, whatever the order. The statistics count one communication round a robot: each tells the next what every target has
    got so far.

    Source: algorithm 3 and theorem 2 of Sung (2019), corrected and proved in docs/formulations/winner-takes-all.md#sequential-greedy; in
    general the locally greedy heuristic of Fisher, Nemhauser and Wolsey (1978).
    """
    stop, limits = context.begin(), Limits.of(problem)
    turns = _turns(problem, order, len(limits.room))
    weights = problem.function.as_item_weights()
    if weights is None:
        picks, evaluations, whole = _valued(problem, limits, turns, stop)
    else:
        from .greedy_steps.loops_kernels import in_order

        best = np.zeros(weights.num_items)
        taken, _, evaluations = in_order(stop.flag, turns, *limits.members(), limits.room, best, *weights.arrays)
        picks, whole = taken.tolist(), len(taken) == limits.most
    holds, message = assumptions(problem)
    guarantee: Guarantee | None = None
    if not whole:
        message = sentences(message, f"ended with {len(picks)} elements: {CUT_SHORT}")
    elif holds:
        guarantee = Guarantee(2.0, "f(S) >= f(OPT) / 2, for every order", (*holds, "partition matroid"), SOURCE)
    statistics = {"evaluations": evaluations, "communication_rounds": len(turns)}
    return concluded(problem, stop, picks, holds, guarantee, statistics, message, whole=whole)


def _turns(problem: SubmodularSelection, order: Any, groups: int) -> NDArray[np.int64]:
    if order is None:
        return np.arange(groups)
    partition = problem.constraint.as_partition(problem.num_elements)
    assert partition is not None
    names = [part.strip() for part in order.split(",")] if isinstance(order, str) else order
    if isinstance(names, int):  # a command line's only robot
        names = [str(names)]
    if isinstance(names, Sequence | np.ndarray) and all(isinstance(g, str | int | np.integer) and not isinstance(g, bool) for g in names):
        number = {partition.group_label(g): g for g in range(groups)} if any(isinstance(g, str) for g in names) else {}
        numbers = [number.get(g, -1) if isinstance(g, str) else int(g) for g in names]
        if sorted(numbers) == list(range(groups)):
            return np.array(numbers, dtype=np.int64)
    what = f"all {groups} {partition.thing}s"
    raise UsageError(f"order must be a permutation of {what}, by number from 0 or by name, not {str(order)[:80]!r}", "malformed")


def _valued(problem: SubmodularSelection, limits: Limits, turns: NDArray[np.int64], stop: Stop) -> tuple[list[int], int, bool]:
    chosen = empty_set(problem.function)
    picks: list[int] = []
    starts, members = limits.members()
    for g in turns.tolist():
        open_ = members[starts[g] : starts[g + 1]]
        for _ in range(int(limits.room[g])):
            element, gain = chosen.best_of(open_, stop)
            if element < 0:
                return picks, chosen.evaluations, False
            if gain < 0:
                break  # a function that is not monotone: rather nothing
            chosen.take(element, gain)
            picks.append(element)
            open_ = open_[open_ != element]
    return picks, chosen.evaluations, True
