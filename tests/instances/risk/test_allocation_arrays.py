from typing import Any

import numpy as np
import pandas as pd
import pytest
from risk_problems import problem

import waybound as wb
from waybound.instances.errors import InputError

TWO: dict[str, Any] = {
    "quantities": np.eye(2), "covariance": np.ones(2), "limits": [5.0, 5.0], "cost": [1.0, 3.0], "total": 0.1, "lower": 0.0,
    "rows": [[1.0, 1.0]], "row_upper": 7.0, "sense": "max", "name": "stalling",
}  # fmt: skip


def test_arrays_make_the_same_as_a_file() -> None:
    assert wb.RiskAllocation.from_arrays(**TWO).digest() == problem().digest()
    one = wb.RiskAllocation.from_arrays(**{**TWO, "limits": 5, "covariance": np.eye(2)})
    assert one.digest() == problem().digest()


def test_frames_are_put_in_order_by_their_labels() -> None:
    x, y = ["left", "right"], ["front", "rear"]
    frames = {
        "quantities": pd.DataFrame([[1.0, 0.5], [0.0, 2.0]], index=y, columns=x),
        "covariance": pd.DataFrame([[4.0, 0.3], [0.3, 1.0]], index=y[::-1], columns=y[::-1]),
        "chance": pd.DataFrame([[1.0, 0.0], [0.0, -1.0], [1.0, 1.0]], index=["a", "b", "c"], columns=y[::-1]),
        "limits": pd.Series([3.0, 2.0, 1.0], index=["c", "b", "a"]), "cost": pd.Series({"right": 2.0, "left": 1.0}),
        "rows": pd.DataFrame([[1.0, -1.0]], columns=x[::-1], index=["even"]), "row_upper": pd.Series({"even": 4.0}),
        "each": pd.Series({"b": 0.02, "a": 0.01, "c": 0.03}), "upper": pd.Series({"right": 8.0, "left": 9.0}), "lower": -1.0,
    }  # fmt: skip
    made = wb.RiskAllocation.from_arrays(**frames, total=0.05, budgets={"step": (["c", "a"], 0.04)})
    given = made.to_instance()
    assert (given.decision_names, given.quantities.names, given.chance.names, given.constraint_names) == (
        ("left", "right"), ("front", "rear"), ("a", "b", "c"), ("even",),
    )  # fmt: skip
    assert given.quantities.covariance.tolist() == [[1.0, 0.3], [0.3, 4.0]]
    assert given.chance.rows.quantities.tolist() == [[0.0, 1.0], [-1.0, 0.0], [1.0, 1.0]]
    assert (given.chance.limits.tolist(), made.linear.tolist(), made.rows.tolist()) == ([1.0, 2.0, 3.0], [1.0, 2.0], [[-1.0, 1.0]])
    assert (given.risk.each.tolist(), given.upper.tolist(), given.lower.tolist()) == ([0.01, 0.02, 0.03], [9.0, 8.0], [-1.0, -1.0])
    assert given.risk.budgets[0].constraints.tolist() == [2, 0]
    shown = made.answer_to_json(made.answer_of([0.0, 0.0]))
    assert list(shown["decision"]) == ["left", "right"]


def test_alternatives_are_rows_of_one_constraint() -> None:
    sides = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]])
    made = wb.RiskAllocation.from_arrays(
        np.eye(2), [0.1, 0.1], [-1.0, -1.0, 3.0], [0.0, 1.0], chance=sides, constraint=["box", "box", "wall"], total=0.05, lower=-3, upper=3
    )
    assert made.disjunctive and made.names == ("box", "wall") and made.constraint.tolist() == [0, 0, 1]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"cost": [1.0, 2.0, 3.0]}, "cost must have one entry a decision; expected 2; found 3"),
        ({"covariance": np.eye(3)}, "covariance must have one entry a quantity; expected 2 x 2; found 3 x 3"),
        ({"limits": [1.0]}, "limits must have one entry a chance constraint; expected 2; found 1"),
        ({"total": None}, "risk says no limit; expected total, each or budgets"),
        (
            {"cost": pd.Series({"x1": 1.0, "z": 3.0}), "quantities": pd.DataFrame(np.eye(2), columns=["x1", "x2"])},
            "cost lacks the decision x2; .*z",
        ),
        ({"cost": pd.Series([1.0, 3.0], index=["x1", "x1"])}, "decision"),
        ({"budgets": {"step": ([5], 0.1)}}, "budget step names an unknown chance constraint; found 5"),
        ({"budgets": {"step": 0.1}}, "budget step must be a pair"),
        ({"constraint": ["a"]}, "constraint must say for each chance row"),
        ({"covariance": [[1.0, 2.0], [2.0, 1.0]]}, "not positive semidefinite"),
        ({"quantities": [["a"]]}, "quantities must hold numbers"),
        ({"total": 2.0}, "the total risk must lie between 0 and 1"),
    ],
)
def test_what_does_not_fit_is_said(changes: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        wb.RiskAllocation.from_arrays(**{**TWO, **changes})
