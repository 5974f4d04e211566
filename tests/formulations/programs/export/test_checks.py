"""What no hand-over lets pass: cones and products that it cannot hold, numbers that are none, sides that cross."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from exported import everything, reference, rows_of, variables

from waybound import InputError, Program, Rows, UnsupportedError


def test_pulp_refuses_a_quadratic_objective_and_only_cvxpy_takes_cones() -> None:

    with pytest.raises(UnsupportedError, match="quadratic"):
        everything("min", quadratic=True).to_pulp()
    cone = replace(everything("min"), cones=(object(),))
    for hand_over in (cone.to_pulp, cone.to_highs, cone.to_mathopt, lambda: cone.write("model.mps")):
        with pytest.raises(UnsupportedError, match="cone"):
            hand_over()


def test_nan_is_refused_by_name_by_every_hand_over(tmp_path: Path) -> None:
    row = rows_of("load", [[1.0, 1.0]], [0.0], [1.0])
    row.data[1] = math.nan
    bad = Program("bad", "min", (variables("x", [0, 0], [1, 1], [1, 1]),), (row,))
    for hand_over in (bad.to_pulp, bad.to_highs, bad.to_cvxpy, bad.to_mathopt, lambda: bad.write(tmp_path / "m.lp")):
        with pytest.raises(InputError, match=r"coefficient of x\[1\] in row load is not a finite number"):
            hand_over()
    price = Program("bad", "min", (variables("x", [0, 0], [1, 1], [1, math.nan]),), ())
    with pytest.raises(InputError, match=r"cost of variable x\[1\]"):
        price.to_highs()
    side = Program("bad", "min", (variables("x", [0, math.nan], [1, 1], [1, 1]),), ())
    with pytest.raises(InputError, match=r"lower bound of variable x\[1\]"):
        side.to_highs()
    assert list(tmp_path.iterdir()) == []


def test_a_column_that_stands_twice_in_a_row_is_added_up() -> None:
    row = Rows(
        "sum", indptr=np.array([0, 3], dtype=np.int32), indices=np.array([0, 1, 0], dtype=np.int32), data=np.array([1.0, 1.0, 2.0]),
        lower=np.array([6.0]), upper=np.array([math.inf]),
    )  # fmt: skip
    program = Program("twice", "min", (variables("x", [0, 0], [1, 9], [1, 2]),), (row,))
    assert reference(program) == pytest.approx(7.0)
    model = program.to_pulp()
    model.solve(__import__("pulp").PULP_CBC_CMD(msg=False))
    assert model.objective.value() == pytest.approx(7.0)
    cvx = program.to_cvxpy()
    cvx.solve(solver="HIGHS")
    assert cvx.value == pytest.approx(7.0)
