"""Standard JSON as text, of whatever answers, solutions and certificates hold."""

import json
import math
from typing import Any

INDENTED = 1_000_000
"""Characters up to which JSON is laid out for people: doing so takes five times as long, which an interrupted command does not have."""


def json_text(data: Any) -> str:
    """Standard JSON, one key a line unless it is long; numbers that JSON does not know are null, characters that cannot be printed are
    escaped."""
    try:
        text = json.dumps(data, ensure_ascii=False, allow_nan=False)  # most data are plain already, and a look at all takes as long again
    except (TypeError, ValueError):
        data = finite(data)
        text = json.dumps(data, ensure_ascii=False, allow_nan=False)
    if len(text) <= INDENTED:
        text = json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False)
    if not all(line.isprintable() for line in text.split("\n")):  # the standard lets DEL, C1 controls and overrides stand as they are
        text = "".join(c if c == "\n" or c.isprintable() else _escaped(c) for c in text)
    return text + "\n"


def _escaped(character: str) -> str:
    return json.dumps(character)[1:-1] if character != "\x7f" else "\\u007f"


def finite(data: Any) -> Any:
    """``data`` of plain JSON values, with null for infinities and NaN, and numpy's numbers as Python's."""
    if isinstance(data, dict):
        return {str(key): finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple | set | frozenset):
        return [finite(value) for value in data]
    if hasattr(data, "tolist"):
        return finite(data.tolist())
    if isinstance(data, float) and not math.isfinite(data):
        return None
    return data
