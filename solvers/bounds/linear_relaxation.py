"""Bound ``linear-relaxation``: an LP solved for its row duals, which the checker multiplies out."""

import math
from dataclasses import replace

import numpy as np

from ...formulations.evidence import Evidence
from ...formulations.problem import Problem
from ...formulations.programs.compiled import Compiled
from ...formulations.programs.program import INTEGERS
from ...formulations.programs.reductions.units import scaled
from ...formulations.stop import NEVER, Stop
from ...formulations.verified_bounds import verified_bound
from ..linear_programs import LinearPrograms
from ..linear_session import LinearSession
from . import bound_method

INTERIOR_POINT = {"highs": {"solver": "ipm"}}
"""Without a vertex at the end, duals of small programs of selection came back with signs that prove nothing."""

FIRST_ORDER = {"highs": {"solver": "pdlp", "kkt_tolerance": 1e-4}}
"""For large selections: 0.3 s and a bound 0.001 % off, where interior points took 5 s (210,000 entries, a cardinality limit) and 36 s (a
partition matroid). It may be stopped at any time: all duals prove something."""

FIRST_ORDER_FORMS = frozenset({"facility-location", "strong-linearisation", "weak-linearisation"})
"""Forms whose programs the first-order method suits from ``SMALL`` entries on."""

MARGINS = (0.0, 1e-12, 1e-10)
"""Distances from 0 at which reduced costs of variables with one bound are kept, as parts of the largest cost; tried one after the other."""

SMALL = 20_000

FIRST_ORDER_ENTRIES_PER_SECOND = 100_000
"""Matrix entries for which a second of the budget gets duals worth having from the first-order method."""

ENTRIES_PER_SECOND = 20_000
"""Matrix entries that interior points get through in a second of the budget (measured: 18 000 to 130 000 on routing files)."""


def _missing(problem: Problem) -> frozenset[str]:
    return frozenset() if problem.forms() else frozenset({f"{problem.family} problems"})


@bound_method("linear-relaxation", _missing, order=2)
def linear_relaxation_bound(problem: Problem, stop: Stop = NEVER, linear: LinearPrograms | None = None) -> Evidence | None:
    """Evidence from the duals of a form's linear relaxation.

    Compiling counts for ``stop``, too. None where the LP exceeds the budget, was not solved in it, or has no evidence to give.
    """
    linear, seconds = linear or LinearPrograms(), stop.seconds_left
    if stop.reached():
        return None
    first_order = problem.linear_entries() > SMALL and not FIRST_ORDER_FORMS.isdisjoint(problem.forms())
    most = (FIRST_ORDER_ENTRIES_PER_SECOND if first_order else ENTRIES_PER_SECOND) * seconds
    if problem.linear_entries() > most:
        return None  # writing down a far too large one is not worth its time either
    forms = map(problem.compile, problem.forms())
    compiled = next((m for m in forms if m.exactness.bound_is_valid and m.program.features() <= INTEGERS), None)
    if compiled is None or compiled.dual_evidence is None or len(compiled.program.data) > most:
        return None
    result = linear.solve(compiled.relaxed().program, stop, FIRST_ORDER if first_order else INTERIOR_POINT)
    duals = result.row_duals
    evidence = None if duals is None or not np.isfinite(duals).all() else compiled.dual_evidence(duals)
    if result.status == "infeasible" or (evidence is not None and not first_order and not math.isfinite(verified_bound(problem, evidence))):
        return vertex(compiled, stop, linear.seed) or evidence
    return evidence


def vertex(made: Compiled, stop: Stop, seed: int) -> Evidence | None:
    """Evidence from the simplex: of the linear relaxation's optimum, or that rows and bounds hold no point, whatever the objective.

    A reduced cost whose rounding points to a side that is not there proves nothing, so it is kept away from 0 where that happens.
    """
    given = made.program
    linear = given.quadratic is None
    variables = tuple(replace(b, integer=False, cost=b.cost if linear else np.zeros(b.size)) for b in given.variables)
    units = scaled(replace(given, quadratic=None, variables=variables))
    program = units.program
    nothing = -math.inf if made.problem.sense == "min" else math.inf
    dearest, one_sided = float(np.abs(program.cost).max(initial=0.0)), np.isinf(program.upper).astype(float) - np.isinf(program.lower)
    for share in MARGINS:
        by = (-share if given.sense == "min" else share) * dearest * one_sided
        result = LinearSession(program.with_costs(program.cost + by), seed).solve(stop)
        tried: list[Evidence] = []
        if result.status == "optimal" and linear and made.dual_evidence is not None:
            tried = [made.dual_evidence(units.duals(result.duals))]
        elif result.ray is not None and made.ray_evidence is not None:
            tried = [made.ray_evidence(units.duals(sign * result.ray)) for sign in (1.0, -1.0)]
        for evidence in tried:
            if verified_bound(made.problem, evidence) != nothing:
                return evidence
    return None
