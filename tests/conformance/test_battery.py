"""Every backend, and every solver within one, on the battery: nothing that they say of a small program is false."""

import functools
import math
from typing import Any

import pytest

from waybound.formulations.forms import FORMS
from waybound.formulations.programs.exactness import Exactness
from waybound.reports.battery.cases import Case, Draw, cases
from waybound.reports.battery.examining import GAVE_UP, REFUSED, RIGHT, examinable, outcome
from waybound.reports.battery.kinds import KINDS
from waybound.solvers.backend import Options

SHORT, LONG = 320, 5_000
"""Programs of the fast suite and of the long one."""

SHARES = {
    "highs": (80, 5_000), "scip": (30, 5_000), "cpsat": (40, 5_000), "mathopt": (20, 2_000), "mathopt:highs": (20, 2_000),
    "mathopt:gscip": (20, 2_000), "mathopt:glop": (30, 5_000), "mathopt:cp-sat": (30, 2_000), "mathopt:pdlp": (20, 2_000),
    "pulp": (30, 2_000), "pulp:HiGHS": (20, 2_000), "cvxpy": (20, 2_000), "cvxpy:CLARABEL": (20, 2_000), "cvxpy:SCS": (20, 2_000),
    "cvxpy:HIGHS": (20, 2_000),
    **{name: (320, 5_000) for name in examinable() if name.startswith("outer-approximation")},
}  # fmt: skip
"""How many of them a solver gets in either, spread over all; those not named here the least of these. Cones alone are few."""

STEP = 11
"""From one case of a solver to the next."""

OPTIONS = Options(time_limit=10.0)


@functools.cache
def drawn(count: int) -> tuple[Case, ...]:
    return tuple(cases(Draw(count)))


def spread(count: int, share: int) -> list[Case]:
    """``share`` of ``count`` cases, of all kinds alike: a step prime to their number and that of kinds."""
    every = drawn(count)
    return [every[k * STEP % count] for k in range(min(share, count))]


def faults(solver: str, chosen: list[Case]) -> tuple[list[str], dict[str, int]]:
    """What a solver says that is false, and how often it is right, gives up and refuses."""
    tally: dict[str, int] = {}
    found: list[str] = []
    for case in chosen:
        told: Any = outcome(solver, case, OPTIONS)
        tally[told.verdict] = tally.get(told.verdict, 0) + 1
        if told.verdict not in (RIGHT, GAVE_UP, REFUSED):
            found.append(f"case {told.number} ({told.kind}, {told.form}): {told.verdict}: {told.truth}, said {told.said}")
    return found, tally


@pytest.mark.slow
def test_every_exact_form_of_every_family_is_in_it():
    every = drawn(SHORT)
    assert all(math.gcd(STEP, many) == 1 for many in (SHORT, LONG, len(KINDS)))
    assert {case.form for case in every} == {name for name in FORMS if FORMS[name].exactness is Exactness.EXACT}
    assert {case.kind for case in every} == set(KINDS)
    assert {case.truth.status for case in every} == {"optimal", "infeasible", "unbounded"}


@pytest.mark.share(4)
@pytest.mark.parametrize(
    "solver", [pytest.param(s, marks=pytest.mark.long) if s.startswith("outer-approximation:") else s for s in examinable()]
)
def test_nothing_that_a_solver_says_is_false(solver):
    found, tally = faults(solver, spread(SHORT, SHARES.get(solver, (20, 2_000))[0]))
    assert not found, f"{len(found)}: {found[:5]}"
    assert tally.get(RIGHT, 0) > 0
    assert tally.get(GAVE_UP, 0) <= tally[RIGHT] / 20, tally


@pytest.mark.long
@pytest.mark.parametrize("solver", examinable())
def test_nothing_that_a_solver_says_of_thousands_is_false(solver):
    found, tally = faults(solver, spread(LONG, SHARES.get(solver, (20, 2_000))[1]))
    assert not found, f"{len(found)}: {found[:5]}"
    assert tally.get(GAVE_UP, 0) <= tally[RIGHT] / 20, tally


@pytest.mark.parametrize("solver", ["highs", "mathopt:highs", "pulp:HiGHS", "cvxpy:HIGHS"])
def test_without_its_protection_every_road_to_highs_goes_wrong(solver):
    # The cases are chosen: each is wrong on its own, 1 in 30 of all.
    chosen = [case for n in (16, 49, 63) for case in cases(Draw(64, 1, "time-windows", "two-index-mtz"), range(n, n + 1))]
    bare = Options(time_limit=10.0, extra={"presolve_rule_off": 0})
    assert all(outcome(solver, case, bare).verdict not in (RIGHT, GAVE_UP, REFUSED) for case in chosen)
    assert all(outcome(solver, case, OPTIONS).verdict == RIGHT for case in chosen)
