import json
import math
from typing import Any

import numpy as np
import pytest
from orchard_cases import random_jobs

import waybound as wb
from waybound import AssignmentInstance, ExplorationMap, GeneralisedAssignmentInstance, InputError, RobotTasks
from waybound.instances.auctions.joint_assignment import JointAssignmentInstance
from waybound.instances.generating import generate
from waybound.instances.reading import read_instance
from waybound.instances.writing import write_instance

COSTS = AssignmentInstance.from_matrix([[1.0, 2.0], [3.0, 4.0]])
LIMITED = GeneralisedAssignmentInstance([[1.0, math.inf], [2.5, 3.0]], [[1.0, 2.0], [3.0, 4.0]], [5.0, 6.0], job_names=("x", "y"))
JOINT = JointAssignmentInstance([[1.0, math.inf]], [[2.0]], [[3.0, 4.0]], np.array([0.0, math.inf]), request_names=("x",))
ROOMS = ExplorationMap(
    [(0, 1)], [[0.0], [1.0]], np.zeros((2, 0)), [[1.0, 0.5]] * 2, [0], 0, [], 1, 4, ("a", "b"), np.array([[0.0, 0.0], [1.0, 0.0]])
)
JOBS = random_jobs(np.random.default_rng(1))
TEAM = RobotTasks.of_positions([[0, 0]], [[1, 1]], name="t")


def again(instance: Any) -> Any:
    return type(instance).from_document(instance.to_document())


def test_many_pairs_are_a_matrix_with_null_and_few_are_lists() -> None:
    dense = AssignmentInstance.from_matrix([[1.0, np.inf], [2.5, 3.0]], filled=np.array([0.0, np.inf]), bin_names=("x", "y"))
    data = dense.to_document()
    assert data["cost"] == [[1, None], [2.5, 3]] and data["bins"] == {"count": 2, "name": ["x", "y"], "filled": [0, None]}
    assert again(dense).digest() == dense.digest()
    sparse = AssignmentInstance.from_pairs(3, 3, [0, 2], [1, 2], [1.0, 2.0])
    assert sparse.to_document()["pairs"] == {"robot": [0, 2], "bin": [1, 2], "cost": [1, 2]}
    assert again(sparse).digest() == sparse.digest()


def test_a_map_is_the_same_again() -> None:
    data = ROOMS.to_document()
    assert data["rooms"]["mapping"] == [[], []] and data["doors"] == [[0, 1]] and data["heard"] == []
    same = again(ROOMS)
    assert same.digest() == ROOMS.digest() and same.room_names == ("a", "b") and same.positions is not None


def test_forbidden_pairs_are_null_and_the_key_says_what_values_mean() -> None:
    data = LIMITED.to_document()
    assert data["cost"] == [[1, None], [2.5, 3]] and data["agents"] == {"count": 2, "capacity": [5, 6]}
    assert again(LIMITED).digest() == LIMITED.digest() and again(LIMITED).job_names == ("x", "y")
    profits = GeneralisedAssignmentInstance([[1.0, -math.inf]], [[1.0, 2.0]], [5.0], "profit")
    assert profits.to_document()["profit"] == [[1, None]] and again(profits).digest() == profits.digest()


def test_what_is_not_allowed_is_null() -> None:
    data = JOINT.to_document()
    assert data["to_bin"] == [[1, None]] and data["bins"] == {"count": 2, "filled": [0, None]} and data["requests"]["name"] == ["x"]
    assert again(JOINT).digest() == JOINT.digest()
    none = JointAssignmentInstance([[1.0]], np.zeros((1, 0)), np.zeros((0, 1)))
    assert none.to_document()["to_request"] == [[]] and again(none).digest() == none.digest()


def test_orchards_come_back_as_they_were_written(tmp_path):
    rng = np.random.default_rng(1)
    for k in range(5):
        jobs = random_jobs(rng)
        write_instance(jobs, tmp_path / f"{k}.json")
        same = read_instance(tmp_path / f"{k}.json")
        assert same.digest() == jobs.digest()
        assert same.name == jobs.name
        assert wb.read(tmp_path / f"{k}.json").problem == "orchard-day"


