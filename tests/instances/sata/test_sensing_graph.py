import pickle
import warnings
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

from waybound.instances.errors import InputError, UsageError
from waybound.instances.sata.sensing_graph import SensingGraph, graph_of_edges


def small(**changes: Any) -> SensingGraph:
    """Two robots with two actions and one; action 0 sees targets 0 and 2, action 1 sees 1, action 2 sees 1."""
    data: dict[str, Any] = {
        "robot_of_action": [0, 0, 1], "action": [0, 2, 0, 1], "target": [2, 1, 0, 1], "weight": [1.0, 0.5, 2.0, 3.0], **changes,
    }  # fmt: skip
    return SensingGraph.from_edges(data.pop("robot_of_action"), data.pop("action"), data.pop("target"), data.pop("weight"), **data)


def test_edges_come_in_the_order_of_actions_and_targets() -> None:
    g = small()
    assert (g.num_robots, g.num_actions, g.num_targets, g.num_edges) == (2, 3, 3, 4)
    assert g.indptr.tolist() == [0, 2, 3, 4]
    assert g.indices.tolist() == [0, 2, 1, 1]
    assert g.weights.tolist() == [2.0, 1.0, 3.0, 0.5]
    assert g.action_of_edge.tolist() == [0, 0, 1, 2]
    assert g.density == pytest.approx(100 * 4 / 9)
    assert (g.indptr.dtype, g.indices.dtype, g.weights.dtype) == (np.int32, np.int32, np.float64)


def test_both_directions_tell_the_same() -> None:
    g = small()
    assert [part.tolist() for part in g.by_target] == [[0, 1, 3, 4], [0, 1, 2, 0], [2.0, 3.0, 0.5, 1.0]]
    assert [part.tolist() for part in g.by_robot] == [[0, 2, 3], [0, 1, 2]]


@given(st.integers(0, 2**32 - 1))
def test_by_target_is_the_transpose_of_by_action(seed: int) -> None:
    rng = np.random.default_rng(seed)
    dense = rng.random((5, 4)) * (rng.random((5, 4)) < 0.4)
    a, t = np.nonzero(dense)
    order = rng.permutation(len(a))
    g = graph_of_edges(rng.integers(0, 3, 5), a[order], t[order], dense[a, t][order], robots=3, targets=4)
    back, forth = np.zeros((5, 4)), np.zeros((5, 4))
    back[g.by_target.indices, np.repeat(np.arange(4), np.diff(g.by_target.indptr))] = g.by_target.weights
    forth[g.action_of_edge, g.indices] = g.weights
    assert np.array_equal(back, dense)
    assert np.array_equal(forth, dense)
    assert sorted(np.concatenate([g.idle_robots, np.unique(g.robot_of_action[g.action_of_edge])]).tolist()) == [0, 1, 2]
    assert g.unseen_targets.tolist() == np.nonzero(dense.sum(axis=0) == 0)[0].tolist()
    usual = [f"{r + 1}.{(g.robot_of_action[:k] == r).sum() + 1}" for k, r in enumerate(g.robot_of_action.tolist())]
    assert list(g.action_labels) == [g.action_name(k) for k in range(5)] == usual


@pytest.mark.filterwarnings("ignore:1 target")
def test_the_order_of_the_edges_changes_nothing() -> None:
    g, h = small(), small(action=[0, 0, 1, 2], target=[0, 2, 1, 1], weight=[2.0, 1.0, 3.0, 0.5])
    assert g.digest() == h.digest()
    assert g.digest() != small(weight=[1.0, 0.5, 2.0, 3.5]).digest()
    assert g.digest() != small(targets=4).digest()


def test_the_digest_does_not_depend_on_the_types_of_the_arrays() -> None:
    g = small()
    h = SensingGraph(
        g.robot_of_action.astype(np.int64), g.indptr.astype(">i8"), g.indices.tolist(), g.weights.tolist(),  # type: ignore[arg-type]
        np.int16(2), np.int64(3),
    )  # fmt: skip
    assert h.digest() == g.digest()


