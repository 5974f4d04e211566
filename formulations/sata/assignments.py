"""Actions of robots as JSON, shared by the problems over sensing graphs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...instances.errors import InputError, UsageError
from ...instances.sata.sensing_graph import SensingGraph
from .selections import Selection


def graph_for(instance: Any, problem: str) -> SensingGraph:
    """The instance as a sensing graph of which ``problem`` may be asked; raises UsageError for any other."""
    if not isinstance(instance, SensingGraph):
        raise UsageError(f"{instance.name} holds no sensing graph, so it cannot be read as {problem}")
    if problem not in instance.problems:
        allowed = ", ".join(instance.problems)
        raise UsageError(f"{instance.name} ({instance.format}) cannot be read as {problem}; it allows {allowed}")
    return instance


def actions_to_json(graph: SensingGraph, answer: Selection) -> list[dict[str, str]]:
    """One entry a chosen action, with the file's own names."""
    return [{"robot": graph.robot_name(int(graph.robot_of_action[a])), "action": graph.action_name(a)} for a in answer.elements]


def action_index(graph: SensingGraph) -> dict[str, int]:
    """Number of each action by its name."""
    return {name: a for a, name in enumerate(graph.action_labels)}


def actions_from_json(graph: SensingGraph, data: Any) -> Selection:
    """Inverse of ``actions_to_json``; raises InputError for anything else."""
    if not isinstance(data, Mapping) or data.get("kind") != "assignment" or not isinstance(data.get("actions"), list):
        raise InputError("not an assignment of actions", expected='an object {"kind": "assignment", "actions": [{"action": ...}, ...]}')
    index = action_index(graph)
    chosen = []
    for number, entry in enumerate(data["actions"], start=1):
        name = entry.get("action") if isinstance(entry, Mapping) else None
        if str(name) not in index:
            raise InputError(f"entry {number} of the actions names no known action", found=str(entry)[:80])
        action = index[str(name)]
        robot = graph.robot_name(int(graph.robot_of_action[action]))
        if "robot" in entry and str(entry["robot"]) != robot:
            raise InputError(f"action {name} belongs to robot {robot}", found=str(entry["robot"])[:80])
        chosen.append(action)
    return Selection(tuple(chosen))
