import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles import SQUARE_4, routing
from programs import program
from sata_cases import CASES

import waybound as wb
from waybound import Exactness, UsageError
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.programs.compiled import Compiled
from waybound.formulations.programs.cones import Cones
from waybound.formulations.programs.program import INTEGERS, LINEAR, Program

ROUTES = [[1, 2], [3, 4]]


def squares() -> Compiled:
    return routing(xy=SQUARE_4, count=2, capacity=2, sites={"demand": 1.0}).compile("two-index-time-flow")


def test_relaxing_drops_integrality_and_nothing_else() -> None:
    compiled = squares()
    relaxed = compiled.relaxed()
    assert (compiled.program.features(), relaxed.program.features()) == (INTEGERS, LINEAR)
    for name in ("cost", "lower", "upper", "row_lower", "row_upper", "indptr", "indices", "data"):
        assert np.array_equal(getattr(relaxed.program, name), getattr(compiled.program, name)), name
    assert (relaxed.form, relaxed.problem) == (compiled.form, compiled.problem) == ("two-index-time-flow", compiled.problem)
    assert compiled.program.features() == INTEGERS  # the one that was given is as it was


def test_a_relaxed_one_decodes_encodes_and_proves_as_before() -> None:
    compiled, relaxed = squares(), squares().relaxed()
    assert compiled.encode is not None and relaxed.encode is not None and relaxed.dual_evidence is not None
    point = relaxed.encode(wb.Routes.of(ROUTES))
    assert np.array_equal(point, compiled.encode(wb.Routes.of(ROUTES)))
    assert relaxed.program.residual(point) <= 1e-9
    assert relaxed.decode(point).canonical() == wb.Routes.of(ROUTES).canonical()
    duals = np.random.default_rng(1).normal(size=compiled.program.num_rows)
    assert relaxed.dual_evidence(duals).data == compiled.dual_evidence(duals).data


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (Exactness.EXACT, Exactness.RELAXATION),
        (Exactness.RELAXATION, Exactness.RELAXATION),
        (Exactness.RESTRICTION, Exactness.NEITHER),
        (Exactness.NEITHER, Exactness.NEITHER),
    ],
)
def test_the_flags_of_form_and_relaxation_compose(before: Exactness, after: Exactness) -> None:
    assert replace(squares(), exactness=before).relaxed().exactness is after


def test_what_is_not_linear_is_not_relaxed() -> None:
    quadratic = ArrayProblem(program([1, 1], [[1, 1]], 1, 9, integer=[0], quadratic=[[2, 0], [0, 2]])).compile()
    ball = Cones("ball", "second-order", 3, np.array([0, 0, 1, 2]), np.array([0, 1]), np.ones(2), np.array([1.0, 0.0, 0.0]))
    round_ = ArrayProblem(replace(program([1, 1], [[1, 1]], -9, 9, -math.inf), cones=(ball,))).compile()
    for compiled in (quadratic, round_, wb.WinnerTakesAllSATA(CASES["S3"].graph).compile("product")):
        with pytest.raises(UsageError, match=f"form {compiled.form} is not linear; only linear programs are relaxed"):
            compiled.relaxed()


@pytest.mark.parametrize("suffix", [".mps", ".lp"])
def test_it_is_written_as_its_program_is(suffix: str, tmp_path: Path) -> None:
    compiled = squares()
    compiled.write(tmp_path / f"made{suffix}")
    compiled.program.write(tmp_path / f"program{suffix}")
    text = (tmp_path / f"made{suffix}").read_text()
    assert text == (tmp_path / f"program{suffix}").read_text()
    assert "x(0,1)" in text or "x[0,1]" in text


def test_it_is_handed_over_as_its_program_is() -> None:
    compiled = squares()
    size = compiled.program.num_variables
    assert compiled.to_highs().getNumCol() == len(compiled.to_pulp().variables()) == size
    assert sum(v.size for v in compiled.to_cvxpy().variables()) == len(list(compiled.to_mathopt().variables())) == size


def test_it_says_what_it_is_of_and_how_exact() -> None:
    assert repr(replace(squares(), exactness=Exactness.RESTRICTION)).startswith("<Compiled ")
    assert "restriction: <Program two-index-time-flow: MILP" in repr(replace(squares(), exactness=Exactness.RESTRICTION))


def test_a_bare_program_and_its_compilation_are_solved_alike() -> None:
    bare: Program = program([3, 2], [[2, 3]], -math.inf, 10.5, 0, [4, 5], integer=[0, 1], sense="max")
    one, other = wb.solve(bare, "highs"), wb.solve(ArrayProblem(bare).compile(), "highs")
    assert one.objective == other.objective == 12.0
    assert (one.status, one.form, one.bound) == (other.status, other.form, other.bound)
