import dataclasses

import numpy as np
import pytest

import waybound as wb
from waybound.reports.tables.answers import answer_tables
from waybound.reports.tables.facts import facts, facts_table
from waybound.reports.tables.routing.routes import routes_table, unserved_sites


@pytest.fixture(scope="module")
def problem():
    return wb.read("demo-c25")


def test_routes_are_told_with_their_totals(problem):
    answer = wb.Routes.of([[1, 2, 3], [10, 11]])
    table = routes_table(problem, answer)
    assert [row[0] for row in table.rows] == ["vehicle 1", "vehicle 2"]
    assert [row[1] for row in table.rows] == ["3", "2"]
    assert table.rows[0][-1] == " ".join(problem.sites.ids[i] for i in (1, 2, 3))
    assert float(table.total[2]) == problem.sites.demand[[1, 2, 3, 10, 11]].sum()
    assert float(table.total[3]) == pytest.approx(problem.evaluate(answer).quantities["distance"], abs=1e-3)


def test_a_mixed_fleet_names_the_type_of_each_vehicle(problem):
    mixed = dataclasses.replace(problem, fleet=(wb.VehicleType(2, 200, name="van"), wb.VehicleType(2, 400, name="lorry")))
    answer = wb.Routes((wb.Route((1, 2)), wb.Route((3,), vehicle=1), wb.Route((4,))))
    assert [row[0] for row in routes_table(mixed, answer).rows] == ["van 1", "lorry 1", "van 2"]


def test_sites_left_out_are_told_with_the_reason():
    sites = wb.Sites.of(range(4), demand=[0, 5, 50, 5], required=[False, True, True, False], coordinates=np.eye(4)[:, :2])
    problem = wb.RoutingProblem(sites, wb.Travel("euclidean", sites.coordinates), (wb.VehicleType(2, 10),))
    reasons = unserved_sites(problem, wb.Routes.of([[1]]))
    assert "capacity 10" in reasons["2"]
    assert reasons["3"] == "in this answer inserting it makes total-cost worse by 0.585786 at best"
    assert set(unserved_sites(problem, None)) == {"2"}


def test_a_complete_answer_leaves_nobody_out(problem):
    assert unserved_sites(problem, wb.Routes.of([problem.customers.tolist()])) == {}


def test_without_an_answer_only_the_sites_out_of_reach_are_told(problem):
    assert answer_tables(problem, None) == []
    (told,) = answer_tables(wb.read("demo-tiny", capacity=9), None)
    assert told.title == "Unserved sites" and all("capacity 9" in row[1] for row in told.rows)


def test_an_answer_is_told_by_its_routes_and_the_sites_that_they_leave_out(problem):
    whole, part = (answer_tables(problem, wb.Routes.of([visits])) for visits in (problem.customers.tolist(), [1, 2]))
    assert [table.title for table in whole] == ["Routes"]
    assert [table.title for table in part] == ["Routes", "Unserved sites"]
    assert len(part[1].rows) == 23


def test_a_routing_problem_is_told_by_sites_windows_and_fleet(problem):
    rows = {row[0]: row[1] for row in facts_table(facts(problem)).rows}
    assert "25 customers" in rows["sites"]
    assert rows["demand"].startswith("total 520,")
    assert "customers, the last closes at" in rows["windows"]
    assert "capacity 200" in rows["fleet"]
    assert rows["problem"] == "vrptw, min total-cost"


def test_how_likely_routes_overrun_is_told_where_it_is_limited():
    line = np.abs(np.subtract.outer(*[np.array([0.0, 4, -5, 6, -7])] * 2))
    sites, travel = wb.Sites.of(range(5), service=[0, 1, 1, 1, 1]), wb.Travel("EXPLICIT", matrix=line, variances=line / 4)
    answer = wb.Routes.of([[1, 3], [2, 4]])
    problem = wb.RoutingProblem(sites, travel, (wb.VehicleType(3, max_duration=18.0),))
    assert "overrun" not in [column.name for column in routes_table(problem, answer).columns]
    table = routes_table(dataclasses.replace(problem, team_risk=0.2), answer)
    at = [column.name for column in table.columns].index("overrun")
    assert [row[at] for row in table.rows] == ["0.0105", "0.143"] and table.total[at] == "0.151"
