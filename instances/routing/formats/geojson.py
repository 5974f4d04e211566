"""Sites as GeoJSON points: what map editors, spatial databases and web services export; documented in ``docs/formats.md``.

Properties are the columns of a frame of sites. What GeoJSON has no place for stands beside ``features``: the vehicles, the speed, units.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from ...document import array, kind_of, parse_json
from ...errors import InputError
from ...formats import FORMATS, Format
from ...suggestions import did_you_mean
from ...text import shown
from ..instance import RoutingInstance

SETTINGS = (
    "name", "vehicles", "capacity", "max_duration", "max_distance", "fixed_cost", "speed", "fleet", "columns", "extra", "time_unit",
    "distance_unit", "min_vehicles", "shipments", "groups",
)  # fmt: skip
"""Members of the collection that are arguments of ``from_frame``."""

REMARKS = ("type", "features", "bbox", "crs", "generator", "copyright", "timestamp", "metadata", "description")

_MARK = re.compile(r'"type"\s*:\s*"FeatureCollection"')


def recognises(text: str) -> bool:
    """Whether a JSON object calls itself a collection of features."""
    return text.lstrip().startswith("{") and _MARK.search(text) is not None


def read(text: str, path: Path) -> RoutingInstance:
    """The instance; see ``Format.read``."""
    import pandas as pd

    from ..frames import instance_from_frame

    data = parse_json(text)
    if not isinstance(data, dict) or data.get("type") != "FeatureCollection":
        raise InputError("is no GeoJSON of sites", expected='"type": "FeatureCollection"', found=kind_of(data))
    for key in data:
        if key not in (*SETTINGS, *REMARKS):
            raise InputError(f"member {shown(key)} is unknown{did_you_mean(key, SETTINGS)}", expected=", ".join(SETTINGS))
    rows = [_site(feature, f"features[{k}]") for k, feature in enumerate(array(data.get("features"), "features"))]
    if not rows:
        raise InputError("holds no sites", expected="features with points")
    given: dict[str, Any] = {"name": path.stem} | {key: data[key] for key in SETTINGS if key in data}
    return instance_from_frame(pd.DataFrame(rows), **given, source="geojson")


def _site(feature: Any, path: str) -> dict[str, Any]:
    """A row of the frame."""
    if not isinstance(feature, dict) or not isinstance(feature.get("geometry"), dict):
        raise InputError(f"{path} must be a feature with a geometry", found=kind_of(feature))
    told = feature.get("properties") or {}
    if not isinstance(told, dict):
        raise InputError(f"{path}.properties must be an object", found=kind_of(told))
    what, place = feature["geometry"].get("type"), feature["geometry"].get("coordinates")
    if what == "LineString" and told.get("kind") == "route":
        raise InputError("is a solution file, not an instance")
    if what != "Point":
        raise InputError(f"{path}.geometry is no point", expected="Point", found=kind_of(what))
    numbers = (
        isinstance(place, list) and len(place) in (2, 3) and all(isinstance(v, int | float) and not isinstance(v, bool) for v in place)
    )
    if not numbers:
        raise InputError(f"{path}.geometry.coordinates must be longitude and latitude", found=kind_of(place))
    if {"lat", "lon"} & told.keys():
        raise InputError(f"{path} tells its place twice", expected="the geometry alone", found="lat or lon among the properties")
    own = {"id": feature["id"]} if "id" in feature and "id" not in told else {}
    return {**own, **told, "lon": place[0], "lat": place[1]}


FORMATS.add(
    "geojson",
    Format(
        "geojson", "sites as GeoJSON points", recognises, read, None, (), "",
        ("vrptw", "cvrp", "tsp", "min-cost-vrp"), "exact", solutions=(".json", ".sol", ".tour", ".geojson"),
    ),
)  # fmt: skip
