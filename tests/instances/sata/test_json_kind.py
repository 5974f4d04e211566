import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from file_cases import refused
from hypothesis import given, strategies as st

from waybound.instances.errors import InputError
from waybound.instances.formats.waybound_json import read, write
from waybound.instances.sata.sensing_graph import PROBLEMS, SensingGraph, graph_of_edges

SMALL = {
    "waybound": 1, "kind": "sensing", "name": "small", "problem": "bottleneck", "robots": {"count": 2}, "actions": {"robot": [0, 0, 1]},
    "targets": {"count": 2}, "edges": {"action": [0, 1, 2], "target": [0, 1, 1]},
}  # fmt: skip


def changed(path: str, value: Any) -> str:
    data: dict[str, Any] = json.loads(json.dumps(SMALL))
    *above, last = path.split(".")
    part: Any = data
    for key in above:
        part = part[key]
    if value == "drop":
        del part[last]
    else:
        part[last] = value
    return json.dumps(data)


def load(text: str) -> SensingGraph:
    made = read(text, Path("small.json"))
    assert isinstance(made, SensingGraph)
    return made


def test_defaults_are_as_documented() -> None:
    g = load(json.dumps(SMALL))
    assert (g.format, g.problems, g.notes) == ("json", PROBLEMS, ())
    assert (g.robot_names, g.action_names, g.target_names, g.action_positions, g.target_positions) == (None,) * 5
    assert g.weights.tolist() == [1.0, 1.0, 1.0]


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("name", "drop", "the document lacks the key 'name'"),
        ("colour", 1, "the document has an unknown key 'colour'"),
        (
            "problem",
            "vrptw",
            "problem must be one of problems; expected bottleneck, bottleneck-lp, winner-takes-all, selection; found vrptw",
        ),
        ("problems", ["bottleneck", "tsp"], "problems[1] is no problem of sensing graphs"),
        ("problems", ["selection"], "problem must be one of problems; expected selection; found bottleneck"),
        ("robots", 2, "robots must be an object; found 2"),
        ("robots.count", "drop", "robots lacks the key 'count'"),
        ("robots.count", 1.5, "robots.count must be a whole number; expected 0 or more; found 1.5"),
        ("robots.count", 0, "the robot of action 1 does not exist; expected none, for there is no robot"),
        ("robots.count", 1, "the robot of action 3 does not exist"),
        ("robots.name", ["a"], "robots.name has a wrong length; expected 2; found 1"),
        ("robots.name", ["a", "a"], "two robots have the name 'a'"),
        ("robots.name", ["a", 3], "robots.name[1] must be a string; found 3"),
        ("robots.x", [0, 0], "robots has an unknown key 'x'"),
        ("actions.robot", [0, True, 1], "actions.robot[1] must be a whole number"),
        ("actions.robot", [0, -1, 1], "actions.robot[1] must be a whole number; expected 0 or more; found -1"),
        ("actions.name", ["p"], "there must be one name for each action; expected 3; found 1"),
        ("actions.x", [0, 1, 2], "actions has x alone"),
        ("targets.y", [0, 1], "targets has y alone"),
        ("targets.count", 1, "the target of edge 2 does not exist; expected 0 to 0; found 1"),
        ("edges.target", [0, 1], "edges.target has a wrong length; expected 3; found 2"),
        ("edges.target", [0, 1, 10**17], "target holds a number that is too large"),
        ("edges.action", [0, 1, 3], "the action of edge 3 does not exist"),
        ("edges.action", [0, 1, 1], "edge 2 joins action 1 and target 1 again"),
        ("edges.weight", [1, 2], "edges.weight has a wrong length; expected 3; found 2"),
        ("edges.weight", [1, 2, None], "edges.weight[2] must be a number; found null"),
        ("edges.weight", [1, 2, -3], "the weight of edge 3 must be finite and not negative; found -3.0"),
        ("edges.cost", [], "edges has an unknown key 'cost'"),
        ("notes", ["a", ""], "notes[1] must be printable and not empty"),
    ],
)
def test_a_fault_is_refused_by_its_path(path: str, value: Any, message: str) -> None:
    assert message in refused(load, changed(path, value))


def test_positions_of_targets_must_be_as_many_as_targets() -> None:
    data = json.loads(changed("targets", {"count": 2, "x": [0, 1, 2], "y": [0, 1, 2]}))
    with pytest.raises(InputError, match=r"targets.x has a wrong length; expected 2; found 3"):
        load(json.dumps(data))


def test_everything_a_graph_can_hold_reads_back_the_same(differences: Callable[..., list[str]]) -> None:
    g = graph_of_edges(
        [1, 0, 1], [0, 2, 2], [3, 0, 1], [1 / 3, 1e-300, 1e300], robots=["ä", "b c", "3"], targets=list("wxyz"), action_names=list("pqr"),
        action_positions=[(0, 1 / 7), (2, 3), (-4, 5)], target_positions=np.arange(8.0).reshape(4, 2), name="all", problem="selection",
        problems=("selection", "winner-takes-all"), notes=("a note",),
    )  # fmt: skip
    again = read(write(g), Path("all.json"))
    assert differences(g, again) == []
    assert write(again) == write(g)
    data = json.loads(write(g))
    assert data["notes"] == ["a note"]  # what the data themselves tell is found again, and not written


@given(st.lists(st.floats(1e-300, 1e300), min_size=1, max_size=6), st.integers(0, 2**32 - 1))
def test_numbers_read_back_to_the_bit(weights: list[float], seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = len(weights)
    g = graph_of_edges(rng.integers(0, 3, count), np.arange(count), rng.integers(0, 2, count), weights, robots=3, targets=2)
    again = load(write(g))
    assert again.weights.tobytes() == g.weights.tobytes()
    assert again.digest() == g.digest()
