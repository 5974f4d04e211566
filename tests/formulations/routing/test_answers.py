import json

import numpy as np
import pandas as pd
import pytest
from coded import check_coded, coded

import waybound as wb
from waybound import Energy, InputError, Route, Routes, RoutingProblem, Sites, UsageError, VehicleType
from waybound.formulations.routing.answers import answer_geojson, answer_graph, visits_of_geojson
from waybound.instances.routing.travel import EXPLICIT, Travel

LINE = np.abs(np.arange(4.0)[:, None] - np.arange(4.0)[None, :])


def problem(vehicle=None, **sites):
    return RoutingProblem(Sites.of("oabc", **sites), Travel(EXPLICIT, matrix=LINE), [vehicle or VehicleType()])


def test_depots_on_the_way_are_written_and_read_among_the_visits():
    made, answer = problem(VehicleType(reloads=(0,))), Routes.of([Route((1, 0, 2, 3))])
    data = made.answer_to_json(answer)
    assert data == {"kind": "routes", "routes": [{"visits": ["a", "o", "b", "c"]}]}
    assert made.answer_from_json(data) == answer


def test_the_table_tells_what_is_on_board_and_what_the_store_holds():
    frame = problem(VehicleType(reloads=(0,)), demand=[0, 1, 2, 0], pickup=[0, 5, 0, 0]).answer_to_frame(Routes.of([(1, 0, 2)]))
    assert frame["on_board"].tolist() == [5, 2, 0] and "energy" not in frame.columns
    frame = problem(VehicleType(energy=Energy(9, 2, stations=(0,)))).answer_to_frame(Routes.of([(1, 0, 2)]))
    assert frame["energy"].tolist() == [7, 9, 5] and "on_board" not in frame.columns


def test_a_plain_table_is_as_it_was():
    frame = problem().answer_to_frame(Routes.of([(1, 2)]))
    assert frame.columns.tolist() == ["vehicle", "position", "site", "arrival", "begin", "departure", "load", "distance"]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"kind": "tour"}, "not an answer to a routing problem"),
        ({"kind": "routes", "routes": [{"visits": "abc"}]}, "route 1 has no list of visits"),
        ({"kind": "routes", "routes": [{"visits": ["z"]}]}, "route 1 visits an unknown site 'z'"),
        ({"kind": "routes", "routes": [{"visits": ["a"], "vehicle": "bus"}]}, "route 1 names an unknown vehicle 'bus'"),
    ],
)
def test_anything_else_is_refused(data, message):
    with pytest.raises(InputError, match=message):
        problem().answer_from_json(data)


def test_a_file_without_a_place_for_stops_at_depots_is_refused():
    with pytest.raises(UsageError, check=coded("unsupported")):
        problem(VehicleType(1, reloads=(0,))).check_answer_suffix(".sol")


def test_edges_are_the_moves_and_nodes_know_their_sites() -> None:
    sites = pd.DataFrame({"id": ["yard", "a", "b"], "x": [0, 3, 6], "y": [0, 4, 8], "demand": [0, 2, 3], "phone": ["-", "1", "2"]})
    problem = wb.RoutingProblem.from_frame(sites, durations=[[0, 9, 9], [9, 0, 9], [9, 9, 0]])
    graph = answer_graph(problem, wb.Routes.of([[1], [2]]))
    assert graph.number_of_edges() == 4 and graph.nodes["a"] == {"phone": "1", "pos": (3.0, 4.0), "depot": False, "demand": 2.0}
    assert graph.edges["yard", "b", 0] == {"vehicle": "vehicle 2", "position": 1, "distance": 10.0, "duration": 9.0}
    assert graph.size("distance") == problem.evaluate(wb.Routes.of([[1], [2]])).values[0]


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
    check_coded(wb.UsageError, "missing", answer_geojson, problem, wb.Routes.of([[1]]))
    check_coded(wb.UsageError, "missing", problem.check_answer_suffix, ".geojson")


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
