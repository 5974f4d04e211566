"""Checked access to parsed JSON: every complaint names the key by its path, and nothing unknown is dropped."""

import json
import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from .errors import InputError
from .number_arrays import Flags, Floats, Integers
from .suggestions import did_you_mean
from .text import plain, shown

Object = dict[str, Any]

DEEPEST = 50
"""Lists and objects within each other that a document may have: whatever walks through one may do so by recursion."""


def parse_json(text: str) -> Any:
    """Parsed JSON. Refuses what the standard does not know (NaN, Infinity), double keys, and depth beyond reason.

    A number beyond the range of float is infinite, whole or not, so that nothing overflows later.

    Raises
    ------
    InputError
        With the line where the text breaks off or the rule is broken.
    """

    def constant(name: str) -> Any:
        finite = "a finite number, or null for infinity"
        raise InputError("JSON has no such number", "out-of-range", line=_line_of(text, name), expected=finite, found=name)

    def whole(digits: str) -> float:
        return int(digits) if len(digits) <= 300 else float(digits)

    def pairs(items: list[tuple[str, Any]]) -> Object:
        keys = dict(items)
        if len(keys) != len(items):
            seen: set[str] = set()
            key = next(k for k, _ in items if k in seen or seen.add(k))  # type: ignore[func-returns-value]
            raise InputError(f"key {shown(key)} stands twice in one object", "duplicate", line=_line_of(text, json.dumps(key)))
        return keys

    try:
        data = json.loads(text, parse_constant=constant, parse_int=whole, object_pairs_hook=pairs)
    except json.JSONDecodeError as error:
        found = text[error.pos : error.pos + 20].split("\n")[0]
        raise InputError(
            f"is no JSON: {error.msg}", line=error.lineno, found=shown(found) if found else "the end of the file or line"
        ) from None
    except RecursionError:
        raise InputError("is nested too deeply", "too-large") from None
    if _deeper(data, DEEPEST):
        raise InputError("is nested too deeply", "too-large", expected=f"at most {DEEPEST} levels")
    return data


def _deeper(data: Any, levels: int) -> bool:
    """True if lists and objects are nested more than ``levels`` deep."""
    inside = [data] if isinstance(data, list | dict) else []
    for _ in range(levels):
        inside = [
            item
            for outer in inside
            for item in (outer.values() if type(outer) is dict else outer)
            if type(item) is list or type(item) is dict
        ]
        if not inside:
            return False
    return bool(inside)


def _line_of(text: str, piece: str) -> int | None:
    at = text.find(piece)
    return None if at < 0 else text.count("\n", 0, at) + 1


def fields(data: Any, path: str, known: Collection[str], required: Collection[str] = ()) -> Mapping[str, Any]:
    """``data`` as an object with no unknown and all required keys."""
    if not isinstance(data, dict):
        raise InputError(f"{path} must be an object", found=kind_of(data))
    for key in data:
        if key not in known:
            raise InputError(f"{path} has an unknown key {shown(key)}{did_you_mean(key, known)}", "unknown-name", expected=", ".join(known))
    for key in required:
        if key not in data:
            raise InputError(f"{path} lacks the key {key!r}", "missing")
    return data


def string(data: Any, path: str) -> str:
    """A text of at least one character that can be printed on one line."""
    if not isinstance(data, str):
        raise InputError(f"{path} must be a string", found=kind_of(data))
    if not data.strip() or not data.isprintable():
        raise InputError(f"{path} must be printable and not empty", found=ascii(data[:40]))
    return data


def strings(data: Any, path: str) -> tuple[str, ...]:
    """Check that ``data`` is a list of strings, and return them; see ``string``."""
    return tuple(string(item, f"{path}[{k}]") for k, item in enumerate(array(data, path)))


def array(data: Any, path: str, length: int | None = None) -> Sequence[Any]:
    """A list, of the given length where one is given."""
    if not isinstance(data, list):
        raise InputError(f"{path} must be a list", found=kind_of(data))
    if length is not None and len(data) != length:
        raise InputError(f"{path} has a wrong length", "wrong-shape", expected=str(length), found=str(len(data)))
    return data


def real(data: Any, path: str, *, null: float | None = None) -> float:
    """A finite number; ``null`` stands for infinity where the key allows it."""
    if data is None and null is not None:
        return null
    if isinstance(data, bool) or not isinstance(data, int | float):
        raise InputError(f"{path} must be a number", found=kind_of(data))
    try:
        value = float(data)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise InputError(f"{path} must be a finite number", "out-of-range", found=shown(str(data)))
    return value


