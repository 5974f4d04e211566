"""Bound ``best-increments`` through ``solve``."""

from __future__ import annotations

from bin_assignments import worked
from explorations import path

import waybound as wb
from waybound.solvers.bounds.auctions.best_increments import missing


def test_an_exploration_is_bounded_and_other_problems_are_not() -> None:
    found = wb.solve(path(4, 3, 5, 1, 2), heuristic="heard-greedy", bound_time=60.0)
    assert found.objective == 1.0 and found.bound_kind == "verified" and found.status == "optimal"
    assert missing(worked("O")) == {"bin-assignment problems"} and not missing(path(3, 0, 1))
