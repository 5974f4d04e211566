"""Routes on a map of streets, by folium; unlike a page it loads tiles and scripts from the network."""

import html
from importlib.util import find_spec
from typing import Any

from ....formulations.routing.answers import answer_geojson
from ....formulations.routing.problem import RoutingProblem
from ....formulations.solution import Solution
from ....instances.errors import MissingPackageError, UsageError
from ....instances.printable import printable
from ...plots.drawing import COLOURS
from ...plots.routing.routes import route_ranks

_IN_SCRIPTS = str.maketrans({"`": "&#96;", "$": "&#36;", "\\": "&#92;", "{": "&#123;", "}": "&#125;"})
"""folium writes texts into templates of JavaScript."""


def street_map(solution: Solution) -> Any:
    """A ``folium.Map``: a line per route, straight from stop to stop, and a dot a site that tells its facts; ``solution.to_folium`` calls
    this."""
    problem = solution.problem
    if not isinstance(problem, RoutingProblem):
        raise UsageError(f"answers to {problem.problem} problems have no map of streets", "unsupported")
    if find_spec("folium") is None:
        raise MissingPackageError("a map of streets needs the package folium: pip install 'waybound[maps]'")
    import folium

    features = answer_geojson(problem, solution.answer)["features"]
    ranks = iter(route_ranks(problem, solution.answer))
    places = [_place(one["geometry"]["coordinates"]) for one in features if one["geometry"]["type"] == "Point"]
    canvas = folium.Map(tiles="OpenStreetMap")
    colours: dict[str, str] = {}
    for one in features:
        data, at = one["properties"], one["geometry"]["coordinates"]
        name, facts = _text(data.get("id", data.get("vehicle"))), folium.Popup(_facts(data), max_width=360)
        if data["kind"] == "route":
            colour = colours[data["vehicle"]] = COLOURS[next(ranks) % len(COLOURS)]
            folium.PolyLine([_place(point) for point in at], color=colour, weight=4, tooltip=name, popup=facts).add_to(canvas)
        else:
            colour = "#111111" if data["kind"] == "depot" else colours.get(data.get("vehicle"), "#888888")
            folium.CircleMarker(
                _place(at), radius=8 if data["kind"] == "depot" else 5, color=colour, fill=True, fill_opacity=0.9, tooltip=name, popup=facts
            ).add_to(canvas)
    canvas.fit_bounds([[min(side) for side in zip(*places, strict=True)], [max(side) for side in zip(*places, strict=True)]])
    return canvas


def _place(point: list[float]) -> tuple[float, float]:
    """Latitude and longitude of a point of GeoJSON, which has them the other way round."""
    return point[1], point[0]


def _text(value: Any) -> str:
    return html.escape(printable(value, 200)).translate(_IN_SCRIPTS)


def _facts(told: dict[str, Any]) -> str:
    rows = ((name, f"{value:.6g}" if isinstance(value, float) else value) for name, value in told.items() if not isinstance(value, list))
    return "<table>" + "".join(f"<tr><td>{_text(name)}</td><td>{_text(value)}</td></tr>" for name, value in rows) + "</table>"
