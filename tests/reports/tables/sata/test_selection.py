"""What is told of selection problems."""

from __future__ import annotations

import numpy as np
import pytest

import waybound as wb
from waybound.reports.tables.facts import facts, facts_table

COVER = wb.Coverage.from_sets([[0, 2], [1], []], [1, 2.5, 3])


@pytest.mark.parametrize(
    ("function", "rule", "told"),
    [
        (COVER, wb.Cardinality(2), ("coverage of 3 items by 3 elements, 3 entries", "cardinality: at most 2 elements")),
        (
            wb.DenseFacilityLocation(np.ones((3, 4))),
            wb.PartitionMatroid.of([0, 0, 1], [1, 5]),
            (
                "facility-location of 4 items by 3 elements, 12 entries",
                "partition matroid: at most 1 to 5 of each of 2 groups, 2 elements in all",
            ),
        ),
        (
            wb.UserFunction(lambda masks: masks.sum(axis=1), 3),
            wb.Knapsack([1, 2, 3.5], 4),
            ("the user's own, of 3 elements", "knapsack: costs up to 4 of 6.5 in all"),
        ),
    ],
)
def test_a_selection_is_told_by_function_and_constraint(function, rule, told):
    rows = dict(facts_table(facts(wb.SubmodularSelection(function, rule))).rows)
    assert (rows["function"], rows["constraint"]) == told


def test_a_constraint_of_another_package_is_told_as_it_is():
    data = {**facts(wb.read("cover-30")), "constraint": {"kind": "intervals", "gap": 3, "whole": True}}
    assert dict(facts_table(data).rows)["constraint"] == "kind intervals, gap 3, whole yes"