def test_arrays_cannot_be_written_to_and_the_callers_own_can() -> None:
    owner = np.array([0], np.int32)
    g = SensingGraph(owner, np.array([0, 1], np.int32), np.array([0], np.int32), np.array([1.0]), 1, 1)
    for values in (g.robot_of_action, g.indptr, g.indices, g.weights):
        with pytest.raises(ValueError, match="read-only"):
            values[0] = 9
    owner[0] = 0


def test_a_graph_survives_pickling() -> None:
    g = small(robots=["a", "b"])
    h = pickle.loads(pickle.dumps(g))
    assert h.digest() == g.digest()
    assert h.robot_names == ("a", "b")


@pytest.mark.filterwarnings("ignore:1 target")
def test_zero_weights_are_no_edges_and_scalars_hold_for_all() -> None:
    assert small(weight=[0.0, 1, 1, -0.0]).num_edges == 2
    assert small(weight=2).weights.tolist() == [2.0] * 4


def test_duplicates_are_an_error_unless_they_are_to_be_added() -> None:
    twice = {"robot_of_action": [0], "action": [0, 0, 0], "target": [1, 0, 1], "weight": [1.0, 2.0, 3.5]}
    with pytest.raises(InputError, match=r"edge 2 joins action 0 and target 1 again; duplicates=\"sum\" would add them up"):
        small(**twice)
    assert small(**twice, duplicates="sum").weights.tolist() == [2.0, 4.5]
    with pytest.raises(UsageError, match="duplicates must be error or sum, not 'max'"):
        small(**twice, duplicates="max")
    with pytest.raises(InputError, match="weights of action 0 and target 1 add up to infinity"):
        small(**{**twice, "weight": [1e308, 1, 1.5e308]}, duplicates="sum")


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"weight": [1, -1, 1, 1]}, "the weight of edge 2 must be finite and not negative; found -1.0"),
        ({"weight": [1, 1, np.nan, 1]}, "the weight of edge 3 must be finite and not negative; found nan"),
        ({"weight": [1, 1, 1, np.inf]}, "the weight of edge 4"),
        ({"weight": [1, 2]}, "weight must be a number, or have one entry an edge; expected 4"),
        ({"weight": [1]}, "weight must be a number, or have one entry an edge; expected 4"),
        ({"weight": "heavy"}, "weight must hold numbers"),
        ({"target": [0, 1]}, "action and target must have one entry an edge; expected 4; found 2"),
        ({"action": [0, 3, 0, 1]}, "the action of edge 2 does not exist; expected 0 to 2; found 3"),
        ({"action": [0, -1, 0, 1]}, "the action of edge 2 does not exist"),
        ({"target": [2, 1, -2, 1]}, "the target of edge 3 does not exist"),
        ({"targets": 2}, "the target of edge 1 does not exist; expected 0 to 1; found 2"),
        ({"robots": 1}, "the robot of action 3 does not exist; expected 0 to 0; found 1"),
        ({"robot_of_action": [0, -1, 1]}, "the robot of action 2 does not exist"),
        ({"robot_of_action": ["r1", "r1", "r2"]}, "robot_of_action must be a list of whole numbers; expected numbers from 0; from_"),
        ({"robot_of_action": [0, 0.5, 1]}, "robot_of_action must be a list of whole numbers"),
        ({"action": 0}, "action must be a list of whole numbers"),
        ({"target": [2, 1, 10**9, 1]}, "there are 1000000001 targets, but only 4 edges"),
        ({"target": [2, 1, 10**12, 1]}, "target holds a number that is too large"),
        ({"targets": 2 * 10**9}, "there are 2000000000 targets"),
        ({"targets": -1}, "the number of targets must be a whole number from 0"),
        ({"robots": 10**8}, "there are 100000000 robots, but only 3 actions"),
        ({"robots": "ab"}, "robots must be a number or a list of names; found 'ab'"),
        ({"robots": True}, "robots must be a number or a list of names; found True"),
        ({"robots": 2.0}, "robots must be a number or a list of names; found 2.0"),
        ({"robots": ["a"]}, "the robot of action 3 does not exist"),
        ({"robots": ["a", "a"]}, "two robots have the name 'a'"),
        ({"targets": ["x", "y", ""]}, "the name of each target must be printable, not empty"),
        ({"action_names": ["p", "q"]}, "there must be one name for each action; expected 3; found 2"),
        ({"action_names": "pqr"}, "the names of actions must be a list"),
        ({"action_positions": [[0, 0], [1, 1]]}, "action positions must be two numbers each; expected (3, 2); found (2, 2)"),
        ({"target_positions": [[0, 0], [1, 1], [0, np.inf]]}, "the position of target 3 must be finite"),
        ({"robot_of_action": [], "action": [], "target": [], "weight": []}, "there is no robot"),
        ({"robot_of_action": [], "robots": 2}, "the action of edge 1 does not exist; expected none, for there is no action; found 0"),
    ],
)  # fmt: skip
def test_bad_input_is_one_clear_line(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError) as caught:
        small(**changes)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("position", "value", "says"),
    [
        (1, [0, 2, 3], "one start an action"), (1, [0, 3, 2, 4], "starts of the actions do not ascend"), (2, [2, 0, 1, 1], "must ascend"),
        (2, [0, 0, 1, 1], "must ascend, none twice"), (2, [0, 3, 1, 1], "target of entry 2 does not exist"),
        (3, [1, 1, 1], "one weight an edge"),
        (3, [1, 0, 1, 1], "weights must be positive"), (3, [1, np.nan, 1, 1], "weights must be positive"), (4, 0, "there is no robot"),
        (4, 1.5, "num_robots must be a whole number"), (0, [0, 0, 2], "the robot of action 3 does not exist"),
    ],
)  # fmt: skip
def test_the_constructor_refuses_what_is_not_in_order(position: int, value: Any, says: str) -> None:
    parts: list[Any] = [[0, 0, 1], [0, 2, 3, 4], [0, 2, 1, 1], [2.0, 1.0, 3.0, 0.5], 2, 3]
    parts[position] = value
    with pytest.raises(InputError, match=says):
        SensingGraph(*parts)


