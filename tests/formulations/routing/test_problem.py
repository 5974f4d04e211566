"""What a routing problem answers in its own way: names of vehicles, facts, reasons why it has no answer, solution files."""

from __future__ import annotations

import dataclasses
import math

import pytest

import waybound as wb
from waybound.formulations.certificate import verified_bound


@pytest.fixture(scope="module")
def problem():
    made = wb.read("demo-tiny")
    assert isinstance(made, wb.RoutingProblem)
    return made


@pytest.fixture(scope="module")
def mixed(problem):
    return dataclasses.replace(problem, fleet=(wb.VehicleType(3, 100, name="old"), wb.VehicleType(1, 5, name="new")))


ROUTES = wb.Routes((wb.Route((1,)), wb.Route((2, 3, 4), vehicle=1), wb.Route((5,)), wb.Route((), vehicle=1), wb.Route((6,), vehicle=7)))


def test_vehicles_are_numbered_within_their_type(mixed):
    assert mixed.vehicle_names(ROUTES) == ["old 1", "new 1", "old 2", "new 2", "old 3"]


def test_one_type_is_numbered_by_routes(problem):
    assert problem.vehicle_names(wb.Routes.of([[1], [2], [3]])) == ["vehicle 1", "vehicle 2", "vehicle 3"]


def test_violations_and_tables_name_the_same_vehicles(mixed):
    found = {v.vehicle for v in mixed.evaluate(ROUTES).violations if v.check == "load"}
    assert found == {"new 1"}
    assert list(mixed.answer_to_frame(wb.Routes(ROUTES.routes[:3]))["vehicle"]) == ["old 1", "new 1", "new 1", "new 1", "old 2"]


def test_the_json_of_an_answer_names_types_and_reads_back(mixed):
    data = mixed.answer_to_json(wb.Routes(ROUTES.routes[:3]))
    assert [route["vehicle"] for route in data["routes"]] == ["old", "new", "old"]
    assert mixed.answer_from_json(data) == wb.Routes(ROUTES.routes[:3])


def test_facts_name_depots_and_count_what_is_out_of_reach(problem):
    facts = wb.read("demo-tiny", capacity=9).facts()
    assert facts["sites"]["unreachable"] > 0
    assert problem.facts()["sites"]["unreachable"] == 0
    assert problem.facts()["fleet"][0]["start"] == problem.sites.ids[0]
    alone = wb.RoutingProblem(wb.Sites.of(["d"]), wb.Travel("euclidean", [[0, 0]]), (wb.VehicleType(),))
    assert alone.facts()["demand"] == {"total": 0.0, "least": 0.0, "largest": 0.0}


@pytest.mark.parametrize(("settings", "kind"), [({"capacity": 9}, "site"), ({"vehicles": 1}, "fleet")])
def test_reasons_are_proofs_that_the_checker_confirms(settings, kind):
    problem = wb.read("demo-tiny", **settings)
    reasons = list(problem.infeasibility_reasons())
    assert {reason.kind for reason in reasons} == {kind}
    assert all(verified_bound(problem, reason.evidence) == math.inf for reason in reasons)


def test_a_search_for_reasons_can_be_given_up():
    assert list(wb.read("demo-tiny", vehicles=1).infeasibility_reasons(lambda: True)) == []


@pytest.mark.parametrize("suffix", [".sol", ".tour"])
def test_solution_files_read_back_the_same(problem, suffix):
    one = dataclasses.replace(problem, fleet=(wb.VehicleType(1),))
    answer = wb.Routes.of([one.customers.tolist()])
    one.check_answer_suffix(suffix)
    assert one.answer_from_text(one.answer_to_text(answer, suffix, 12.5)) == (answer, 12.5 if suffix == ".sol" else None)


def test_solution_files_that_name_no_types_are_refused_for_a_mixed_fleet(mixed):
    for suffix in (".sol", ".tour"):
        with pytest.raises(wb.UsageError, match=r"which of the 2 vehicle types drives a route; use \.json"):
            mixed.check_answer_suffix(suffix)
    with pytest.raises(wb.UsageError, match="vehicle types"):
        mixed.answer_from_text("Route #1: 1\n")
    mixed.check_answer_suffix(".json")
