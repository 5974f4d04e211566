"""Actions of robots as JSON, and which problems a sensing graph allows."""

from __future__ import annotations

import pytest

import waybound as wb
from waybound.formulations.problem import problem_from_instance
from waybound.formulations.sata.assignments import action_index, actions_from_json, actions_to_json
from waybound.instances.sata.sensing_graph import graph_of_edges

GRAPH = graph_of_edges([1, 0, 1], [0, 1, 2], [0, 0, 1], robots=["a", "b"], problem="selection", problems=("selection", "bottleneck"))


def test_actions_are_written_with_their_robots_and_read_back_in_their_order():
    answer = wb.Selection.of([2, 1])
    data = actions_to_json(GRAPH, answer)
    assert data == [{"robot": "b", "action": "b.2"}, {"robot": "a", "action": "a.1"}]
    assert actions_from_json(GRAPH, {"kind": "assignment", "actions": data}) == answer
    assert actions_from_json(GRAPH, {"kind": "assignment", "actions": [{"action": "b.1"}]}) == wb.Selection.of([0])
    assert action_index(GRAPH) == {"b.1": 0, "a.1": 1, "b.2": 2}


def test_a_graph_is_asked_only_what_it_allows():
    assert isinstance(problem_from_instance(GRAPH), wb.SubmodularSelection)
    assert isinstance(problem_from_instance(GRAPH, "bottleneck"), wb.BottleneckSATA)
    for problem in ("bottleneck-lp", "winner-takes-all"):
        with pytest.raises(wb.UsageError, match=f"cannot be read as {problem}; it allows selection, bottleneck"):
            problem_from_instance(GRAPH, problem)
