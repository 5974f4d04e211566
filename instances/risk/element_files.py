"""Risk elements in waybound's JSON; the keys are documented in ``docs/formats.md``."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ..document import array, fields, flags, integer, json_number, json_numbers, kind_of, matrix, real, reals, string, wholes
from ..errors import InputError, UsageError
from .element import RiskElement
from .elements import AccessRisk, LengthRisk, LocaleRisk, MoveRisk, TurnRisk
from .tether import Tether
from .traverse_elements import CollectedRisk, TetherRisk, TravelledRisk

Reader = Callable[[Any, str, int], Any]


def _befores(data: Any, path: str, states: int) -> Any:
    return np.array([-1 if item is None else integer(item, f"{path}[{k}]", 0) for k, item in enumerate(array(data, path))], dtype=np.int64)


NUMBER: Reader = lambda data, path, states: real(data, path)  # noqa: E731
NUMBERS: Reader = lambda data, path, states: reals(data, path)  # noqa: E731
TEXT: Reader = lambda data, path, states: string(data, path)  # noqa: E731
STATES: Reader = lambda data, path, states: wholes(data, path)  # noqa: E731
LEVELS: Reader = lambda data, path, states: matrix(data, path, columns=states)  # noqa: E731
BOXES: Reader = lambda data, path, states: matrix(data, path)  # noqa: E731
SPACING: Reader = lambda data, path, states: None if data is None else real(data, path)  # noqa: E731

ELEMENTS: dict[str, tuple[Callable[..., RiskElement], dict[str, Reader]]] = {
    "locale": (LocaleRisk, {"risk": reals}),
    "length": (LengthRisk, {"rate": NUMBER, "growth": TEXT}),
    "turn": (TurnRisk, {"rate": NUMBER, "measure": TEXT}),
    "access": (AccessRisk, {"width": reals, "narrowing": NUMBER, "widening": NUMBER}),
    "moves": (MoveRisk, {"before": _befores, "state": STATES, "after": STATES, "risk": NUMBERS}),
    "collected": (CollectedRisk, {"collects": flags, "risk": LEVELS}),
    "travelled": (TravelledRisk, {"rate": NUMBER, "free": NUMBER}),
    "tether": (TetherRisk, {"length_rate": NUMBER, "contact_rate": NUMBER}),
}
"""Class of each kind, with the readers of its fields."""

TETHER: dict[str, Reader] = {"reel": lambda data, path, states: tuple(reals(data, path, 2)), "obstacles": BOXES, "spacing": SPACING}


def written_element(element: RiskElement) -> dict[str, Any]:
    """A risk element in JSON; raises UsageError for one that files cannot hold."""
    if element.kind not in ELEMENTS:
        raise UsageError(f"risk element {element.label} is a function of one's own, which files cannot hold", "unsupported")
    data: dict[str, Any] = {"kind": element.kind, "label": element.label}
    for owner, keys in ((element, ELEMENTS[element.kind][1]), (getattr(element, "tether", None), TETHER)):
        if owner is not None:
            data.update({key: _plain(getattr(owner, key)) for key in keys})
    if element.kind == "moves":
        data["before"] = [None if state < 0 else state for state in data["before"]]
    return data


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return json_numbers(value) if value.dtype.kind == "f" else value.tolist()
    if isinstance(value, tuple):
        return [json_number(v) for v in value]
    return json_number(value) if isinstance(value, float) else value


def read_element(data: Any, path: str, states: int) -> RiskElement:
    """A risk element out of JSON, over that many states."""
    kind = data.get("kind") if isinstance(data, dict) else None
    if not isinstance(data, dict) or not isinstance(kind, str) or kind not in ELEMENTS:
        found = kind_of(kind if isinstance(data, dict) else data)
        raise InputError(
            f"{path} is no risk element",
            "unknown-name" if isinstance(kind, str) else "malformed",
            expected=", ".join(ELEMENTS),
            found=found,
        )
    make, readers = ELEMENTS[data["kind"]]
    tethered = TETHER if data["kind"] == "tether" else {}
    fields(data, path, ("kind", "label", *readers, *tethered))
    arguments = {key: read(data[key], f"{path}.{key}", states) for key, read in readers.items() if key in data}
    if "label" in data:
        arguments["label"] = string(data["label"], f"{path}.label")
    try:
        if tethered:
            arguments["tether"] = Tether(**{key: read(data[key], f"{path}.{key}", states) for key, read in tethered.items() if key in data})
        return make(**arguments)
    except TypeError as fault:
        raise InputError(f"{path} is incomplete: {str(fault).partition('__init__() ')[2]}", "missing") from None
