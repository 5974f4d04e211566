from typing import Any

import numpy as np
import pytest
from coded import check_coded
from file_cases import check_refused
from hypothesis import given, strategies as st

from waybound.instances.errors import Code, InputError, UsageError
from waybound.instances.sata.sensing_graph import SensingGraph, graph_of_edges
from waybound.instances.sata.sensing_rows import Named, edges_of_rows, exact_rows, reading_order, rows_of_graph


def graph(*rows: str, weights: list[float] | None = None, **options: Any) -> SensingGraph:
    """From rows such as "r1 p1 t1", with - for an empty cell."""
    cells = [["" if cell == "-" else cell for cell in row.split()] for row in rows]
    columns = [Named.of(cell[k] for cell in cells) for k in range(3)]
    listed = None if weights is None else np.array(weights, float)
    return graph_of_edges(**edges_of_rows(*columns, listed, place="row {}".format, **options))  # type: ignore[arg-type]


def edges(g: SensingGraph) -> set[tuple[str, str, str, float]]:
    return {
        (g.robot_name(int(g.robot_of_action[a])), g.action_name(a), g.target_name(t), w)
        for a, t, w in zip(g.action_of_edge.tolist(), g.indices.tolist(), g.weights.tolist(), strict=True)
    }


def test_full_rows_are_edges_and_others_declare() -> None:
    g = graph("a p x", "a q -", "b - -", "- - y", "a p z")
    assert edges(g) == {("a", "p", "x", 1.0), ("a", "p", "z", 1.0)}
    assert (g.robot_names, g.action_names, g.target_names) == (("a", "b"), ("p", "q"), ("x", "y", "z"))
    assert (g.idle_robots.tolist(), g.unseen_targets.tolist()) == ([1], [1])


def test_a_name_that_two_robots_use_is_completed_by_the_robot() -> None:
    g = graph("a left x", "b left x", "b right y")
    assert g.action_names == ("a.left", "b.left", "b.right")
    assert edges(g) == {("a", "a.left", "x", 1.0), ("b", "b.left", "x", 1.0), ("b", "b.right", "y", 1.0)}


def test_completed_names_that_meet_are_refused() -> None:
    with pytest.raises(InputError, match=r"two actions have the name 'a.b.c'"):
        graph("a b.c x", "a.b c x", "a c x")


def test_names_as_they_would_be_anyway_are_not_kept() -> None:
    g = graph("1 1.1 1", "1 1.2 2", "2 2.1 2")
    assert (g.robot_names, g.action_names, g.target_names) == (None, None, None)
    assert graph("1 1 1", "1 2 2", "2 1 2").digest() == g.digest()


def test_whole_numbers_come_in_ascending_order_and_texts_as_they_appear() -> None:
    assert reading_order(["10", "9", "02"], "names") == [2, 1, 0]
    assert reading_order(["10", "9", "02"], "rows") == [0, 1, 2]
    assert reading_order(["10", "9", "b"], "names") == [0, 1, 2]
    g = graph("3 30 7", "1 10 5")
    assert (g.robot_names, g.action_names, g.target_names) == (("1", "3"), ("10", "30"), ("5", "7"))
    assert g.robot_of_action.tolist() == [0, 1]
    assert graph("3 30 7", "1 10 5", order="rows").robot_names == ("3", "1")


