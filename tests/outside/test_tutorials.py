"""What the tutorials of other toolkits show, asked through the public interface: the published result or better, with a verified bound.

Each case stands beside the published objective and beside the lines of code that the original takes for it, without data, printing,
comments and blank lines, counted by hand and rounded down.
"""

import inspect
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from city_corners import (
    CITY,
    CORNERS,
    DELIVERY,
    DEMAND,
    DUE,
    GROUPS,
    HEAVY,
    MINUTES,
    PICKUP,
    PRIZES,
    READY,
    SHIPMENTS,
    STREETS,
    ZONE,
)  # fmt: skip

import waybound as wb

from_frame = wb.RoutingProblem.from_frame
ANY = [999, *DUE[1:]]
TWO = [True, True, *[False] * 15]
OPTIONAL = [False] * 17
ANY_TWO = {"ready": [0, 0, *READY[2:]], "due": [999, 999, *DUE[2:]]}
SPAN = wb.TotalCost() + 100 * wb.LongestRoute()
"""The guide's "global span" adds 100 times the longest route to the total."""


@dataclass(frozen=True)
class Case:
    """``make`` states the problem, ``how`` is given to ``solve``; ``bound`` is the least that must be proved."""

    make: Callable[[], wb.Problem]
    published: float
    lines: int
    bound: float
    how: dict[str, Any]


# -- the routing guide of OR-Tools: objectives as its samples print them -------------------------------------------------------


def capacities() -> wb.Problem:
    return from_frame(CITY.assign(demand=DEMAND), travel=STREETS, vehicles=4, capacity=15)


def windows() -> wb.Problem:
    return from_frame(CITY.assign(ready=READY, due=ANY), travel=MINUTES, vehicles=4)


def global_span() -> wb.Problem:
    return from_frame(CITY, travel=STREETS, fleet=[{"count": 4, "max_distance": 3000}], objective=SPAN)


def pickups_and_deliveries() -> wb.Problem:
    return from_frame(CITY, travel=STREETS, fleet=[{"count": 4, "max_distance": 3000}], shipments=SHIPMENTS, objective=SPAN)


def dropped_visits() -> wb.Problem:
    sites = CITY.assign(demand=HEAVY, required=OPTIONAL, penalty=[0] + [1000] * 16)
    return from_frame(sites, travel=STREETS, vehicles=4, capacity=15, objective=wb.TotalCost() + wb.Penalties())


def starts_and_ends() -> wb.Problem:
    sites = CITY.assign(depot=CITY.id.isin([0, 1, 2, 15, 16]))
    fleet = [{"name": f"from {k}", "count": 1, "start": k, "end": 0, "max_distance": 2000} for k in (1, 2, 15, 16)]
    return from_frame(sites, travel=STREETS, fleet=fleet, min_vehicles=4, objective=SPAN)


INITIAL = [[8, 16, 14, 13, 12, 11], [3, 4, 9, 10], [15, 1], [7, 5, 2, 6]]

# -- PyVRP's tutorial: objectives as PyVRP finds them --------------------------------------------------------------------------


def windows_and_durations() -> wb.Problem:
    fleet = [{"count": 4, "max_duration": 30}]
    return from_frame(CITY.assign(ready=READY, due=ANY), travel=STREETS, durations=MINUTES, fleet=fleet)


def several_depots() -> wb.Problem:
    return from_frame(CITY.assign(depot=TWO, **ANY_TWO), travel=STREETS, durations=MINUTES, vehicles=2, max_duration=30)


def prizes() -> wb.Problem:
    sites = CITY.assign(depot=TWO, penalty=PRIZES, required=OPTIONAL, **ANY_TWO)
    return from_frame(sites, travel=STREETS, durations=MINUTES, vehicles=2, objective=wb.TotalCost() + wb.Penalties())


def deliveries_and_returns() -> wb.Problem:
    sites = CITY.assign(depot=TWO, penalty=PRIZES, required=OPTIONAL, demand=DELIVERY, pickup=PICKUP, **ANY_TWO)
    return from_frame(sites, travel=STREETS, durations=MINUTES, vehicles=2, capacity=15, objective=wb.TotalCost() + wb.Penalties())


def alternatives() -> wb.Problem:
    """PyVRP counts the prizes of what is left out: its objective is this one and all prizes."""
    sites = CITY.assign(depot=TWO, reward=PRIZES, required=OPTIONAL, **ANY_TWO)
    return from_frame(sites, travel=STREETS, durations=MINUTES, vehicles=2, groups=GROUPS, objective=wb.TotalCost() - wb.Reward())


