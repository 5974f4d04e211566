import numpy as np
import pytest
from oracles import GAP_5, OCTO_8, SQUARE_4, TW_4, agrees, optimum, routing, solved
from program_text import lines_of

from waybound import LatestReturn, LongestRoute, Makespan, Reward, TotalCost, TotalDuration, VehicleType
from waybound.formulations.forms import FORMS

LINE = np.array([(0, 0), (3, 0)], dtype=float)


def test_a_makespan_is_at_least_the_work_of_every_vehicle() -> None:
    problem = routing(xy=LINE, count=2, sites={"service": [0, 1]}, objective=Makespan())
    assert lines_of(problem, "min", "worked", "elapsed", "makespan") == [
        "min makespan",
        "worked[1]: 3 x[0,1,1] + 4 x[1,0,1] - duration[1] <= 0",
        "makespan[1]: makespan - duration[1] >= 0",
    ]
    agrees(problem, "three-index", 7.0)


def test_where_somebody_may_wait_the_departure_is_free() -> None:
    """The site opens at 10, 3 away, and takes 1: 7 from a departure at 7, paid 2 each; what is beyond 5 costs 3 more."""
    sites = {"service": [0, 1], "ready": [0, 10], "due": [50, 20]}
    problem = routing(xy=LINE, count=1, sites=sites, unit_cost=0.0, unit_duration_cost=2.0, regular_duration=5.0, unit_overtime_cost=3.0)
    assert lines_of(problem, "min", "worked", "elapsed", "overtime") == [
        "min 2 duration[1] + 3 overtime[1]",
        "elapsed[1]: departure[1] - return[1] + duration[1] >= 0",
        "worked[1]: 3 x[0,1,1] + 4 x[1,0,1] - duration[1] <= 0",
        "overtime[1]: - duration[1] + overtime[1] >= -5",
    ]
    agrees(problem, "three-index", 20.0)
    agrees(routing(xy=LINE, count=1, sites=sites, objective=LatestReturn()), "three-index", 14.0)
    agrees(routing(xy=LINE, count=1, sites=sites, objective=TotalDuration()), "three-index", 7.0)


def test_nobody_has_to_return_who_has_not_left() -> None:
    """The second type is on duty from 50 on, and stays at home."""
    fleet = (VehicleType(1, name="day"), VehicleType(1, shift=(50.0, 90.0), name="night"))
    problem = routing(xy=LINE, fleet=fleet, objective=LatestReturn())
    assert "latest[2]: 56 x[0,0,2] - return[2] + latest >= 0" in lines_of(problem, "latest")
    agrees(problem, "three-index", 6.0)
    agrees(routing(xy=LINE, fleet=fleet[1:], objective=LatestReturn()), "three-index", 56.0)


MAKESPANS = [("SQUARE-4", 1, 18.0), ("SQUARE-4", 2, 12.0), ("SQUARE-4", 4, 10.0)]


@pytest.mark.parametrize(("name", "vehicles", "value"), MAKESPANS)
def test_reference_values_of_the_makespan(name: str, vehicles: int, value: float) -> None:
    for objective in (Makespan(), LongestRoute(), LatestReturn()):
        problem = routing(xy=SQUARE_4, count=vehicles, objective=objective)
        for form in ("three-index", "set-partitioning"):
            agrees(problem, form, value)


def test_the_root_of_the_makespan_is_as_published() -> None:
    """Three-index roots of the uncorrected rows are 9 and 25.388: the average of the shortest successors."""
    for xy, root in ((SQUARE_4, 9.0), (OCTO_8, 25.388)):
        found = solved(routing(xy=xy, count=2, objective=Makespan()).compile("three-index", relax=True).program)[1]
        assert found >= root - 1e-3


@pytest.mark.parametrize(("limit", "value"), [(12.0, 22.0), (8.0, 9.0)])
def test_nobody_collects_a_reward_twice(limit: float, value: float) -> None:
    """As printed, a site that is last on its routes is free to all vehicles: 30 and 10."""
    sites = {"required": False, "reward": [0, 4, 10, 5, 3]}
    problem = routing(xy=SQUARE_4, count=2, max_distance=limit, sites=sites, objective=Reward())
    for form in ("three-index", "set-partitioning"):
        agrees(problem, form, value)


def test_a_weight_of_the_makespan_may_cost_the_best_reward() -> None:
    """A = (5, 0) with reward 10 takes all of the 10 there are, B = (-0.5, 0) with 9 takes 1: with the printed weight 0.9 B is better."""
    sites = {"required": False, "reward": [0, 10, 9]}
    xy = np.array([(0, 0), (5, 0), (-0.5, 0)])
    for objective, value in ((Reward(), 10.0), (Reward() - 0.9 * Makespan(), 8.1), (Reward() - 0.01 * Makespan(), 9.9)):
        problem = routing(xy=xy, count=1, max_duration=10.0, sites=sites, objective=objective)
        for form in ("three-index", "set-partitioning"):
            agrees(problem, form, value)


def test_a_maximum_that_should_be_large_is_refused() -> None:
    form = FORMS["three-index"]
    assert form.missing(routing(xy=SQUARE_4, count=2, objective=Reward() + LongestRoute())) == {"objective:longest-route"}
    paid = {"unit_duration_cost": 1.0, "regular_duration": 3.0, "unit_overtime_cost": 1.0}
    waits = routing(xy=SQUARE_4, sites=dict(TW_4), count=2, objective=Reward() + TotalCost(), **paid)
    assert form.missing(waits) == {"overtime", "duration-cost"}
    assert form.missing(routing(xy=SQUARE_4, count=2, objective=Reward() + TotalDuration())) == set()
    several = routing(xy=GAP_5, count=2, sites={"windows": {1: [(0, 30), (40, 60)]}}, max_duration=90.0, objective=LatestReturn())
    assert form.missing(several) == {"several-windows"}
    agrees(several, "set-partitioning", optimum(several))
