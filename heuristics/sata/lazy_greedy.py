"""Lazy greedy: greedy's answer with a fraction of its evaluations."""

from __future__ import annotations

from collections.abc import Sequence

from ...formulations.sata.submodular_selection import SubmodularSelection
from ..heuristic import CUT_SHORT, HEURISTICS, Context, Heuristic, Outcome
from .greedy_steps.ending import concluded
from .greedy_steps.guarantees import assumptions, greedy_guarantee
from .greedy_steps.limits import ANY_FUNCTION, ASKED, GROUPED, chosen_elements
from .greedy_steps.picking import check_threshold, pick


def lazy_greedy(problem: SubmodularSelection, context: Context, *, eps: float = 0.0, base: Sequence[int] | str = ()) -> Outcome:
    """Keep the gains of earlier rounds as upper bounds, and evaluate again only the elements that could still be the best.

    Parameters
    ----------
    problem : SubmodularSelection
    context : Context
    eps : float, >= 0
        Stop where the largest gain is smaller.
    base : sequence of int, or str
        Elements that are chosen already (an earlier plan), by number from 0, or as text by their names, separated by commas: they stay
        in the answer, take room, and gains are over them.

    Returns
    -------
    Outcome
        The guarantee of greedy; none with a ``base``, with an end by ``eps``, or for a function that is not declared monotone and
        submodular, for which the answer may differ from greedy's as well. The statistics hold the evaluations, and those that a plain
        greedy needs.

    Raises
    ------
    UsageError
        For options out of range.

    Notes
    -----
    Minoux (1978), Accelerated greedy algorithms for maximizing submodular set functions; algorithm 5 of Mitchell (2020), corrected
    (docs/selection.md#errata): bounds are kept per element, the best of a round is reset, gains are over all that is chosen. Ties go to the
    smallest index, so that an old gain equal to the best new one is evaluated only where its element comes first.
    """
    check_threshold(eps)
    begun = chosen_elements("base", base, problem)
    stop = context.begin()
    taken = pick(problem, stop, evaluation="lazy", eps=float(eps), base=begun)
    holds, message = assumptions(problem)
    guarantee = None if begun else greedy_guarantee(problem, holds)
    if taken.ended != "full":
        why = f"no element gains {eps:g} any more" if taken.ended == "eps" else CUT_SHORT
        guarantee, message = None, "; ".join(m for m in (message, f"ended with {len(taken.elements)} elements: {why}") if m)
    statistics = {"evaluation": "lazy", "evaluations": taken.evaluations, "plain_evaluations": taken.plain_evaluations}
    return concluded(problem, stop, [*begun, *taken.elements], holds, guarantee, statistics, message, whole=taken.ended != "stopped")


HEURISTICS.add(
    "lazy-greedy",
    Heuristic(
        name="lazy-greedy",
        families=("selection",),
        features=ANY_FUNCTION | GROUPED | ASKED,
        run=lazy_greedy,
        summary="greedy's answer with few evaluations: old gains are upper bounds",
        stated="as greedy: 1 - (1 - 1/k)^k > 1 - 1/e under a cardinality limit, 1/2 under a partition matroid, for monotone "
        "submodular functions",
    ),
)
