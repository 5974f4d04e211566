"""What is told of robots and tasks."""

from __future__ import annotations

from task_problems import line, parts

from waybound.reports.tables.facts import facts, facts_table


def test_a_team_is_told_by_its_sizes():
    rows = dict(facts_table(facts(line([0, 10], [4, 6, 1], "mini-max"))).rows)
    assert (rows["problem"], rows["robots"], rows["tasks"]) == ("task-allocation, min mini-max", "2", "3")
    assert rows["distances"] == "euclidean, 1 to 9"
    rows = dict(facts_table(facts(parts([0, 1], weights=[1, 2.5]))).rows)
    assert (rows["tasks"], rows["edges"]) == ("2, of weight 3.5 together", "mst")
