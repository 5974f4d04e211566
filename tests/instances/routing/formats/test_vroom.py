import copy
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from file_cases import Differences, Read, Refusal, strangers
from file_texts import DURATIONS, VROOM as GOOD

from waybound import Energy, Shipment, VehicleType
from waybound.instances.formats import waybound_json
from waybound.instances.generating import generate
from waybound.instances.routing.formats.vroom import read, recognises, write


def changed(path: str, value: Any) -> str:
    """The good document with another value at a path such as ``jobs.0.id``; ... takes the key out."""
    data = copy.deepcopy(GOOD)
    part: Any = data
    *above, last = (int(key) if key.isdigit() else key for key in path.split("."))
    for key in above:
        part = part[key]
    if value is ...:
        del part[last]
    else:
        part[last] = value
    return json.dumps(data)


@pytest.fixture
def good(read_text_as: Read) -> Any:
    return read_text_as(json.dumps(GOOD), "delivery.json")


def test_sites_are_named_for_tasks_and_places(good: Any) -> None:
    assert (good.name, good.format, good.problem, good.objective) == ("delivery", "vroom", "min-cost-vrp", ("reward", "total-cost"))
    assert good.sites.ids == ("location 0", "location 3", "anywhere", "1", "2", "pickup 2", "delivery 6")
    assert good.sites.depots.tolist() == [0, 1, 2]
    assert good.sites.demand.tolist() == [0, 0, 0, 1, 0, 0, 0]
    assert (good.sites.pickup.tolist(), good.sites.further_pickup.tolist()) == ([0, 0, 0, 0, 1, 0, 0], [[0], [0], [0], [0], [2], [0], [0]])
    assert good.sites.shipments == (Shipment(5, 6, (1.0, 3.0)),)
    assert good.sites.service.tolist() == [0, 0, 0, 300, 300, 30, 0]
    assert (good.sites.ready.tolist()[3:5], good.sites.due.tolist()[3:5]) == ([32400, 32400], [36000, 38000])
    assert good.sites.windows[4] == ((32400, 36000), (37000, 38000))
    assert good.sites.skills[3] == {"1"} and good.sites.skills[5] == good.sites.skills[6] == {"14"}


def test_priority_comes_before_the_number_of_tasks_and_that_before_costs(good: Any) -> None:
    assert not good.sites.required.any()
    assert good.sites.reward.tolist() == [0, 0, 0, 1, 10 * 5 + 1, 1, 1]


def test_vehicles_that_are_alike_make_one_type(good: Any) -> None:
    first, second = good.fleet
    assert (first.count, first.name, first.capacities, first.skills) == (2, "vehicle 1 5", (4.0, 9.0), {"1", "14"})
    assert (first.shift, first.unit_cost, first.fixed_cost, first.travel) == ((28800.0, 43200.0), 1.0, 0.0, None)
    assert (second.count, second.name, second.fixed_cost, second.unit_cost, second.max_distance) == (1, "vehicle 7", 5.0, 2.0, 9000.0)
    assert second.energy == Energy(5000.0)
    assert (second.start, second.end) == (1, 2)


