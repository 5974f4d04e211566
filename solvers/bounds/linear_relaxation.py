"""Bound ``linear-relaxation``: an LP solved for its row duals, which the checker multiplies out."""

from __future__ import annotations

from ...formulations.evidence import Evidence
from ...formulations.problem import Problem
from ...formulations.programs.program import INTEGERS
from ...formulations.stop import NEVER, Stop
from ..linear_programs import LinearPrograms
from . import BOUNDS, BoundMethod

INTERIOR_POINT = {"highs": {"solver": "ipm"}}
"""Without a vertex at the end, duals of small programs of selection came back with signs that prove nothing."""

FIRST_ORDER = {"highs": {"solver": "pdlp", "kkt_tolerance": 1e-4}}
"""For large selections: 0.3 s and a bound 0.001 % off, where interior points took 5 s (210,000 entries, a cardinality limit) and 36 s (a
partition matroid). It may be stopped at any time: all duals prove something."""

FIRST_ORDER_FORMS = frozenset({"facility-location", "strong-linearisation", "weak-linearisation"})
"""Whose programs the first-order method suits from ``SMALL`` entries on."""

SMALL = 20_000

FIRST_ORDER_ENTRIES_PER_SECOND = 100_000
"""Matrix entries for which a second of the budget gets duals worth having from the first-order method."""

ENTRIES_PER_SECOND = 20_000
"""Matrix entries that interior points get through in a second of the budget (measured: 18 000 to 130 000 on routing files)."""


def linear_relaxation_bound(problem: Problem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence from the duals of a form's linear relaxation.

    Parameters
    ----------
    problem : Problem
    stop : Stop
        Compiling counts too.
    linear : LinearPrograms, optional

    Returns
    -------
    Evidence or None
        None where the LP exceeds the budget, was not solved in it, or has no evidence to give.
    """
    linear, seconds = linear or LinearPrograms(), stop.seconds_left
    if stop.reached():
        return None
    first_order = problem.linear_entries() > SMALL and not FIRST_ORDER_FORMS.isdisjoint(problem.forms())
    most = (FIRST_ORDER_ENTRIES_PER_SECOND if first_order else ENTRIES_PER_SECOND) * seconds
    if problem.linear_entries() > most:
        return None  # writing down a far too large one is not worth its time either
    made = next((m for m in map(problem.compile, problem.forms()) if m.exactness.bound_is_valid and m.program.features() <= INTEGERS), None)
    if made is None or made.dual_evidence is None or len(made.program.data) > most:
        return None
    duals = linear.duals(made.relaxed().program, stop, FIRST_ORDER if first_order else INTERIOR_POINT)
    return None if duals is None else made.dual_evidence(duals)


def _missing(problem: Problem) -> frozenset[str]:
    return frozenset() if problem.forms() else frozenset({f"{problem.family} problems"})


BOUNDS.add("linear-relaxation", BoundMethod("linear-relaxation", _missing, linear_relaxation_bound, order=2))
