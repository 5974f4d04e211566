"""Greedy, plain and lazy: the largest gain again and again; for a bottleneck, robot by robot the best worst target."""

from collections.abc import Sequence

from ...formulations.sata.bottleneck_sata import BottleneckSATA
from ...formulations.sata.selections import Selection
from ...formulations.sata.submodular_selection import SubmodularSelection
from ...instances.errors import UsageError
from ..heuristic import CUT_SHORT, Context, Outcome, heuristic
from .greedy_steps.limits import ANY_FUNCTION, ASKED, GROUPED, chosen_elements, not_whole
from .greedy_steps.outcomes import assumptions, concluded, greedy_guarantee, sentences
from .greedy_steps.picking import check_threshold, pick


@heuristic(
    "greedy", ("selection", "max-min"), ANY_FUNCTION | GROUPED | ASKED | {"sensing", "whole-actions"},
    "the largest gain again and again; for a bottleneck, the best worst target robot by robot",
    "1 - (1 - 1/k)^k > 1 - 1/e under a cardinality limit, 1/2 under a partition matroid, for monotone submodular functions; "
    "none for a bottleneck",
    refuses=not_whole,
)  # fmt: skip
def greedy(problem: SubmodularSelection | BottleneckSATA, context: Context, *, eps: float = 0.0, evaluation: str = "auto") -> Outcome:
    """Take the element that gains most, until the constraint allows no more; for a bottleneck, robot by robot the action with the best
    worst target so far.

    Selections: stops where the largest gain is below ``eps`` (>= 0); ``evaluation`` is ``plain``, ``lazy``, ``incremental``, or ``auto``,
    whichever is fastest, and the answer is the same. Ties go to the smallest index. Guaranteed for monotone submodular functions: 1 - (1 -
    1/k)^k under a cardinality limit k, 1/2 under a partition matroid; none where ``eps`` ended it early, and none for a bottleneck.

    Source: Nemhauser, Wolsey and Fisher (1978); threshold ``eps``: Mitchell (2020), algorithm 1, corrected in docs/selection.md#errata.
    Bottleneck: it can be arbitrarily bad (Sung 2019, appendix A.3, corrected in docs/formulations/bottleneck.md#errata).
    """
    check_threshold(eps)
    if isinstance(problem, BottleneckSATA):
        if eps > 0 or evaluation != "auto":
            raise UsageError("eps and evaluation are options for selection problems; a bottleneck has none")
        return _bottleneck(problem, context)
    return _selection(problem, context, evaluation, eps, [])


@heuristic(
    "lazy-greedy", "selection", ANY_FUNCTION | GROUPED | ASKED, "greedy's answer with few evaluations: old gains are upper bounds",
    "as greedy: 1 - (1 - 1/k)^k > 1 - 1/e under a cardinality limit, 1/2 under a partition matroid, for monotone submodular functions",
)  # fmt: skip
def lazy_greedy(problem: SubmodularSelection, context: Context, *, eps: float = 0.0, base: Sequence[int] | str = ()) -> Outcome:
    """Greedy that keeps the gains of earlier rounds as upper bounds, and evaluates again only the elements that could still be the best.

    ``base``: elements that are chosen already, by number from 0 or as names separated by commas; they stay in the answer, take room, and
    gains are over them. The guarantee is that of greedy; none with a ``base``, with an end by ``eps``, or for a function that is not
    declared monotone and submodular, for which the answer may differ from greedy's as well. An old gain equal to the best new one is
    evaluated only where its element comes first.

    Source: Minoux (1978), Accelerated greedy algorithms for maximizing submodular set functions; algorithm 5 of Mitchell (2020), corrected
    (docs/selection.md#errata): bounds are kept per element, the best of a round is reset, gains are over all that is chosen.
    """
    check_threshold(eps)
    return _selection(problem, context, "lazy", eps, chosen_elements("base", base, problem))


def _selection(problem: SubmodularSelection, context: Context, evaluation: str, eps: float, base: list[int]) -> Outcome:
    stop = context.begin()
    taken = pick(problem, stop, evaluation=evaluation, eps=float(eps), base=base)
    holds, message = assumptions(problem)
    guarantee = None if base else greedy_guarantee(problem, holds)
    if taken.ended != "full":
        why = f"no element gains {eps:g} any more" if taken.ended == "eps" else CUT_SHORT
        guarantee, message = None, sentences(message, f"ended with {len(taken.elements)} elements: {why}")
    statistics = {"evaluation": taken.evaluation, "evaluations": taken.evaluations, "plain_evaluations": taken.plain_evaluations}
    return concluded(problem, stop, [*base, *taken.elements], holds, guarantee, statistics, message, whole=taken.ended != "stopped")


def _bottleneck(problem: BottleneckSATA, context: Context) -> Outcome:
    from .greedy_steps.bottleneck_kernels import best_worst_target

    g, stop = problem.graph, context.begin()
    starts, actions = g.by_robot
    picks, evaluations = best_worst_target(stop.flag, starts, actions, g.indptr, g.indices, g.weights, g.num_targets)
    chosen = picks[picks >= 0].tolist()
    answer = Selection(tuple(chosen))
    if evaluations < g.num_robots:
        message = f"{evaluations:,} of {g.num_robots:,} robots chose: {CUT_SHORT}"
        return Outcome(answer, statistics={"robots_asked": int(evaluations)}, message=message, limit=stop.reached() or "time")
    return Outcome(answer, statistics={"evaluations": g.num_actions})
