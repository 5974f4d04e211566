"""Stochastic greedy: the best element of a random sample, again and again."""

import math

import numpy as np

from ...formulations.evidence import Guarantee
from ...formulations.sata.submodular_selection import SubmodularSelection
from ...instances.errors import UsageError
from ...solvers.bounds.sata.growing_sets import empty_set
from ..heuristic import CUT_SHORT, Context, Outcome, heuristic
from .greedy_steps.limits import ANY_FUNCTION, Limits
from .greedy_steps.outcomes import assumptions, concluded, rounded_down, sentences

SOURCE = "Mirzasoleiman, Badanidiyuru, Karbasi, Vondrák and Krause (2015), Lazier than lazy greedy"


@heuristic(
    "stochastic-greedy", "selection", ANY_FUNCTION | {"constraint:cardinality"},
    "the best of a random sample again and again: n ln(1/eps) evaluations",
    "1 - 1/e - eps in expectation under a cardinality limit, for monotone submodular functions",
)  # fmt: skip
def stochastic_greedy(problem: SubmodularSelection, context: Context, *, eps: float = 0.1) -> Outcome:
    """In each of k rounds, take the best of ``(n / k) ln(1 / eps)`` elements drawn from those that are left, with 0 < eps < 1 - 1/e.

    Guaranteed 1 - 1/e - eps in expectation over the samples, so that a single answer may be worse, with n ln(1 / eps) evaluations whatever
    the cardinality limit k is (Mirzasoleiman et al. 2015). Ties go to the smallest index.
    """
    most = 1.0 - math.exp(-1.0)
    if isinstance(eps, bool) or not isinstance(eps, int | float) or not 0.0 < eps < most:
        raise UsageError(f"eps must lie between 0 and 1 - 1/e = {most:.4f}, not {eps!r}", "out-of-range")
    limits = Limits.of(problem)
    n, k = problem.num_elements, limits.most
    size = math.ceil(-n / max(k, 1) * math.log(eps))  # 1 / eps may overflow
    chosen, picks = empty_set(problem.function), []
    # The first ``unchosen`` places hold what is not chosen; a chosen element changes places with the last of these.
    order, place, unchosen = np.arange(n), np.arange(n), n
    stop, rounds = context.begin(), 0
    while rounds < k and not (rounds and stop.reached()):
        drawn = order[:unchosen] if size >= unchosen else order[context.rng.choice(unchosen, size, replace=False)]
        element, gain = chosen.best_of(np.sort(drawn), stop)
        if element < 0:
            break
        rounds += 1
        if gain < 0:
            continue  # a user's function that is not monotone
        chosen.take(element, gain)
        picks.append(element)
        unchosen -= 1
        other, at = order[unchosen], place[element]
        order[at], order[unchosen], place[other], place[element] = other, element, at, unchosen
    holds, message = assumptions(problem)
    guarantee: Guarantee | None = None
    if rounds < k:
        message = sentences(message, f"ended with {len(picks)} elements: {CUT_SHORT}")
    elif holds:
        statement = f"E[f(S)] >= (1 - 1/e - {eps:g}) f(OPT), that is {rounded_down(most - eps)} f(OPT), in expectation over the samples"
        guarantee = Guarantee(1.0 / (most - eps), statement, (*holds, f"at most k = {k} elements, {size} drawn a round"), SOURCE)
    statistics = {"evaluations": chosen.evaluations, "plain_evaluations": limits.plain_evaluations(picks), "sample": size}
    return concluded(problem, stop, picks, holds, guarantee, statistics, message, whole=rounds == k)
