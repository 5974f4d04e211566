"""From picks to an ``Outcome``: the evidence that every submodular answer carries, and what is said of it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from ...formulations.bounds.marginal_gains import best_prefix
from ...formulations.evidence import Evidence, Guarantee
from ...formulations.problems.submodular_selection import SubmodularSelection
from ...formulations.selections import Selection
from ...instances.errors import in_words
from ..heuristic import Outcome, Setting

CUT_SHORT = "the time was up, or it was asked to stop"


def watch(setting: Setting) -> Callable[[], bool]:
    """Whether a method that starts now has to end: its time is up, or it is asked to."""
    end = time.perf_counter() + setting.seconds
    return lambda: setting.stopped() or time.perf_counter() > end


def concluded(
    problem: SubmodularSelection,
    picks: Sequence[int],
    holds: tuple[str, ...],
    guarantee: Guarantee | None,
    statistics: dict[str, Any],
    message: str = "",
    evidence: tuple[Evidence, ...] = (),
) -> Outcome:
    """The outcome of a method that took ``picks``.

    Parameters
    ----------
    holds : tuple of str
        What makes f monotone and submodular; without it there is neither evidence nor guarantee.
    statistics : dict
        ``bound_evaluations`` is added: gains evaluated for the evidence alone.
    """
    looked = 0
    if holds:
        try:
            found, looked = best_prefix(problem, picks)
            evidence += () if found is None else (found,)
        except Exception as fault:  # of memory, say: the answer is made, and outlives its bound
            message = "; ".join(m for m in (message, f"no bound by marginal gains: {in_words(fault)}") if m)
    answer = Selection(tuple(int(e) for e in picks))
    return Outcome(answer, guarantee if holds else None, evidence, {**statistics, "bound_evaluations": looked}, message)
