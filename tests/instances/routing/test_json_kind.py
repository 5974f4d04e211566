import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from draws import draws
from file_cases import refused
from hypothesis import given, settings, strategies as st

import waybound as wb
from waybound import Energy, InputError, RoutingInstance, Sites, Travel, VehicleType
from waybound.instances.formats.waybound_json import read, write
from waybound.instances.routing.frames import instance_from_frame
from waybound.instances.routing.json_kind import decode, encode

SMALL = {
    "waybound": 1,
    "kind": "routing",
    "name": "small",
    "problem": "vrptw",
    "sites": {"id": ["d", "a", "b"], "x": [0, 3, 6], "y": [0, 4, 8], "due": [None, 20, None]},
    "travel": {"metric": "euclidean"},
    "fleet": [{}],
}


def changed(path: str, value: Any) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(json.dumps(SMALL))
    *above, last = path.split(".")
    part: Any = data
    for key in above:
        part = part[int(key)] if isinstance(part, list) else part[key]
    if value == "drop":
        del part[last]
    else:
        part[last] = value
    return data


def load(data: dict[str, Any]) -> RoutingInstance:
    made = read(json.dumps(data), Path("small.json"))
    assert isinstance(made, RoutingInstance)
    return made


def test_defaults_are_as_documented() -> None:
    made = load(SMALL)
    assert (made.format, made.problems, made.min_vehicles, made.objective, made.notes) == ("json", ("vrptw",), 0, (), ())
    assert made.fleet == (VehicleType(),)
    assert made.sites.depot.tolist() == [True, False, False]
    assert made.sites.due.tolist() == [math.inf, 20, math.inf]
    assert made.travel.convention == "exact"


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("name", "drop", "the document lacks the key 'name'"),
        ("name", "", "name must be printable and not empty"),
        ("name", "a\nb", "name must be printable"),
        ("name", "\ud800", "name must be printable"),
        ("name", 5, "name must be a string; found 5"),
        ("problems", ["cvrp"], "problems must hold problem"),
        ("sites", [], "sites must be an object; found a list"),
        ("sites.id", "drop", "sites lacks the key 'id'"),
        ("sites.id", ["d", "a"], "sites.due has a wrong length; expected 2; found 3"),
        ("sites.id", ["d", "a", "a"], "two sites have the id 'a'"),
        ("sites.id", ["d", "a", 3], "sites.id[2] must be a string"),
        ("sites.color", [1], "sites has an unknown key 'color'"),
        ("sites.y", "drop", "sites has x alone"),
        ("sites.x", [0, 1, "2"], "sites.x[2] must be a number; found '2'"),
        ("sites.x", [0, 1, True], "sites.x[2] must be a number; found true"),
        ("sites.x", [0, 1, None], "sites.x[2] must be a number; found null"),
        ("sites.x", [0, 1, 10**400], "sites.x[2] must be a finite number"),
        ("sites.demand", [0, -1, 0], "demand of site a must be finite and not negative"),
        ("sites.demand", [0, None, 0], "sites.demand[1] must be a number"),
        ("sites.due", [None, -5, None], "time window of site a closes before it opens"),
        ("sites.due", [None, 4, None], "no vehicle can reach customer a: earliest arrival"),
        ("sites.depot", [True, 0, False], "sites.depot[1] must be true or false"),
        ("sites.depot", [False, False, False], "there is no depot"),
        ("sites.required", [True, True, True], "sites.required[0] asks for a visit to a depot"),
        ("travel.metric", "EUC_9D", "travel.metric is unknown"),
        ("travel.metric", "EXPLICIT", "travel by EXPLICIT needs matrix"),
        ("travel.matrix", [[0]], "travel by euclidean has no matrix"),
        ("travel.durations", [[0, 1, 1], [1, 0, 1], [1, 1]], "travel.durations[2] has a wrong length"),
        ("travel.durations", [[0, 1, 1], [1, 0, 1]], "travel.durations has a wrong length"),
        ("travel.durations", [[0, 1, 1], [1, 0, -1], [1, 1, 0]], "duration in row 2, column 3"),
        ("fleet", [], "the fleet is empty"),
        ("fleet", {}, "fleet must be a list"),
        ("fleet.0", {"count": 0}, "fleet[0].count must be a whole number; expected 1 or more"),
        ("fleet.0", {"count": 2.5}, "fleet[0].count must be a whole number"),
        ("fleet.0", {"capacity": -1}, "capacity of vehicle must be a number and not negative"),
        ("fleet.0", {"start": "x"}, "fleet[0].start names no site"),
        ("fleet.0", {"end": "a"}, "site a, which is no depot"),
        ("fleet.0", {"wheels": 3}, "fleet[0] has an unknown key 'wheels'"),
        ("fleet.0", {"speed": 0}, "speed of vehicle must be positive"),
        ("fleet.0", {"shift": [9, 3]}, "the shift of vehicle must have a begin and a later end"),
        ("fleet.0", {"shift": [9]}, "fleet[0].shift has a wrong length"),
        ("fleet.0", {"reloads": ["a"]}, "vehicle reloads at site a, which is no depot"),
        ("fleet.0", {"energy": {"capacity": 5, "stations": ["x"]}}, "fleet[0].energy.stations[0] names no site"),
        ("fleet.0", {"energy": {"capacity": 5, "initial": 6}}, "energy at departure must be within the capacity"),
        ("fleet.0", {"capacity": [5, 6]}, "capacity of vehicle has another number of load dimensions"),
        ("fleet.0", {"committed": 1}, "fleet[0].committed must be true or false"),
        ("fleet.0", {"energy": {"capacity": 5, "charge": "sun"}}, "unknown energy charge"),
        ("fleet.0", {"energy": {"rate": 5}}, "fleet[0].energy lacks the key 'capacity'"),
        ("fleet", [{}, {}], "vehicle types must have different names"),
        ("min_vehicles", -1, "min_vehicles must be a whole number"),
        ("objective", "vehicles", "objective must be a list"),
    ],
)
def test_a_fault_is_refused_by_its_path(path: str, value: Any, message: str) -> None:
    with pytest.raises(InputError) as caught:
        data = changed(path, value) if not path.startswith("fleet.") else {**SMALL, "fleet": [value]}
        read(json.dumps(data), Path("small.json"))
    assert message in str(caught.value)


