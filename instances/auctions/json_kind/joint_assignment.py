"""Joint assignments in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...document import array, fields, integer, json_numbers, reals, string, strings
from ...errors import InputError
from ...kinds import KINDS, Kind
from ..joint_assignment import PROBLEMS, JointAssignmentInstance

KEYS = ("name", "problem", "robots", "bins", "requests", "to_bin", "to_request", "between", "notes")
PARTS = ("robot", "bin", "request")


def encode(instance: JointAssignmentInstance) -> dict[str, Any]:
    """The keys of an instance."""
    data: dict[str, Any] = {"name": instance.name, "problem": instance.problem}
    for what in PARTS:
        names = getattr(instance, f"{what}_names")
        data[f"{what}s"] = {"count": getattr(instance, f"num_{what}s"), **({} if names is None else {"name": list(names)})}
    assert instance.filled is not None
    if instance.filled.any():
        data["bins"]["filled"] = json_numbers(instance.filled)
    for key in ("to_bin", "to_request", "between"):
        data[key] = json_numbers(getattr(instance, key))
    return {**data, "notes": list(instance.notes)} if instance.notes else data


def decode(data: dict[str, Any]) -> JointAssignmentInstance:
    """The instance; see ``Kind.decode``."""
    fields(data, "the document", KEYS, KEYS[:-1])
    problem = string(data["problem"], "problem")
    if problem not in PROBLEMS:
        raise InputError("problem is none of joint assignments", expected=", ".join(PROBLEMS), found=problem)
    counts: list[int] = []
    further: dict[str, Any] = {"name": string(data["name"], "name"), "format": "json", "notes": strings(data.get("notes", []), "notes")}
    for what in PARTS:
        key = f"{what}s"
        part = fields(data[key], key, ("count", "name", "filled") if what == "bin" else ("count", "name"), ("count",))
        counts.append(integer(part["count"], f"{key}.count", 0 if what == "request" else 1))
        if "name" in part:
            further[f"{what}_names"] = strings(part["name"], f"{key}.name")
        if "filled" in part:
            further["filled"] = reals(part["filled"], f"{key}.filled", counts[-1], null=math.inf)
    n, m, q = counts

    def matrix(key: str, rows: int, columns: int, null: float | None) -> Any:
        given = array(data[key], key, rows)
        made = [reals(row, f"{key}[{k}]", columns, null=null) for k, row in enumerate(given)]
        return np.array(made, dtype=np.float64).reshape(rows, columns)

    return JointAssignmentInstance(
        matrix("to_bin", n, m, math.inf), matrix("to_request", n, q, math.inf), matrix("between", q, m, None), **further
    )


KINDS.add("joint-assignment", Kind("joint-assignment", encode, decode))
