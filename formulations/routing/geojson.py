"""Answers as GeoJSON: sites as points, routes as lines, for any map."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ...instances.errors import UsageError
from .answers import routes_frame, routes_to_frame
from .routes import Routes

if TYPE_CHECKING:
    from .problem import RoutingProblem


def answer_geojson(problem: RoutingProblem, answer: Routes) -> dict[str, Any]:
    """A ``FeatureCollection``: a ``LineString`` a route, straight from stop to stop, then a ``Point`` a site, and one a stop at a depot on
    the way.

    Properties of a line are those of ``routes_frame``, of a point the site's id and attributes, who visits it and when, or why nobody does.
    Vehicles may stop at a depot often, so that each such stop is a point of its own, of kind ``stop``.

    Raises
    ------
    UsageError
        If sites have no latitude and longitude.

    Notes
    -----
    RFC 7946: longitude before latitude, WGS 84.
    """
    sites = problem.sites
    if sites.coordinates is None or not sites.geographic:
        raise UsageError("GeoJSON needs latitude and longitude, which these sites do not have: columns lat and lon of from_frame")
    places = sites.coordinates.tolist()
    features = []
    for row, route in zip(_rows(routes_frame(problem, answer)), answer, strict=True):
        vehicle = problem.fleet[route.vehicle]
        line = [places[k] for k in (vehicle.start, *route.visits, vehicle.end)]
        features.append(_feature("LineString", line, {"kind": "route", **row, "visits": [sites.ids[k] for k in route.visits]}))
    visits: dict[str, list[dict[str, Any]]] = {}
    for row in _rows(routes_to_frame(problem, answer)):
        visits.setdefault(row.pop("site"), []).append(row)
    reasons = {one.where: one.reason for one in problem.left_out(answer)}
    for k, site in enumerate(sites.ids):
        kept = {title: values[k] for title, values in sites.attributes.items()}
        kind = "depot" if sites.depot[k] else "site"
        stops = visits.get(site, [])
        told, further = (stops[0], stops[1:]) if stops and kind == "site" else ({}, stops)
        left = {"left_out": reasons[site]} if site in reasons else {}
        features.append(_feature("Point", places[k], {"kind": kind, "id": site, **kept, **told, **left}))
        features += [_feature("Point", places[k], {"kind": "stop", "id": site, **kept, **each}) for each in further]
    return {"type": "FeatureCollection", "features": features}


def _feature(kind: str, coordinates: Any, properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": properties}


def _rows(frame: Any) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = frame.to_dict("records")
    return [{str(key): value.isoformat() if hasattr(value, "isoformat") else value for key, value in row.items()} for row in rows]


def visits_of_geojson(data: Any) -> dict[str, list[str]] | None:
    """Visits by vehicle in such a document; None where it is none."""
    features = data.get("features") if isinstance(data, dict) and data.get("type") == "FeatureCollection" else None
    if not isinstance(features, list):
        return None
    told = [f["properties"] for f in features if isinstance(f, dict) and isinstance(f.get("properties"), dict)]
    return {str(row["vehicle"]): row["visits"] for row in told if row.get("kind") == "route" and {"vehicle", "visits"} <= row.keys()}