def integer(data: Any, path: str, least: int, most: int | None = None) -> int:
    """A whole number of at least ``least``, and at most ``most`` where that is given."""
    if isinstance(data, bool) or not isinstance(data, int) or not least <= data < (10**18 if most is None else most + 1):
        expected = f"{least} or more" if most is None else f"{least} to {most}"
        raise InputError(
            f"{path} must be a whole number", "out-of-range" if type(data) is int else "malformed", expected=expected, found=kind_of(data)
        )
    return data


def reals(data: Any, path: str, length: int | None = None, *, null: float | None = None) -> Floats:
    """A list of finite numbers as an array, of the given length where one is given."""
    items = array(data, path, length)
    if all(type(item) is float or type(item) is int for item in items):
        try:
            values = np.array(items, dtype=np.float64)
        except OverflowError:
            pass
        else:
            if np.isfinite(values).all():
                return values
    return np.array([real(item, f"{path}[{k}]", null=null) for k, item in enumerate(items)], dtype=np.float64)


def wholes(data: Any, path: str, length: int | None = None) -> Integers:
    """A list of whole numbers of at least 0, of the given length where one is given."""
    items = array(data, path, length)
    if not all(type(item) is int and 0 <= item < 10**18 for item in items):
        for k, item in enumerate(items):
            integer(item, f"{path}[{k}]", 0)
    return np.array(items, dtype=np.int64)


def flags(data: Any, path: str, length: int) -> Flags:
    """A list of true and false, as an array of the given length."""
    items = array(data, path, length)
    for k, item in enumerate(items):
        if not isinstance(item, bool):
            raise InputError(f"{path}[{k}] must be true or false", found=kind_of(item))
    return np.array(items, dtype=bool)


def matrix(data: Any, path: str, rows: int | None = None, columns: int | None = None, *, null: float | None = None) -> Floats:
    """A list of rows, all of one length, as an array; rows and columns are as many as there are where no number is given."""
    lists = array(data, path, rows)
    width = columns if columns is not None else len(array(lists[0], f"{path}[0]")) if lists else 0
    values = [reals(row, f"{path}[{k}]", width, null=null) for k, row in enumerate(lists)]
    return np.array(values, dtype=np.float64).reshape(len(lists), width)


def square(data: Any, path: str, size: int) -> Floats:
    """A list of rows, as an array of shape (size, size)."""
    return matrix(data, path, size, size)


def positions(data: Mapping[str, Any], path: str, count: int, keys: Sequence[str] = "xy") -> Floats | None:
    """Places in two or more columns of an object, as an array of shape (count, coordinates); None where there are none."""
    there = [key for key in keys if key in data]
    if there and there != list(keys)[: max(2, len(there))]:
        expected = ", or ".join(f"{', '.join(keys[: n - 1])} and {keys[n - 1]}" for n in range(2, len(keys) + 1))
        raise InputError(f"{path} has {' and '.join(there)} alone", "missing", expected=expected)
    return np.column_stack([reals(data[key], f"{path}.{key}", count) for key in there]) if there else None


def kind_of(data: Any) -> str:
    """A short description of a JSON value for messages."""
    if isinstance(data, str):
        return shown(data)
    if isinstance(data, bool | int | float) or data is None:
        return "a number beyond all bounds" if _huge(data) else json.dumps(data)
    if isinstance(data, list | dict):
        return "a list" if isinstance(data, list) else "an object"
    return f"{type(data).__module__}.{type(data).__name__}".removeprefix("builtins.")  # of Python, and nothing that JSON has


def _huge(data: Any) -> bool:
    return isinstance(data, int) and abs(data) > 10**30


# -- writing -------------------------------------------------------------------------------------------------------------


def json_number(value: float) -> float | int | None:
    """A number as JSON holds it: exact, whole numbers without a point, infinity as null."""
    value = float(value)
    if math.isinf(value):
        return None
    text = plain(value)
    return int(text) if text.lstrip("-").isdigit() else value


def json_numbers(values: Floats) -> list[Any]:
    """An array of one or two dimensions as lists."""
    return [json_numbers(row) for row in values] if values.ndim > 1 else [json_number(v) for v in values.tolist()]


def dump_json(data: Any) -> str:
    """JSON text with one line for each key, list of values, and object or list inside a list."""
    return _dumped(data, "") + "\n"


def _dumped(data: Any, indent: str) -> str:
    deeper = indent + "  "
    if isinstance(data, dict) and data:
        inner = [f"{deeper}{json.dumps(key, ensure_ascii=False)}: {_dumped(value, deeper)}" for key, value in data.items()]
        return "{\n" + ",\n".join(inner) + f"\n{indent}}}"
    if isinstance(data, list) and data and isinstance(data[0], dict | list):
        return "[\n" + ",\n".join(deeper + _dumped(value, deeper) for value in data) + f"\n{indent}]"
    return json.dumps(data, ensure_ascii=False, allow_nan=False)
