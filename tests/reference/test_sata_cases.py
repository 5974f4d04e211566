"""The reference cases of simultaneous action and target assignment on every installed solver that can take them."""

import itertools
import json
import math
from typing import Any

import numpy as np
import pytest
from sata_cases import CASES

import waybound as wb
from waybound import BottleneckSATA, UnsupportedError, WinnerTakesAllSATA
from waybound.formulations.certificate import check_certificate
from waybound.formulations.programs.program import INTEGERS, LINEAR, QUADRATIC
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.solvers.backend import BACKENDS, Control, Options, RawResult
from waybound.solvers.program_backend import takers

EXACT = 1e-6
FORMS = ("facility-location", "strong-linearisation", "weak-linearisation", "product")
LINEAR_FORMS = FORMS[:3]
MILP = [*takers(INTEGERS), "pulp:HiGHS"]
LP = [*takers(LINEAR), "pulp:HiGHS"]
MIQP = takers(INTEGERS | QUADRATIC)

COUNTED = ("mathopt:cp-sat",)
"""It refuses continuous variables in steps other than 1."""


def pairs(solvers: list[str]) -> list[Any]:
    """Every case on every solver; in the fast suite all on HiGHS, half on others, a third on solvers within a solver, not the same ones."""
    every = itertools.product(enumerate(CASES), enumerate(solvers))
    step = lambda solver: 1 if solver == "highs" else 3 if ":" in solver else 2  # noqa: E731
    apart = lambda k, number, solver: pytest.mark.long if (k + number) % step(solver) else ()  # noqa: E731
    return [pytest.param(case, solver, marks=apart(k, number, solver)) for (k, case), (number, solver) in every]


def run(solver: str, program) -> RawResult:
    """What a solver says of a program, in this process."""
    base, _, variant = solver.partition(":")
    backend = BACKENDS[base](variant) if variant else BACKENDS[base]()
    try:
        result = backend.run(program, Options(time_limit=60.0), Control())
    except UnsupportedError as fault:
        if solver in COUNTED:
            assert "continuous variables" in str(fault)
            pytest.skip(str(fault))
        raise
    assert result.status == "optimal", result
    assert program.residual(result.answer) <= 1e-5
    return result


def check_answer(made: wb.Compiled, result: RawResult, value: float) -> None:
    """The answer is feasible and of the known value, recomputed from the data; the solver's bound is on its other side."""
    judged = made.problem.evaluate(made.decode(result.answer))
    assert judged.feasible, judged.violations
    assert judged.values[0] == pytest.approx(value, abs=EXACT)
    assert result.bound is None or result.bound >= value - EXACT


def proved(case: str, bound: float) -> float:
    """What a bound on whole choices proves: where all weights are whole, so is every value."""
    rows = np.array([row for robot in CASES[case].robots for row in robot])
    return math.floor(bound + EXACT) if (rows == np.round(rows)).all() else bound


def test_the_suite_runs_on_all_solvers() -> None:
    assert set(MILP) >= {"cpsat", "cvxpy:HIGHS", "highs", "mathopt:highs", "mathopt:gscip", "mathopt:cp-sat", "pulp"}
    assert set(LP) >= {"cvxpy:CLARABEL", "cvxpy:SCS", "cvxpy:HIGHS", "highs", "mathopt:glop", "mathopt:pdlp", "mathopt:gscip", "pulp"}
    assert set(MIQP) >= {"cpsat", "mathopt:gscip"}


@pytest.mark.share(2)
@pytest.mark.parametrize(("case", "solver"), pairs(MILP))
def test_bottleneck_of_whole_actions(case: str, solver: str) -> None:
    made = BottleneckSATA(CASES[case].graph).compile("max-min")
    check_answer(made, run(solver, made.program), CASES[case].bottleneck)


@pytest.mark.share(3)
@pytest.mark.parametrize(("case", "solver"), pairs(LP))
def test_bottleneck_of_shares(case: str, solver: str) -> None:
    known = CASES[case]
    problem = BottleneckSATA(known.graph, fractional=True)
    made = problem.compile("max-min")
    result = run(solver, made.program)
    check_answer(made, result, known.lp)
    if known.shares:
        assert made.decode(result.answer) == pytest.approx(known.shares, abs=1e-5)
    if result.row_duals is not None:
        evidence = made.dual_evidence(result.row_duals)
        assert known.lp - 1e-9 <= verified_bound(problem, evidence) == evidence.value <= known.lp + EXACT


