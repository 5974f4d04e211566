import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from oracles import routing
from small_routing import varied

from waybound import Energy, Route, Routes, RoutingProblem, Shipment, UnsupportedError, VehicleType
from waybound.solvers.backend import Control, Options
from waybound.solvers.engines.routing.ortools import ORTools, _parameters
from waybound.solvers.engines.routing.ortools_model import Model
from waybound.solvers.engines.routing.ortools_stops import Stop, stops_on_the_way
from waybound.solvers.engines.routing.routing_integers import integer_routing

LINE = np.array([(0, 0), (10, 0), (4, 0), (14, 0), (18, 0)], dtype=float)
"""Home, a depot at 10, and sites at 4, 14 and 18."""


def lined(sites: dict[str, Any] | None = None, **vehicle: Any) -> RoutingProblem:
    return routing(xy=LINE, sites={"depot": [True, True, False, False, False], **(sites or {})}, count=1, **vehicle)


LOADED = lined({"demand": [0, 0, 3, 3, 2]}, capacity=5.0, reloads=(0, 1))
CASES = {
    "delivered": LOADED,
    "delivered-and-collected": lined({"demand": [0, 0, 3, 1, 2], "pickup": [0, 0, 1, 4, 2]}, capacity=5.0, reloads=(1,)),
    "shipped": lined({"demand": [0, 0, 0, 0, 4], "shipments": [Shipment(2, 3, (2.0,))]}, capacity=5.0, reloads=(1,)),
    "once": replace(LOADED, fleet=(replace(LOADED.fleet[0], max_reloads=1),)),
    "recharged": lined(energy=Energy(20.0, stations=(1,))),
    "half-full": lined(energy=Energy(16.0, stations=(0, 1), initial=11.0)),
    "reloaded-and-recharged": lined({"demand": [0, 0, 3, 3, 2]}, capacity=5.0, reloads=(0,), energy=Energy(30.0, stations=(1,))),
    "serviced": lined({"demand": [0, 0, 3, 3, 2], "service": [1, 5, 1, 1, 1]}, capacity=5.0, reloads=(0, 1), max_duration=50.0),
    "open-late": lined({"demand": [0, 0, 3, 3, 2], "ready": [0, 12, 0, 0, 0], "due": [90, 30, 90, 90, 40]}, capacity=5.0, reloads=(1,)),
}


def sequences(problem: RoutingProblem) -> list[tuple[int, ...]]:
    """All orders of all sites, with one depot at most in each gap."""
    gaps = [(), *((depot,) for depot in sorted({*problem.fleet[0].reloads, *problem.fleet[0].stations}))]
    orders = itertools.permutations(problem.customers.tolist())
    found = []
    for order, stops in itertools.product(orders, itertools.product(gaps, repeat=len(problem.customers) + 1)):
        found.append(tuple(itertools.chain(stops[0], *((site, *stop) for site, stop in zip(order, stops[1:], strict=True)))))
    return found


@pytest.mark.parametrize("case", CASES)
def test_what_it_lets_pass_is_what_the_judge_lets_pass(case: str) -> None:
    problem = CASES[case]
    model = Model(problem, integer_routing(problem), len(problem.customers))
    model.routing.CloseModelWithParameters(_parameters(Options(), 1.0))
    passed = 0
    for visits in sequences(problem)[:: 3 if len(problem.fleet[0].reloads) > 1 else 1]:
        answer = Routes((Route(visits, 0),))
        feasible = problem.evaluate(answer).feasible
        assert (model.assignment(answer) is not None) == feasible, visits
        passed += feasible
    assert passed


def test_a_depot_is_stopped_at_as_often_as_an_answer_has_to() -> None:
    fleet = (
        VehicleType(2, reloads=(1,), max_reloads=1, name="a"),
        VehicleType(1, reloads=(1,), energy=Energy(9.0, stations=(1,)), name="b"),
    )
    problem = routing(xy=LINE, fleet=fleet, sites={"depot": [True, True, False, False, False]})
    found = stops_on_the_way(problem, [0, 0, 1], 99)
    assert found == [Stop(1, frozenset({0}), True, False)] * 2 + [Stop(1, frozenset({1}), True, True)] * 6
    assert len(stops_on_the_way(problem, [0, 0, 1], 3)) == 2 + 3


def test_nobody_drives_to_stop_at_depots_alone() -> None:
    problem = lined(energy=Energy(40.0, stations=(1,)))
    model = Model(problem, integer_routing(problem), 3)
    model.routing.CloseModelWithParameters(_parameters(Options(), 1.0))
    assert model.assignment(Routes.of([[1]])) is None


@pytest.mark.parametrize("case", ["delivered", "recharged", "shipped"])
def test_it_finds_the_best_walk(case: str) -> None:
    problem = CASES[case]
    best = min(verdict.values[0] for visits in sequences(problem) if (verdict := problem.evaluate(Routes((Route(visits, 0),)))).feasible)
    found = ORTools().run(problem, Options(time_limit=60.0, iterations=200), Control())
    assert found.objective == pytest.approx(best)


def test_charges_of_windows_are_refused_beside_stops() -> None:
    problem = varied("reloads", 0, 3)
    charged = replace(problem, fleet=tuple(replace(v, energy=Energy(999.0, charge="windows")) for v in problem.fleet))
    with pytest.raises(UnsupportedError, match="energy:windows with stops at depots"):
        ORTools().run(charged, Options(), Control())
