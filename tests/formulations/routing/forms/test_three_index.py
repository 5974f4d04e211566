from pathlib import Path

import numpy as np
import pytest
from oracles import SQUARE_4, TW_4, agrees, routing, solved
from program_text import TWO_SITES, expected, program_text, written

from waybound.instances.routing.instance import Energy, VehicleType


def test_three_index_from_text_to_text(tmp_path: Path) -> None:
    """Nobody is at a by 9 after b (5 + 2 + 4): that move is dropped. Who begins at b by 9 is home by 16. Vehicle 2 leaves a to 1."""
    assert written(TWO_SITES, "three-index", tmp_path) == expected("""
        three-index, exact
        min 3 x[o,a,1] + 3 x[o,a,2] + 5 x[o,b,1] + 5 x[o,b,2] + 4 x[a,b,1] + 4 x[a,b,2] + 3 x[a,o,1] + 3 x[a,o,2] + 5 x[b,o,1] +
            5 x[b,o,2]
        visit[a]: x[a,b,1] + x[a,b,2] + x[a,o,1] + x[a,o,2] = 1
        visit[b]: x[b,o,1] + x[b,o,2] = 1
        fleet: x[o,a,1] + x[o,a,2] + x[o,b,1] + x[o,b,2] >= 1
        depart[1]: x[o,a,1] + x[o,b,1] + x[o,o,1] = 1
        depart[2]: x[o,a,2] + x[o,b,2] + x[o,o,2] = 1
        flow[a,1]: x[o,a,1] - x[a,b,1] - x[a,o,1] = 0
        flow[b,1]: x[o,b,1] + x[a,b,1] - x[b,o,1] = 0
        flow[a,2]: x[o,a,2] - x[a,b,2] - x[a,o,2] = 0
        flow[b,2]: x[o,b,2] + x[a,b,2] - x[b,o,2] = 0
        load[1]: 2 x[a,b,1] + 2 x[a,o,1] + x[b,o,1] <= 4
        load[2]: 2 x[a,b,2] + 2 x[a,o,2] + x[b,o,2] <= 4
        distance[1]: 3 x[o,a,1] + 5 x[o,b,1] + 4 x[a,b,1] + 3 x[a,o,1] + 5 x[b,o,1] <= 12
        distance[2]: 3 x[o,a,2] + 5 x[o,b,2] + 4 x[a,b,2] + 3 x[a,o,2] + 5 x[b,o,2] <= 12
        time[o,a,1]: 6 x[o,a,1] + departure[1] - t[a,1] <= 3
        time[o,a,2]: 6 x[o,a,2] + departure[2] - t[a,2] <= 3
        time[o,b,1]: 6 x[o,b,1] + departure[1] - t[b,1] <= 1
        time[o,b,2]: 6 x[o,b,2] + departure[2] - t[b,2] <= 1
        time[a,b,1]: 9 x[a,b,1] + t[a,1] - t[b,1] <= 4
        time[a,b,2]: 9 x[a,b,2] + t[a,2] - t[b,2] <= 4
        time[a,o,1]: 6 x[a,o,1] + t[a,1] - return[1] <= 2
        time[a,o,2]: 6 x[a,o,2] + t[a,2] - return[2] <= 2
        time[b,o,1]: 9 x[b,o,1] + t[b,1] - return[1] <= 2
        time[b,o,2]: 9 x[b,o,2] + t[b,2] - return[2] <= 2
        x[o,a,1], x[o,b,1], x[o,b,2], x[o,o,1], x[o,o,2], x[a,b,1], x[a,o,1], x[b,o,1], x[b,o,2] binary
        x[o,a,2], x[a,b,2], x[a,o,2] = 0 integer
        0 <= departure[1], departure[2] <= 6
        3 <= t[a,1], t[a,2] <= 9
        5 <= t[b,1], t[b,2] <= 9
        7 <= return[1], return[2] <= 16
    """)


@pytest.mark.parametrize(
    ("charge", "row"),
    [
        ("travel", "energy[1]: 6 x[0,1,1] + 6 x[1,0,1] <= 20"),
        ("elapsed", "energy[1]: - 2 departure[1] + 2 return[1] <= 20"),
        ("windows", "energy[1]: 10 x[0,1,1] + 8 x[1,0,1] <= 20"),
        ("elapsed-fixed-start", None),
    ],
)
def test_each_charge_of_energy_writes_its_own_row(charge: str, row: str | None) -> None:
    """One site 3 away that opens at 5 and takes 1; 2 a unit of time are drawn of 20, so that a fixed start means to be home by 10."""
    matrix = np.array([[0, 3], [3, 0]], dtype=float)
    sites = {"ready": [0, 5], "service": [0, 1]}
    problem = routing(matrix=matrix, sites=sites, count=1, energy=Energy(20, 2, charge))
    lines = program_text(problem.compile("three-index").program).splitlines()
    assert [line for line in lines if line.startswith("energy")] == ([] if row is None else [row])
    assert any("return[1] <= 10" in line for line in lines) == (row is None)


def test_numbers_of_visits_exclude_cycles_that_take_no_time() -> None:
    """All at one place: u grows along each move between two customers, whoever makes it."""
    lines = program_text(routing(xy=np.zeros((3, 2)), count=1).compile("three-index").program).splitlines()
    assert [line for line in lines if line.startswith("order")] == [
        "order[1,2,1]: 2 x[1,2,1] + u[1] - u[2] <= 1",
        "order[2,1,1]: 2 x[2,1,1] - u[1] + u[2] <= 1",
    ]
    assert "1 <= u[1], u[2] <= 2" in lines


def test_a_late_departure_saves_elapsed_time_but_not_from_a_fixed_start() -> None:
    """Route 2-3-1 lasts 17 from the latest departure and 18 from the opening of the depot."""
    for store, charge, value in ((17, "elapsed", 22.0), (16.9, "elapsed", 24.0), (17, "elapsed-fixed-start", 24.0)):
        agrees(routing(xy=SQUARE_4, sites=dict(TW_4), count=4, energy=Energy(store, 1.0, charge)), "three-index", value)
    agrees(routing(xy=SQUARE_4, sites=dict(TW_4), count=4, max_duration=17.0), "three-index", 22.0)


def test_three_index_gives_each_type_its_own_depot() -> None:
    xy = np.array([(0, 0), (1, 0), (9, 0), (10, 0)], dtype=float)
    sites = {"depot": [True, False, False, True]}
    fleet = (VehicleType(count=1, start=0, end=0, name="west"), VehicleType(count=1, start=3, end=3, name="east"))
    problem = routing(xy=xy, sites=sites, fleet=fleet)
    agrees(problem, "three-index", 4.0)
    made = problem.compile("three-index")
    assert {r.vehicle: r.visits for r in made.decode(solved(made.program)[2])} == {0: (1,), 1: (2,)}
