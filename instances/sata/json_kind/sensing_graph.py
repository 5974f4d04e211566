"""Sensing graphs in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...document import array, fields, integer, json_number, json_numbers, reals, string, strings, wholes
from ...errors import InputError
from ...kinds import KINDS, Kind
from ..sensing_graph import PROBLEMS, SensingGraph, graph_of_edges

KEYS = ("name", "problem", "problems", "robots", "actions", "targets", "edges", "notes")
ROBOT_KEYS = ("count", "name")
ACTION_KEYS = ("robot", "name", "x", "y")
TARGET_KEYS = ("count", "name", "x", "y")
EDGE_KEYS = ("action", "target", "weight")


def encode(graph: SensingGraph) -> dict[str, Any]:
    """The keys of a sensing graph; columns and keys that hold nothing but defaults are left out."""
    data: dict[str, Any] = {"name": graph.name, "problem": graph.problem}
    if graph.problems != PROBLEMS:
        data["problems"] = list(graph.problems)
    robots: dict[str, Any] = {"count": graph.num_robots}
    actions: dict[str, Any] = {"robot": graph.robot_of_action.tolist()}
    targets: dict[str, Any] = {"count": graph.num_targets}
    for part, names in ((robots, graph.robot_names), (actions, graph.action_names), (targets, graph.target_names)):
        if names is not None:
            part["name"] = list(names)
    for part, points in ((actions, graph.action_positions), (targets, graph.target_positions)):
        if points is not None:
            part["x"], part["y"] = (json_numbers(column) for column in points.T)
    edges: dict[str, Any] = {"action": graph.action_of_edge.tolist(), "target": graph.indices.tolist()}
    if (graph.weights != 1.0).any():
        edges["weight"] = [json_number(w) for w in graph.weights.tolist()]
    data.update(robots=robots, actions=actions, targets=targets, edges=edges)
    notes = [note for note in graph.notes if note not in graph.findings]
    if notes:
        data["notes"] = notes
    return data


def decode(data: dict[str, Any]) -> SensingGraph:
    """The instance; see ``Kind.decode``."""
    fields(data, "the document", KEYS, ("name", "problem", "robots", "actions", "targets", "edges"))
    problems = strings(data.get("problems", list(PROBLEMS)), "problems")
    problem = string(data["problem"], "problem")
    for k, name in enumerate(problems):
        if name not in PROBLEMS:
            raise InputError(f"problems[{k}] is no problem of sensing graphs", expected=", ".join(PROBLEMS), found=name)
    if problem not in problems:
        raise InputError("problem must be one of problems", expected=", ".join(problems), found=problem)
    robots, targets = _members(data["robots"], "robots", ROBOT_KEYS), _members(data["targets"], "targets", TARGET_KEYS)
    actions = fields(data["actions"], "actions", ACTION_KEYS, ("robot",))
    owner = wholes(actions["robot"], "actions.robot")
    edges = fields(data["edges"], "edges", EDGE_KEYS, ("action", "target"))
    action = wholes(edges["action"], "edges.action")
    target = wholes(edges["target"], "edges.target", len(action))
    weight = reals(edges["weight"], "edges.weight", len(action)) if "weight" in edges else np.ones(len(action))
    return graph_of_edges(
        owner, action, target, weight, robots=robots, targets=targets,
        action_names=strings(actions["name"], "actions.name") if "name" in actions else None,
        action_positions=_points(actions, "actions", len(owner)), target_positions=_points(data["targets"], "targets", None),
        name=string(data["name"], "name"), format="json", problem=problem, problems=problems,
        notes=strings(data.get("notes", []), "notes"),
    )  # fmt: skip


def _members(data: Any, path: str, keys: tuple[str, ...]) -> int | tuple[str, ...]:
    """How many there are, or their names."""
    fields(data, path, keys, ("count",))
    count = integer(data["count"], f"{path}.count", 0)
    if "name" not in data:
        return count
    names = strings(data["name"], f"{path}.name")
    if len(names) != count:
        raise InputError(f"{path}.name has a wrong length", expected=str(count), found=str(len(names)))
    return names


def _points(data: Any, path: str, count: int | None) -> NDArray[np.float64] | None:
    given = [key for key in ("x", "y") if key in data]
    if len(given) == 1:
        raise InputError(f"{path} has {given[0]} alone", expected="x and y")
    if not given:
        return None
    size = len(array(data["x"], f"{path}.x")) if count is None else count
    return np.column_stack([reals(data[key], f"{path}.{key}", size) for key in given])


KINDS.add("sensing", Kind("sensing", encode, decode))
