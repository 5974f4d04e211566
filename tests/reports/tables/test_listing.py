"""Tables of solvers and heuristics."""

from __future__ import annotations

import dataclasses

import waybound as wb
from waybound.reports.tables.listing import heuristics_table, solvers_table


def test_solvers_and_heuristics_say_what_they_lack():
    problem = wb.read("demo-tiny")
    infos = wb.solvers(problem)
    lacking = dataclasses.replace(infos[0], missing=("energy:travel",))
    absent = dataclasses.replace(infos[0], installed=False)
    told = [row[1] for row in solvers_table([infos[0], lacking, absent], asked=True).rows]
    assert told[0].startswith("takes it")
    assert told[1:] == ["lacks energy:travel", f"not installed: {infos[0].install}"]
    table = heuristics_table(wb.heuristics(problem), asked=True)
    assert all(len(row) == len(table.columns) for row in table.rows)
