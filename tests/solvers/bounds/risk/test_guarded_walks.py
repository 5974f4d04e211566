"""The bound of walks with memory."""

from __future__ import annotations

import pytest
import risky_cases as cases

from waybound.formulations.stop import NEVER
from waybound.solvers.bounds import BOUNDS

BOUND = BOUNDS["guarded-walks"]


@pytest.mark.parametrize(("make", "best", "guarded"), [(cases.loop, 12, [1]), (cases.refusal, 6, [1]), (cases.mud_costs, 5, [])])
def test_it_guards_what_walks_would_repeat_and_closes_the_gap(make, best, guarded):
    evidence = BOUND.evidence(make(), NEVER, None, None)
    assert evidence.value == pytest.approx(best) and evidence.data["guarded"] == guarded


def test_rewards_are_not_its_business():
    assert BOUND.missing(cases.two_ways()) == {"objective:reward-per-risk"}
