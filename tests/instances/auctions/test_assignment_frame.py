from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pytest

from waybound import AssignmentInstance, InputError

INF = np.inf
PAIRS = pd.DataFrame({"robot": ["r1", "r1", "r2"], "bin": ["a", "b", "a"], "cost": [2.0, 3.0, 1.0]})
MATRIX = PAIRS.pivot(index="robot", columns="bin", values="cost")


@pytest.mark.parametrize(
    "frame",
    [
        PAIRS, PAIRS[["cost", "bin", "robot"]], PAIRS.rename(columns=str.upper), PAIRS.rename(columns={"cost": " Cost"}),
        PAIRS.set_index(["robot", "bin"]), PAIRS.set_index("robot"), PAIRS.astype("string"), PAIRS.astype({"robot": "category"}),
        pd.concat([PAIRS, pd.DataFrame({"robot": ["r1"]})]), MATRIX, MATRIX.astype(object), MATRIX.astype("Float64"), MATRIX.fillna(INF),
        MATRIX.astype(object).where(MATRIX.notna(), "-"), MATRIX.reset_index(),
        MATRIX.reset_index().rename(columns={"robot": "Robot"})[["a", "Robot", "b"]],
        MATRIX.reset_index().rename(columns={"robot": "robot/bin"}), MATRIX.reset_index().rename(columns={"robot": "who"}),
    ],
)  # fmt: skip
def test_pairs_in_any_order_and_case_and_matrices_are_the_same_data(frame: pd.DataFrame) -> None:
    made = AssignmentInstance.from_frame(frame)
    assert (made.robot_names, made.bin_names) == (("r1", "r2"), ("a", "b"))
    assert made.matrix().tolist() == [[2.0, 3.0], [1.0, INF]]


def test_columns_of_the_csv_format_are_taken() -> None:
    frame = PAIRS.assign(filled=[1, INF, 1], robot_x=[0, 0, 4], **{"Robot-Y": [1, 1, 5]})
    made = AssignmentInstance.from_frame(frame, robot_names=("u", "v"))
    assert made.filled is not None and made.filled.tolist() == [1.0, INF] and made.robot_names == ("u", "v")
    assert made.robot_positions is not None and made.robot_positions.tolist() == [[0, 1], [4, 5]] and made.bin_positions is None


def test_a_row_with_a_robot_or_a_bin_alone_tells_that_there_is_one() -> None:
    made = AssignmentInstance.from_frame(pd.DataFrame({"robot": [1, 2, None], "bin": ["a", None, "c"], "cost": [1, None, None]}))
    assert (made.robot_names, made.bin_names, made.num_pairs) == (("1", "2"), ("a", "c"), 1)


def test_bins_that_differ_in_case_alone_are_two() -> None:
    assert AssignmentInstance.from_frame(pd.DataFrame({"A": [1], "a": [2]})).bin_names == ("A", "a")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda f: f.assign(note="x"), "column 'note' is unknown; leave it out; expected robot, bin, cost, filled"),
        (lambda f: f.assign(filed=1), "column 'filed' is unknown; did you mean 'filled'"),
        (lambda f: f.rename(columns={"bin": "task"}), "column 'task' is unknown; rename it: there is no bin; expected"),
        (lambda f: f.rename(columns={"cost": "price"}), "column 'price' is unknown; rename it: there is no cost"),
        (lambda f: f.rename(columns={"robot": "who", "bin": "what"}), "'who' is unknown; rename it: there is no robot and no bin"),
        (lambda f: f[["robot", "cost"]], "column bin is missing; expected robot, bin, cost; found robot, cost"),
        (lambda f: f.assign(Cost=1), "column cost stands twice"),
        (lambda f: pd.concat([f, f]), "the pair of robot r1 and bin a stands twice"),
        (lambda f: f.assign(cost=[1, "x", 2]), "column cost holds no number in row 2; expected a number, or inf; found 'x'"),
        (lambda f: f.assign(cost=[1, None, 2]), "row 2 has no cost"),
        (lambda f: f.assign(bin=["a", None, "b"]), "row 2 has a cost, and no pair"),
        (lambda f: pd.concat([f, pd.DataFrame({"filled": [1]})])[["robot", "bin", "cost"]], "row 4 names neither"),
        (lambda f: f.assign(filled=[1, 2, 3]), "filled of bin a is another one in row 3 than in row 1; expected 1; found 3"),
        (lambda f: f.assign(filled=[1, None, 1]), "filled of bin b is missing in row 2"),
        (lambda f: f.assign(filled=[1, -2, 1]), "the time until bin b is full"),
        (lambda f: pd.concat([f, pd.DataFrame({"robot": ["r3"]})]).assign(filled=1), "filled stands in row 4, which names no bin"),
        (lambda f: f.assign(bin_x=0), "places of bins need both bin-x and bin-y"),
        (lambda f: f.iloc[:0], "there are no robots"),
        (lambda f: f[["robot", "bin"]], "column cost is missing"),
        (lambda f: MATRIX.assign(a=["u", "v"], b=["x", "y"]), "column 'b' holds no number in row 1; expected columns robot, bin and cost"),
        (lambda f: MATRIX.assign(b=[1.0, -INF]), "the cost of robot r2 and bin b must be a number"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named(change: Callable[[pd.DataFrame], Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        AssignmentInstance.from_frame(change(PAIRS))
