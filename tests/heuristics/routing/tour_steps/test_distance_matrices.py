import math

import numpy as np
import pytest
from coded import coded

from waybound import RoutingProblem, Sites, Travel, UsageError, VehicleType
from waybound.formulations.stop import NEVER, Stop
from waybound.heuristics.routing.tour_steps import distance_matrices as module
from waybound.heuristics.routing.tour_steps.distance_matrices import dense, site_data
from waybound.instances.routing.travel import EXPLICIT

TRAVEL = Travel("EUC_2D", np.random.default_rng(1).integers(0, 1000, (50, 2)))


def test_it_holds_the_distances_of_the_sites_that_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "STRIP", 100)  # in many strips
    nodes = np.array([7, 3, 49, 3])
    made = dense(TRAVEL.distance, nodes, NEVER, "a tour")
    assert made is not None and (made == TRAVEL.distances[np.ix_(nodes, nodes)]).all()


def test_asked_to_stop_there_are_no_distances() -> None:
    assert dense(TRAVEL.distance, np.arange(50), Stop(0.0), "a tour") is None


def test_too_many_sites_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_SITES", 49)
    with pytest.raises(UsageError, match=r"a tour of 50 sites .* takes at most 49; savings needs none"):
        dense(TRAVEL.distance, np.arange(50), NEVER, "a tour", savings=True)
    with pytest.raises(UsageError, match=r"takes at most 49$"):
        dense(TRAVEL.distance, np.arange(50), NEVER, "greedy orienteering")
    monkeypatch.setattr(module, "MOST_SITES", 50)
    monkeypatch.setattr("waybound.instances.memory.available", lambda: 1e3)
    with pytest.raises(UsageError, check=coded("too-large")):
        dense(TRAVEL.distance, np.arange(50), NEVER, "a tour")


def problem(**travel: object) -> RoutingProblem:
    sites = Sites.of("abcd", depot=[True, False, True, False], demand=[0, 3, 0, 5], ready=[1, 2, 0, 0], due=[9, 9, 8, 7])
    made = Travel(EXPLICIT, matrix=np.arange(16.0).reshape(4, 4), **travel)  # type: ignore[arg-type]
    return RoutingProblem(sites, made, (VehicleType(start=0, end=2, max_distance=50.0),))


def test_nodes_are_the_start_the_customers_and_the_end() -> None:
    nodes, (demand, _, ready, due, distance, time), limits = site_data(problem(), NEVER, "insertion")
    assert nodes.tolist() == [0, 1, 3, 2]
    assert (demand.tolist(), ready.tolist(), due.tolist()) == ([0, 3, 5, 0], [1, 2, 0, 0], [9, 9, 7, 8])
    assert distance[1].tolist() == [4, 0, 7, 6] and time is distance
    assert limits == (1.0, 8.0, math.inf, 50.0)


def test_durations_of_their_own_are_kept_apart() -> None:
    found = site_data(problem(duration_matrix=np.ones((4, 4))), NEVER, "insertion")
    assert found is not None and found[1][5][0].tolist() == [0, 1, 1, 1]


def test_asked_to_stop_there_is_nothing() -> None:
    assert site_data(problem(), Stop(0.0), "insertion") is None
