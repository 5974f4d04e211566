import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import waybound as wb
from waybound.formulations.problem import PROBLEMS
from waybound.formulations.routing.named_problems import DEFAULT_OBJECTIVE
from waybound.formulations.routing.routes import Route, Routes
from waybound.formulations.routing.unvisited_sites import left_out
from waybound.instances.formats.waybound_json import read, write
from waybound.instances.routing.features import FEATURES, features
from waybound.instances.routing.frames import instance_from_frame
from waybound.reports.plots import PLOTS
from waybound.reports.tables.facts import facts, facts_table

SITES = pd.DataFrame({"id": list("oabc"), "x": [0.0, 3, 4, 9], "y": [0.0, 1, 5, 2]})
TWO = {"depot": [True, False, False, True]}
MATRIX = np.abs(np.arange(4.0)[:, None] - np.arange(4.0))

CASES = {
    "capacity": ({"demand": [0, 1, 2, 3]}, {"capacity": 9}, "capacity 9"),
    "demands": ({"demand": [0, 1, 2, 3]}, {}, "total 6, 1 to 3 a customer"),
    "time-windows": ({"ready": [0, 5, 0, 0], "due": [math.inf, 30, 40, 50]}, {}, "3 customers, the last closes at 50"),
    "depot-windows": ({"due": [99, math.inf, math.inf, math.inf]}, {}, "0 to 99"),
    "service-times": ({"service": [0, 1, 2, 3]}, {}, "total 6, 1 to 3 a customer"),
    "demand-or-service-of-depots": ({"service": [4, 0, 0, 0]}, {}, "at depots demand 0, service 4"),
    "rewards": ({"reward": [0, 1, 2, 3]}, {}, "reward total 6"),
    "optional-sites": ({"required": [False, True, False, True]}, {}, "1 customers are optional"),
    "limited-fleet": ({}, {"vehicles": 2}, "at most 2"),
    "min-vehicles": ({}, {"min_vehicles": 2}, "at least 2 routes"),
    "heterogeneous-fleet": ({}, {"fleet": [{"name": "van"}, {"name": "bike", "count": 1}]}, "bike: at most 1"),
    "multiple-depots": (TWO, {}, "depot o, c"),
    "open-routes": (TWO, {"fleet": [{"start": "o", "end": "c"}]}, "from o to c"),
    "max-duration": ({}, {"max_duration": 40}, "duration up to 40"),
    "max-distance": ({}, {"fleet": [{"max_distance": 40}]}, "distance up to 40"),
    **{
        f"energy:{charge}": ({}, {"fleet": [{"energy": {"capacity": 40, "charge": charge}}]}, f"energy 40 at rate 1 ({charge})")
        for charge in ("travel", "elapsed", "elapsed-fixed-start", "windows")
    },
    "fixed-cost": ({}, {"fleet": [{"fixed_cost": 7}]}, "fixed cost 7"),
    "unit-cost": ({}, {"fleet": [{"unit_cost": 3}]}, "unit cost 3"),
    "separate-durations": ({}, {"durations": 2 * MATRIX}, "durations of their own"),
    "duration-cost": ({}, {"fleet": [{"unit_duration_cost": 2}]}, "unit duration cost 2"),
    "overtime": ({}, {"fleet": [{"regular_duration": 20, "unit_overtime_cost": 3}]}, "regular duration 20"),
    "shifts": ({}, {"fleet": [{"shift": [3, 70]}]}, "shift 3, 70"),
    "vehicle-speeds": ({}, {"fleet": [{"speed": 2}]}, "speed 2"),
    "vehicle-travel": ({}, {"fleet": [{"travel": {"metric": "EXPLICIT", "matrix": MATRIX.tolist()}}]}, "travel metric EXPLICIT"),
    "several-loads": ({"demand": [0, 1, 2, 3], "demand2": [0, 4, 5, 6]}, {}, "further demand total 15"),
    "pickups": ({"pickup": [0, 1, 2, 4]}, {}, "pickup total 7"),
    "shipments": ({}, {"shipments": [("a", "b", 5)]}, "shipments count 1, load 5"),
    "groups": ({}, {"groups": [["a", "b"]]}, "groups count 1, required 1"),
    "several-windows": ({}, {"windows": {"a": [(0, 5), (9, 20)]}}, "several windows sites 1, most 2"),
    "skills": ({"skills": ["", "cold", "", ""]}, {"fleet": [{"skills": ["cold"]}]}, "skills sites 1, names cold"),
    "penalties": ({"penalty": [0, 1, 2, 4], "required": False}, {}, "penalty total 7"),
    "reloads": ({}, {"fleet": [{"reloads": ["o"], "max_reloads": 2}]}, "reloads o"),
    "recharging": ({}, {"fleet": [{"energy": {"capacity": 40, "stations": ["o"]}}]}, "recharging at o"),
    "initial-energy": ({}, {"fleet": [{"energy": {"capacity": 40, "initial": 30}}]}, "30 at departure"),
    "closing-moves": ({}, {"closing": np.full((4, 4), 90.0)}, "12 moves close"),
    "forbidden-moves": ({}, {"travel": np.where(np.eye(4, k=1), np.inf, MATRIX)}, "3 moves are forbidden"),
    "committed-vehicles": ({}, {"fleet": [{"count": 2, "committed": True}]}, "committed"),
    "uncertain-durations": ({}, {"variances": MATRIX}, "uncertain durations of variance up to 3"),
    "route-risk": ({}, {"variances": MATRIX, "fleet": [{"max_duration": 40, "risk": 0.05}]}, "risk 0.05"),
    "team-risk": ({}, {"variances": MATRIX, "max_duration": 40, "team_risk": 0.1}, "team risk 0.1"),
}  # fmt: skip
"""By feature: columns, what else ``from_frame`` takes, and words of the table that ``waybound info`` shows."""