def test_everything_an_instance_can_hold_reads_back_the_same(differences: Callable[..., list[str]]) -> None:
    sites = Sites.of(
        ["north", "ü 1", "2", "south"], depot=[True, False, False, True], demand=[0, 0.1, 1 / 3, 0], ready=[-5, 0, 1e-300, 0],
        due=[100, math.inf, 50.5, 90], service=[0, 2, 3, 0], reward=[0, 5, 6, 0], required=[False, True, False, False],
        coordinates=np.array([[1, 2], [3, 4], [5, 6], [7, 8.25]]),
    )  # fmt: skip
    matrix = np.arange(16.0).reshape(4, 4) / 7
    travel = Travel("EXPLICIT", matrix=matrix, duration_matrix=matrix * 2, convention="trunc2")
    fleet = (
        VehicleType(2, 5.5, 0, 3, 80, 70, Energy(40, 0.5, "windows"), 3, 0.25, "van"),
        VehicleType(None, math.inf, 3, 3, name="bike"),
    )
    made = RoutingInstance("all", "test", sites, travel, fleet, "vrptw", ("vrptw", "cvrp"), 1, ("vehicles", "total-cost"), ("a note",))
    again = read(write(made), Path("all.json"))
    assert differences(made, again) == []
    assert again.notes == made.notes
    assert write(again) == write(made)


numbers = st.floats(0, 1e150, allow_nan=False)


