import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

import waybound as wb
from waybound.formulations.answers import check_answer_path, read_answer
from waybound.formulations.routing.vroom_answers import is_vroom_output, routes_from_vroom, vroom_output
from waybound.instances.errors import UsageError

SQUARE = [[0, 10, 20, 30], [10, 0, 15, 25], [20, 15, 0, 12], [30, 25, 12, 0]]
INSTANCE = {
    "vehicles": [
        {"id": 4, "start_index": 0, "end_index": 0, "capacity": [4], "time_window": [0, 500]},
        {"id": 9, "start_index": 0, "end_index": 0, "capacity": [4], "time_window": [0, 500]},
        {"id": 6, "start_index": 3, "capacity": [2], "costs": {"fixed": 7}},
    ],
    "jobs": [
        {"id": 1, "service": 5, "delivery": [1], "location_index": 1, "time_windows": [[30, 60]]},
        {"id": 2, "pickup": [1], "location_index": 2, "priority": 3},
    ],
    "shipments": [{"amount": [1], "pickup": {"id": 2, "location_index": 2}, "delivery": {"id": 6, "location_index": 3}}],
    "matrices": {"car": {"durations": SQUARE}},
}
OUTPUT = {
    "code": 0,
    "summary": {"cost": 99},
    "unassigned": [{"id": 2, "type": "job"}],
    "routes": [
        {"vehicle": 9, "steps": [{"type": "start"}, {"type": "job", "id": 1, "arrival": 30}, {"type": "end"}]},
        {"vehicle": 6, "steps": [{"type": "start"}, {"type": "pickup", "id": 2}, {"type": "delivery", "id": 6}, {"type": "end"}]},
    ],
}


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> wb.RoutingProblem:
    path = tmp_path_factory.mktemp("vroom") / "plan.json"
    path.write_text(json.dumps(INSTANCE))
    made = wb.read(path)
    assert isinstance(made, wb.RoutingProblem)
    return made


def test_steps_are_sites_and_vehicles_their_types(problem: wb.RoutingProblem) -> None:
    answer = routes_from_vroom(problem, OUTPUT)
    ids = [[problem.sites.ids[k] for k in route.visits] for route in answer]
    assert (ids, [route.vehicle for route in answer]) == ([["1"], ["pickup 2", "delivery 6"]], [0, 1])
    judged = problem.evaluate(answer)
    assert judged.feasible
    assert judged.values == (3.0, 20.0 + 12 + 12 + 7)  # anywhere is no distance away


def test_an_answer_is_printed_as_vroom_prints_its_own(problem: wb.RoutingProblem, tmp_path: Path) -> None:
    answer = routes_from_vroom(problem, OUTPUT)
    made = vroom_output(problem, answer)
    assert made["summary"] == {"cost": 51.0, "routes": 2, "unassigned": 1}
    assert made["unassigned"] == [{"type": "job", "id": 2}]
    assert [route["vehicle"] for route in made["routes"]] == [4, 6]
    first = made["routes"][0]["steps"][1]
    assert {key: first[key] for key in ("type", "id", "arrival", "waiting_time", "service")} == {
        "type": "job", "id": 1, "arrival": 30.0, "waiting_time": 0.0, "service": 5.0
    }  # fmt: skip
    path = tmp_path / "answer.vroom"
    path.write_text(problem.answer_to_text(answer, ".vroom"))
    assert read_answer(problem, path).answer == answer


def test_stops_at_depots_on_the_way_have_no_place() -> None:
    made = wb.RoutingProblem.from_frame(pd.DataFrame({"x": [0, 1, 2], "y": 0}), fleet=[{"reloads": ["0"]}])
    with pytest.raises(UsageError, match="no place for stops at depots on the way"):
        check_answer_path(made, "plan.vroom")


def test_one_type_of_vehicle_drives_all_routes() -> None:
    problem: Any = wb.read("demo-tiny")
    answer = wb.Routes.of([[1, 2], [3]])
    assert routes_from_vroom(problem, json.loads(problem.answer_to_text(answer, ".vroom"))) == answer
    check_answer_path(problem, "plan.vroom")


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("code", 2, "VROOM found no answer: error 2"),
        ("code", "0", "code must be a whole number"),
        ("routes", {}, "routes must be a list"),
        ("routes.0", 5, r"routes\[0\] must be an object with the keys vehicle and steps"),
        ("routes.0.vehicle", 5, r"routes\[0\].vehicle names no vehicle; expected 4, 6, 9; found 5"),
        ("routes.0.steps", 5, r"routes\[0\].steps must be a list"),
        ("routes.0.steps.1", 5, r"routes\[0\].steps\[1\] must be an object with a type"),
        ("routes.0.steps.1.type", "break", r"routes\[0\].steps\[1\].type is not supported; expected start, end, job, pickup, delivery"),
        ("routes.0.steps.1.id", 7, r"routes\[0\].steps\[1\] names a task that does not exist; expected an id of the instance; found 7"),
        ("routes.0.steps.1.id", None, r"routes\[0\].steps\[1\].id must be a whole number"),
    ],
)
def test_a_fault_is_refused_by_its_key(problem: wb.RoutingProblem, path: str, value: Any, message: str) -> None:
    data: Any = json.loads(json.dumps(OUTPUT))
    *above, last = (int(key) if key.isdigit() else key for key in path.split("."))
    part = data
    for key in above:
        part = part[key]
    part[last] = value
    with pytest.raises(wb.InputError, match=message):
        routes_from_vroom(problem, data)


def test_sites_and_vehicles_without_numbers_are_described(problem: wb.RoutingProblem) -> None:
    renamed = replace(problem, fleet=(replace(problem.fleet[0], name="car"), problem.fleet[1]))
    lettered = replace(problem, sites=replace(problem.sites, ids=("a", *problem.sites.ids[1:-1], "z")))
    for changed in (renamed, lettered):
        customers = changed.customers.tolist()
        answer = wb.Routes.of([wb.Route((customers[0],), 0), wb.Route((customers[1],), 1)])
        said = json.loads(json.dumps(vroom_output(changed, answer)))
        assert routes_from_vroom(changed, said) == answer
    assert vroom_output(renamed, answer)["routes"][0]["description"] == "car 1"
    assert {task["description"] for task in vroom_output(lettered, wb.Routes.of([]))["unassigned"]} >= {"z"}
    with pytest.raises(wb.InputError, match=r"routes\[0\]\.description names no vehicle; expected car, "):
        routes_from_vroom(renamed, OUTPUT)
    with pytest.raises(wb.UsageError, match="3 routes use vehicle 4 9, of which there are 2"):
        vroom_output(problem, wb.Routes.of([[k] for k in problem.customers.tolist()[:3]]))


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (OUTPUT, True), ({"code": 3, "error": "x"}, True), ({"routes": [{"vehicle": 1, "steps": []}]}, True), ({"routes": []}, False),
        ({"kind": "routes", "routes": []}, False), ({"answer": OUTPUT, "code": 0, "routes": []}, False), ({"code": 0}, False),
    ],
)  # fmt: skip
def test_what_is_output_of_vroom(data: dict[str, Any], expected: bool) -> None:
    assert is_vroom_output(data) is expected
