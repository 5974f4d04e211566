"""Local ratios: half of the best profit at least, and no less on the chain that attains it."""

from __future__ import annotations

import numpy as np
import pytest
from draws import draws
from knapsack_assignments import enumerated, random_assignment, worked

import waybound as wb
from waybound.heuristics.auctions import _knapsack
from waybound.instances.errors import UsageError, WayboundError
from waybound.reports.ratios.studies.auctions.families.knapsack_assignment import stolen


def test_two_is_kept_and_three_where_knapsacks_are_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(2)
    for k in range(draws(60)):
        problem = random_assignment(rng, 5)
        if problem.objective != "profit":
            continue
        monkeypatch.setattr(_knapsack, "LONGEST", 1 << 15 if k % 4 else 1)
        found, best = wb.solve(problem, heuristic="local-ratio", bound_time=0), enumerated(problem)
        stated = found.certificate.guarantee
        assert best is not None and stated is not None and stated.ratio in (2.0, 3.0)
        assert found.objective * stated.ratio >= best - 1e-9


def test_two_is_attained() -> None:
    found = wb.solve(stolen(3).problem, heuristic="local-ratio", bound_time=0)
    assert found.objective == 3.0 and stolen(3).optimum.value == pytest.approx(6.0)


def test_an_order_is_one_of_all_agents() -> None:
    assert wb.solve(worked("profit"), heuristic="local-ratio", order=(1, 0), bound_time=0).certificate.feasible
    with pytest.raises(UsageError, match="each of 2 agents once"):
        wb.solve(worked("profit"), heuristic="local-ratio", order=(1, 1))
    with pytest.raises(WayboundError, match="objective:cost"):
        wb.solve(worked(), heuristic="local-ratio")
