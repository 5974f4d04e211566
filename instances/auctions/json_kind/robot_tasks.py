"""Robots and tasks in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...document import array, fields, json_numbers, reals, string, strings
from ...errors import InputError
from ...kinds import KINDS, Kind
from ..robot_tasks import METRICS, PROBLEMS, RobotTasks

KEYS = ("name", "problem", "metric", "robots", "tasks", "distances", "notes")
ROBOT_KEYS = ("count", "name", "x", "y")
TASK_KEYS = (*ROBOT_KEYS, "weight")


def encode(instance: RobotTasks) -> dict[str, Any]:
    """The keys of an instance; columns that hold nothing but defaults are left out."""
    robots: dict[str, Any] = {"count": instance.num_robots}
    tasks: dict[str, Any] = {"count": instance.num_tasks}
    for part, names in ((robots, instance.robot_names), (tasks, instance.task_names)):
        if names is not None:
            part["name"] = list(names)
    if instance.positions is not None:
        for part, places in ((robots, instance.positions[: instance.num_robots]), (tasks, instance.positions[instance.num_robots :])):
            part["x"], part["y"] = (json_numbers(column) for column in places.T)
    if instance.weights is not None and instance.weights.any():
        tasks["weight"] = json_numbers(instance.weights)
    data = {"name": instance.name, "problem": instance.problem, "metric": instance.metric, "robots": robots, "tasks": tasks}
    if instance.matrix is not None:
        data["distances"] = json_numbers(instance.matrix)
    return {**data, "notes": list(instance.notes)} if instance.notes else data


def decode(data: dict[str, Any]) -> RobotTasks:
    """The instance; see ``Kind.decode``."""
    fields(data, "the document", KEYS, ("name", "problem", "metric", "robots", "tasks"))
    problem, metric = string(data["problem"], "problem"), string(data["metric"], "metric")
    if problem not in PROBLEMS:
        raise InputError("problem is none of robots and tasks", expected=", ".join(PROBLEMS), found=problem)
    if metric not in METRICS:
        raise InputError("metric is unknown", expected=", ".join(METRICS), found=metric)
    counts, names, places = [], [], []
    for what, known in (("robots", ROBOT_KEYS), ("tasks", TASK_KEYS)):
        part = fields(data[what], what, known, ("count",))
        count = part["count"]
        if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= 100_000:
            raise InputError(f"{what}.count must be a whole number", expected="1 to 100000", found=str(count)[:40])
        if ("x" in part) != ("y" in part):
            raise InputError(f"{what} has one coordinate alone", expected="x and y")
        counts.append(count)
        names.append(strings(part["name"], f"{what}.name") if "name" in part else None)
        places.append(np.column_stack([reals(part[key], f"{what}.{key}", count) for key in ("x", "y")]) if "x" in part else None)
    if (places[0] is None) != (places[1] is None):
        raise InputError("positions are given of robots or of tasks alone", expected="x and y of both, or of neither")
    matrix = None
    if "distances" in data:
        rows = array(data["distances"], "distances", sum(counts))
        matrix = np.array([reals(row, f"distances[{k}]", counts[1]) for k, row in enumerate(rows)])
    weights = reals(data["tasks"]["weight"], "tasks.weight", counts[1]) if "weight" in data["tasks"] else None
    return RobotTasks(
        counts[0], counts[1], metric, None if places[0] is None or places[1] is None else np.vstack([places[0], places[1]]), matrix,
        weights, names[0], names[1], name=string(data["name"], "name"), format="json", problem=problem,
        notes=strings(data.get("notes", []), "notes"),
    )  # fmt: skip


KINDS.add("robot-tasks", Kind("robot-tasks", encode, decode))
