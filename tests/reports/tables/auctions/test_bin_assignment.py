"""What is told of costs of robots and bins."""

from __future__ import annotations

import numpy as np

import waybound as wb
from waybound.reports.tables.facts import facts, facts_table


def test_costs_are_told_by_sizes_and_ranges() -> None:
    problem = wb.BinAssignment.from_matrix([[1.0, np.inf], [2.0, 3.5], [4.0, 5.0]], filled=np.array([0.0, 2.0]))
    rows = dict(facts_table(facts(problem)).rows)
    expected = {
        "problem": "bin-assignment, min sum of the costs of 2 pairs",
        "pairs asked for": "2",
        "robots": "3, each for 1 to 2 bins",
        "bins": "2, each for 2 to 3 robots",
        "pairs": "5, 1 forbidden",
        "costs": "1 to 5",
        "waiting": "1 bins are not yet full",
        "positions": "none",
    }
    assert {name: rows[name] for name in expected} == expected
