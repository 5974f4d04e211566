"""What is told of generalised assignments."""

from __future__ import annotations

import math

from waybound.formulations.auctions.generalised_assignment import GeneralisedAssignment
from waybound.reports.tables.facts import facts, facts_table


def test_sizes_and_ranges_are_told():
    problem = GeneralisedAssignment.from_arrays([[1.0, -math.inf], [2.5, 3.0]], [[1.0, 2.0], [3.0, 4.0]], [5.0, 6.0], "profit")
    rows = dict(facts_table(facts(problem)).rows)
    assert rows["agents"] == "2, capacities 5 to 6, 11 together" and rows["jobs"] == "2, 1 pairs forbidden"
    assert rows["profits"] == "1 to 3" and rows["consumption"] == "1 to 4"
    barred = GeneralisedAssignment.from_arrays([[math.inf]], [[1.0]], [5.0])
    assert dict(facts_table(facts(barred)).rows)["costs"] == "none"