def of(name):
    columns, given, told = CASES[name]
    return instance_from_frame(SITES.assign(**columns), **given), told


def test_every_feature_has_a_case():
    assert CASES.keys() == FEATURES.keys()


@pytest.mark.parametrize("name", CASES)
def test_a_frame_can_say_it_and_json_holds_it(name):
    instance, _ = of(name)
    again = read(write(instance), Path("i.json"))
    assert name in features(instance) and features(again) == features(instance)
    made, same = (wb.RoutingProblem.from_instance(i, "min-cost-vrp") for i in (instance, again))
    assert (
        made.digest() == same.digest()
        and wb.RoutingProblem.from_frame(SITES.assign(**CASES[name][0]), **CASES[name][1], problem="min-cost-vrp").digest() == made.digest()
    )


@pytest.mark.parametrize("name", CASES)
def test_info_tells_it(name):
    instance, told = of(name)
    text = "\n".join(" ".join(row) for row in facts_table(facts(wb.RoutingProblem.from_instance(instance))).rows)
    assert told in text, text


@pytest.mark.share(3)
@pytest.mark.parametrize("name", CASES)
def test_its_answers_are_drawn_and_what_they_leave_out_is_told(name):
    problem = wb.RoutingProblem.from_instance(of(name)[0], "min-cost-vrp")
    site = problem.customers.tolist()[0]
    stops = (site, *problem.fleet[0].reloads, *problem.fleet[0].stations)
    answer = Routes((Route(stops, 0),))
    ax = PLOTS["routing"](problem, answer)
    drawn = np.concatenate([line.get_xydata() for line in ax.lines])
    assert {tuple(xy) for xy in problem.sites.coordinates[list(stops)]} <= {tuple(xy) for xy in drawn}
    assert len(left_out(problem, answer)) == len(problem.customers) - 1


@pytest.mark.parametrize("name", DEFAULT_OBJECTIVE)
def test_every_problem_has_a_constructor_in_the_face_and_a_name_on_the_command_line(name):
    assert callable(getattr(wb, name.replace("-", "_"))) and name in PROBLEMS
