"""Costs of assignments in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...document import array, fields, integer, json_numbers, reals, string, strings, wholes
from ...errors import InputError
from ...kinds import KINDS, Kind
from ..assignment import PROBLEMS, AssignmentInstance

KEYS = ("name", "problem", "robots", "bins", "cost", "pairs", "notes")
ROBOT_KEYS = ("count", "name", "x", "y")
BIN_KEYS = (*ROBOT_KEYS, "filled")
PAIR_KEYS = ("robot", "bin", "cost")


def encode(instance: AssignmentInstance) -> dict[str, Any]:
    """The keys of an instance: a matrix where at least half of all pairs are allowed, else lists of pairs."""
    data: dict[str, Any] = {"name": instance.name, "problem": instance.problem}
    for what, key in (("robot", "robots"), ("bin", "bins")):
        part: dict[str, Any] = {"count": getattr(instance, f"num_{key}")}
        names, positions = getattr(instance, f"{what}_names"), getattr(instance, f"{what}_positions")
        if names is not None:
            part["name"] = list(names)
        if positions is not None:
            part["x"], part["y"] = (json_numbers(column) for column in positions.T)
        data[key] = part
    if instance.filled is not None:
        data["bins"]["filled"] = json_numbers(instance.filled)
    if 2 * instance.num_pairs >= instance.num_robots * instance.num_bins:
        data["cost"] = json_numbers(instance.matrix())
    else:
        data["pairs"] = {"robot": instance.robots.tolist(), "bin": instance.bins.tolist(), "cost": json_numbers(instance.cost)}
    return {**data, "notes": list(instance.notes)} if instance.notes else data


def decode(data: dict[str, Any]) -> AssignmentInstance:
    """The instance; see ``Kind.decode``."""
    fields(data, "the document", KEYS, ("name", "problem", "robots", "bins"))
    problem = string(data["problem"], "problem")
    if problem not in PROBLEMS:
        raise InputError("problem is none of assignments", expected=", ".join(PROBLEMS), found=problem)
    if ("cost" in data) == ("pairs" in data):
        raise InputError("costs stand in one of two ways", expected="the key 'cost', a matrix, or the key 'pairs'")
    further: dict[str, Any] = {
        "name": string(data["name"], "name"), "format": "json", "problem": problem, "notes": strings(data.get("notes", []), "notes"),
    }  # fmt: skip
    counts = []
    for what, key, known in (("robot", "robots", ROBOT_KEYS), ("bin", "bins", BIN_KEYS)):
        part = fields(data[key], key, known, ("count",))
        counts.append(integer(part["count"], f"{key}.count", 1))
        if "name" in part:
            further[f"{what}_names"] = strings(part["name"], f"{key}.name")
        if ("x" in part) != ("y" in part):
            raise InputError(f"{key} has one coordinate alone", expected="x and y")
        if "x" in part:
            further[f"{what}_positions"] = np.column_stack([reals(part[axis], f"{key}.{axis}", counts[-1]) for axis in ("x", "y")])
        if "filled" in part:
            further["filled"] = reals(part["filled"], f"{key}.filled", counts[-1], null=math.inf)
    if "cost" in data:
        rows = array(data["cost"], "cost", counts[0])
        return AssignmentInstance.from_matrix([reals(row, f"cost[{k}]", counts[1], null=math.inf) for k, row in enumerate(rows)], **further)
    pairs = fields(data["pairs"], "pairs", PAIR_KEYS, PAIR_KEYS)
    robots = wholes(pairs["robot"], "pairs.robot")
    bins, costs = wholes(pairs["bin"], "pairs.bin", len(robots)), reals(pairs["cost"], "pairs.cost", len(robots))
    return AssignmentInstance.from_pairs(counts[0], counts[1], robots, bins, costs, **further)


KINDS.add("assignment", Kind("assignment", encode, decode))
