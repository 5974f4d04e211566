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


def test_each_stop_at_a_depot_on_the_way_has_its_times() -> None:
    day = pd.Timestamp("2026-05-04 06:00")
    sites = SITES.drop(columns="required").assign(demand=[0, 2, 2, 2], service=5, ready=day, due=day + pd.Timedelta("12h"))
    fleet = [{"name": "van", "count": 1, "capacity": 2, "reloads": ["yard"], "max_reloads": 2}]
    problem = wb.RoutingProblem.from_frame(sites, fleet=fleet, speed=50, time_unit="min")
    answer = wb.Routes.of([[1, 0, 2, 0, 3]])
    assert problem.evaluate(answer).feasible
    data = json.loads(json.dumps(answer_geojson(problem, answer)))
    rows = problem.answer_to_frame(answer).set_index("position")
    stops = [f["properties"] for f in data["features"] if f["properties"]["kind"] == "stop"]
    assert [(stop["id"], stop["position"], stop["phone"]) for stop in stops] == [("yard", 2, "-"), ("yard", 4, "-")]
    for stop in stops:
        assert all(stop[title] == rows.loc[stop["position"], title].isoformat() for title in ("arrival", "begin", "departure"))
    assert [f["properties"]["id"] for f in data["features"] if f["properties"]["kind"] == "depot"] == ["yard"]
    assert wb.judge(problem, data).feasible
