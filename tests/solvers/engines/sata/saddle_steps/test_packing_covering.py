import warnings

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st
from patience import HANG

import waybound as wb
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.instances.errors import UnsupportedError, UsageError
from waybound.reports.benchmarks.saddle import joined
from waybound.solvers.backend import Control, Options
from waybound.solvers.engines.sata.saddle import LEAST_GAP, Saddle
from waybound.solvers.engines.sata.saddle_steps.packing_covering import PackingCovering


def program(seed: int, variables: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Random rows over a few variables, the first of which stands in two packing rows; every covering row holds a variable."""
    rng = np.random.default_rng(seed)
    n, p, q = variables or rng.integers(1, 12), rng.integers(2, 8), rng.integers(1, 8)
    packing, covering = (rng.uniform(0.1, 3.0, (m, n)) * (rng.random((m, n)) < rng.uniform(0.2, 1.0)) for m in (p, q))
    packing[rng.integers(p, size=n), np.arange(n)] = 1.0
    packing[:2, 0] = 0.5
    covering[np.arange(q), rng.integers(n, size=q)] = covering[0, 0] = 1.0
    return packing, covering


def run(problem: wb.MaxMinLP, control: Control | None = None, **options):
    result = Saddle().run(problem, Options(**{"time_limit": HANG, **options}), control or Control())
    evaluation = problem.evaluate(result.answer)
    assert evaluation.feasible and evaluation.values[0] == pytest.approx(result.objective, rel=1e-12)
    assert verified_bound(problem, result.evidence[0]) == pytest.approx(result.bound, rel=1e-12)
    return result


def optimum(problem: wb.MaxMinLP) -> float:
    return wb.solve(problem, "highs", bound_time=0.0).objective


@settings(deadline=None, max_examples=draws(60))
@given(st.integers(0, 10**6), st.sampled_from(["max", "min"]))
def test_value_and_bound_close_around_the_optimum(seed: int, sense: str) -> None:
    problem = wb.MaxMinLP(*program(seed), sense=sense)
    result, best = run(problem, gap=1e-4, iterations=200_000), optimum(problem)
    assert "several-packing-rows" in problem.features() and result.limit in ("gap", "none")
    low, high = sorted((result.objective, result.bound))
    assert (low == result.objective) == (sense == "max") or low == high
    assert low <= best * (1 + 1e-7) and best <= high * (1 + 1e-7) and high <= low * (1 + 1e-4)


def test_one_row_a_variable_is_taken_where_the_most_is_made_least() -> None:
    solution = wb.solve(wb.MaxMinLP(np.eye(2), [[1.0, 2.0]], sense="min"), "saddle", gap=1e-6)
    assert solution.objective == pytest.approx(1 / 3, rel=1e-5) and solution.bound_kind == "verified" and solution.gap <= 1.1e-6


def test_variables_that_cover_for_nothing_are_refused() -> None:
    problem = wb.MaxMinLP([[1.0, 0.0]], [[1.0, 1.0]], sense="min")
    assert Saddle().missing(problem) == {"variables that cover without a packing row"}
    with pytest.raises(UnsupportedError, match="cover without a packing row"):
        run(problem)


@settings(deadline=None, max_examples=draws(30))
@given(st.integers(0, 10**6), st.integers(0, 10**6))
def test_other_units_and_names_of_the_same_program_have_the_same_value(seed: int, other: int) -> None:
    packing, covering = program(seed)
    rng = np.random.default_rng(other)
    columns, limits, unit = (np.exp(rng.normal(0, 2, k)) for k in (packing.shape[1], len(packing), 1))
    scaled = (limits[:, None] * packing * columns) / limits[:, None], covering * columns * unit
    scaled = tuple(m[rng.permutation(len(m))] for m in scaled)
    order = rng.permutation(packing.shape[1])
    useless = np.zeros((len(covering), 1))
    wider = wb.MaxMinLP(np.hstack([scaled[0][:, order], np.ones((len(packing), 1))]), np.hstack([scaled[1][:, order], useless]))
    first = run(wb.MaxMinLP(packing, covering), gap=1e-4, iterations=200_000)
    second = run(wider, gap=1e-4, iterations=200_000)
    assert second.objective / unit[0] <= first.bound * (1 + 1e-12)
    assert first.objective <= second.bound / unit[0] * (1 + 1e-12)
    assert second.bound <= second.objective * (1 + 1e-4) and second.answer[-1] == 0.0


@settings(deadline=None, max_examples=draws(20))
@given(st.integers(0, 10**6), st.floats(0.01, 100.0))
def test_twice_the_room_is_worth_twice_as_much(seed: int, room: float) -> None:
    packing, covering = program(seed)
    first, second = (run(wb.MaxMinLP(a, covering), gap=1e-4, iterations=200_000) for a in (packing, packing / room))
    assert room * first.objective <= second.bound * (1 + 1e-12) and second.objective <= room * first.bound * (1 + 1e-12)


def test_an_optimum_known_by_hand() -> None:
    """Two variables share a row, a third joins them in one each: x = y = 1/2 leave z = 1/2, and all cover 1/2."""
    packing, covering = [[1.0, 1.0, 0.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0]], np.eye(3)
    solution = wb.solve(wb.MaxMinLP(packing, covering), "saddle")
    assert (solution.status, solution.bound_kind) == ("optimal", "verified")
    assert solution.objective == pytest.approx(0.5, rel=2 * LEAST_GAP) == solution.bound
    assert solution.certificate.evidence[0].kind == "packing-covering-duals"


def test_joined_at_random_it_closes_to_what_highs_finds() -> None:
    problem = joined(1000)
    assert run(problem, gap=1e-5).objective == pytest.approx(optimum(problem), rel=1e-5)


@pytest.mark.parametrize("spread", [1.0, 2.0])
def test_widely_spread_coefficients(spread: float) -> None:
    problem, rng = joined(400), np.random.default_rng(1)
    a, c = problem.packing.scipy, problem.covering.scipy
    a.data, c.data = (np.exp(spread * rng.normal(size=len(m.data))) for m in (a, c))
    problem = wb.MaxMinLP(a, c)
    assert run(problem, gap=1e-4, iterations=200_000).objective == pytest.approx(optimum(problem), rel=1e-4)


@pytest.mark.parametrize("exponent", [-900, 900])
def test_a_unit_changes_no_digit(exponent: int) -> None:
    packing, covering = program(5, 9)
    first, second = (run(wb.MaxMinLP(packing, c), iterations=200) for c in (covering, np.ldexp(covering, exponent)))
    assert second.objective == np.ldexp(first.objective, exponent) and np.array_equal(first.answer, second.answer)


def test_a_refusal_names_the_two_variables_whose_coefficients_are_far_apart() -> None:
    problem = wb.MaxMinLP([[1.0, 1.0], [1.0, 0.0]], [[1e200, 1e-200]])
    with pytest.raises(UnsupportedError, match=r"1e-200 in covering and 1 in packing of variable 2, and 1e\+200 in covering"):
        Saddle().run(problem, Options(iterations=10), Control())


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("decades", [20, 120, 300])
@pytest.mark.parametrize("sense", ["max", "min"])
def test_coefficients_of_all_sizes_end_in_true_claims_or_are_refused(seed: int, decades: int, sense: str) -> None:
    rng = np.random.default_rng(seed)
    packing, covering = (np.where(m > 0, 10.0 ** rng.uniform(-decades, decades, m.shape), 0.0) for m in program(seed, 8))
    problem = wb.MaxMinLP(packing, covering, sense=sense)
    try:
        result = Saddle().run(problem, Options(iterations=300), Control())
    except UnsupportedError as error:
        assert "quotients no double holds" in str(error) and decades > 20
        assert "alternative" not in str(error) and "divide all covering rows" in str(error)
        return
    assert problem.evaluate(result.answer).feasible
    low, high = (result.objective, result.bound) if sense == "max" else (result.bound, result.objective)
    assert 0.0 < low <= high * (1 + 1e-12)
    assert verified_bound(problem, result.evidence[0]) == pytest.approx(result.bound, rel=1e-9)


def test_a_covering_row_without_variables_keeps_the_value_at_zero() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        problem = wb.MaxMinLP(np.ones((2, 2)), [[1.0, 1.0], [0.0, 0.0]])
    solution = wb.solve(problem, "saddle")
    assert (solution.status, solution.objective, solution.bound_kind) == ("optimal", 0.0, "verified")
    assert "covering row 2" in solution.message


def test_a_start_from_the_local_algorithm_is_refused() -> None:
    with pytest.raises(UsageError, match="one packing row"):
        run(joined(100), extra={"h": 2})
    with pytest.raises(UsageError, match="a max-min program"):
        run(wb.MaxMinLP(np.eye(2), np.eye(2), sense="min"), extra={"h": 2})


def test_a_start_is_kept_and_one_that_is_none_ignored() -> None:
    problem = joined(400)
    good = run(problem, gap=1e-3)
    again = run(problem, start=good.answer, iterations=1)
    assert again.statistics["start"] == "used" and again.objective >= good.objective * (1 - 1e-12)
    assert run(problem, start=10 * good.answer, iterations=1).objective >= good.objective * (1 - 1e-9)
    for start in (np.full(problem.num_variables, np.nan), np.ones(3), np.zeros(problem.num_variables)):
        assert run(problem, start=start, iterations=1).statistics["start"] == "ignored"


def test_a_start_of_a_min_max_program_is_kept() -> None:
    packing, covering = program(3, 40)
    problem = wb.MaxMinLP(packing, covering, sense="min")
    good = run(problem, gap=1e-3)
    again = run(problem, start=good.answer, iterations=1)
    assert again.statistics["start"] == "used" and again.objective <= good.objective * (1 + 1e-12)
    assert run(wb.MaxMinLP(np.eye(2), np.eye(2), sense="min"), start=[1.0, 0.0]).statistics["start"] == "ignored"


@pytest.mark.parametrize("iterations", [1, 37, 400])
def test_limits_on_work_repeat_to_the_bit(iterations: int) -> None:
    problem = joined(1000)
    first, second = (run(problem, iterations=iterations) for _ in range(2))
    assert first.limit == "iterations" and first.statistics == second.statistics and first.statistics["steps"] == iterations
    assert (first.objective, first.bound, first.evidence) == (second.objective, second.bound, second.evidence)
    assert np.array_equal(first.answer, second.answer)


def test_more_work_is_no_worse_and_what_is_published_is_true() -> None:
    problem, events = joined(1000), []

    class Listening(Control):
        def publish(self, answer=None, objective=None, bound=None, evidence=()):
            super().publish(answer, objective, bound, evidence)
            if answer is not None:
                assert problem.evaluate(answer).values[0] == pytest.approx(objective, rel=1e-12)
            if bound is not None:
                assert verified_bound(problem, evidence[0]) == pytest.approx(bound, rel=1e-12)
            events.append((self.objective, self.bound))

    result = run(problem, Listening(), iterations=400)
    values, bounds = ([e[k] for e in events if e[k] is not None] for k in (0, 1))
    assert values == sorted(values) and bounds == sorted(bounds, reverse=True) and len(events) > 6
    assert (values[-1], bounds[-1]) == (result.objective, result.bound)


def test_time_and_interrupts_leave_an_answer_and_a_bound() -> None:
    problem = joined(4000)
    result = run(problem, time_limit=1e-6)
    assert (result.status, result.limit) == ("feasible", "time") and 0.0 < result.objective < result.bound < np.inf
    control, seen = Control(), []
    control._progress = lambda event: (seen.append(event), len(seen) == 6 and control.stop())
    result = run(problem, control)
    assert (result.status, result.limit) == ("feasible", "interrupt") and result.objective >= seen[5]["objective"]


def test_a_restart_goes_on_from_a_point_no_worse_than_the_first() -> None:
    game = PackingCovering(joined(400))
    first = game.bound - game.value
    game.run(Stop(HANG), 1e-3)
    assert game.restarts > 1 and game.closed(1e-3) and game.bound - game.value < 0.01 * first
