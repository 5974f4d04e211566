"""Outcomes of methods for selections: the ratios that hold, the assumptions under which they do, and the bound that each answer carries."""

import math
from collections.abc import Sequence
from typing import Any

from ....formulations.evidence import Evidence, Guarantee
from ....formulations.sata.selections import Selection
from ....formulations.sata.submodular_selection import SubmodularSelection
from ....formulations.stop import Stop
from ....instances.errors import in_words
from ....solvers.bounds.sata.marginal_gains import best_prefix
from ...heuristic import Outcome
from ..submodularity import check_submodular
from .limits import Limits

EVIDENCE_SECONDS = 1.0
"""For the evidence of an answer, once its time is up."""

SAMPLES = 200
"""Triples of sets and element on which a user's declaration is tried before a guarantee rests on it."""

NWF = "Nemhauser, Wolsey and Fisher (1978), An analysis of approximations for maximizing submodular set functions I"
FNW = "Fisher, Nemhauser and Wolsey (1978), An analysis of approximations for maximizing submodular set functions II"


def assumptions(problem: SubmodularSelection) -> tuple[tuple[str, ...], str]:
    """The assumptions by which ``f`` is monotone and submodular with f({}) = 0; where there are none, an empty tuple and the reason in
    words."""
    f = problem.function
    if f.as_item_weights() is not None:
        return (f"{f.name} with weights >= 0: monotone, submodular, 0 for the empty set",), ""
    if not (f.monotone and f.submodular):
        return (), f"nothing is guaranteed or bounded: {f.label} is not declared monotone and submodular"
    report = check_submodular(f, samples=SAMPLES, seed=1)
    if not report:
        return (), f"nothing is guaranteed or bounded, whatever is declared: {report}"
    return (f"{f.label} is monotone and submodular as declared by the user; {report}",), ""


def greedy_guarantee(problem: SubmodularSelection, holds: tuple[str, ...]) -> Guarantee | None:
    """Guarantee of the greedy rule: 1 - (1 - 1/k)^k under a cardinality limit k, 1/2 under any other matroid."""
    c = problem.constraint
    if not holds or not c.matroid:
        return None
    if c.matroid == "uniform":
        k = max(1, Limits.of(problem).most)
        share = 1.0 - (1.0 - 1.0 / k) ** k
        statement = f"f(S) >= (1 - (1 - 1/{k})^{k}) f(OPT), that is {rounded_down(share)} f(OPT); for every k more than 1 - 1/e"
        return Guarantee(1.0 / share, statement, (*holds, f"at most k = {k} elements"), NWF)
    return Guarantee(2.0, "f(S) >= f(OPT) / 2", (*holds, f"{c.matroid} matroid"), FNW)


def rounded_down(share: float) -> str:
    """A share with four decimals that do not promise more than is proved."""
    return f"{math.floor(share * 1e4 + 1e-9) / 1e4:.4f}"


def sentences(*parts: str) -> str:
    """The parts of a message that are not empty, as one line."""
    return "; ".join(part for part in parts if part)


def concluded(
    problem: SubmodularSelection,
    stop: Stop,
    picks: Sequence[int],
    holds: tuple[str, ...],
    guarantee: Guarantee | None,
    statistics: dict[str, Any],
    message: str = "",
    *,
    whole: bool = True,
    in_order: bool = True,
) -> Outcome:
    """The outcome of a method that took ``picks``, one after the other if ``in_order``, within ``stop``.

    ``holds`` are the assumptions by which f is monotone and submodular: without them there is neither evidence nor guarantee. To the
    statistics ``bound_evaluations`` is added, the gains evaluated for the evidence alone. ``whole`` is false where the method was cut
    short.
    """
    looked, evidence = 0, tuple[Evidence, ...]()
    if holds:
        try:
            prefix, looked = best_prefix(problem, picks, stop.after(EVIDENCE_SECONDS + stop.seconds_left))
            evidence = () if prefix is None else (prefix,)
        except Exception as fault:  # of memory, say: the answer is made, and outlives its bound
            message = sentences(message, f"no bound by marginal gains: {in_words(fault)}")
    answer = Selection(tuple(int(e) for e in picks), in_order=in_order)
    limit = "none" if whole else stop.reached() or "time"
    return Outcome(answer, guarantee if holds else None, evidence, {**statistics, "bound_evaluations": looked}, message, limit)