def test_idle_robots_and_unseen_targets_are_legal_and_named_in_warning_and_notes() -> None:
    with pytest.warns(UserWarning) as caught:
        g = SensingGraph.from_edges([0, 2], [0], [1], robots=["a", "b", "c"], targets=["t", "u", "v"])
    told = [str(w.message) for w in caught]
    assert told == ["2 robots without an action that sees anything: b, c", "2 targets that no action sees: t, v"]
    assert caught[0].filename == __file__
    assert g.notes == tuple(told)
    assert g.with_notes("more").notes == (*told, "more")
    assert (g.idle_robots.tolist(), g.unseen_targets.tolist()) == ([1, 2], [0, 2])


def test_a_note_names_only_the_first_few() -> None:
    assert graph_of_edges([0], [0], [0], robots=9).notes == ("8 robots without an action that sees anything: 2, 3, 4, 5, 6, ...",)
    assert graph_of_edges([0], [0], [0], targets=2).notes == ("1 target that no action sees: 2",)


def test_a_graph_in_which_all_see_and_are_seen_warns_of_nothing() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert small().notes == ()


def test_a_robot_without_actions_and_no_targets_at_all_are_legal() -> None:
    g = graph_of_edges([], [], [], robots=2)
    assert (g.num_actions, g.num_targets, g.num_edges, g.density) == (0, 0, 0, 0.0)
    assert g.by_target.indptr.tolist() == [0]
    assert g.by_robot[0].tolist() == [0, 0, 0]
    assert g.idle_robots.tolist() == [0, 1]


def test_names_are_the_users_or_counted_from_1() -> None:
    g = small()
    assert [g.robot_name(1), g.target_name(2), g.action_name(1), g.action_name(2)] == ["2", "3", "1.2", "2.1"]
    h = small(robots=["x", "y"], targets=iter("abc"))
    assert [h.robot_name(1), h.target_name(2), h.action_name(1), h.action_name(2)] == ["y", "c", "x.2", "y.1"]
    assert small(action_names=[10, 20, 30]).action_labels == ("10", "20", "30")
    assert small(name="two\nlines ").name == "two lines"


def test_a_graph_shows_itself_in_one_line() -> None:
    assert repr(small(name="s")) == "<SensingGraph s: 2 robots, 3 actions, 3 targets, 4 edges (44.4 %)>"
