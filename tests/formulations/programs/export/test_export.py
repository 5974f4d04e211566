"""Every hand-over and file keeps the program: same arrays where they can be read back, same optimum everywhere."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from oracles import SQUARE_4, TW_4, routing

from waybound.formulations.programs.program import Program, Rows, Variables
from waybound.instances.errors import InputError, UnsupportedError, UsageError


def rows_of(name: str, matrix: Any, lower: Any, upper: Any) -> Rows:
    m = sp.csr_matrix(np.atleast_2d(np.asarray(matrix, dtype=float)))
    return Rows(
        name, indptr=m.indptr.astype(np.int32), indices=m.indices.astype(np.int32), data=m.data,
        lower=np.asarray(lower, dtype=float), upper=np.asarray(upper, dtype=float),
    )  # fmt: skip


def variables(name: str, lower: Any, upper: Any, cost: Any, integer: bool = False) -> Variables:
    low, high, price = (np.asarray(v, dtype=float) for v in (lower, upper, cost))
    return Variables(name, lower=low, upper=high, cost=price, integer=integer)


def everything(sense: str = "max", quadratic: bool = False) -> Program:
    """Ranges, equalities, one-sided and free rows; free, fixed, negative, half-open and integer variables; a constant.

    Maximisation of -(its minimisation), so that both senses have the optimum of opposite sign.
    """
    sign = 1.0 if sense == "min" else -1.0
    x = variables("x", [-math.inf, 2.5, -7.0, -math.inf], [math.inf, 2.5, -3.0, 4.0], sign * np.array([1.0, 2.0, -1.0, -0.5]))
    k = variables("k", [0.0, -5.0, 2.0], [1.0, math.inf, 9.0], sign * np.array([-3.0, 1.0, 0.0]), integer=True)
    rows = (
        rows_of("range", [[1, 0, 1, 0, 1, 0, 0]], [-6.0], [5.5]),
        rows_of("sides", [[0, 1, 0, 1, 0, 1, 0], [2, 0, 0, 1, 0, 0, 1]], [-math.inf, 1 / 3], [8.1, math.inf]),
        rows_of("equal", [[1, 0, 0, 0, 0, 1, -1]], [0.1], [0.1]),
        rows_of("free", [[1, 1, 1, 1, 1, 1, 1]], [-math.inf], [math.inf]),
    )
    q = None
    if quadratic:
        q = sp.csr_matrix(sign * np.diag([2.0, 0, 1.0, 0, 0, 0, 0]) + sign * sp.csr_matrix(([0.5, 0.5], ([0, 2], [2, 0])), shape=(7, 7)))
        k = variables("k", [0.0, -5.0, 2.0], [1.0, 90.0, 9.0], sign * np.array([-3.0, 1.0, 0.0]))
    return Program("everything", sense, (x, k), rows, offset=sign * 12.25, quadratic=q)


def highs_value(model: Any) -> float:
    import highspy

    model.setOptionValue("output_flag", False)
    model.setOptionValue("mip_rel_gap", 0.0)
    model.run()
    assert model.getModelStatus() == highspy.HighsModelStatus.kOptimal
    return float(model.getInfo().objective_function_value)


def read_back(path: Path) -> Any:
    import highspy

    model = highspy.Highs()
    model.setOptionValue("output_flag", False)
    assert model.readModel(str(path)) == highspy.HighsStatus.kOk
    return model


def arrays_of(model: Any) -> dict[str, Any]:
    lp = model.getLp()
    matrix = sp.csc_matrix((lp.a_matrix_.value_, lp.a_matrix_.index_, lp.a_matrix_.start_), shape=(lp.num_row_, lp.num_col_))
    return {
        "cost": lp.col_cost_, "lower": lp.col_lower_, "upper": lp.col_upper_, "row_lower": lp.row_lower_, "row_upper": lp.row_upper_,
        "matrix": matrix.toarray(), "offset": lp.offset_, "sense": "max" if "Max" in str(lp.sense_) else "min",
        "integer": [str(v).endswith("kInteger") for v in lp.integrality_] or [False] * lp.num_col_,
    }  # fmt: skip


SQUARE = routing(xy=SQUARE_4, sites={**TW_4, "demand": [0, 1, 2, 1, 1], "service": 0.5}, count=3, capacity=3, max_duration=30.0)
PROGRAMS = {
    "everything-min": everything("min"),
    "everything-max": everything("max"),
    "mtz": routing(xy=SQUARE_4, sites={**TW_4, "demand": [0, 1, 2, 1, 1]}, count=3, capacity=3).compile("two-index-mtz").program,
    "three-index": SQUARE.compile("three-index").program,
}


def reference(program: Program) -> float:
    return highs_value(program.to_highs())


@pytest.mark.parametrize("name", PROGRAMS)
def test_mps_read_back_by_highs_holds_the_same_arrays_to_the_last_bit(name: str, tmp_path: Path) -> None:
    program, path = PROGRAMS[name], tmp_path / "model.mps"
    program.write(path)
    back = arrays_of(read_back(path))
    kept = np.isfinite(program.row_lower) | np.isfinite(program.row_upper)
    for key in ("cost", "lower", "upper", "integer", "offset", "sense"):
        assert np.array_equal(back[key], getattr(program, key)), key
    assert np.array_equal(back["matrix"], program.matrix.toarray()[kept])
    assert np.array_equal(back["row_lower"], program.row_lower[kept])
    assert np.array_equal(back["row_upper"], program.row_upper[kept])


@pytest.mark.parametrize("name", PROGRAMS)
def test_lp_read_back_by_highs_holds_the_same_variables_and_rows(name: str, tmp_path: Path) -> None:
    program, path = PROGRAMS[name], tmp_path / "model.lp"
    program.write(path)
    back = arrays_of(read_back(path))
    for key in ("cost", "lower", "upper", "integer", "offset", "sense"):
        assert np.array_equal(back[key], getattr(program, key)), key
    expected = []  # a range is two rows, a free row none
    for row, low, high in zip(program.matrix.toarray(), program.row_lower, program.row_upper, strict=True):
        if low == high:
            expected.append((row.tolist(), low, high))
        else:
            expected.extend((row.tolist(), a, b) for a, b in ((-math.inf, high), (low, math.inf)) if math.isfinite(a) or math.isfinite(b))
    found = list(zip(back["matrix"].tolist(), back["row_lower"], back["row_upper"], strict=True))
    assert found == expected


@pytest.mark.parametrize("suffix", ["mps", "lp"])
@pytest.mark.parametrize("names", [True, False])
@pytest.mark.parametrize("name", PROGRAMS)
def test_files_have_the_same_optimum(name: str, names: bool, suffix: str, tmp_path: Path) -> None:
    from waybound.formulations.programs.export import write_program

    path = tmp_path / f"model.{suffix}"
    write_program(PROGRAMS[name], path, names=names)
    assert highs_value(read_back(path)) == pytest.approx(reference(PROGRAMS[name]), abs=1e-6)
    text = path.read_text()
    assert ("x(0,1" in text) == (names and name in ("mtz", "three-index"))


@pytest.mark.parametrize("suffix", ["mps", "lp"])
@pytest.mark.parametrize("sense", ["min", "max"])
def test_files_keep_a_quadratic_objective(suffix: str, sense: str, tmp_path: Path) -> None:
    program, path = everything(sense, quadratic=True), tmp_path / f"model.{suffix}"
    program.write(path)
    model = read_back(path)
    hessian = model.getModel().hessian_
    n = program.num_variables
    lower = sp.csc_matrix((hessian.value_, hessian.index_, hessian.start_), shape=(n, n)).toarray()
    assert program.quadratic is not None
    assert np.array_equal(lower, np.tril(program.quadratic.toarray()))
    assert highs_value(model) == pytest.approx(reference(program), abs=1e-5)


def test_both_senses_of_a_program_have_opposite_optima() -> None:
    assert reference(everything("max")) == pytest.approx(-reference(everything("min")), abs=1e-9)
    assert reference(everything("max", quadratic=True)) == pytest.approx(-reference(everything("min", quadratic=True)), abs=1e-5)


@pytest.mark.parametrize("name", PROGRAMS)
def test_pulp_has_the_same_optimum_and_columns(name: str) -> None:
    import pulp

    program = PROGRAMS[name]
    model = program.to_pulp()
    assert pulp.LpStatus[model.solve(pulp.PULP_CBC_CMD(msg=False, gapRel=0.0))] == "Optimal"
    assert pulp.value(model.objective) == pytest.approx(reference(program), abs=1e-6)
    assert [int(v.name[1:]) for v in model.variables()] == list(range(program.num_variables))
    x = np.array([v.varValue for v in model.variables()])
    assert program.residual(x) <= 1e-6


def test_pulp_keeps_the_bounds_of_binaries() -> None:
    program = Program("must", "min", (variables("x", [1.0, 0.0], [1.0, 0.0], [2.0, -1.0], integer=True),), ())
    model = program.to_pulp()
    assert [(v.lowBound, v.upBound, v.cat) for v in model.variables()] == [(1.0, 1.0, "Integer"), (0.0, 0.0, "Integer")]
    model.solve(__import__("pulp").PULP_CBC_CMD(msg=False))
    assert model.objective.value() == 2.0


@pytest.mark.parametrize("name", PROGRAMS)
def test_cvxpy_has_the_same_optimum_and_columns(name: str) -> None:
    program = PROGRAMS[name]
    model = program.to_cvxpy()
    model.solve(solver="HIGHS")
    assert model.status == "optimal"
    assert model.value == pytest.approx(reference(program), abs=1e-4)
    x = np.concatenate([np.atleast_1d(model.var_dict[b.name].value) for b in program.variables if b.size])
    assert program.residual(x) <= 1e-5


@pytest.mark.parametrize("name", PROGRAMS)
def test_mathopt_has_the_same_optimum(name: str) -> None:
    from ortools.math_opt.python import mathopt

    program = PROGRAMS[name]
    result = mathopt.solve(program.to_mathopt(), mathopt.SolverType.GSCIP)
    assert result.termination.reason == mathopt.TerminationReason.OPTIMAL
    assert result.objective_value() == pytest.approx(reference(program), abs=1e-4)
    values = result.variable_values()
    x = np.array([values[v] for v in sorted(values, key=lambda v: v.id)])
    assert program.residual(x) <= 1e-5


@pytest.mark.parametrize("sense", ["min", "max"])
def test_cvxpy_and_mathopt_keep_a_quadratic_objective(sense: str) -> None:
    from ortools.math_opt.python import mathopt

    program = everything(sense, quadratic=True)
    model = program.to_cvxpy()
    model.solve(solver="CLARABEL")
    assert model.value == pytest.approx(reference(program), abs=1e-4)
    result = mathopt.solve(program.to_mathopt(), mathopt.SolverType.GSCIP)
    assert result.objective_value() == pytest.approx(reference(program), abs=1e-4)


def test_pulp_refuses_a_quadratic_objective_and_only_cvxpy_takes_cones() -> None:
    from dataclasses import replace

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


def test_other_suffixes_and_crossing_sides_are_refused_and_leave_no_file(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"\.mps or \.lp"):
        everything().write(tmp_path / "model.nl")
    crossed = Program("crossed", "min", (variables("x", [2], [1], [1]),), ())
    with pytest.raises(InputError, match=r"bounds of variable x cross"):
        crossed.write(tmp_path / "model.mps")
    assert list(tmp_path.iterdir()) == []


def test_names_are_different_and_valid_whatever_the_sites_are_called() -> None:
    from waybound.formulations.programs.export._names import readable_names

    given_names = ["x[a,b]", "x[a b]", "x[a-b]", "e5", "E", "free", "3rd", "infinity1", "", "x" * 300, "x" * 300, "ü[1]", "time-link[1,2]"]
    made = readable_names(len(given_names), lambda k: given_names[k], "x")
    assert len(set(made)) == len(made)
    assert made[0] == "x(a,b)" and made[-1] == "time_link(1,2)"
    assert all(name.isascii() and " " not in name and "[" not in name for name in made)
    assert made[3] == "x_e5" and made[5] == "x_free" and made[6] == "x_3rd"


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(data=st.data())
def test_random_programs_survive_both_formats(data: st.DataObject, tmp_path: Path) -> None:
    """Any mixture of sides comes back: from MPS to the bit (ranges to a rounding), from LP with the same columns."""
    n, m = data.draw(st.integers(1, 5)), data.draw(st.integers(0, 4))
    number = st.floats(-1e6, 1e6, allow_subnormal=False).filter(lambda v: v == 0 or abs(v) > 1e-8)
    vector = lambda size: np.array(data.draw(st.lists(number, min_size=size, max_size=size)))  # noqa: E731

    def sides(size: int) -> tuple[Any, Any]:
        a, b = vector(size), vector(size)
        low, high = np.minimum(a, b), np.maximum(a, b)
        low[np.array(data.draw(st.lists(st.booleans(), min_size=size, max_size=size)), dtype=bool)] = -math.inf
        high[np.array(data.draw(st.lists(st.booleans(), min_size=size, max_size=size)), dtype=bool)] = math.inf
        return low, high

    blocks = (variables("x", *sides(n), vector(n)), variables("k", *sides(2), vector(2), integer=True))
    matrix = vector(m * (n + 2)).reshape(m, n + 2) if m else np.zeros((0, n + 2))
    low, high = sides(m)
    program = Program(
        "random",
        data.draw(st.sampled_from(["min", "max"])),
        blocks,
        (rows_of("r", matrix, low, high),) if m else (),
        offset=float(vector(1)[0]),
    )
    for suffix in ("mps", "lp"):
        path = tmp_path / f"m.{suffix}"
        program.write(path)
        back = arrays_of(read_back(path))
        for key in ("cost", "lower", "upper", "integer", "sense", "offset"):
            assert np.array_equal(back[key], getattr(program, key)), (suffix, key)
        if suffix == "mps" and m:
            kept = np.isfinite(low) | np.isfinite(high)
            assert np.array_equal(back["matrix"], program.matrix.toarray()[kept])
            assert np.allclose(back["row_lower"], low[kept], rtol=1e-15, atol=1e-9)
            assert np.allclose(back["row_upper"], high[kept], rtol=1e-15, atol=1e-9)
