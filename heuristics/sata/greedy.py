"""Greedy: the best element again and again; for a bottleneck, robot by robot the action that lifts the worst target most."""

from __future__ import annotations

from ...formulations.sata.bottleneck_sata import BottleneckSATA
from ...formulations.sata.selections import Selection
from ...formulations.sata.submodular_selection import SubmodularSelection
from ...instances.errors import UsageError
from ..heuristic import CUT_SHORT, HEURISTICS, Context, Heuristic, Outcome
from .greedy_steps.ending import concluded
from .greedy_steps.guarantees import assumptions, greedy_guarantee
from .greedy_steps.limits import ANY_FUNCTION, ASKED, GROUPED, not_whole
from .greedy_steps.picking import check_threshold, pick


def greedy(problem: SubmodularSelection | BottleneckSATA, context: Context, *, eps: float = 0.0, evaluation: str = "auto") -> Outcome:
    """Take what gains most, until the constraint allows no more.

    Parameters
    ----------
    problem : SubmodularSelection or BottleneckSATA
    context : Context
    eps : float, >= 0
        Selection: stop where the largest gain is smaller.
    evaluation : str
        Selection: ``plain``, ``lazy``, ``incremental``, or ``auto``, whichever is fastest; the answer is the same. The statistics
        say which ran.

    Returns
    -------
    Outcome
        With a guarantee for monotone submodular functions: 1 - (1 - 1/k)^k under a cardinality limit k, 1/2 under a partition
        matroid; none where ``eps`` ended it early, and none for a bottleneck.

    Raises
    ------
    UsageError
        For options out of range.

    Notes
    -----
    Ties go to the smallest index. Selection: Nemhauser, Wolsey and Fisher (1978); threshold ``eps``: Mitchell (2020),
    algorithm 1, corrected in docs/selection.md#errata. Bottleneck: robots in their order, each the action with the best worst target
    so far; it can be arbitrarily bad (Sung 2019, appendix A.3, corrected in docs/formulations/bottleneck.md#errata).
    """
    check_threshold(eps)
    if isinstance(problem, BottleneckSATA):
        if eps > 0 or evaluation != "auto":
            raise UsageError("eps and evaluation are options for selection problems; a bottleneck has none")
        return _bottleneck(problem, context)
    stop = context.begin()
    taken = pick(problem, stop, evaluation=evaluation, eps=float(eps))
    holds, message = assumptions(problem)
    guarantee = greedy_guarantee(problem, holds)
    if taken.ended != "full":
        why = f"no element gains {eps:g} any more" if taken.ended == "eps" else CUT_SHORT
        guarantee, message = None, "; ".join(m for m in (message, f"ended with {len(taken.elements)} elements: {why}") if m)
    statistics = {"evaluation": taken.evaluation, "evaluations": taken.evaluations, "plain_evaluations": taken.plain_evaluations}
    return concluded(problem, stop, taken.elements, holds, guarantee, statistics, message, whole=taken.ended != "stopped")


def _bottleneck(problem: BottleneckSATA, context: Context) -> Outcome:
    from .greedy_steps.bottleneck_kernels import best_worst_target

    g, stop = problem.graph, context.begin()
    starts, actions = g.by_robot
    picks, asked = best_worst_target(stop.flag, starts, actions, g.indptr, g.indices, g.weights, g.num_targets)
    chosen = picks[picks >= 0].tolist()
    answer = Selection(tuple(chosen))
    if asked < g.num_robots:
        message = f"{asked:,} of {g.num_robots:,} robots chose: {CUT_SHORT}"
        return Outcome(answer, statistics={"robots_asked": int(asked)}, message=message, limit=stop.reached() or "time")
    return Outcome(answer, statistics={"evaluations": g.num_actions})


HEURISTICS.add(
    "greedy",
    Heuristic(
        name="greedy",
        families=("selection", "max-min"),
        features=ANY_FUNCTION | GROUPED | ASKED | {"sensing", "whole-actions"},
        run=greedy,
        summary="the largest gain again and again; for a bottleneck, the best worst target robot by robot",
        stated="1 - (1 - 1/k)^k > 1 - 1/e under a cardinality limit, 1/2 under a partition matroid, for monotone submodular "
        "functions; none for a bottleneck",
        refuses=not_whole,
    ),
)