@pytest.mark.parametrize(
    "team",
    [
        generate("robot-tasks", 1, weight=2),
        RobotTasks.of_distances([[1, 2]], [[0, 3], [4, 0]], task_names=("a", "b"), notes=("one way",)),
    ],
    ids=lambda team: team.metric,
)
def test_robots_and_tasks_come_back_as_they_were_written(tmp_path, team):
    write_instance(team, tmp_path / "t.json")
    same = read_instance(tmp_path / "t.json")
    assert same.digest() == team.digest()
    for key in ("name", "problem", "notes", "task_names", "metric"):
        assert getattr(same, key) == getattr(team, key)
    assert (same.positions is None) == (team.positions is None)


@pytest.mark.parametrize(
    ("instance", "change", "message"),
    [
        (COSTS, {"cost": None}, "cost must be a list"),
        (COSTS, {"cost": [[1, 2]]}, "cost has a wrong length; expected 2; found 1"),
        (COSTS, {"cost": [[1, 2], [3]]}, r"cost\[1\] has a wrong length"),
        (COSTS, {"pairs": {"robot": [], "bin": [], "cost": []}}, "costs stand in one of two ways"),
        (COSTS, {"problem": "tsp"}, "problem is none of assignments"),
        (COSTS, {"robots": {"count": 0}}, "robots.count must be a whole number"),
        (COSTS, {"robots": {"count": 2, "x": [1, 2]}}, "robots has x alone; expected x and y"),
        (ROOMS, {"doors": [[0]]}, r"doors\[0\]"),
        (ROOMS, {"problem": "tsp"}, "problem is none of maps of rooms"),
        (ROOMS, {"robots": [0.5]}, "robots"),
        (ROOMS, {"rooms": {**ROOMS.to_document()["rooms"], "exploring": [[0], [1, 2]]}}, r"rooms.exploring\[1\]"),
        (ROOMS, {"rooms": {k: v for k, v in ROOMS.to_document()["rooms"].items() if k != "y"}}, "rooms has x alone"),
        (LIMITED, {"cost": [[1, 2]]}, "cost has a wrong length; expected 2; found 1"),
        (LIMITED, {"cost": [[1, 2], [3]]}, r"cost\[1\] has a wrong length"),
        (LIMITED, {"profit": [[1, 2], [3, 4]]}, "either costs or profits"),
        (LIMITED, {"consumption": [[1, 2], [3, None]]}, r"consumption\[1\]"),
        (LIMITED, {"problem": "tsp"}, "problem is none of generalised assignments"),
        (LIMITED, {"agents": {"count": 2}}, "lacks the key 'capacity'"),
        (JOINT, {"to_bin": [[1]]}, r"to_bin\[0\] has a wrong length"),
        (JOINT, {"between": [[1, None]]}, r"between\[0\]"),
        (JOINT, {"problem": "tsp"}, "problem is none of joint assignments"),
        (JOINT, {"robots": {"count": 1, "filled": [1]}}, "unknown key 'filled'"),
        (JOBS, {"orchard": {**JOBS.to_document()["orchard"], "columns": 2}}, "columns"),
        (JOBS, {"robots": {**JOBS.to_document()["robots"], "row": [9, 0, 0]}}, "lies outside"),
        (JOBS, {"bins": {**JOBS.to_document()["bins"], "work": [1]}}, "work"),
        (JOBS, {"problem": "tsp"}, "none of bins in an orchard"),
        (JOBS, {"bins": {**JOBS.to_document()["bins"], "standing": [1] * 5}}, "standing"),
        (TEAM, {"metric": "polar"}, "metric is unknown"),
        (TEAM, {"problem": "tsp"}, "problem is none of robots and tasks"),
        (TEAM, {"robots": {"count": 0}}, "robots.count must be a whole number"),
        (TEAM, {"robots": {"count": 1, "x": [0]}}, "robots has x alone"),
        (TEAM, {"robots": {"count": 1}}, "positions are given of robots or of tasks alone"),
        (TEAM, {"distances": [[1]]}, "distances has a wrong length"),
        (TEAM, {"tasks": {"count": 1, "x": [0], "y": [0], "weight": ["a"]}}, r"tasks.weight\[0\] must be a number"),
        (TEAM, {"surplus": 1}, "unknown key 'surplus'"),
    ],
)
def test_what_is_wrong_in_a_file_is_named_by_its_path(tmp_path, instance, change, message):
    write_instance(instance, tmp_path / "wrong.json")
    data = json.loads((tmp_path / "wrong.json").read_text())
    (tmp_path / "wrong.json").write_text(json.dumps({**data, **change}))
    with pytest.raises(InputError, match=message):
        read_instance(tmp_path / "wrong.json")
