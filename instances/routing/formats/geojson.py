"""Sites as GeoJSON points: what map editors, spatial databases and web services export; documented in ``docs/formats.md``.

Properties are the columns of a frame of sites. What GeoJSON has no place for stands beside ``features``: the vehicles, the speed, units.
"""

import math
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ...document import array, fields, integer, kind_of, parse_json, real, string, strings
from ...errors import InputError
from ...formats import FORMATS, Format
from ...suggestions import did_you_mean
from ...text import shown
from ..instance import RoutingInstance
from ..json_vehicles import VEHICLE_KEYS
from ._frame_settings import KEYS, arguments, in_file, of_set

SETTINGS = (
    "name", "vehicles", "capacity", "max_duration", "max_distance", "fixed_cost", "speed", "fleet", "columns", "extra", "time_unit",
    "distance_unit", "min_vehicles", "shipments", "groups",
)  # fmt: skip
"""Members of the collection that are arguments of ``from_frame``."""

FEATURE = ("type", "id", "bbox", "geometry", "properties")
"""Members of a feature that GeoJSON knows."""

REMARKS = ("type", "features", "bbox", "crs", "generator", "copyright", "timestamp", "metadata", "description")

_MARK = re.compile(r'"type"\s*:\s*"FeatureCollection"')


def recognises(text: str) -> bool:
    """True if a JSON object calls itself a collection of features."""
    return text.lstrip().startswith("{") and _MARK.search(text) is not None


def read(text: str, path: Path, settings: Mapping[str, Any] | None = None) -> RoutingInstance:
    """The instance; see ``Format.read``. ``settings`` go before those in the file."""
    import pandas as pd

    from ..frames import instance_from_frame

    data = parse_json(text)
    if not isinstance(data, dict) or data.get("type") != "FeatureCollection":
        raise InputError("is no GeoJSON of sites", expected='"type": "FeatureCollection"', found=kind_of(data))
    for key in data:
        if key not in (*SETTINGS, *REMARKS):
            raise InputError(f"member {shown(key)} is unknown{did_you_mean(key, SETTINGS)}", "unknown-name", expected=", ".join(SETTINGS))
    rows = [_site(feature, f"features[{k}]") for k, feature in enumerate(array(data.get("features"), "features"))]
    if not rows:
        raise InputError("holds no sites", "missing", expected="features with points")
    given: dict[str, Any] = {"name": path.stem} | {key: _setting(data[key], key) for key in SETTINGS if key in data}
    given |= arguments(of_set(settings or {}), path.parent, len(rows))
    try:
        return instance_from_frame(pd.DataFrame(rows), **given, source="geojson")
    except InputError as error:
        raise in_file(error) from None


def _setting(value: Any, key: str) -> Any:
    """A member as ``from_frame`` takes it."""
    if key in ("name", "time_unit", "distance_unit"):
        return string(value, key)
    if key in ("vehicles", "min_vehicles"):
        return integer(value, key, 0)
    if key == "capacity" and isinstance(value, list):
        return [real(v, f"{key}[{k}]") for k, v in enumerate(array(value, key))] or [math.inf]
    if key in ("capacity", "max_duration", "max_distance", "fixed_cost", "speed"):
        return real(value, key)
    if key == "columns":
        titles = fields(value, key, value if isinstance(value, dict) else ())
        return {name: string(title, f"columns.{name}") for name, title in titles.items()}
    if key == "extra":
        return value if isinstance(value, bool) else list(strings(value, key))
    return [_ENTRIES[key](entry, f"{key}[{k}]") for k, entry in enumerate(array(value, key))]


def _shipment(value: Any, path: str) -> list[Any]:
    pair = array(value, path)
    if len(pair) not in (2, 3):
        raise InputError(f"{path} must be a pickup, a delivery and perhaps a load", found=f"{len(pair)} values")
    return [*pair[:2], *(real(v, f"{path}[2]") for v in pair[2:])]


def _group(value: Any, path: str) -> Any:
    if isinstance(value, dict):
        entries = fields(value, path, ("sites", "required"), ("sites",))
        return {**entries, "sites": list(array(entries["sites"], f"{path}.sites"))}
    return list(array(value, path))


_ENTRIES: dict[str, Callable[[Any, str], Any]] = {
    "fleet": lambda value, path: fields(value, path, VEHICLE_KEYS), "shipments": _shipment, "groups": _group,
}  # fmt: skip


def _site(feature: Any, path: str) -> dict[str, Any]:
    """A row of the frame."""
    if not isinstance(feature, dict):
        raise InputError(f"{path} must be a feature", expected="an object", found=kind_of(feature))
    if not isinstance(feature.get("geometry"), dict):
        found = "no geometry" if "geometry" not in feature else f"geometry {kind_of(feature['geometry'])}"
        raise InputError(f"{path} is without a place", "missing", expected="a geometry of type Point", found=found)
    properties = feature.get("properties") or {}
    if not isinstance(properties, dict):
        raise InputError(f"{path}.properties must be an object", found=kind_of(properties))
    what, place = feature["geometry"].get("type"), feature["geometry"].get("coordinates")
    if what == "LineString" and properties.get("kind") == "route":
        raise InputError("is a solution file, not an instance", "foreign")
    if what != "Point":
        raise InputError(f"{path}.geometry is no point", expected="Point", found=kind_of(what))
    if not isinstance(place, list) or len(place) not in (2, 3) or any(isinstance(v, bool) or not isinstance(v, int | float) for v in place):
        raise InputError(f"{path}.geometry.coordinates must be longitude and latitude", found=kind_of(place))
    if {"lat", "lon"} & (properties.keys() | feature.keys()):
        raise InputError(f"{path} tells its place twice", "duplicate", expected="the geometry alone", found="lat or lon beside it")
    own = {"id": feature["id"]} if "id" in feature and "id" not in properties else {}
    beside = {key: value for key, value in feature.items() if key not in FEATURE}  # what others put there may be meant to count
    if twice := next((key for key in beside if key in properties), None):
        message = f"{path} tells {shown(twice)} twice"
        raise InputError(message, "duplicate", expected="one of them", found="a member of the feature, and a property")
    return {**own, **beside, **properties, "lon": place[0], "lat": place[1]}


FORMATS.enter(
    Format(
        "geojson", "sites as GeoJSON points", recognises, read, problems=("vrptw", "cvrp", "tsp", "min-cost-vrp"),
        solutions=(".json", ".sol", ".tour", ".geojson"), settings=KEYS,
    )
)  # fmt: skip
