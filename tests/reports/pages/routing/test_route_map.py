import html
import json
import re
from typing import Any

import numpy as np
import pytest

import waybound as wb
from waybound.instances.routing.travel import EXPLICIT
from waybound.reports.pages.rendering import Rendering
from waybound.reports.pages.routing.route_map import LEAST_HEIGHT, MARGIN, WIDTH, RouteMap, answer_blocks, placed
from waybound.reports.plots import positions
from waybound.reports.plots.routing import routes

HOSTILE = "</script><script>alert(1)</script>\"'&"


def shown(problem: Any, answer: Any) -> tuple[str, dict[str, Any]]:
    """The map, and the facts within it."""
    text = str(RouteMap(problem, answer).html(Rendering()))
    held = re.search(r'<script type="application/json">(.*?)</script>', text, re.DOTALL)
    return text, json.loads(held[1])


def small(given_lengths: bool = False, **sites: Any) -> wb.RoutingProblem:
    at = np.array([(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)])
    told = {"demand": [0, 1, 2, 3], "ready": [0, 5, 0, 0], "due": [100, 50, 60, 70], "ids": ["hub", "a", "b", "c"], **sites}
    lengths = np.hypot(*(at[:, None] - at).transpose(2, 0, 1))
    travel = wb.Travel(EXPLICIT, None, lengths) if given_lengths else wb.Travel("euclidean", at)
    made = wb.Sites.of(told.pop("ids"), depot=[True, False, False, False], **told)
    return wb.RoutingProblem(made, travel, [wb.VehicleType(capacity=5, count=2)])


def test_facts_of_routes_and_stops_are_those_of_the_answer_s_tables() -> None:
    problem = wb.read("demo-c25")
    answer = wb.solve(problem, heuristic="savings", bound_time=0).answer
    text, facts = shown(problem, answer)
    frames = problem.answer_frames(answer)
    visits, routes = frames["visits"], frames["routes"]
    stops = [stop for route in facts["routes"] for stop in route["stops"]]
    assert [stop["id"] for stop in stops] == visits["site"].tolist()
    arrival, window = facts["of_stop"].index("arrival"), facts["of_stop"].index("window")
    assert [float(stop["facts"][arrival]) for stop in stops] == pytest.approx(visits["arrival"].tolist(), rel=1e-5)
    assert [route["facts"][facts["of_route"].index("stops")] for route in facts["routes"]] == routes["stops"].astype(str).tolist()
    for stop in stops:
        opens, closes = map(float, stop["facts"][window].split(" to "))
        assert opens <= float(stop["facts"][arrival + 1]) <= closes  # service begins
    assert text.count('class="route"') == text.count('class="way"') == len(answer)


def test_north_is_up_all_is_within_and_lengths_keep_their_ratios() -> None:
    where = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 5.0]])
    at, height = placed(where, False)
    assert at[2, 1] < at[1, 1] and at.min() >= MARGIN - 0.1 and at[:, 0].max() <= WIDTH - MARGIN + 0.1 and at[:, 1].max() <= height
    assert np.hypot(*(at[1] - at[0])) == pytest.approx(2 * np.hypot(*(at[2] - at[1])), rel=1e-3)
    globe, _ = placed(where + np.array([0.0, 60.0]), True)
    assert np.hypot(*(globe[1] - globe[0])) == pytest.approx(np.hypot(*(globe[2] - globe[1])), rel=0.1)  # cos 62.5 degrees is 0.46


@pytest.mark.parametrize("where", [[[1.0, 2.0]], [[1.0, 2.0]] * 3, [[0.0, 0.0], [5.0, 0.0]], [[0.0, 0.0], [0.0, 1e-9]]])
def test_sites_on_a_line_or_at_one_place_have_a_map(where: list[list[float]]) -> None:
    at, height = placed(np.array(where), False)
    assert np.isfinite(at).all() and height >= LEAST_HEIGHT - 0.1
    assert ((at >= MARGIN - 0.1) & (at <= np.array([WIDTH, height]) - MARGIN + 0.1)).all()


def test_hostile_names_are_no_markup() -> None:
    text, facts = shown(small(ids=[HOSTILE, HOSTILE + "2", "b" * 300, "c"]), wb.Routes.of([[1, 2], [3]]))
    assert text.count("<script") == 1 and "alert(1)</script>" not in text
    assert facts["routes"][0]["stops"][0]["id"] == HOSTILE + "2"
    assert html.escape(HOSTILE, quote=False)[:20] in text
    assert len(facts["routes"][0]["stops"][1]["id"]) <= 60


def test_sites_left_out_say_why() -> None:
    text, _ = shown(small(required=[False, True, True, False], reward=[0, 1, 1, 1]), wb.Routes.of([[1, 2]]))
    assert re.search(r'class="left-out"[^>]*><title>c is left out: .+</title>', text)


def test_answers_without_routes_have_a_map_of_sites() -> None:
    text, facts = shown(small(required=[False] * 4), wb.Routes.of([]))
    assert facts["routes"] == [] and text.count('class="depot"') == 1 and text.count('class="left-out"') == 3


def test_without_coordinates_sites_are_placed_and_too_many_are_not(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = small(given_lengths=True)
    solution = wb.solve(problem, heuristic="savings", bound_time=0)
    told = str(answer_blocks(problem, solution.answer, solution)[0].html(Rendering()))
    assert "placed by scaling of their distances" in told
    for module in (positions, routes):
        monkeypatch.setattr(module, "SCALED_SITES", 3)
    told = str(answer_blocks(problem, solution.answer, solution)[0].html(Rendering()))
    assert "too many to be placed on a map" in told and "<svg" not in told