@pytest.mark.share(2)
@pytest.mark.parametrize(("case", "solver"), pairs(MILP))
def test_winner_takes_all_through_every_linear_form(case: str, solver: str) -> None:
    problem = WinnerTakesAllSATA(CASES[case].graph)
    for form in LINEAR_FORMS:
        made = problem.compile(form)
        check_answer(made, run(solver, made.program), CASES[case].winner)


@pytest.mark.share(3)
@pytest.mark.parametrize(("case", "solver"), pairs(MIQP))
def test_winner_takes_all_as_a_product(case: str, solver: str) -> None:
    made = WinnerTakesAllSATA(CASES[case].graph).compile("product")
    assert made.program.features() == INTEGERS | QUADRATIC
    check_answer(made, run(solver, made.program), CASES[case].winner)


@pytest.mark.share(2)
@pytest.mark.parametrize(("case", "solver"), pairs(LP))
def test_relaxations_have_their_known_values_and_prove_bounds(case: str, solver: str) -> None:
    known = CASES[case]
    problem = WinnerTakesAllSATA(known.graph)
    for form in LINEAR_FORMS:
        value = known.weak if form == "weak-linearisation" else known.strong
        made = problem.compile(form, relax=True)
        result = run(solver, made.program)
        assert result.objective == pytest.approx(value, abs=EXACT)
        if result.row_duals is not None:
            bound = verified_bound(problem, made.dual_evidence(result.row_duals))
            assert known.winner - 1e-9 <= bound <= value + EXACT
            if form != "weak-linearisation":
                assert bound == pytest.approx(proved(case, value), abs=EXACT)


@pytest.mark.parametrize("case", CASES)
def test_known_choices_are_best(case: str) -> None:
    known = CASES[case]
    for choice, problem, value in (
        (known.bottleneck_choice, BottleneckSATA(known.graph), known.bottleneck),
        (known.winner_choice, WinnerTakesAllSATA(known.graph), known.winner),
    ):
        if choice:
            answer = known.selection(choice)
            assert problem.evaluate(answer).feasible
            assert problem.evaluate(answer).values[0] == pytest.approx(value)


@pytest.mark.share(2)
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("form", [*LINEAR_FORMS, "max-min", "lp"])
def test_certificates_hold_without_a_solver(case: str, form: str) -> None:
    known = CASES[case]
    if form == "max-min":
        problem, value, bound = BottleneckSATA(known.graph), known.bottleneck, known.lp
    elif form == "lp":
        problem, value, bound = BottleneckSATA(known.graph, fractional=True), known.lp, known.lp
    else:
        problem, value, bound = WinnerTakesAllSATA(known.graph), known.winner, known.strong
    solution = wb.solve(problem, "highs", form=form if form in LINEAR_FORMS else None, bound_time=60.0)
    assert solution.status == "optimal"
    assert solution.objective == pytest.approx(value, abs=EXACT)
    written = json.loads(json.dumps(solution.certificate.to_json(with_evidence=True)))
    answer = problem.answer_from_json(json.loads(json.dumps(problem.answer_to_json(solution.answer))))
    again = check_certificate(problem, written, problem.evaluate(answer))
    assert again.bound == pytest.approx(value, abs=EXACT)  # of the linear relaxation, or of a tree where that is worth more
    assert value - 1e-9 <= again.bound <= bound + EXACT


@pytest.mark.parametrize("solver", ["mathopt:highs", *(pytest.param(s, marks=pytest.mark.long) for s in ("cvxpy", "cvxpy:HIGHS"))])
def test_solvers_that_run_apart_are_reached_through_solve(solver: str) -> None:
    known = CASES["S3"]
    shares = wb.solve(BottleneckSATA(known.graph, fractional=True), solver, bound_time=0)
    assert shares.objective == pytest.approx(known.lp, abs=EXACT)
    assert shares.certificate.bound == pytest.approx(known.lp, abs=EXACT)
    if solver != "cvxpy:HIGHS":
        return
    whole = wb.solve(WinnerTakesAllSATA(known.graph), solver, bound_time=0)
    assert (whole.status, whole.objective) == ("optimal", 31.0)


def test_gap_family_has_an_unbounded_integrality_gap() -> None:
    for n in (2, 5, 9):
        graph = graph_of_edges(np.zeros(n, int), np.arange(n), np.arange(n))
        assert wb.solve(BottleneckSATA(graph, fractional=True), "highs", bound_time=0).objective == pytest.approx(1 / n)
        assert wb.solve(BottleneckSATA(graph), "highs", bound_time=0).objective == 0.0
