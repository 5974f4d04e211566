"""Maps of rooms in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...document import array, fields, integer, json_numbers, reals, string, strings, wholes
from ...errors import InputError
from ...kinds import KINDS, Kind
from ..exploration_map import GAINS, PROBLEMS, ExplorationMap

KEYS = ("name", "problem", "rooms", "doors", "robots", "base", "heard", "silence", "steps", "notes")
ROOM_KEYS = ("count", "name", "x", "y", *GAINS)


def encode(instance: ExplorationMap) -> dict[str, Any]:
    """The keys of an instance."""
    rooms: dict[str, Any] = {"count": instance.num_rooms}
    if instance.room_names is not None:
        rooms["name"] = list(instance.room_names)
    if instance.positions is not None:
        rooms["x"], rooms["y"] = (json_numbers(column) for column in instance.positions.T)
    rooms.update({key: json_numbers(getattr(instance, key)) for key in GAINS})
    data = {
        "name": instance.name, "problem": instance.problem, "rooms": rooms, "doors": instance.doors.tolist(),
        "robots": instance.starts.tolist(), "base": instance.base, "heard": instance.heard.tolist(), "silence": instance.silence,
        "steps": instance.steps,
    }  # fmt: skip
    return {**data, "notes": list(instance.notes)} if instance.notes else data


def decode(data: dict[str, Any]) -> ExplorationMap:
    """The instance; see ``Kind.decode``."""
    fields(data, "the document", KEYS, KEYS[:-1])
    problem = string(data["problem"], "problem")
    if problem not in PROBLEMS:
        raise InputError("problem is none of maps of rooms", expected=", ".join(PROBLEMS), found=problem)
    rooms = fields(data["rooms"], "rooms", ROOM_KEYS, ("count", *GAINS))
    count = integer(rooms["count"], "rooms.count", 1)
    positions = None
    if ("x" in rooms) != ("y" in rooms):
        raise InputError("rooms have one coordinate alone", expected="x and y")
    if "x" in rooms:
        positions = np.column_stack([reals(rooms[axis], f"rooms.{axis}", count) for axis in ("x", "y")])
    gains = []
    for key in GAINS:
        table = array(rooms[key], f"rooms.{key}", count)
        times = len(array(table[0], f"rooms.{key}[0]"))
        gains.append(np.array([reals(row, f"rooms.{key}[{k}]", times) for k, row in enumerate(table)]).reshape(count, times))
    pairs = [
        np.array([wholes(pair, f"{key}[{k}]", 2) for k, pair in enumerate(array(data[key], key))], dtype=np.int64).reshape(-1, 2)
        for key in ("doors", "heard")
    ]
    return ExplorationMap(
        pairs[0], gains[0], gains[1], gains[2], wholes(data["robots"], "robots"), integer(data["base"], "base", 0), pairs[1],
        integer(data["silence"], "silence", 0), integer(data["steps"], "steps", 1),
        strings(rooms["name"], "rooms.name") if "name" in rooms else None, positions, name=string(data["name"], "name"), format="json",
        notes=strings(data.get("notes", []), "notes"),
    )  # fmt: skip


KINDS.add("exploration-map", Kind("exploration-map", encode, decode))
