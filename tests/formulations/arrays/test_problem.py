"""A bare program is judged by its arrays alone, and refused where they hold no numbers."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from coded import coded
from programs import program

import waybound as wb
from waybound import Evidence, Exactness, InputError, Program, Rows, UsageError, Variables, solve
from waybound.formulations.arrays.problem import ArrayProblem
from waybound.formulations.certificate import certify
from waybound.formulations.problem import PROBLEMS
from waybound.formulations.programs.cones import Cones
from waybound.formulations.verified_bounds import verified_bound


def knapsack(**changes: Any) -> Program:
    """max 3 x0 + 2 x1 + 1 with 2 x0 + 3 x1 <= 10.5, x integer within [0,4] x [0,5]: 13 at (4,0); its relaxation 14.6667."""
    x = Variables("x", lower=np.zeros(2), upper=np.array([4.0, 5.0]), cost=np.array([3.0, 2.0]), integer=True)
    row = Rows(
        "size", indptr=np.array([0, 2], dtype=np.int32), indices=np.array([0, 1], dtype=np.int32), data=np.array([2.0, 3.0]),
        lower=np.array([-math.inf]), upper=np.array([10.5]),
    )  # fmt: skip
    return replace(Program("knapsack", "max", (x,), (row,), offset=1.0), **changes)


def test_a_row_that_adds_up_nothing_is_judged_by_its_own_size() -> None:
    (row,) = knapsack().rows
    empty = replace(row, data=np.zeros(2), lower=np.array([3e-8]), upper=np.array([math.inf]))
    assert not ArrayProblem(knapsack(rows=(empty,))).evaluate(np.array([4.0, 0.0])).feasible
    barely = replace(row, lower=np.array([10.5 + 3e-8]), upper=np.array([math.inf]), data=np.array([2.625, 3.0]))
    assert ArrayProblem(knapsack(rows=(barely,))).evaluate(np.array([4.0, 0.0])).feasible


def test_features_say_what_a_solver_must_take() -> None:
    assert ArrayProblem(knapsack()).features() == {"LP", "integer"}
    assert ArrayProblem(knapsack(quadratic=sp.eye(2, format="csr"))).features() == {"LP", "integer", "quadratic"}


def test_every_violation_is_named_with_its_amount() -> None:
    problem = ArrayProblem(knapsack())
    verdict = problem.evaluate(np.array([4.5, -1.0]))
    assert verdict.values[0] == pytest.approx(12.5)
    assert [(v.check, round(v.amount, 9)) for v in verdict.violations] == [("bounds", 0.5), ("bounds", 1.0), ("integrality", 0.5)]
    assert "x[0] is 4.5, outside [0, 4]" in verdict.violations[0].message
    verdict = problem.evaluate([4, 1])
    assert [(v.check, v.message, v.amount) for v in verdict.violations] == [("rows", "size is 11, outside [-inf, 10.5]", 0.5)]
    assert problem.evaluate([4, 0]).feasible and problem.evaluate([4, 0]).objective == 13.0


@pytest.mark.parametrize("bad", [[math.nan, 0.0], [math.inf, 0.0]])
def test_an_answer_that_holds_no_numbers_is_infeasible(bad: list[float]) -> None:
    assert not ArrayProblem(knapsack()).evaluate(bad).feasible


@pytest.mark.parametrize("bad", [[1.0], [[1.0, 2.0]], "ab", None, [1.0, 2.0, 3.0]])
def test_an_answer_of_another_shape_is_an_error(bad: Any) -> None:
    with pytest.raises(InputError, check=coded("wrong-shape")):
        ArrayProblem(knapsack()).evaluate(bad)


def test_quadratic_objectives_are_recomputed() -> None:
    problem = ArrayProblem(knapsack(quadratic=sp.csr_matrix(np.array([[2.0, 1.0], [1.0, 0.0]]))))
    assert problem.evaluate([2, 1]).objective == pytest.approx(1 + 8 + 0.5 * (2 * 4 + 2 * 2))


def test_answers_survive_json_and_frames() -> None:
    problem = ArrayProblem(knapsack())
    assert problem.answer_from_json(problem.answer_to_json(np.array([4.0, 0.1]))).tolist() == [4.0, 0.1]
    frame = problem.answer_to_frame([4.0, 0.0])
    assert frame["variable"].tolist() == ["x[0]", "x[1]"] and frame["value"].tolist() == [4.0, 0.0]
    wrongs: list[Any] = [{}, {"kind": "vector"}, {"kind": "vector", "values": [1.0]}, {"kind": "vector", "values": ["a", 1.0]}, []]
    for wrong in wrongs:
        with pytest.raises(InputError):
            problem.answer_from_json(wrong)


def test_digest_depends_on_every_array() -> None:
    x, row = knapsack().variables[0], knapsack().rows[0]
    others = [
        knapsack(), knapsack(sense="min"), knapsack(offset=2.0), knapsack(quadratic=sp.eye(2, format="csr")),
        knapsack(variables=(replace(x, integer=False),)), knapsack(variables=(replace(x, upper=np.array([4.0, 6.0])),)),
        knapsack(variables=(replace(x, cost=np.array([3.0, 2.5])),)), knapsack(rows=(replace(row, upper=np.array([10.0])),)),
        knapsack(rows=(replace(row, data=np.array([2.0, 3.5])),)), knapsack(rows=()),
    ]  # fmt: skip
    assert len({ArrayProblem(p).digest() for p in others}) == len(others)
    assert ArrayProblem(knapsack()).digest() == ArrayProblem(knapsack()).digest()


def test_bad_arrays_are_refused_by_name() -> None:
    x, row = knapsack().variables[0], knapsack().rows[0]
    for changes, message in (
        ({"variables": (replace(x, cost=np.array([math.nan, 1.0])),)}, r"cost of variable x\[0\] is not a finite number"),
        ({"variables": (replace(x, upper=np.array([math.nan, 1.0])),)}, r"upper bound of variable x\[0\] is not a number"),
        ({"variables": (replace(x, cost=np.zeros(3)),)}, "arrays of variables x have different lengths"),
        ({"rows": (replace(row, data=np.array([1.0, math.inf])),)}, r"coefficient of x\[1\] in row size is not a finite number"),
        ({"rows": (replace(row, indices=np.array([0, 2], dtype=np.int32)),)}, "a column that does not exist"),
        ({"rows": (replace(row, indptr=np.array([0, 1], dtype=np.int32)),)}, "row starts of rows size"),
        ({"rows": (replace(row, upper=np.zeros(2)),)}, "arrays of rows size have different lengths"),
        ({"offset": math.nan}, "constant of the objective"),
        ({"quadratic": sp.eye(3, format="csr")}, "quadratic part has the wrong shape"),
    ):
        with pytest.raises(InputError, match=message):
            ArrayProblem(knapsack(**changes))
    with pytest.raises(InputError, check=coded("unknown-name")):
        ArrayProblem(knapsack(sense="best"))


def test_what_bare_programs_cannot_do_is_refused() -> None:
    with pytest.raises(UsageError, check=coded("unsupported")):
        ArrayProblem(knapsack()).to_instance()
    x = knapsack().variables[0]
    with pytest.raises(InputError, check=coded("contradiction")):
        ArrayProblem(knapsack(variables=(replace(x, integer=False),))).restricted([({"variable": 0, "most": 1}, True)])


def test_compiling_gives_the_arrays_back_with_vectors_as_answers() -> None:
    problem = ArrayProblem(knapsack())
    assert problem.forms() == ["arrays"]
    compiled = problem.compile()
    assert compiled.problem is problem and compiled.exactness is Exactness.EXACT
    assert compiled.encode is not None and compiled.encode([4, 0]).tolist() == [4.0, 0.0]
    with pytest.raises(InputError, check=coded("wrong-shape")):
        compiled.encode([4])
    assert problem.compile(relax=True).exactness is Exactness.RELAXATION


@pytest.mark.parametrize("sense", ["min", "max"])
def test_row_duals_prove_the_value_of_the_relaxation_whatever_their_sign(sense: str) -> None:
    x = knapsack().variables[0]
    turned = knapsack() if sense == "max" else knapsack(sense="min", variables=(replace(x, cost=-x.cost),), offset=-1.0)
    problem = ArrayProblem(turned)
    relaxed = problem.compile(relax=True)
    assert relaxed.dual_evidence is not None
    model = relaxed.to_highs()
    model.run()
    duals = np.array(model.getSolution().row_dual)
    expected = (1 + 12 + 2 * 2.5 / 3) * (1 if sense == "max" else -1)
    for given in (duals, -duals) if sense == "max" else (duals,):
        evidence = relaxed.dual_evidence(given)
        assert evidence.kind == "lp-dual" and evidence.value == pytest.approx(expected)
        # No vector of whole numbers has a value between 14 and 14.6667, which the checker knows.
        assert verified_bound(problem, evidence) == pytest.approx(math.copysign(14.0, expected), abs=1e-6)


@pytest.mark.parametrize("solver", ["highs", "pulp"])
def test_a_bare_program_is_solved_checked_and_bounded(solver: str) -> None:
    solution = solve(knapsack(), solver, time_limit=20.0)
    assert solution.status == "optimal" and solution.objective == 13.0
    assert solution.answer.tolist() == [4.0, 0.0]
    assert solution.certificate.feasible and solution.certificate.bound is not None
    assert 13.0 - 1e-6 <= solution.certificate.bound <= 14.6667


def disc(**changes: Any) -> Cones:
    """|(x0, x1)| <= 2, as a block of one cone."""
    arrays = {"indptr": np.array([0, 0, 1, 2]), "indices": np.array([0, 1]), "data": np.ones(2), "offset": np.array([2.0, 0.0, 0.0])}
    return Cones("disc", **{"kind": "second-order", "width": 3, **arrays, **changes})


def test_cones_are_judged_like_rows() -> None:
    problem = ArrayProblem(knapsack(cones=(disc(),)))
    assert problem.features() == {"LP", "integer", "cones"}
    assert problem.evaluate(np.array([2.0, 0.0])).feasible
    (violation,) = problem.evaluate(np.array([3.0, 0.0])).violations
    assert (violation.check, violation.amount) == ("disc", pytest.approx(1.0))
    assert problem.program.residual(np.array([3.0, 0.0])) == pytest.approx(1.0)


def test_exponential_cones_hold_their_limits() -> None:
    cone = Cones("exp", "exponential", 3, np.arange(4), np.arange(3), np.ones(3), np.zeros(3))
    for point, inside in (((0, 1, 1), True), ((1, 1, 2.7), False), ((-1, 0, 1), True), ((1, 0, 9), False), ((0, -1, 1), False)):
        assert bool(cone.excess(np.array(point, dtype=float))[0] <= 0) is inside


def test_the_digest_covers_cones() -> None:
    plain = ArrayProblem(knapsack()).digest()
    one, other = (ArrayProblem(knapsack(cones=(disc(offset=np.array([r, 0.0, 0.0])),))).digest() for r in (1.0, 2.0))
    assert len({plain, one, other}) == 3


@pytest.mark.parametrize(
    "wrong", [{"kind": "round"}, {"width": 2}, {"kind": "exponential", "width": 2}, {"indices": np.array([0, 7])}, {"data": np.ones(3)}]
)
def test_malformed_cones_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="cones disc"):
        ArrayProblem(knapsack(cones=(disc(**wrong),)))


def test_a_cone_program_is_solved_and_checked() -> None:
    x = Variables("x", lower=np.full(2, -9.0), upper=np.full(2, 9.0), cost=np.array([3.0, 4.0]))
    solution = solve(Program("reach", "max", (x,), (), cones=(disc(),)), "cvxpy")
    assert solution.objective == pytest.approx(10.0, abs=1e-6)
    assert solution.certificate.feasible
    assert solution.bound_kind == "claimed"


def small(cost, upper, row, low, high, integer=()) -> ArrayProblem:
    """One row over variables from 0 to ``upper``, each a block of its own."""
    return ArrayProblem(program(cost, [row], low, high, 0, upper, integer=integer))


@pytest.mark.parametrize("most", [1.0, 1e3, 1e6])
def test_a_row_is_tested_by_its_own_size_and_not_by_how_far_its_variables_may_go(most):
    asked = small([1.0], [most], [1.0], 1.0, math.inf)
    assert not asked.evaluate([0.99]).feasible
    assert asked.evaluate([1.0 - 5e-7]).feasible
    assert not small([1.0, 1.0], [most, 1.0], [1.0, -most], -math.inf, 0.0, {1}).evaluate([1.0, 0.0]).feasible


def test_whole_numbers_are_known_exactly():
    asked = small([1.0], [1e7], [1.0], 2e6, math.inf, {0})
    certificate = certify(asked, asked.evaluate([2e6 + 1]), [Evidence("lp-dual", "by hand", 2e6, {"duals": [1.0]})])
    assert certificate.bound == 2e6 and certificate.observed_ratio > 1.0 and certificate.gap > 0.0


def test_its_facts_are_its_sizes() -> None:
    assert ArrayProblem(knapsack()).facts() == {"variables": 2, "rows": 1, "entries": 2}


def test_a_restricted_program_shares_all_but_its_bounds_with_the_whole() -> None:
    whole = ArrayProblem(program([1, 2], [[1, 1]], 0, 9, [0.5, -4], 9, integer=[0, 1]))
    part = whole.restricted([({"variable": 0, "most": 3}, True), ({"variable": 1, "most": -2}, False), ({"variable": 1, "most": 50}, True)])
    assert (part.program.lower.tolist(), part.program.upper.tolist()) == ([0.5, -1.0], [3.0, 9.0])
    assert whole.program.upper.tolist() == [9.0, 9.0]
    assert part.program.data is whole.program.data and part.program.row_upper is whole.program.row_upper
    assert part.program.variables[1].lower.tolist() == [-1.0]
    assert part.digest() != whole.digest()
    assert whole.evaluate([4.0, 0.0]).feasible and not part.evaluate([4.0, 0.0]).feasible and part.evaluate([3.0, 0.0]).feasible


def test_only_a_bare_program_is_read_as_arrays():
    with pytest.raises(UsageError, match="demo-tiny is no bare program, so it cannot be read as arrays"):
        wb.read("demo-tiny", problem="arrays")
    with pytest.raises(UsageError, match="has no setting 'vehicles'"):
        PROBLEMS["arrays"](program([1.0], [[1.0]], 0.0, 1.0), "arrays", {"vehicles": 3})
