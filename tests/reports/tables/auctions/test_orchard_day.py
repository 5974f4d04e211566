"""What is told of days in the orchard."""

from __future__ import annotations

from orchard_cases import TWO_ROUTES, lane, retrievals

import waybound as wb
from waybound.reports.tables.facts import facts, facts_table


def test_a_day_is_told_by_its_sizes():
    rows = dict(facts_table(facts(wb.OrchardDay(wb.OrchardJobs.of_routes(lane(TWO_ROUTES, 2), TWO_ROUTES)))).rows)
    assert rows["orchard"] == "1 lanes of 6 cells"
    assert rows["robots"] == "2"
    assert rows["bins"] == "8, 6 of them to be brought; 16 steps to fill all"
    assert dict(facts_table(facts(retrievals(((0, 2),), (0,), ((0, 0), (0, 6))))).rows)["robots"] == "2, 1 of them in the field"
