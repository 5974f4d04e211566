"""Answers of selection and assignment problems: what judges them, and robots' actions as JSON."""

import numpy as np
import pytest
from coded import coded
from hypothesis import given, strategies as st

import waybound as wb
from waybound.formulations.problem import problem_from_instance
from waybound.formulations.sata.selections import Selection, action_index, actions_from_json, actions_to_json, judge_elements
from waybound.instances.errors import UsageError
from waybound.instances.sata.sensing_graph import graph_of_edges

GRAPH = graph_of_edges([1, 0, 1], [0, 1, 2], [0, 0, 1], robots=["a", "b"], problem="selection", problems=("selection", "bottleneck"))


def test_any_whole_numbers_make_a_selection():
    made = Selection.of(np.array([3, 1]), winners=iter([0, -1]))
    assert (made.elements, made.winners, len(made), list(made)) == ((3, 1), (0, -1), 2, [3, 1])
    assert Selection.of([]) == Selection()


@pytest.mark.parametrize("elements", [["a"], 3, None, [[1]]])
def test_anything_else_does_not(elements):
    with pytest.raises(UsageError, check=coded("malformed")):
        Selection.of(elements)


@given(st.lists(st.integers(-2, 6) | st.just(10**40), max_size=8))
def test_elements_that_exist_and_stand_once_pass(elements):
    chosen, (check, faults) = judge_elements(Selection.of(elements), 5, "elements", "element", str)
    assert chosen.tolist() == sorted({e for e in elements if 0 <= e < 5})
    bad = sum(not 0 <= e < 5 for e in elements) + sum(elements[:k].count(e) > 0 for k, e in enumerate(elements) if 0 <= e < 5)
    assert len(faults) == bad
    assert (check.passed, check.tested) == (bad == 0, len(elements))


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
