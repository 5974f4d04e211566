"""Every solver through ``solve``: the same words in, a verified answer out, whatever the solver."""

import _thread
import threading
from typing import Any

import numpy as np
import pytest
from patience import HANG
from programs import program
from small_routing import small
from truth.routing import best_values

import waybound as wb
from waybound import RoutingProblem, Sites, Travel, VehicleType
from waybound.solvers.backend import BACKENDS

ROUTING = ("ortools", "pyvrp")
PROGRAMS = ["highs", "pulp", "cpsat", "mathopt", *(["scip"] if BACKENDS["scip"].installed() else [])]
APART = [pytest.param(name, marks=pytest.mark.long) for name in ("cvxpy", "mathopt:highs")]
"""They need a process of their own, which takes seconds each time."""


@pytest.fixture(params=[*PROGRAMS, *ROUTING, *APART])
def solver(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.mark.share(3)
@pytest.mark.parametrize(
    ("feature", "convention"),
    [("capacity", "round"), ("time-windows", "exact"), ("service-times", "round"), ("limited-fleet", "exact")],
)
def test_all_solvers_find_the_optimum_of_small_problems(solver: str, feature: str, convention: str) -> None:
    problem = small(feature, 1, convention)
    work = {"iterations": 300} if solver in ROUTING else {}
    solution = wb.solve(problem, solver, time_limit=HANG, bound_time=0, **work)
    assert solution.certificate.feasible
    assert solution.objective == pytest.approx(best_values(problem)[0], abs=1e-6)
    assert solution.status in ("optimal", "feasible")


def test_programs_that_are_not_routing_are_solved_as_they_are(solver: str) -> None:
    if solver in ROUTING:
        pytest.skip("an engine for routing problems")
    solution = wb.solve(program([2, 3], [[1, 1]], 4.5, np.inf, integer=[1]), solver)
    assert solution.status == "optimal"
    assert solution.objective == pytest.approx(9.0)


@pytest.mark.share(3)
@pytest.mark.share(3)
def test_isolation_changes_nothing_but_the_process(solver: str) -> None:
    problem = small("capacity", 0, "round")
    work = {"iterations": 100} if solver in ROUTING else {}
    apart = wb.solve(problem, solver, time_limit=HANG, bound_time=0, isolate=True, **work)
    here = wb.solve(problem, solver, time_limit=HANG, bound_time=0, **work)
    assert (apart.status, apart.objective) == (here.status, here.objective)


@pytest.mark.share(3)
def test_demand_beyond_the_fleet_has_no_answer(solver: str) -> None:
    problem = small("capacity", 1, "round")
    problem = RoutingProblem(problem.sites, problem.travel, (VehicleType(1, 10.0),))
    solution = wb.solve(problem, solver, time_limit=0.5, bound_time=0)
    assert solution.answer is None
    assert solution.status in ("infeasible", "unknown")


@pytest.mark.share(2)
@pytest.mark.parametrize("solver", ["pyvrp", "ortools"])
def test_an_interrupt_of_the_user_returns_a_verified_answer(solver: str) -> None:
    rng = np.random.default_rng(0)
    xy = rng.uniform(0, 100, (61, 2))
    sites = Sites.of(range(61), demand=np.append(0.0, rng.uniform(1, 20, 60)), coordinates=xy)
    problem = RoutingProblem(sites, Travel("euclidean", xy), (VehicleType(capacity=100.0),))
    asked: list[threading.Timer] = []

    def heard(event: dict[str, Any]) -> None:
        if event["objective"] is not None and not asked:
            asked.append(threading.Timer(0.1, _thread.interrupt_main))
            asked[0].start()

    solution = wb.solve(problem, solver, time_limit=HANG, bound_time=0, progress=heard)
    assert solution.limit == "interrupt"
    assert solution.certificate.feasible
