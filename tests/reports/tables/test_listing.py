import dataclasses

import waybound as wb
from waybound.reports.tables.listing import heuristics_table, solvers_table


def test_solvers_and_heuristics_say_what_they_lack_those_that_take_a_problem_first():
    problem = wb.read("demo-tiny")
    able = next(info for info in wb.solvers(problem) if not info.missing)
    lacking = dataclasses.replace(able, missing=("energy:travel",))
    foreign = dataclasses.replace(able, missing=("routing problems",))
    absent = dataclasses.replace(able, installed=False)
    made = solvers_table([foreign, lacking, absent, able], asked=True)
    told = [row[1] for row in made.rows]
    assert told[0].startswith("takes it")
    assert told[1:] == [f"not installed: {able.install}", "does not handle energy:travel", "does not handle routing problems"]
    assert made.most == 2
    assert solvers_table([foreign, lacking], asked=True).most is None, "where nobody takes it, all say why"
    assert [row[0] for row in solvers_table([lacking, able], asked=False).rows] == [able.name] * 2
    table = heuristics_table(wb.heuristics(problem), asked=True)
    assert all(len(row) == len(table.columns) for row in table.rows)
