"""Graphs with risk in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...document import array, fields, flags, integer, json_number, json_numbers, kind_of, real, reals, string, strings, wholes
from ...errors import InputError, UsageError
from ...kinds import KINDS, Kind
from ..element import RiskElement
from ..elements import AccessRisk, LengthRisk, LocaleRisk, MoveRisk, TurnRisk
from ..risky_graph import RiskyGraph
from ..tether import Tether
from ..traverse_elements import CollectedRisk, TetherRisk, TravelledRisk

KEYS = ("name", "problem", "problems", "states", "moves", "start", "goals", "objective", "discount", "conditional", "elements", "obstacles",
        "notes")  # fmt: skip
STATE_KEYS = ("count", "name", "x", "y", "z", "reward")
MOVE_KEYS = ("tail", "head")

Reader = Callable[[Any, str, int], Any]


def _table(data: Any, path: str, states: int) -> Any:
    return np.array([reals(row, f"{path}[{k}]", states) for k, row in enumerate(array(data, path))]).reshape(-1, states)


def _befores(data: Any, path: str, states: int) -> Any:
    return np.array([-1 if item is None else integer(item, f"{path}[{k}]", 0) for k, item in enumerate(array(data, path))], dtype=np.int64)


def _boxes(data: Any, path: str, states: int) -> Any:
    rows = array(data, path)
    width = len(array(rows[0], f"{path}[0]")) if rows else 4
    return np.array([reals(row, f"{path}[{k}]", width) for k, row in enumerate(rows)]).reshape(-1, width)


def _optional(data: Any, path: str, states: int) -> float | None:
    return None if data is None else real(data, path)


def _columns(data: Any, path: str, states: int) -> Any:
    return reals(data, path, len(array(data, path)))


NUMBER: Reader = lambda data, path, states: real(data, path)  # noqa: E731
TEXT: Reader = lambda data, path, states: string(data, path)  # noqa: E731
A_STATE_EACH: Reader = reals
STATES: Reader = lambda data, path, states: wholes(data, path)  # noqa: E731

ELEMENTS: dict[str, tuple[Callable[..., RiskElement], dict[str, Reader]]] = {
    "locale": (LocaleRisk, {"risk": A_STATE_EACH}),
    "length": (LengthRisk, {"rate": NUMBER, "growth": TEXT}),
    "turn": (TurnRisk, {"rate": NUMBER, "measure": TEXT}),
    "access": (AccessRisk, {"width": A_STATE_EACH, "narrowing": NUMBER, "widening": NUMBER}),
    "moves": (MoveRisk, {"before": _befores, "state": STATES, "after": STATES, "risk": _columns}),
    "collected": (CollectedRisk, {"collects": flags, "risk": _table}),
    "travelled": (TravelledRisk, {"rate": NUMBER, "free": NUMBER}),
    "tether": (TetherRisk, {"length_rate": NUMBER, "contact_rate": NUMBER}),
}
"""By kind: the class, and how each of its fields is read."""

TETHER: dict[str, Reader] = {"reel": lambda data, path, states: tuple(reals(data, path, 2)), "obstacles": _boxes, "spacing": _optional}


def encode(graph: RiskyGraph) -> dict[str, Any]:
    """The keys of a graph with risk; those that hold nothing but defaults are left out."""
    states: dict[str, Any] = {"count": graph.num_states}
    if graph.state_names is not None:
        states["name"] = list(graph.state_names)
    if graph.positions is not None:
        states.update(zip("xyz", (json_numbers(column) for column in graph.positions.T), strict=False))
    if graph.rewards is not None and graph.rewards.any():
        states["reward"] = json_numbers(graph.rewards)
    data: dict[str, Any] = {
        "name": graph.name, "problem": graph.problem, "states": states, "moves": {"tail": graph.tail.tolist(), "head": graph.head.tolist()},
        "start": graph.start, "goals": list(graph.goals), "objective": graph.objective, "discount": json_number(graph.discount),
        "conditional": graph.conditional, "elements": [_encoded(element) for element in graph.elements],
    }  # fmt: skip
    if graph.obstacles is not None:
        data["obstacles"] = json_numbers(graph.obstacles)
    if graph.notes:
        data["notes"] = list(graph.notes)
    return data


def _encoded(element: RiskElement) -> dict[str, Any]:
    if element.kind not in ELEMENTS:
        raise UsageError(f"risk element {element.label} is a function of one's own, which files cannot hold")
    made: dict[str, Any] = {"kind": element.kind, "label": element.label}
    for owner, keys in ((element, ELEMENTS[element.kind][1]), (getattr(element, "tether", None), TETHER)):
        if owner is not None:
            made.update({key: _plain(getattr(owner, key)) for key in keys})
    if element.kind == "moves":
        made["before"] = [None if state < 0 else state for state in made["before"]]
    return made


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return json_numbers(value) if value.dtype.kind == "f" else value.tolist()
    if isinstance(value, tuple):
        return [json_number(v) for v in value]
    return json_number(value) if isinstance(value, float) else value


def decode(data: dict[str, Any]) -> RiskyGraph:
    """The instance; see ``Kind.decode``."""
    fields(data, "the document", KEYS, ("name", "problem", "states", "moves", "start", "conditional", "elements"))
    problem = string(data["problem"], "problem")
    problems = strings(data.get("problems", [problem]), "problems")
    if problem != "risky-path" or problems != ("risky-path",):
        raise InputError("graphs with risk allow one problem", expected="risky-path", found=", ".join((problem, *problems)))
    states = fields(data["states"], "states", STATE_KEYS, ("count",))
    count = integer(states["count"], "states.count", 1)
    axes = [key for key in "xyz" if key in states]
    if axes not in ([], ["x", "y"], ["x", "y", "z"]):
        raise InputError(f"states has {' and '.join(axes)} alone", expected="x and y, or x, y and z")
    moves = fields(data["moves"], "moves", MOVE_KEYS, MOVE_KEYS)
    tail = wholes(moves["tail"], "moves.tail")
    if not isinstance(data["conditional"], bool):
        raise InputError("conditional must be true or false", found=kind_of(data["conditional"]))
    return RiskyGraph(
        count, tail, wholes(moves["head"], "moves.head", len(tail)),
        tuple(_decoded(item, f"elements[{k}]", count) for k, item in enumerate(array(data["elements"], "elements"))),
        integer(data["start"], "start", 0), data["conditional"], tuple(wholes(data.get("goals", []), "goals").tolist()),
        reals(states["reward"], "states.reward", count) if "reward" in states else None, real(data.get("discount", 1), "discount"),
        string(data["objective"], "objective") if "objective" in data else "",
        positions=np.column_stack([reals(states[key], f"states.{key}", count) for key in axes]) if axes else None,
        obstacles=_boxes(data["obstacles"], "obstacles", count) if "obstacles" in data else None,
        state_names=strings(states["name"], "states.name") if "name" in states else None,
        name=string(data["name"], "name"), format="json", notes=strings(data.get("notes", []), "notes"),
    )  # fmt: skip


def _decoded(data: Any, path: str, states: int) -> RiskElement:
    kind = data.get("kind") if isinstance(data, dict) else None
    if not isinstance(data, dict) or not isinstance(kind, str) or kind not in ELEMENTS:
        found = kind_of(kind if isinstance(data, dict) else data)
        raise InputError(f"{path} is no risk element", expected=", ".join(ELEMENTS), found=found)
    make, readers = ELEMENTS[data["kind"]]
    tethered = TETHER if data["kind"] == "tether" else {}
    fields(data, path, ("kind", "label", *readers, *tethered))
    given = {key: read(data[key], f"{path}.{key}", states) for key, read in readers.items() if key in data}
    if "label" in data:
        given["label"] = string(data["label"], f"{path}.label")
    try:
        if tethered:
            given["tether"] = Tether(**{key: read(data[key], f"{path}.{key}", states) for key, read in tethered.items() if key in data})
        return make(**given)
    except TypeError as fault:
        raise InputError(f"{path} is incomplete: {str(fault).partition('__init__() ')[2]}") from None


KINDS.add("risky-graph", Kind("risky-graph", encode, decode))
