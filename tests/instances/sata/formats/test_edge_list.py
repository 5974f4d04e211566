from pathlib import Path

import numpy as np
import pytest
from file_cases import Read, Refusal, check_refused
from hypothesis import given, strategies as st

from waybound.instances.errors import InputError, UsageError
from waybound.instances.formats import FORMATS
from waybound.instances.sata.formats.edge_list import read, recognises, write
from waybound.instances.sata.sensing_graph import SensingGraph, graph_of_edges

TEXT = """\
# name: two robots
# made by hand
robot,action,target,weight
r1,left,t1,2.5
r1,right,t2,1
r2,left,t2,0.5
r2,stay,,
r3,,,
,,t3,
"""


def test_rows_are_edges_or_declare_what_has_none(read_text_as: Read) -> None:
    g = read_text_as(TEXT, "a.csv")
    assert isinstance(g, SensingGraph)
    assert (g.name, g.format, g.problem) == ("two robots", "edges", "bottleneck")
    assert (g.robot_names, g.target_names) == (("r1", "r2", "r3"), ("t1", "t2", "t3"))
    assert g.action_names == ("r1.left", "r1.right", "r2.left", "r2.stay")
    assert g.weights.tolist() == [2.5, 1.0, 0.5]
    assert g.notes == ("1 robot without an action that sees anything: r3", "1 target that no action sees: t3")


@pytest.mark.parametrize("delimiter", [",", ";", "\t", "|"])
def test_columns_may_stand_in_any_order_and_be_parted_by_any_delimiter(read_text_as: Read, delimiter: str) -> None:
    g = read_text_as("Target,ACTION,robot\n7,12,3\n\n7,4,1\n".replace(",", delimiter), "pairs.csv")
    assert (g.name, g.robot_names, g.action_names, g.target_names) == ("pairs", ("1", "3"), ("4", "12"), ("7",))
    assert g.weights.tolist() == [1.0, 1.0]


def test_settings_choose_problem_order_and_what_duplicates_mean(read_text_as: Read) -> None:
    text = "# problem: winner-takes-all\n# duplicates: sum\n# order: rows\nrobot,action,target,weight\n3,12,7,1\n1,4,7,2\n3,12,7,0.25\n"
    g = read_text_as(text)
    assert (g.problem, g.robot_names, g.weights.tolist()) == ("winner-takes-all", ("3", "1"), [1.25, 2.0])


def test_a_quoted_name_may_hold_the_delimiter(read_text_as: Read) -> None:
    g = read_text_as('robot,action,target\n"a, b",p,"say ""x"""\n')
    assert (g.robot_names, g.target_names) == (("a, b",), ('say "x"',))


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("robot,action,target\n1,p,x\n1,p,x\n", 3, 'the edge stands already in line 2; duplicates "sum" would add them up'),
        ("robot,action,target\n\n1,p,x\n,p,y\n", 4, "the action has no robot"),
        ("robot,action,target\n1,,x\n", 2, "a robot and a target are named, but no action"),
        ("robot,action,target,weight\n1,p,x,-1\n", 2, "the weight must be a finite number, not negative; found -1.0"),
        ("robot,action,target,weight\n1,p,x,nan\n", 2, "weight must be a finite number; expected a number; found 'nan'"),
        ("robot,action,target,weight\n1,p,x,1e999\n", 2, "weight must be a finite number"),
        ("robot,action,target,weight\n1,p,x,\n", 2, "the weight of the edge is empty"),
        ("robot,action,target,weight\n1,p,x,1\n1,q,,2\n", 3, "a weight stands in a row that is no edge; found 2.0"),
        ("robot,action,target\n1,p\n", 2, "row has a wrong length; expected 3 values; found 2 values"),
        ("robot,action,target,colour\n1,p,x,red\n", 1, "column 'colour' is unknown; expected robot, action, target, weight"),
        ("robot,action,target,target\n1,p,x,y\n", 1, "column target stands twice"),
        ("robot,action,target\n", 1, "holds no edges"),
        ("# size: 3\nrobot,action,target\n1,p,x\n", 1, "setting 'size' is unknown; expected name, problem, duplicates, order"),
        ("\n# problem: vrptw\nrobot,action,target\n1,p,x\n", 2, "problem 'vrptw' is unknown; expected bottleneck, bottleneck-lp"),
        ("# duplicates: max\nrobot,action,target\n1,p,x\n", 1, "duplicates 'max' is unknown; expected error, sum"),
        ("# order:\nrobot,action,target\n1,p,x\n", 1, "setting order has no value"),
        ("# order: rows\n# order: rows\nrobot,action,target\n1,p,x\n", 2, "setting order stands twice"),
        ('robot,action,target\n1,"p,x\n', 2, "is no CSV"),
        ("robot,action,target\n1,p,x\n2,q\x07,y\n", 3, "action cannot be printed"),
    ],
)
def test_a_fault_is_named_by_its_line(refusal: Refusal, text: str, line: int, says: str) -> None:
    error = refusal(text)
    assert error.line == line
    assert says in str(error)


