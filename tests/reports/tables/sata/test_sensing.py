"""What is told of sensing graphs."""

from __future__ import annotations

import pytest

import waybound as wb
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.reports.tables.facts import facts, facts_table

GRAPH = graph_of_edges(
    [0, 0, 0, 1, 3], [0, 0, 1, 3, 4], [0, 1, 1, 1, 1], [1, 2, 3, 4, 5], robots=["a", "b", "c", "d"], targets=["x", "y", "z"]
)  # action 2 of robot a sees nothing


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
    data = problem.facts()
    assert len(data["graph"]["idle_robots"]) == 29
    assert told(problem)["idle robots"] == "29: 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, ..."


def test_a_graph_without_edges_has_facts_too():
    problem = wb.WinnerTakesAllSATA(graph_of_edges([], [], [], robots=2))
    data = problem.facts()
    assert data["graph"]["weights"] is None
    assert (data["graph"]["delta_r"], data["graph"]["delta_t"], data["graph"]["phi"]) == (0, 0, 0.0)
    assert told(problem)["edges"] == "0, density phi 0 %"
