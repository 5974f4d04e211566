"""What is told of joint assignments."""

from __future__ import annotations

from joint_assignments import WORKED

from waybound.reports.tables.facts import facts, facts_table


def test_sizes_are_told():
    rows = dict(facts_table(facts(WORKED)).rows)
    assert rows["robots"] == "2, 2 of them have something to bring"
    assert rows["bins"] == "2, 1 of them not yet full" and rows["requests"] == "2"
