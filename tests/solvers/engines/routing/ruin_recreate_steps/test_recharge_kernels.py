from dataclasses import replace

import numpy as np
import pytest
from small_routing import varied

import waybound as wb
from waybound.formulations.routing.routes import Route, Routes
from waybound.solvers.backend import Control, Options, RawResult
from waybound.solvers.engines.routing.routing_integers import searched_integers
from waybound.solvers.engines.routing.ruin_recreate import RuinRecreate
from waybound.solvers.engines.routing.ruin_recreate_steps.arrays import arrays

REFUEL = np.array([[0, 0], [8, 0], [2, 3], [5, 4], [9, 4], [11, 0], [6, -3]], dtype=float)
LINE = np.array([[0, 0], [10, 0], [1, 0], [11, 0]], dtype=float)


def stored(xy: np.ndarray, energy: float, homes: list[int], aim: object = None, **more: object) -> wb.RoutingProblem:
    """Two depots, which are stations too, and a vehicle at each of some homes."""
    sites = wb.Sites.of(range(len(xy)), depot=np.arange(len(xy)) < 2, coordinates=xy, **more)
    kinds = {home: homes.count(home) for home in homes}
    fleet = [wb.VehicleType(many, start=home, end=home, energy=wb.Energy(energy, 1.0, "travel", (0, 1))) for home, many in kinds.items()]
    return wb.RoutingProblem(sites, wb.Travel("manhattan", xy), fleet, aim)


def searched(problem: wb.RoutingProblem, iterations: int = 3000) -> RawResult:
    return RuinRecreate().run(problem, Options(time_limit=60.0, iterations=iterations), Control())


@pytest.mark.parametrize(("energy", "least"), [(9.5, None), (10.0, 22.0), (22.0, 22.0)])
def test_stations_come_one_after_another_and_no_way_is_longer_than_a_store_lasts(energy: float, least: float | None) -> None:
    problem = stored(LINE, energy, [0])
    found = searched(problem)
    assert (found.answer and problem.evaluate(found.answer).values[0]) == least


@pytest.mark.parametrize(("energy", "homes", "least"), [(14.0, [0], 56.0), (14.0, [0, 1], 28.0), (14.0, [0, 0], 36.0), (16.0, [0], 44.0)])
def test_least_makespans_with_stores_that_are_filled_up(energy: float, homes: list[int], least: float) -> None:
    problem = stored(REFUEL, energy, homes, wb.Makespan())
    judged = problem.evaluate(searched(problem, 10_000).answer)
    assert judged.feasible and judged.values[0] == least


def test_no_station_is_left_where_nobody_needs_it() -> None:
    problem = stored(REFUEL, 60.0, [0])
    answer = searched(problem).answer
    assert answer is not None and {0, 1}.isdisjoint(site for route in answer for site in route.visits)


@pytest.mark.parametrize("pickup", [False, True])
def test_nothing_is_loaded_at_a_station(pickup: bool) -> None:
    """Two sites of 6 each are on no route of a vehicle of 10 together, wherever it stops."""
    load = [0, 0, 6, 6]
    problem = stored(LINE, 30.0, [0], demand=[0, 0, 6, 0] if pickup else load, pickup=[0, 0, 6, 6] if pickup else [0] * 4)
    two = replace(problem, fleet=(replace(problem.fleet[0], count=2, capacity=10.0),))
    found = searched(two)
    assert two.evaluate(found.answer).feasible and len(found.answer) == 2


def test_a_start_of_more_stops_than_there_are_nodes_for_is_refused() -> None:
    problem = stored(LINE, 50.0, [0])
    held = arrays(problem, searched_integers(problem)[0], 60, 1)
    before = held.node.copy()
    assert not held.begin(Routes((Route((2, *[0] * 50, 3)),))) and np.array_equal(held.node, before)
    assert held.begin(Routes((Route((2, 0, 1, 3)),)))


@pytest.mark.parametrize(("feature", "lacking"), [("shipments", "recharging with shipments"), ("reloads", "recharging with reloads")])
def test_what_does_not_go_with_stations_is_refused(feature: str, lacking: str) -> None:
    problem = varied(feature, 0, 3)
    stations = tuple(problem.sites.depots.tolist())
    filled = replace(problem, fleet=tuple(replace(v, energy=wb.Energy(99.0, 1.0, "travel", stations)) for v in problem.fleet))
    filled = replace(filled, objective=wb.Objective.of(wb.TotalCost()))
    assert lacking in RuinRecreate().missing(filled)
