"""Routing data that make no sense: one clear line from Python and from the command line, naming what is wrong."""

import json
import math

import numpy as np
import pandas as pd
import pytest
from coded import coded

import waybound as wb
from waybound.instances.errors import InputError, UsageError

PLACES = {"id": ["o", "a", "b", "c"], "depot": [True, False, False, False], "x": [0, 3, 4, 9], "y": [0, 0, 0, 0]}
MATRIX = [[0, 3, 4, 9], [3, 0, 1, 6], [4, 1, 0, 5], [9, 6, 5, 0]]


def document(problem="min-cost-vrp", fleet=None, travel=None, **sites):
    return {
        "waybound": 1, "kind": "routing", "name": "i", "problem": problem, "convention": "exact", "sites": PLACES | sites,
        "travel": travel or {"metric": "euclidean"}, "fleet": fleet or [{"count": 2}],
    }  # fmt: skip


def bent(value):
    return [row if k != 1 else [3, 0, value, 6] for k, row in enumerate(MATRIX)]


SHIPMENT = {"pickup": "a", "delivery": "b", "load": 1}

FILES = {
    "a late site": (document(due=[None, None, None, 5]), "no vehicle can reach customer c: earliest arrival"),
    "a site beyond all routes": (document(fleet=[{"max_duration": 10}]), "no vehicle can reach customer c: shortest duration"),
    "no vehicle": (document(fleet=[{"count": 0}]), "fleet[0].count must be a whole number"),
    "a shift after closing time": (document(due=[9, 9, 9, 9], fleet=[{"shift": [10, 20]}]), "the shift of vehicle begins after its depot"),
    "nobody with the skill": (document(skills={"a": ["cold"]}), "no vehicle has the skills that site a asks for; expected cold"),
    "no energy": (document(fleet=[{"energy": {"capacity": 2}}]), "the energy of no vehicle lasts to any site and back; expected at least"),
    "a reward that is none": (document(reward=[0, 1, None, 1]), "sites.reward[2] must be a number"),
    "a negative reward": (document(reward=[0, 1, -2, 1]), "reward of site b must be finite and not negative"),
    "a negative distance": (
        document(travel={"metric": "EXPLICIT", "matrix": bent(-1)}), "distance in row 2, column 3 must be finite and not negative"
    ),
    "an infinite distance": (document(travel={"metric": "EXPLICIT", "matrix": bent(None)}), "travel.matrix[1][2] must be a number"),
    "an infinite duration": (document(travel={"metric": "euclidean", "durations": bent(math.inf)}), "JSON has no such number"),
    "two conventions": (
        document(fleet=[{"travel": {"metric": "euclidean", "convention": "round"}}]), "travels under another convention than the others"
    ),
    "a delivery before its pickup": (
        document(ready=[0, 9, 0, 0], due=[None, None, 5, None], shipments=[SHIPMENT]), "shipment from a to b comes before its pickup"
    ),
    "deliveries in a circle": (document(shipments=[SHIPMENT, {"pickup": "b", "delivery": "a"}]), "visited before the others: a, b"),
    "a member twice": (
        document(required=[False, False, False, True], groups=[{"sites": ["a", "a"]}]), "group 1 has the site a twice; expected different"
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", FILES)
def test_a_file_is_refused_in_one_line(run, tmp_path, case):
    data, message = FILES[case]
    path = tmp_path / "i.json"
    path.write_text(json.dumps(data))
    with pytest.raises(InputError) as caught:
        wb.read(path)
    assert message in str(caught.value) and "\n" not in str(caught.value)
    result = run("info", path)
    assert result.exit_code == 2 and message in result.stderr and len(result.stderr.strip().splitlines()) == 1


FRAME = pd.DataFrame({key: values for key, values in PLACES.items() if key != "depot"})
FRAMES = {
    "a reward that is none": ({"reward": [0, 1, math.nan, 1]}, {}, "reward of site b must be finite and not negative; found nan"),
    "a negative reward": ({"reward": [0, 1, -2, 1]}, {}, "reward of site b must be finite and not negative; found -2.0"),
    "more routes than vehicles": ({}, {"vehicles": 2, "min_vehicles": 3}, "at least 3 vehicles are asked for, but the fleet has 2"),
    "no energy": ({}, {"fleet": [{"energy": {"capacity": 2}}]}, "the energy of no vehicle lasts to any site and back"),
    "a distance that is none": ({}, {"travel": np.array(bent(math.nan))}, "distance from site a to site b must be a number"),
    "a negative duration": ({}, {"durations": np.array(bent(-1))}, "duration from site a to site b must be a number and not negative"),
    "two conventions": (
        {}, {"fleet": [{"travel": {"metric": "euclidean", "convention": "round"}}]}, "travels under another convention than the others"
    ),
    "a delivery before its pickup": (
        {"ready": [0, 9, 0, 0], "due": [99, 99, 5, 99]}, {"shipments": [("a", "b")]}, "comes before its pickup; expected a delivery after"
    ),
    "a member twice": ({}, {"groups": [["a", "a"]]}, "group 1 has the site a twice"),
}  # fmt: skip


@pytest.mark.parametrize("case", FRAMES)
def test_a_frame_is_refused_in_one_line(case):
    columns, given, message = FRAMES[case]
    with pytest.raises(InputError) as caught:
        wb.RoutingProblem.from_frame(FRAME.assign(**columns), **given)
    assert message in str(caught.value) and "\n" not in str(caught.value)


def test_an_unreachable_site_of_a_problem_that_visits_all_is_named(run, tmp_path):
    """Where a file may mean it, such as a store of energy, the instance is read, and has no answer."""
    path = tmp_path / "i.json"
    path.write_text(json.dumps(document(fleet=[{"count": 2, "energy": {"capacity": 12}}])))
    why = "a route to it draws 18 of energy at least (travel), the store holds 12"
    (reason,) = wb.explain(wb.read(path)).reasons
    assert (reason.where, reason.message) == ("c", why)
    for command in ("solve", "explain"):
        result = run(command, path)
        assert result.exit_code == 3 and why in " ".join(result.stdout.split())


def test_a_start_for_another_instance_is_refused(run, tmp_path):
    path, start = tmp_path / "i.json", tmp_path / "start.json"
    path.write_text(json.dumps(document()))
    start.write_text(json.dumps({"kind": "routes", "routes": [{"visits": ["a", "z"]}]}))
    told = run("solve", path, "--start", start)
    assert told.exit_code == 2 and "route 1 visits an unknown site 'z'" in told.stderr
    problem = wb.read(path)
    for routes, message in (
        (wb.Routes.of([[1, 2], [3, 7]]), "the start is for another instance: route 2 visits site 7, and there are 4"),
        (wb.Routes((wb.Route((1, 2), 3),)), "the start is for another instance: route 1 has vehicle type 3, and there are 1"),
    ):
        with pytest.raises(UsageError, match=message, check=coded("foreign")):
            wb.solve(problem, "highs", start=routes)


SHOPS = """\
name,lat,lon,demand,ready,due,service,phone
Yard,45.81,15.98,,07:00,18:00,,-
Graz,47.07,15.44,4,2026-05-04T08:00,12:30,20min,007
Rijeka,45.33,14.44,2,,,1h 5min,005
"""


def test_a_table_as_people_have_it_is_solved_and_shown_with_what_it_keeps(json_of, run, tmp_path):
    path = tmp_path / "shops.csv"
    path.write_text(SHOPS)
    given = ("--set", "speed=70", "--set", "time-unit=min", "--set", "capacity=4")
    data = json_of("info", path, *given)
    assert data["problem"] == "vrptw" and data["fleet"][0]["capacity"] == 4 and data["around"]["latitude"] == pytest.approx(46.07, abs=0.01)
    assert "around 46.1 N, 15.3 E, all within 1" in run("info", path, *given).stdout
    told = run("solve", path, *given, "--heuristic", "insertion", "--bound-time", "0", "-q").stdout
    assert "Visits" in told and "007" in told and "2026-05-04 08:" in told
    lacks = run("info", path, "--set", "speed=70")
    assert lacks.exit_code == 2 and "expected --set time-unit=min, or s, h, d" in lacks.stderr
    path.write_text(SHOPS.replace("lat,lon", "lon,lat").replace("45.81,15.98", "51.50,-0.10").replace("47.07,15.44", "51.52,-0.11").replace(
        "45.33,14.44", "51.48,-0.12"))  # fmt: skip
    assert "latitude and longitude may be swapped: most sites lie in the open sea" in run("info", path, *given).stderr
