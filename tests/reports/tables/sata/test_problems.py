"""What tables tell of max-min problems, selections and sensing graphs."""

import numpy as np
import pytest

import waybound as wb
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.reports.tables.facts import facts, facts_table

GRAPH = graph_of_edges(
    [0, 0, 0, 1, 3], [0, 0, 1, 3, 4], [0, 1, 1, 1, 1], [1, 2, 3, 4, 5], robots=["a", "b", "c", "d"], targets=["x", "y", "z"]
)  # action 2 of robot a sees nothing
COVER = wb.Coverage.from_sets([[0, 2], [1], []], [1, 2.5, 3])


def told(problem):
    return dict(facts_table(facts(problem)).rows)


@pytest.mark.parametrize("problem", [wb.BottleneckSATA(GRAPH), wb.BottleneckSATA(GRAPH, fractional=True), wb.WinnerTakesAllSATA(GRAPH)])
def test_a_graph_is_told_with_the_degrees_of_what_sees(problem):
    assert problem.facts()["graph"] == {
        "robots": 4, "actions": 5, "actions_of_a_robot": [0, 3], "seeing_actions": 4, "targets": 3, "edges": 5, "phi": 100 * 5 / 15,
        "delta_r": 2, "delta_t": 4, "weights": [1.0, 5.0], "positions": False, "idle_robots": ["c"], "unseen_targets": ["z"],
    }  # fmt: skip
    rows = told(problem)
    assert rows["robots"] == "4, 0 to 3 actions each (5 in all, 1 see nothing)"
    assert rows["edges"] == "5, density phi 33.33 %, weights 1 to 5"
    assert (rows["idle robots"], rows["unseen targets"]) == ("1: c", "1: z")


def test_long_lists_of_names_are_cut_in_the_table_alone():
    problem = wb.BottleneckSATA(graph_of_edges([0], [0], [0], robots=30))
    assert len(problem.facts()["graph"]["idle_robots"]) == 29
    assert told(problem)["idle robots"] == "29: 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, ..."


def test_a_graph_without_edges_has_facts_too():
    problem = wb.WinnerTakesAllSATA(graph_of_edges([], [], [], robots=2))
    data = problem.facts()
    assert data["graph"]["weights"] is None
    assert (data["graph"]["delta_r"], data["graph"]["delta_t"], data["graph"]["phi"]) == (0, 0, 0.0)
    assert told(problem)["edges"] == "0, density phi 0 %"


def test_a_max_min_program_is_told_by_its_rows():
    rows = told(wb.MaxMinLP([[1, 1, 0], [0, 0, 2]], [[1, 0, 1]]))
    expected = {
        "variables": "3",
        "packing": "2 rows, 3 entries, at most 2 in a row",
        "covering": "1 rows, 2 entries, at most 2 in a row",
        "structure": "one packing row a variable",
    }
    assert {name: rows[name] for name in expected} == expected


@pytest.mark.parametrize(
    ("function", "rule", "texts"),
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
def test_a_selection_is_told_by_function_and_constraint(function, rule, texts):
    rows = told(wb.SubmodularSelection(function, rule))
    assert (rows["function"], rows["constraint"]) == texts


def test_a_constraint_of_another_package_is_told_as_it_is():
    data = {**facts(wb.read("cover-30")), "constraint": {"kind": "intervals", "gap": 3, "whole": True}}
    assert dict(facts_table(data).rows)["constraint"] == "kind intervals, gap 3, whole yes"
