import numpy as np
from oracles import agrees, routing
from program_text import lines_of

from waybound.instances.routing.instance import Energy, Group, Shipment

LINE = np.array([(0, 0), (1, 0), (2, 0)], dtype=float)


def test_one_of_a_group_is_visited() -> None:
    row = "x[1,2,1] + x[1,0,1] + x[2,1,1] + x[2,0,1]"
    problem = routing(xy=LINE, count=1, sites={"groups": [Group((1, 2))]})
    assert lines_of(problem, "group") == [f"group[1]: {row} = 1"]
    agrees(problem, "three-index", 2.0)
    free = routing(xy=LINE, count=1, sites={"groups": [Group((1, 2), required=False)]})
    assert lines_of(free, "group") == [f"group[1]: 0 <= {row} <= 1"]
    agrees(free, "three-index", 0.0)


def test_the_vehicle_that_picks_up_delivers_later() -> None:
    """Site 2 delivers to site 1: the way there is 2 long, and home from 1."""
    problem = routing(xy=LINE, count=1, sites={"shipments": [Shipment(2, 1, 1.0)]}, capacity=1.0)
    assert lines_of(problem, "together", "precedes", "order") == [
        "order[1,2,1]: 2 x[1,2,1] + u[1] - u[2] <= 1",
        "order[2,1,1]: 2 x[2,1,1] - u[1] + u[2] <= 1",
        "together[2,1,1]: - x[1,2,1] - x[1,0,1] + x[2,1,1] + x[2,0,1] = 0",
        "precedes[2,1]: 2 x[2,1,1] + 2 x[2,0,1] - u[1] + u[2] <= 1",
    ]
    agrees(problem, "three-index", 4.0)


def test_a_site_is_served_in_one_of_its_windows() -> None:
    """Open until 1 and from 8 to 9: a duration of 2 where the departure is free, and the second window for who comes late."""
    problem = routing(xy=LINE[:2], count=1, sites={"windows": {1: [(0, 1), (8, 9)]}}, max_duration=5.0)
    assert lines_of(problem, "window", "opens", "closes", "outside") == [
        "window[1]: w[1,1] + w[1,2] = 1",
        "opens[1,1]: t[1,1] - w[1,1] - 8 w[1,2] >= 0",
        "closes[1,1]: t[1,1] - w[1,1] - 9 w[1,2] <= 0",
    ]
    agrees(problem, "three-index", 2.0)
    late = routing(xy=LINE[:2], count=1, sites={"windows": {1: [(0, 0.5), (8, 9)]}})
    assert lines_of(late, "outside") == ["outside[1,1,1]: x[1,0,1] + w[1,1] <= 1"]
    agrees(late, "three-index", 2.0)


def test_copies_of_a_station_are_used_in_order() -> None:
    made = lines_of(routing(xy=LINE[:2], count=1, energy=Energy(3.0, stations=(0,))), "copy")
    assert len(made) == 1 and made[0].startswith("copy[1]: ") and made[0].endswith(" <= 0")