@pytest.mark.parametrize(
    ("rows", "weights", "code", "says"),
    [
        (["- p x"], None, "missing", "row 0: the action has no robot"),
        (["a p x", "- p -"], None, "missing", "row 1: the action has no robot"),
        (["a - x"], None, "missing", "row 0: a robot and a target are named, but no action"),
        (["- - -"], None, "missing", "row 0: neither a robot nor a target is named"),
        (["a p x"], [np.nan], "out-of-range", "row 0: the weight must be a finite number, not negative; found nan"),
        (["a p x", "a p y"], [1, -2], "out-of-range", "row 1: the weight must be a finite number, not negative; found -2.0"),
        (["a p x"], [np.inf], "out-of-range", "row 0: the weight must be a finite number"),
        (["a p x", "a p -"], [1, 2], "contradiction", "row 1: a weight stands in a row that is no edge; found 2.0"),
        (["a p x", "b q x", "a p x"], None, "duplicate", 'row 2: the edge stands already in row 0; duplicates "sum" would add them up'),
    ],
)
def test_a_row_that_means_nothing_is_refused_by_its_place(rows: list[str], weights: Any, code: Code, says: str) -> None:
    with pytest.raises(InputError) as caught:
        graph(*rows, weights=weights)
    assert str(caught.value).startswith(says) and caught.value.code == code
    lines = [10 * k for k in range(1, len(rows) + 1)]
    with pytest.raises(InputError) as caught:
        graph(*rows, weights=weights, lines=lines)
    assert caught.value.line in lines


def test_unknown_choices_are_refused() -> None:
    check_refused(UsageError, "order must be one of names, rows, not 'size'", graph, "a p x", order="size")
    check_coded(UsageError, "unknown-name", graph, "a p x", duplicates="max")


def test_duplicates_are_added_where_asked() -> None:
    assert edges(graph("a p x", "a p x", weights=[1, 2.5], duplicates="sum")) == {("a", "p", "x", 3.5)}


labels = st.lists(st.sampled_from(["1", "2", "3", "10", "07", "a", "b", "c.1", "2.1", "é"]), min_size=3, max_size=3, unique=True)


@st.composite
def graphs(draw: st.DrawFn) -> SensingGraph:
    """Graphs with and without names, idle robots and unseen targets among them."""
    owner = draw(st.lists(st.integers(0, 2), max_size=5))
    pairs = draw(st.sets(st.tuples(st.integers(0, max(len(owner) - 1, 0)), st.integers(0, 2)), max_size=9)) if owner else set()
    weights = draw(st.lists(st.floats(1e-9, 1e9), min_size=len(pairs), max_size=len(pairs)))
    names = draw(st.none() | st.permutations(["3", "7", "p", "q", "1.1"]).map(lambda p: p[: len(owner)]))
    robots: Any = draw(st.just(3) | labels)
    targets: Any = draw(st.just(3) | labels)
    chosen = sorted(pairs)
    return graph_of_edges(
        owner, [a for a, _ in chosen], [t for _, t in chosen], weights, robots=robots, targets=targets, action_names=names
    )  # fmt: skip


@given(graphs())
def test_exact_rows_read_back_as_the_same_graph(g: SensingGraph) -> None:
    rows = exact_rows(g)
    cells = [
        [("" if code < 0 else name(code)) for code in codes.tolist()]
        for codes, name in ((rows.robot, g.robot_name), (rows.action, g.action_name), (rows.target, g.target_name))
    ]
    h = graph_of_edges(**edges_of_rows(*map(Named.of, cells), rows.weight, order=rows.order))  # type: ignore[arg-type]
    assert h.digest() == g.digest()
    assert [h.robot_name(k) for k in range(3)] == [g.robot_name(k) for k in range(3)]
    assert [h.target_name(k) for k in range(3)] == [g.target_name(k) for k in range(3)]
    assert h.action_labels == g.action_labels


def test_every_edge_and_everything_without_one_has_a_row() -> None:
    rows = rows_of_graph(graph_of_edges([1, 1], [1, 1], [2, 0], [4, 5], robots=3, targets=4))
    table = np.column_stack([rows.robot, rows.action, rows.target]).tolist()
    assert table == [[1, 0, -1], [1, 1, 0], [1, 1, 2], [0, -1, -1], [2, -1, -1], [-1, -1, 1], [-1, -1, 3]]
    assert rows.weight.tolist()[1:3] == [5.0, 4.0]
    assert np.isnan(rows.weight[[0, 3, 4, 5, 6]]).all()