@settings(max_examples=draws(50), deadline=None)
@given(st.lists(st.tuples(numbers, numbers, numbers, numbers), min_size=2, max_size=5))
def test_numbers_read_back_to_the_bit(rows: list[tuple[float, float, float, float]]) -> None:
    x, y, demand, reward = (np.array(column) for column in zip(*rows, strict=True))
    xy = np.column_stack([x, -y])
    sites = Sites.of(range(len(rows)), demand=demand, reward=reward, coordinates=xy)
    made = RoutingInstance("n", "test", sites, Travel("euclidean", coordinates=xy), (VehicleType(),))
    again = load(json.loads(write(made)))
    for name in ("demand", "reward", "coordinates"):
        assert getattr(again.sites, name).tobytes() == getattr(sites, name).tobytes()


def test_a_map_that_differs_from_the_distances_is_kept_apart() -> None:
    sites = Sites.of("ab", coordinates=[[1, 2], [3, 4]])
    made = RoutingInstance("n", "test", sites, Travel("GEO", coordinates=[[2, 1], [4, 3]]), (VehicleType(),))  # type: ignore[arg-type]
    again = load(json.loads(write(made)))
    assert again.sites.coordinates.tolist() == [[1, 2], [3, 4]]  # type: ignore[union-attr]
    assert again.travel.coordinates.tolist() == [[2, 1], [4, 3]]  # type: ignore[union-attr]


def test_attributes_places_on_the_globe_the_clock_and_forbidden_moves_read_back() -> None:
    sites = {
        "id": ["d", "a"],
        "lon": [9.0, 9.5],
        "lat": [45.0, 45.5],
        "attributes": {"phone": ["-", None], "stars": [1, 2.5], "open": [True, "no"]},
    }
    data = SMALL | {
        "sites": sites, "travel": {"metric": "haversine", "pace": 2.0}, "forbidden": [["a", "d"]],
        "clock": {"unit": "min", "origin": "2026-05-04T00:00:00+02:00"},
    }  # fmt: skip
    made = load(data)
    again = read(write(made), Path("again.json"))
    assert isinstance(again, RoutingInstance)
    for held in (made, again):
        assert held.sites.geographic and held.sites.attributes == {k: tuple(v) for k, v in sites["attributes"].items()}  # type: ignore[attr-defined]
        assert (
            held.clock is not None
            and held.clock.unit == "min"
            and held.forbidden is not None
            and held.forbidden.tolist() == [[False, False], [True, False]]
        )
        assert held.travel.duration(0, 1) == 2.0 * held.travel.distance(0, 1)


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("forbidden", [["a", "z"]], "forbidden[0] names no site; expected an id of sites.id; found z"),
        ("forbidden", [["a"]], "forbidden[0] has a wrong length"),
        ("clock", {"unit": "fortnight"}, "clock.unit: unknown unit of time 'fortnight'"),
        ("clock", {"unit": "min", "origin": "noon"}, "the origin of time is no moment"),
        ("clock", {}, "clock lacks the key 'unit'"),
        ("sites.attributes", {"phone": ["1"]}, "sites.attributes.phone has a wrong length"),
        ("sites.attributes", {"phone": [[], 1, 2]}, "sites.attributes.phone[0] must be a text, a number, true, false or null"),
        ("sites.lat", [1, 2, 3], "sites has lat alone; expected lon and lat"),
        ("travel.pace", 0, "the time that a unit of distance takes must be positive"),
    ],
)
def test_a_fault_in_them_is_refused_by_its_path(path: str, value: Any, message: str) -> None:
    assert message in refused(load, changed(path, value))


def test_unused_columns_are_told_as_the_attributes_are_and_not_as_stored_notes_say() -> None:
    sites = pd.DataFrame({"x": [0, 3], "y": [0, 4], "lowest": [1, 2]})
    data = encode(instance_from_frame(sites, vehicles=1))
    assert data["notes"] == ["columns kept and not used: lowest"] and list(decode(data).notes) == data["notes"]
    data["sites"]["attributes"]["arrival"] = [3, 4]
    data["notes"] = ["first", *data["notes"], "columns kept and not used: phone", "last"]
    made = decode(data)
    assert made.notes == ("first", "columns kept and not used: lowest, arrival", "last")
    assert wb.RoutingProblem.from_instance(made).remarks()[:2] == made.notes[:2]
    del data["sites"]["attributes"], data["notes"][0]
    assert decode(data).notes == ("last",)
