from __future__ import annotations

import numpy as np
import pytest

from waybound.formulations.stop import NEVER, Stop
from waybound.heuristics.routing.tour_steps import dense as module
from waybound.heuristics.routing.tour_steps.dense import dense
from waybound.instances.errors import UsageError
from waybound.instances.routing.travel import Travel

TRAVEL = Travel("EUC_2D", np.random.default_rng(1).integers(0, 1000, (50, 2)))


def test_it_holds_the_distances_of_the_sites_that_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "STRIP", 100)  # in many strips
    nodes = np.array([7, 3, 49, 3])
    made = dense(TRAVEL.distance, nodes, NEVER, "a tour")
    assert made is not None and (made == TRAVEL.distances[np.ix_(nodes, nodes)]).all()


def test_asked_to_stop_it_holds_nothing() -> None:
    assert dense(TRAVEL.distance, np.arange(50), Stop(0.0), "a tour") is None


def test_too_many_sites_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_SITES", 49)
    with pytest.raises(UsageError, match=r"a tour of 50 sites .* takes at most 49; savings needs none"):
        dense(TRAVEL.distance, np.arange(50), NEVER, "a tour", savings=True)
    with pytest.raises(UsageError, match=r"takes at most 49$"):
        dense(TRAVEL.distance, np.arange(50), NEVER, "greedy orienteering")
    monkeypatch.setattr(module, "MOST_SITES", 50)
    monkeypatch.setattr("waybound.instances.memory.available", lambda: 1e3)
    with pytest.raises(UsageError, match=r"a tour of 50 sites .* needs"):
        dense(TRAVEL.distance, np.arange(50), NEVER, "a tour")