def test_anywhere_is_no_distance_from_any_site(good: Any) -> None:
    assert not good.travel.distances[2].any() and not good.travel.distances[:, 2].any()
    assert good.travel.distance(0, 3) == good.travel.duration(0, 3) == 2104
    bike = good.fleet[1].travel
    assert (float(bike.distance(1, 3)), float(bike.duration(1, 3))) == (3153 // 2, 3153)


def test_costs_by_time_and_distance_are_summed(read_text_as: Read) -> None:
    made = read_text_as(
        changed("vehicles.2", {**GOOD["vehicles"][2], "costs": {"per_km": 500}, "max_distance": 9000}).replace(', "max_distance": 9000', "")
    )
    assert made.fleet[1].travel.distance(1, 3) == 3153 + 0.5 * (3153 // 2)
    assert made.fleet[1].unit_cost == 1


def test_costs_of_their_own_and_a_speed(read_text_as: Read) -> None:
    data = json.loads(changed("vehicles.2.costs", {}))
    del data["vehicles"][2]["max_distance"]
    data["vehicles"][2]["speed_factor"] = 0.5
    data["matrices"]["bike"]["costs"] = [[v + 1 for v in row] for row in DURATIONS]
    bike = read_text_as(json.dumps(data)).fleet[1].travel
    assert (float(bike.distance(1, 3)), float(bike.duration(1, 3))) == (3154, 6306)


def test_the_matrix_of_older_versions_is_that_of_cars(read_text_as: Read) -> None:
    data = {"vehicles": [{"id": 0, "end_index": 0}], "jobs": [{"id": 3, "location_index": 1}], "matrix": [[0, 5], [6, 0]]}
    made = read_text_as(json.dumps(data))
    assert made.sites.ids == ("anywhere", "location 0", "3")
    assert made.fleet == (VehicleType(1, start=0, end=1, name="vehicle 0"),)


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("vehicles", [], "vehicles is empty"),
        ("vehicles", {}, "vehicles must be a list"),
        ("vehicles.0", 5, "vehicles[0] must be an object"),
        ("vehicles.0.id", ..., "vehicles[0] lacks the key 'id'"),
        ("vehicles.0.id", 5, "two vehicles have the id 5"),
        ("vehicles.0.colour", "red", "vehicles[0] has an unknown key 'colour'"),
        ("vehicles.0.profile", "boat", "vehicles[0].profile has no matrices; expected car, bike; found 'boat'"),
        ("vehicles.0.start_index", 4, "vehicles[0].start_index is no row of the matrices; expected 0 to 3; found 4"),
        ("vehicles.2.start_index", ..., "vehicles[2] neither starts nor ends anywhere"),
        ("vehicles.2.start", [1, 2, 3], "vehicles[2].start has a wrong length"),
        ("vehicles.0.breaks", [{"id": 1}], "vehicles[0].breaks is not supported; expected no breaks"),
        ("vehicles.0.max_tasks", 4, "vehicles[0].max_tasks is not supported"),
        ("vehicles.0.steps", [{"type": "start"}], "vehicles[0].steps is not supported"),
        ("vehicles.0.max_distance", 4, "vehicles[0].max_distance is not supported where costs are not by distance alone"),
        ("vehicles.0.speed_factor", 0, "vehicles[0].speed_factor is out of range"),
        ("vehicles.0.time_window", [5, 4], "vehicles[0].time_window closes before it opens"),
        ("vehicles.0.capacity", [4], "loads and capacities have different lengths; expected the same everywhere; found 1, 2"),
        ("vehicles.0.capacity", [-4, 1], "vehicles[0].capacity[0] must be a whole number"),
        ("vehicles.0.costs", {"per_task_hour": 5}, "vehicles[0].costs.per_task_hour is not supported"),
        ("vehicles.0.costs", {"per_km": 5}, "vehicles[0].costs.per_km needs distances of profile car"),
        ("vehicles.0.costs", {"fixed": -5}, "must be finite and not negative"),
        ("jobs.0.location_index", ..., "jobs[0] lacks the key 'location_index'; expected a row of the matrices: no server is asked"),
        ("jobs.0.setup", 5, "jobs[0].setup is not supported; expected no setup"),
        ("jobs.0.setup", 0, None),
        ("jobs.0.service", 1.5, "jobs[0].service must be a whole number"),
        ("jobs.0.priority", 101, "jobs[0].priority is too large; expected 0 to 100; found 101"),
        ("jobs.0.time_windows", [], "jobs[0].time_windows is empty"),
        ("jobs.1.time_windows", [[5, 9], [9, 12]], "jobs[1].time_windows[1] begins before the one before it ends"),
        ("jobs.0.pickup", [1], "jobs[0] delivers and picks up different numbers of loads; expected 2; found 1"),
        ("jobs.0.id", 2, "two tasks have the id 2"),
        ("shipments.0.pickup", ..., "shipments[0] lacks the key 'pickup'"),
        ("shipments.0.amount", [1], "loads and capacities have different lengths"),
        ("shipments.0.delivery.location_index", 9, "shipments[0].delivery.location_index is no row of the matrices"),
        ("matrices", ..., "matrices are missing, and no server is asked for travel times"),
        ("matrices.car", {"distances": DURATIONS}, "matrices.car lacks the key 'durations'"),
        ("matrices.car.durations.1", [1, 2], "matrices.car.durations[1] has a wrong length; expected 4; found 2"),
        ("matrices.car.durations.1.0", -1, "durations of profile car hold a negative number"),
        ("matrix", DURATIONS, "matrix stands beside matrices"),
        ("options", {"g": True}, None),
    ],
)  # fmt: skip
def test_a_fault_is_refused_by_its_key(path: str, value: Any, message: str | None, read_text_as: Read, refusal: Refusal) -> None:
    if message is None:
        read_text_as(changed(path, value))
    else:
        assert message in str(refusal(changed(path, value)))


def test_nothing_to_do_is_refused(refusal: Refusal) -> None:
    data = {"vehicles": GOOD["vehicles"][:1], "matrices": GOOD["matrices"]}
    assert "there is nothing to do; expected jobs or shipments" in str(refusal(json.dumps(data)))
    assert refusal(json.dumps({"code": 0, "routes": []}), format="vroom").code == "foreign"


def test_what_is_read_is_written_again(good: Any, differences: Differences) -> None:
    assert differences(good, read(write(good), Path("delivery.json"))) == []


def test_what_every_site_asks_for_is_written_too(read_text_as: Read) -> None:
    made: Any = generate("random", 1, metric="EUC_2D", windows=True, vehicles=3)
    data = json.loads(write(made))
    assert [job["id"] for job in data["jobs"]] == [1, 2, 3, 4, 5, 6]
    assert [vehicle["id"] for vehicle in data["vehicles"]] == [1, 2, 3]
    again = read_text_as(write(made))
    assert again.sites.ids[1:] == made.sites.ids[1:]
    assert np.array_equal(again.travel.distances, made.travel.distances)
    assert again.sites.reward.tolist() == [0, 1, 1, 1, 1, 1, 1]
    assert waybound_json.recognises(waybound_json.write(again)) and not recognises(waybound_json.write(again))


test_other_texts_are_not_recognised = strangers(recognises, "vehicles", '{"jobs": []}', '{"waybound": 1, "vehicles": []}', "[]", "")
