from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from small_routing import small

from waybound.formulations.routing.problem import RoutingProblem
from waybound.formulations.routing.routes import Routes
from waybound.instances.errors import UsageError
from waybound.instances.routing.instance import Sites, VehicleType
from waybound.instances.routing.travel import Travel
from waybound.solvers.backend import BACKENDS, Control, Options

pytestmark = pytest.mark.skipif(not BACKENDS["vroom"].installed(), reason="VROOM is not installed")


def run(problem: RoutingProblem, **options):
    return BACKENDS["vroom"]().run(problem, Options(**options), Control())


def test_it_goes_the_ways_of_the_bare_library() -> None:
    import vroom

    problem = small("capacity", 0, "round")
    bare = vroom.Input()
    bare.set_durations_matrix("car", problem.travel.distances)
    bare.add_job([vroom.Job(i, i, delivery=[int(problem.sites.demand[i])]) for i in problem.customers.tolist()])
    bare.add_vehicle([vroom.Vehicle(k, start=0, end=0, capacity=[int(problem.fleet[0].capacity)]) for k in range(len(problem.customers))])
    found = bare.solve(exploration_level=5, nb_threads=1)
    ours = run(problem)
    assert ours.objective == found.summary.cost
    jobs = found.routes[found.routes["type"] == "job"]
    assert {r.visits for r in ours.answer} == {tuple(map(int, v["location_index"])) for _, v in jobs.groupby("vehicle_id")}


def test_the_exploration_level_is_a_number_from_0_to_5() -> None:
    problem = small("capacity", 0, "round")
    assert run(problem, extra={"exploration_level": "0"}).statistics["exploration_level"] == 0
    for wrong in (-1, 6):
        with pytest.raises(UsageError, match="exploration_level is a number from 0 to 5"):
            run(problem, extra={"exploration_level": wrong})


def test_types_of_vehicles_have_costs_of_their_own() -> None:
    problem = small("capacity", 0, "round")
    dear, cheap = (
        replace(problem.fleet[0], unit_cost=3.0, name="dear"),
        replace(problem.fleet[0], unit_cost=0.5, fixed_cost=2.0, name="cheap"),
    )
    found = run(replace(problem, fleet=(dear, cheap)))
    assert {r.vehicle for r in found.answer} == {1}


def test_a_feasible_start_is_used_and_another_is_not() -> None:
    problem = small("time-windows", 0, "round")
    best = run(problem)
    again = run(problem, start=best.answer, extra={"exploration_level": 0})
    assert (again.statistics["start"], again.objective) == ("used", best.objective)
    assert run(problem, start=Routes.of([problem.customers.tolist()] * 2)).statistics["start"] == "refused"


def test_numbers_that_32_bits_cannot_hold_are_rounded() -> None:
    xy = np.array([[0.0, 0.0], [1.0, 1.0], [2.0**31, 0.0]])
    problem = RoutingProblem(Sites.of(range(3), coordinates=xy), Travel("EUC_2D", xy), (VehicleType(),))
    found = run(problem)
    assert found.statistics["scale"]["exact"] is False
    assert problem.evaluate(found.answer).values == pytest.approx([2.0**32])


def test_what_fractions_cost_is_told_by_the_problem_itself() -> None:
    problem = small("capacity", 0, "exact")
    found = run(problem)
    assert found.objective == problem.evaluate(found.answer).values[0]
    assert found.statistics["scale"]["exact"] is False
