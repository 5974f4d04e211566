"""Answers as GeoJSON, and back."""

from __future__ import annotations

import json

import pandas as pd
import pytest

import waybound as wb
from waybound.formulations.routing.geojson import answer_geojson, visits_of_geojson

SITES = pd.DataFrame(
    {
        "id": ["yard", "a", "b", "c"], "lat": [45.0, 45.1, 45.2, 45.3], "lon": [9.0, 9.1, 9.0, 9.2], "phone": list("-123"),
        "required": [True, True, True, False],
    }
)  # fmt: skip


def test_lines_and_points_tell_who_goes_where_when_and_who_is_left_out() -> None:
    problem = wb.RoutingProblem.from_frame(SITES)
    data = json.loads(json.dumps(answer_geojson(problem, wb.Routes.of([[2, 1]]))))
    line, *points = data["features"]
    assert line["geometry"] == {"type": "LineString", "coordinates": [[9.0, 45.0], [9.0, 45.2], [9.1, 45.1], [9.0, 45.0]]}
    assert line["properties"]["visits"] == ["b", "a"] and line["properties"]["vehicle"] == "vehicle 1"
    told = {point["properties"]["id"]: point["properties"] for point in points}
    assert told["b"]["position"] == 1 and told["b"]["phone"] == "2" and told["yard"]["kind"] == "depot"
    assert "left_out" in told["c"] and "vehicle" not in told["c"]
    assert visits_of_geojson(data) == {"vehicle 1": ["b", "a"]}
    assert wb.judge(problem, data).feasible


def test_sites_without_latitude_and_longitude_have_no_place_on_the_globe() -> None:
    problem = wb.RoutingProblem.from_frame(SITES.rename(columns={"lat": "y", "lon": "x"}))
    with pytest.raises(wb.UsageError, match="GeoJSON needs latitude and longitude"):
        answer_geojson(problem, wb.Routes.of([[1]]))
    with pytest.raises(wb.UsageError, match="GeoJSON needs latitude and longitude"):
        problem.check_answer_suffix(".geojson")


def test_other_documents_are_none() -> None:
    assert visits_of_geojson({"type": "Feature"}) is None and visits_of_geojson([]) is None
