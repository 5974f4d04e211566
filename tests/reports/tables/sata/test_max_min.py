"""What is told of max-min problems."""

from __future__ import annotations

import waybound as wb
from waybound.reports.tables.facts import facts, facts_table


def test_a_max_min_program_is_told_by_its_rows():
    rows = dict(facts_table(facts(wb.MaxMinLP([[1, 1, 0], [0, 0, 2]], [[1, 0, 1]]))).rows)
    expected = {
        "variables": "3",
        "packing": "2 rows, 3 entries, at most 2 in a row",
        "covering": "1 rows, 2 entries, at most 2 in a row",
        "structure": "one packing row a variable",
    }
    assert {name: rows[name] for name in expected} == expected
