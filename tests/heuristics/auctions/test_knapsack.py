"""Knapsacks against enumeration, and half of the best where lists would grow too long."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from draws import draws

from waybound.formulations.stop import Stop
from waybound.heuristics.auctions import _knapsack
from waybound.heuristics.auctions._knapsack import knapsack


def best_of(worth: np.ndarray, weights: np.ndarray, most: float) -> float:
    sets = np.array(list(itertools.product([0, 1], repeat=len(worth))))
    return float((sets @ worth)[sets @ weights <= most * (1 + 1e-12)].max())


@pytest.mark.parametrize(("limit", "longest"), [("LONGEST", 1 << 15), ("LONGEST", 2), ("MOST_KEPT", 2)])
def test_the_best_is_found_or_half_of_it(limit: str, longest: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_knapsack, limit, longest)
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
