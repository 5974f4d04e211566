"""Tables of solvers and heuristics."""

from __future__ import annotations

import dataclasses

import waybound as wb
from waybound.reports.tables.listing import heuristics_table, solvers_table


def test_solvers_and_heuristics_say_what_they_lack():
    problem = wb.read("demo-tiny")
    able = next(info for info in wb.solvers(problem) if not info.missing)
    lacking = dataclasses.replace(able, missing=("energy:travel",))
    absent = dataclasses.replace(able, installed=False)
    told = [row[1] for row in solvers_table([able, lacking, absent], asked=True).rows]
    assert told[0].startswith("takes it")
    assert told[1:] == ["does not handle energy:travel", f"not installed: {able.install}"]
    table = heuristics_table(wb.heuristics(problem), asked=True)
    assert all(len(row) == len(table.columns) for row in table.rows)
