"""What the forms of selection share: the rows of each constraint, creditors, and the edges that serve an item best."""

import pickle
from pathlib import Path

import numpy as np
import pytest
from program_text import expected, written

from waybound import Cardinality, DenseFacilityLocation, SubmodularSelection
from waybound.formulations.sata.forms._selections import Labels, edges_of

COVERAGE = """
    {"waybound": 1, "kind": "selection", "name": "tiny", "problem": "selection", "elements": ["a", "b", "c"],
     "function": {"kind": "coverage", "sets": [[0], [0, 1], [1]], "item_weights": [4, 3]}, "constraint": %s}
"""


@pytest.mark.parametrize(
    ("constraint", "rows"),
    [
        ('{"kind": "cardinality", "limit": 2}', ["cardinality: x[a] + x[b] + x[c] <= 2"]),
        ('{"kind": "partition", "groups": [0, 1, 0], "limits": [2, 1]}', ["group[1]: x[a] + x[c] <= 2", "group[2]: x[b] <= 1"]),
        ('{"kind": "knapsack", "costs": [1.5, 0, 2], "budget": 3}', ["budget: 1.5 x[a] + 2 x[c] <= 3"]),
    ],
)
def test_each_constraint_writes_its_own_rows_before_all_others(constraint: str, rows: list[str], tmp_path: Path) -> None:
    text = written(COVERAGE % constraint, "facility-location", tmp_path, ".json")
    assert text == expected("""
        facility-location, exact
        max 4 u[1,1] + 3 u[2,1]
        %s
        level[1,1]: - x[a] - x[b] + u[1,1] <= 0
        level[2,1]: - x[b] - x[c] + u[2,1] <= 0
        x[a], x[b], x[c] binary
        0 <= u[1,1], u[2,1] <= 1
    """) % "\n".join(rows)


def test_creditors_are_groups_of_one_choice_and_else_single_elements(tmp_path: Path) -> None:
    """Of a and c both may be chosen, so each has a credit of its own; b is alone in its group."""
    text = written(COVERAGE % '{"kind": "partition", "groups": [0, 1, 0], "limits": [2, 1]}', "product", tmp_path, ".json")
    assert text.splitlines()[1] == "max 4 x[a] y[a,1] + 4 x[b] y[group 2,1] + 3 x[b] y[group 2,2] + 3 x[c] y[c,2]"


def test_the_best_edge_of_an_item_is_the_first_of_the_heaviest_chosen() -> None:
    weights = np.array([[2.0, 0.0], [3.0, 1.0], [3.0, 4.0]])
    edges = edges_of(SubmodularSelection(DenseFacilityLocation(weights), Cardinality(3)))
    assert list(zip(edges.element.tolist(), edges.item.tolist(), edges.weight.tolist(), strict=True)) == [
        (0, 0, 2.0), (1, 0, 3.0), (1, 1, 1.0), (2, 0, 3.0), (2, 1, 4.0),
    ]  # fmt: skip
    assert edges.best(np.array([1.0, 1.0, 1.0])).tolist() == [1, 4]
    assert edges.best(np.array([1.0, 1.0, 0.0])).tolist() == [1, 2]
    assert edges.best(np.array([1.0, 0.0, 0.0])).tolist() == [0]
    assert edges.best(np.zeros(3)).tolist() == []


def test_labels_are_made_when_asked_for_and_travel_as_texts() -> None:
    asked: list[int] = []
    labels = Labels(5, lambda k: asked.append(k) or f"t{k}")  # type: ignore[func-returns-value]
    assert labels[-1] == "t4" and labels[1:3] == ["t1", "t2"] and asked == [4, 1, 2]
    assert pickle.loads(pickle.dumps(labels)) == ("t0", "t1", "t2", "t3", "t4")
