"""Every hand-over and file keeps the program: same arrays where they can be read back, same optimum everywhere."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from coded import coded
from draws import draws
from exported import PROGRAMS, arrays_of, everything, highs_value, read_back, reference, rows_of, variables
from hypothesis import HealthCheck, given, settings, strategies as st

from waybound import InputError, Program, UsageError
from waybound.formulations.programs.export import write_program


@pytest.mark.parametrize("suffix", ["mps", "lp"])
@pytest.mark.parametrize("names", [True, False])
@pytest.mark.parametrize("name", PROGRAMS)
def test_files_have_the_same_optimum(name: str, names: bool, suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"model.{suffix}"
    write_program(PROGRAMS[name], path, names=names)
    assert highs_value(read_back(path)) == pytest.approx(reference(PROGRAMS[name]), abs=1e-6)
    assert ("x(0,1" in path.read_text()) == (names and name in ("mtz", "three-index"))


@pytest.mark.parametrize("suffix", ["mps", "lp"])
@pytest.mark.parametrize("sense", ["min", "max"])
def test_files_keep_a_quadratic_objective(suffix: str, sense: str, tmp_path: Path) -> None:
    program, path = everything(sense, quadratic=True), tmp_path / f"model.{suffix}"
    program.write(path)
    model = read_back(path)
    hessian = model.getModel().hessian_
    n = program.num_variables
    lower = sp.csc_matrix((hessian.value_, hessian.index_, hessian.start_), shape=(n, n)).toarray()
    assert np.array_equal(lower, np.tril(program.quadratic.toarray()))
    assert highs_value(model) == pytest.approx(reference(program), abs=1e-5)


@pytest.mark.parametrize("sense", ["min", "max"])
def test_cvxpy_and_mathopt_keep_a_quadratic_objective(sense: str) -> None:
    from ortools.math_opt.python import mathopt

    program = everything(sense, quadratic=True)
    model = program.to_cvxpy()
    model.solve(solver="CLARABEL")
    assert model.value == pytest.approx(reference(program), abs=1e-4)
    result = mathopt.solve(program.to_mathopt(), mathopt.SolverType.GSCIP)
    assert result.objective_value() == pytest.approx(reference(program), abs=1e-4)


def test_other_suffixes_and_crossing_sides_are_refused_and_leave_no_file(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"\.mps or \.lp"):
        everything().write(tmp_path / "model.nl")
    crossed = Program("crossed", "min", (variables("x", [2], [1], [1]),), ())
    with pytest.raises(InputError, match=r"bounds of variable x cross", check=coded("contradiction")):
        crossed.write(tmp_path / "model.mps")
    assert list(tmp_path.iterdir()) == []


@settings(max_examples=draws(60), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
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