def zones() -> wb.Problem:
    inside = np.array([all(a <= v <= b for a, v, b in zip(ZONE[0], corner, ZONE[1], strict=True)) for corner in CORNERS])
    barred = wb.Travel("EXPLICIT", matrix=np.where(inside, 1000, STREETS), duration_matrix=np.where(inside, 1000, MINUTES))
    fleet = [wb.VehicleType(2, name="any"), wb.VehicleType(2, start=0, end=1, travel=barred, name="not inside")]
    return from_frame(CITY.assign(depot=TWO, **ANY_TWO), travel=STREETS, durations=MINUTES, fleet=fleet)


def reloads() -> wb.Problem:
    fleet = [{"count": 2, "capacity": 15, "start": 0, "end": 0, "reloads": [0, 1], "max_reloads": 2}]
    return from_frame(CITY.assign(depot=TWO, demand=[0, 0, *DEMAND[2:]]), travel=STREETS, fleet=fleet)


CASES = {
    case.make.__name__: case
    for case in (
        Case(capacities, 6208, 30, 6208, {"solver": "pyvrp", "iterations": 1500, "bound_time": 10}),
        Case(windows, 71, 30, 71, {"solver": "highs", "bound_time": 5}),
        Case(global_span, 161408, 25, 161407.9, {"solver": "cpsat", "time_limit": 10, "bound_time": 5}),
        Case(pickups_and_deliveries, 226116, 30, 210503.9, {"solver": "ortools", "time_limit": 3, "bound_time": 5}),
        Case(dropped_visits, 7548, 35, 7548, {"solver": "pyvrp", "iterations": 1500, "bound_time": 10}),
        Case(starts_and_ends, 115794, 25, 115793.9, {"solver": "cpsat", "time_limit": 10, "bound_time": 5}),
        Case(windows_and_durations, 6528, 28, 6528, {"solver": "pyvrp", "iterations": 1500, "bound_time": 10}),
        Case(several_depots, 6004, 24, 6004, {"solver": "pyvrp", "iterations": 1500, "bound_time": 10}),
        Case(prizes, 5145, 26, 5145, {"solver": "pyvrp", "iterations": 1500, "bound_time": 10}),
        Case(deliveries_and_returns, 5375, 29, 5204, {"solver": "pyvrp", "iterations": 1500, "bound_time": 10}),
        Case(alternatives, 5869 - sum(PRIZES), 28, 5869 - sum(PRIZES), {"solver": "pyvrp", "iterations": 1500, "bound_time": 10}),
        Case(zones, 6072, 45, 6071.9, {"solver": "pyvrp", "iterations": 1500, "bound_time": 10}),
        Case(reloads, 5728, 20, 5660, {"solver": "pyvrp", "iterations": 1500, "bound_time": 10}),
    )
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_a_tutorial_is_answered_as_well_as_published_with_a_verified_bound(name: str) -> None:
    case = CASES[name]
    solution = wb.solve(case.make(), seed=1, **case.how)
    assert solution.certificate.feasible
    assert solution.objective <= case.published
    assert case.bound <= solution.certificate.bound <= solution.objective


@pytest.mark.parametrize("name", CASES)
def test_a_tutorial_takes_at_most_a_third_of_the_lines_of_its_original(name: str) -> None:
    own = [line for line in inspect.getsource(CASES[name].make).splitlines() if line.strip()]
    assert 3 * len(own) <= CASES[name].lines, (len(own), CASES[name].lines)


@pytest.mark.slow
def test_initial_routes_are_improved() -> None:
    problem = global_span()
    before = wb.check(problem, INITIAL)
    assert (before.feasible, before.objective) == (True, 255004)
    after = wb.solve(problem, "ortools", start=INITIAL, time_limit=3, bound_time=5)
    assert after.objective <= 161408
    assert after.certificate.bound >= 161407.9


# -- VROOM's examples (docs/example_*.json) ------------------------------------------------------------------------------------

MATRIX = {
    "vehicles": [{"id": 0, "start_index": 0, "end_index": 3}],
    "jobs": [{"id": 1414, "location_index": 1}, {"id": 1515, "location_index": 2}],
    "matrix": [[0, 2104, 197, 1299], [2103, 0, 2255, 3152], [197, 2256, 0, 1102], [1299, 3153, 1102, 0]],
}


# fmt: off
PARIS = [(2.35044, 48.71764), (1.98935, 48.701), (2.03655, 48.61128), (2.28325, 48.5958), (2.89357, 48.90736), (2.41808, 49.22619),
         (2.39719, 49.07611)]
# fmt: on
JOBS = [1, 2, 5, 6, 4, 3]
"""The ids of the examples' stops, in the order of PARIS after the depot."""


def straight(kilometres_an_hour: float = 60.0) -> list[list[int]]:
    """Seconds between the examples' places along great circles: the routing service that VROOM asked is none of the data."""
    longitude, latitude = np.radians(np.array(PARIS)).T
    half = np.sin((latitude[:, None] - latitude) / 2) ** 2
    half += np.cos(latitude[:, None]) * np.cos(latitude) * np.sin((longitude[:, None] - longitude) / 2) ** 2
    return (2 * 6371 * np.arcsin(np.sqrt(half)) / kilometres_an_hour * 3600).round().astype(int).tolist()


def depot(**more: Any) -> dict[str, Any]:
    return {"start_index": 0, "end_index": 0, "capacity": [4], **more}


def stop(number: int, **more: Any) -> dict[str, Any]:
    return {"id": number, "location_index": 1 + JOBS.index(number), "service": 300, **more}


def asked_of_vroom(folder: Path, data: dict[str, Any]) -> wb.Problem:
    (folder / "example.json").write_text(json.dumps({"matrices": {"car": {"durations": straight()}}, **data}))
    return wb.read(folder / "example.json")


def stops_of(solution: wb.Solution) -> set[tuple[str, ...]]:
    rows = solution.to_frame()
    return {tuple(part["site"]) for _, part in rows.groupby("vehicle")}


@pytest.mark.slow
def test_vrooms_example_with_a_matrix(tmp_path: Path) -> None:
    """VROOM's objective is to serve as much as can be, and then the least cost: here all that there is, at the published cost."""
    (tmp_path / "example.json").write_text(json.dumps(MATRIX))
    solution = wb.solve(wb.read(tmp_path / "example.json"), "highs", bound_time=30)
    assert solution.objective == [2, 5461]
    assert stops_of(solution) == {("1414", "1515")}
    assert (solution.bound, solution.bound_kind) == ([2, 5461], "verified")


@pytest.mark.slow
def test_vrooms_example_with_skills_and_a_shipment(tmp_path: Path) -> None:
    """Without breaks, which are no part of the family, and along great circles (as long forth as back): who visits what is as published."""
    shift = {"time_window": [28800, 43200]}
    deliveries = [stop(1, delivery=[1], skills=[1], time_windows=[[32400, 36000]]), stop(2, delivery=[1], skills=[1])]
    deliveries += [stop(5, delivery=[1], skills=[14]), stop(6, delivery=[1], skills=[14])]
    shipment = {"amount": [1], "skills": [2], "pickup": stop(4), "delivery": stop(3)}
    vehicles = [depot(id=1, skills=[1, 14], **shift), depot(id=2, skills=[2, 14], **shift)]
    problem = asked_of_vroom(tmp_path, {"vehicles": vehicles, "jobs": deliveries, "shipments": [shipment]})
    solution = wb.solve(problem, "highs", time_limit=20, bound_time=30)
    one, other = sorted(stops_of(solution))
    assert one in (("1", "2", "5"), ("5", "2", "1"))
    assert other == ("6", "pickup 4", "delivery 3")
    assert (solution.bound, solution.bound_kind) == (solution.objective, "verified")


LEGS = {(0, 1): 2328, (1, 2): 890, (2, 3): 1595, (3, 0): 1752, (0, 4): 2941, (4, 5): 3816, (5, 6): 1909, (6, 0): 3480}
"""Seconds of the moves of the published plan, by its cumulated durations; the other moves of the road network are none of the data."""


def test_vrooms_example_of_a_plan_that_breaks_its_limits(tmp_path: Path) -> None:
    """Published: vehicle 1 is overloaded (7 of 4); vehicle 2, which leaves 800 s before its hours as the plan asks, is 1266 s late at its
    last stop, and 1446 s at the depot."""
    opens, closes = 1600416000, 1600426800
    amounts = {1: 2, 2: 2, 5: 3, 6: 1, 4: 1, 3: 1}
    late = {"time_windows": [[opens, 1600423200]]}
    jobs = [stop(number, delivery=[amount], **(late if number in (6, 4, 3) else {})) for number, amount in amounts.items()]
    vehicles = [depot(id=1, time_window=[opens, closes]), depot(id=2, time_window=[opens - 800, closes])]
    seconds = straight()
    for (i, j), leg in LEGS.items():
        seconds[i][j] = leg
    problem = asked_of_vroom(tmp_path, {"matrices": {"car": {"durations": seconds}}, "vehicles": vehicles, "jobs": jobs})
    verdict = wb.check(problem, wb.Routes((wb.Route((1, 2, 3), 0), wb.Route((4, 5, 6), 1))))
    assert verdict.feasible is False
    assert [(v.check, v.amount) for v in verdict.violations] == [("load", 3), ("time-windows", 1266), ("time-windows", 1446)]
