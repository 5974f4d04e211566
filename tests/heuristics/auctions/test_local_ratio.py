import itertools

import numpy as np
import pytest
from coded import check_coded
from draws import draws
from file_cases import check_refused
from knapsack_assignments import enumerated, random_assignment, worked

import waybound as wb
from waybound.formulations.stop import Stop
from waybound.heuristics.auctions import local_ratio
from waybound.heuristics.auctions.local_ratio import knapsack
from waybound.instances.errors import UsageError, WayboundError
from waybound.reports.studies.auctions.local_ratio import stolen


def test_two_is_kept_and_three_where_knapsacks_are_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(2)
    for k in range(draws(60)):
        problem = random_assignment(rng, 5)
        if problem.objective != "profit":
            continue
        monkeypatch.setattr(local_ratio, "LONGEST", 1 << 15 if k % 4 else 1)
        found, best = wb.solve(problem, heuristic="local-ratio", bound_time=0), enumerated(problem)
        stated = found.certificate.guarantee
        assert best is not None and stated is not None and stated.ratio in (2.0, 3.0)
        assert found.objective * stated.ratio >= best - 1e-9


def test_two_is_attained() -> None:
    found = wb.solve(stolen(3).problem, heuristic="local-ratio", bound_time=0)
    assert found.objective == 3.0 and stolen(3).optimum.value == pytest.approx(6.0)


def test_an_order_is_one_of_all_agents() -> None:
    assert wb.solve(worked("profit"), heuristic="local-ratio", order=(1, 0), bound_time=0).certificate.feasible
    check_coded(UsageError, "malformed", wb.solve, worked("profit"), heuristic="local-ratio", order=(1, 1))
    check_refused(WayboundError, "objective:cost", wb.solve, worked(), heuristic="local-ratio")


def best_of(worth: np.ndarray, weights: np.ndarray, most: float) -> float:
    sets = np.array(list(itertools.product([0, 1], repeat=len(worth))))
    return float((sets @ worth)[sets @ weights <= most * (1 + 1e-12)].max())


@pytest.mark.parametrize(("limit", "longest"), [("LONGEST", 1 << 15), ("LONGEST", 2), ("MOST_KEPT", 2)])
def test_the_best_is_found_or_half_of_it(limit: str, longest: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(local_ratio, limit, longest)
    rng = np.random.default_rng(5)
    cut = 0
    for k in range(draws(200)):
        n = int(rng.integers(1, 9))
        worth, weights = (
            (rng.integers(0, 9, n).astype(float), rng.integers(0, 9, n).astype(float)) if k % 2 else (rng.random(n), rng.random(n))
        )
        most = float(rng.integers(0, 20)) if k % 2 else rng.random() * 2
        chosen, exact = knapsack(worth, weights, most)
        best = best_of(worth, weights, most)
        assert weights[chosen].sum() <= most * (1 + 1e-12) and len(set(chosen.tolist())) == len(chosen)
        assert worth[chosen].sum() == pytest.approx(best) if exact else worth[chosen].sum() >= best / 2 - 1e-12
        cut += not exact
    assert bool(cut) == (longest == 2)


def test_an_empty_knapsack_has_nothing() -> None:
    assert knapsack(np.zeros(0), np.zeros(0), 1.0)[0].tolist() == [] == knapsack(np.ones(2), np.ones(2), 0.5)[0].tolist()
    assert knapsack(np.array([1.0, 2.0]), np.zeros(2), 0.0)[0].tolist() == [0, 1]


def test_who_is_stopped_still_takes_half_of_the_best_at_least() -> None:
    stop = Stop()
    stop.ask()
    chosen, exact = knapsack(np.array([3.0, 5.0]), np.array([1.0, 2.0]), 2.0, stop)
    assert chosen.tolist() == [1] and not exact