def test_a_column_that_is_missing_is_named() -> None:
    with pytest.raises(InputError, match="column target is missing; expected robot, action, target, weight; found robot, action") as caught:
        read("# remark\nrobot,action\n1,p\n", Path("a.csv"))
    assert caught.value.line == 2


@pytest.mark.parametrize(
    ("text", "known"),
    [
        ("robot,action,target\n", True), ("# x: y\n\n Target ; Robot;\"Action\"\n", True), ("weight|robot|action|target", True),
        ("robot,action,weight\n", False), ("id,robot,action,target\n", False), ("x,y,robot,action,target\n", False), ("id,x,y\n", False),
        ("robot action target\n", False), ("# robot,action,target\n", False), ("", False),
    ],
)  # fmt: skip
def test_the_titles_tell_an_edge_list_from_a_table_of_sites(text: str, known: bool) -> None:
    assert recognises(text) is known
    assert not (known and FORMATS["csv"].recognises(text))


names = st.text(st.characters(exclude_categories=("C", "Z")), min_size=1, max_size=4)


@given(st.integers(0, 2**32 - 1), st.lists(names, min_size=12, max_size=12, unique=True), st.booleans())
def test_what_is_written_reads_back_to_the_bit(seed: int, labels: list[str], unit: bool) -> None:
    rng = np.random.default_rng(seed)
    owner = rng.integers(0, 3, 5)
    pairs = np.unique(rng.integers(0, 20, 7))
    weights = np.ones(len(pairs)) if unit else np.exp(rng.normal(0, 20, len(pairs)))
    g = graph_of_edges(
        owner,
        pairs // 4,
        pairs % 4,
        weights,
        robots=labels[:3],
        targets=labels[3:7],
        action_names=labels[7:],
        name="g",
        problem="selection",
    )
    text = write(g)
    h = read(text, Path("g.csv"))
    assert h.digest() == g.digest()
    assert (h.robot_names, h.action_names, h.target_names) == (g.robot_names, g.action_names, g.target_names)
    assert (h.name, h.problem, h.notes) == (g.name, g.problem, g.notes)
    assert write(h) == text
    titles = next(line for line in text.split("\n") if not line.startswith("#"))
    assert titles == "robot,action,target" + (",weight" if (g.weights != 1).any() else "")


def test_weights_that_are_all_1_are_not_written() -> None:
    assert write(graph_of_edges([0], [0], [0], name="g")) == "# name: g\n# problem: bottleneck\nrobot,action,target\n1,1.1,1\n"
    assert "robot,action,target,weight\n1,1.1,1,2\n" in write(graph_of_edges([0], [0], [0], 2))


def test_what_has_no_place_in_the_format_is_refused() -> None:
    check_refused(UsageError, "no place for positions; use json", write, graph_of_edges([0], [0], [0], action_positions=[(0, 0)]))
    check_refused(UsageError, "no place for a choice of problems", write, graph_of_edges([0], [0], [0], problems=("bottleneck",)))
