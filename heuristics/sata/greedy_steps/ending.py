"""From picks to an ``Outcome``: the evidence that every submodular answer carries, and what is said of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ....formulations.evidence import Evidence, Guarantee
from ....formulations.sata.selections import Selection
from ....formulations.sata.submodular_selection import SubmodularSelection
from ....formulations.stop import Stop
from ....instances.errors import in_words
from ....solvers.bounds.sata.marginal_gains import best_prefix
from ...heuristic import Outcome

EVIDENCE_SECONDS = 1.0
"""For the evidence of an answer, once its time is up."""


def concluded(
    problem: SubmodularSelection,
    stop: Stop,
    picks: Sequence[int],
    holds: tuple[str, ...],
    guarantee: Guarantee | None,
    statistics: dict[str, Any],
    message: str = "",
    evidence: tuple[Evidence, ...] = (),
    *,
    whole: bool = True,
    in_order: bool = True,
) -> Outcome:
    """The outcome of a method that took ``picks``.

    Parameters
    ----------
    stop : Stop
        What the method kept.
    holds : tuple of str
        What makes f monotone and submodular; without it there is neither evidence nor guarantee.
    statistics : dict
        ``bound_evaluations`` is added: gains evaluated for the evidence alone.
    whole : bool
        Whether it did all it had to do, rather than be cut short.
    in_order : bool
        Whether it took ``picks`` one after the other.
    """
    looked = 0
    if holds:
        try:
            found, looked = best_prefix(problem, picks, stop.after(EVIDENCE_SECONDS + stop.seconds_left))
            evidence += () if found is None else (found,)
        except Exception as fault:  # of memory, say: the answer is made, and outlives its bound
            message = "; ".join(m for m in (message, f"no bound by marginal gains: {in_words(fault)}") if m)
    answer = Selection(tuple(int(e) for e in picks), in_order=in_order)
    limit = "none" if whole else stop.reached() or "time"
    return Outcome(answer, guarantee if holds else None, evidence, {**statistics, "bound_evaluations": looked}, message, limit)
