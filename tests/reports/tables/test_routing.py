"""Tables that people read."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import waybound as wb
from waybound.formulations.answers import finite
from waybound.reports.tables.routing import (
    Column,
    Table,
    answer_table,
    facts,
    facts_table,
    heuristics_table,
    routes_table,
    solvers_table,
    unserved_sites,
)


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
    answer = wb.Routes((wb.Route((1, 2)), wb.Route((3,), vehicle=1)))
    assert "lorry" in routes_table(mixed, answer).rows[1][0]


def test_sites_left_out_are_told_with_the_reason():
    sites = wb.Sites.of(range(4), demand=[0, 5, 50, 5], required=[False, True, True, False], coordinates=np.eye(4)[:, :2])
    problem = wb.RoutingProblem(sites, wb.Travel("euclidean", sites.coordinates), (wb.VehicleType(2, 10),))
    reasons = unserved_sites(problem, wb.Routes.of([[1]]))
    assert "capacity 10" in reasons["2"]
    assert "optional" in reasons["3"]
    assert set(unserved_sites(problem, None)) == {"2"}


def test_a_complete_answer_leaves_nobody_out(problem):
    assert unserved_sites(problem, wb.Routes.of([problem.customers.tolist()])) == {}


def test_facts_are_plain_values_and_agree_with_the_data(problem):
    data = facts(problem)
    assert finite(data).keys() == data.keys()
    assert data["demand"] == {"total": 520.0, "least": data["demand"]["least"], "largest": problem.sites.demand.max()}
    assert data["windows"]["sites"] <= 25
    rows = {row[0]: row[1] for row in facts_table(data).rows}
    assert "25 customers" in rows["sites"]
    assert "capacity 200" in rows["fleet"]


def test_solvers_and_heuristics_say_what_they_lack(problem):
    infos = wb.solvers(problem)
    lacking = dataclasses.replace(infos[0], missing=("energy:travel",))
    absent = dataclasses.replace(infos[0], installed=False)
    told = [row[1] for row in solvers_table([infos[0], lacking, absent], asked=True).rows]
    assert told[0].startswith("takes it")
    assert told[1:] == ["lacks energy:travel", f"not installed: {infos[0].install}"]
    table = heuristics_table(wb.heuristics(problem), asked=True)
    assert all(len(row) == len(table.columns) for row in table.rows)


def test_an_answer_that_is_no_set_of_routes_is_told_row_by_row():
    table = answer_table(wb.read("figure-3-3"), wb.Selection.of([0, 2, 5]))
    assert [c.name for c in table.columns] == ["robot", "action", "share", "targets"]
    assert [c.right for c in table.columns] == [False, False, True, True]
    assert table.rows[1] == ("r2", "p3", "1", "2")


def test_a_long_answer_is_cut_and_says_so():
    problem = wb.MaxMinLP(np.ones((1, 50)), np.ones((1, 50)))
    table = answer_table(problem, np.full(50, 0.01))
    assert len(table.rows) == 21
    assert table.rows[-1] == ("and 30 more", "")


def test_every_entry_is_printable_and_only_wide_columns_are_long():
    table = Table("a\x1b[2Jb", (Column("site"), Column("reason", wide=True)), (("x\ny" + "z" * 900, "\u202ew" * 900),), ("\x07", ""))
    shown = [table.title, *table.rows[0], *table.total]
    assert all(text.isprintable() for text in shown)
    assert len(table.rows[0][0]) == 200 and len(table.rows[0][1]) == 1800
