"""waybound's JSON: every kind of instance, exact to the bit. The schema is documented in ``docs/formats.md``."""

import re
from pathlib import Path
from typing import Any

from ..document import dump_json, fields, integer, kind_of, parse_json, string
from ..errors import InputError, UsageError, in_words
from ..instance import Instance, settings_of, with_settings
from ..kinds import KINDS
from . import FORMATS, Format

VERSION = 1


_VERSION, _VEHICLES = re.compile(r'"waybound"\s*:'), re.compile(r'"vehicles"\s*:|"type"\s*:\s*"FeatureCollection"')


def recognises(text: str) -> bool:
    """True if the text is meant as a JSON object, and not as VROOM's, which has vehicles, or as GeoJSON."""
    return text.lstrip().startswith("{") and (_VERSION.search(text) is not None or _VEHICLES.search(text) is None)


def read(text: str, path: Path) -> Instance:
    """The instance; see ``Format.read``."""
    data = parse_json(text)
    if not isinstance(data, dict):
        raise InputError("must hold one object", found=kind_of(data))
    if "waybound" not in data:
        if "answer" in data or "routes" in data:
            raise InputError("is a solution file, not an instance", "foreign")
        raise InputError("is JSON, but no waybound instance", expected='the key "waybound" with the version of the schema')
    version = integer(data["waybound"], "waybound", 1)
    if version != VERSION:
        raise InputError("schema version is not supported", "unsupported", expected=str(VERSION), found=str(version))
    fields(data, "the document", tuple(data), ("kind",))
    kind = string(data["kind"], "kind")
    if kind not in KINDS:
        raise InputError("kind is unknown", "unknown-name", expected=", ".join(KINDS.names()), found=kind)
    instance = _decoded(kind, {key: value for key, value in data.items() if key not in ("waybound", "kind", "settings")})
    return with_settings(instance, _settings(data["settings"])) if "settings" in data else instance


def _decoded(kind: str, data: dict[str, Any]) -> Instance:
    """The instance of a document; a kind from outside that trips over bad data has been given bad data."""
    decode = KINDS[kind].decode
    try:
        return decode(data)
    except (KeyError, IndexError, TypeError, ValueError, AttributeError) as fault:
        if decode.__module__.startswith("waybound."):
            raise
        raise InputError(f"is no document of kind {kind}", found=in_words(fault)) from fault


def _settings(data: Any) -> dict[str, Any]:
    """Plain values by name, as ``--set`` takes them."""
    settings = fields(data, "settings", data if isinstance(data, dict) else ())
    for name, value in settings.items():
        if not isinstance(value, str | int | float):
            raise InputError(f"settings.{name} must be a text, a number, true or false", found=kind_of(value))
    return dict(settings)


def write(instance: Any) -> str:
    """The text; see ``Format.write``."""
    if instance.kind not in KINDS:
        raise UsageError(f"{instance.name} is of kind {instance.kind}, which has no JSON form", "unsupported")
    settings = settings_of(instance)
    more = {"settings": settings} if settings else {}
    return dump_json({"waybound": VERSION, "kind": instance.kind, **KINDS[instance.kind].encode(instance), **more})


FORMATS.enter(
    Format(
        "json", "waybound JSON (every kind of instance)", recognises, read, write, (".json",), sense="of the problem",
        answer="of the problem", kinds=(),
    )
)  # fmt: skip
