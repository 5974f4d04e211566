"""Robots and tasks in waybound's JSON."""

from __future__ import annotations

import json

import pytest

from waybound.instances.auctions.robot_tasks import RobotTasks
from waybound.instances.errors import InputError
from waybound.instances.generating import generate
from waybound.instances.reading import read_instance
from waybound.instances.writing import write_instance

EXAMPLES = (
    generate("robot-tasks", 1, weight=2),
    RobotTasks.of_distances([[1, 2]], [[0, 3], [4, 0]], task_names=("a", "b"), notes=("one way",)),
)


@pytest.mark.parametrize("team", EXAMPLES, ids=lambda team: team.metric)
def test_what_is_written_is_read_back(tmp_path, team):
    write_instance(team, tmp_path / "t.json")
    again = read_instance(tmp_path / "t.json")
    assert again.digest() == team.digest()
    assert (again.name, again.problem, again.notes, again.task_names, again.metric) == (
        team.name, team.problem, team.notes, team.task_names, team.metric,
    )  # fmt: skip
    assert (again.positions is None) == (team.positions is None)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"metric": "polar"}, "metric is unknown"),
        ({"problem": "tsp"}, "problem is none of robots and tasks"),
        ({"robots": {"count": 0}}, "robots.count must be a whole number"),
        ({"robots": {"count": 1, "x": [0]}}, "robots has one coordinate alone"),
        ({"robots": {"count": 1}}, "positions are given of robots or of tasks alone"),
        ({"distances": [[1]]}, "distances has a wrong length"),
        ({"tasks": {"count": 1, "x": [0], "y": [0], "weight": ["a"]}}, r"tasks.weight\[0\] must be a number"),
        ({"surplus": 1}, "unknown key 'surplus'"),
    ],
)
def test_other_keys_and_values_are_refused_by_their_path(tmp_path, change, message):
    data = {
        "waybound": 1, "kind": "robot-tasks", "name": "t", "problem": "task-allocation", "metric": "euclidean",
        "robots": {"count": 1, "x": [0], "y": [0]}, "tasks": {"count": 1, "x": [1], "y": [1]},
    }  # fmt: skip
    (tmp_path / "t.json").write_text(json.dumps({**data, **change}))
    with pytest.raises(InputError, match=message):
        read_instance(tmp_path / "t.json")
