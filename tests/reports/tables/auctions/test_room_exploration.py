"""What is told of maps of rooms."""

from __future__ import annotations

from explorations import path

from waybound.reports.tables.facts import facts, facts_table


def test_sizes_are_told():
    rows = dict(facts_table(facts(path(4, 1, 5, 2))).rows)
    assert rows["rooms"] == "4, 3 doors, 1 rooms are heard at the base"
    assert rows["robots"] == "2, 5 steps each, 1 of them in a row without contact"
