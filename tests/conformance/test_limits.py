"""Every program backend at a limit, on an interrupt and from a start: what is said then must be true."""

import threading
import time

import numpy as np
import pytest
from patience import HANG
from programs import program

from waybound.instances.errors import UsageError
from waybound.solvers.backend import BACKENDS, Control, Options
from waybound.solvers.isolation import run_isolated
from waybound.solvers.program_backend import ProgramBackend

CVXPY = ("cvxpy", "cvxpy:SCS", "cvxpy:HIGHS")

NO_BOUND = ("pulp:HiGHS",)
"""PuLP drops the bound."""

NO_WORK_LIMIT = ("mathopt:gscip", "scip")
"""They have no limit on work for linear programs."""

NO_START = ("pulp:HiGHS", *CVXPY)

TOLERANCE = 1e-6
SHORT = 0.25
LONGER = (SHORT, 10 * SHORT, 100 * SHORT)
"""What is found in the first of these takes longer on a busy machine."""


def made(name: str):
    """The backend of this name."""
    base, _, variant = name.partition(":")
    return BACKENDS[base](variant) if variant else BACKENDS[base]()


def holds(program, result) -> None:
    """An answer is feasible and of the value told, and the bound lies on the other side of it."""
    value = program.value(result.answer)
    assert program.residual(result.answer) <= TOLERANCE
    if result.status == "optimal" or program.is_integer:
        assert result.objective == pytest.approx(value, abs=1e-7)
    else:
        assert result.objective is None
    if result.bound is not None:
        assert result.bound >= value - TOLERANCE if program.sense == "max" else result.bound <= value + TOLERANCE


def stopped_after(seconds: float) -> Control:
    """A control that is asked to stop from another thread."""
    control = Control()

    def stop() -> None:
        time.sleep(seconds)
        control.stop()

    threading.Thread(target=stop, daemon=True).start()
    return control


def stopped_once_found(publishes: bool) -> Control:
    """A control that is asked to stop soon after an answer is published; CBC publishes none, and is asked later."""

    def found(event) -> None:
        if event.get("objective") is not None:
            threading.Timer(SHORT / 4, control.stop).start()

    control = Control(found)
    fallback = threading.Timer(HANG / 2 if publishes else 4 * SHORT, control.stop)
    fallback.daemon = True
    fallback.start()
    return control


def test_a_time_limit_with_an_incumbent_is_feasible_not_optimal(knapsack, solve_with):
    for seconds in LONGER:
        result = solve_with(knapsack, time_limit=seconds)
        assert result.limit == "time"
        if result.answer is not None:
            break
    assert result.status == "feasible"
    holds(knapsack, result)


def test_native_backends_tell_a_bound_at_the_time_limit(knapsack, backend_name, solve_with):
    if backend_name in NO_BOUND:
        pytest.skip(f"{backend_name} tells none")
    results = (solve_with(knapsack, time_limit=limit) for limit in LONGER)  # none before the root is solved
    result = next(r for r in results if r.bound is not None and r.objective is not None)
    assert result.bound > result.objective + 1.0


def test_a_time_limit_without_an_incumbent_leaves_no_answer(market_split, solve_with):
    result = solve_with(market_split, time_limit=SHORT)
    assert (result.status, result.limit) == ("unknown", "time")
    assert result.answer is None
    assert result.objective is None
    assert result.message


def test_a_tiny_time_limit_of_an_lp_claims_nothing_false(solve_with):
    rng = np.random.default_rng(3)
    m, n = 400, 600
    a = rng.random((m, n))
    lp = program(rng.random(n).tolist(), a, a.sum(axis=1) * 0.3, np.inf, 0, 1)
    result = solve_with(lp, time_limit=0.02)
    assert result.status in ("unknown", "feasible", "optimal")
    if result.answer is not None:
        holds(lp, result)
    if result.status == "unknown":
        assert result.limit == "time"
        assert result.bound is None


def test_a_node_limit_is_named_and_repeats_to_the_bit(branching, backend_name, solve_with):
    if "iterations" not in made(backend_name).honours:
        pytest.skip(f"{backend_name} has no work limit")
    result, again = (solve_with(branching, iterations=1, time_limit=60, seed=7) for _ in range(2))
    assert (result.status, result.limit) == ("feasible", "nodes")
    holds(branching, result)
    assert result.objective == again.objective
    assert (result.answer == again.answer).all()


def test_an_iteration_limit_of_an_lp_is_named(backend_name, solve_with):
    rng = np.random.default_rng(4)
    a = rng.random((60, 80))
    lp = program(rng.random(80).tolist(), a, a.sum(axis=1) * 0.3, np.inf, 0, 1)
    if "iterations" not in made(backend_name).honours:
        pytest.skip(f"{backend_name} has no work limit")
    if backend_name in NO_WORK_LIMIT:
        with pytest.raises(UsageError, match="iterations"):
            solve_with(lp, iterations=3)
        return
    result = solve_with(lp, iterations=3)
    assert result.limit == "iterations"
    assert result.status in ("unknown", "feasible")


def test_a_gap_that_suffices_is_not_called_optimal(knapsack, solve_with):
    result = solve_with(knapsack, gap=0.2, time_limit=60)
    assert (result.status, result.limit) == ("feasible", "gap")
    holds(knapsack, result)
    if result.bound is not None:
        assert abs(result.bound - result.objective) <= 0.2 * abs(result.objective) + TOLERANCE


def test_an_interrupt_in_mid_run_keeps_the_best_answer(knapsack, backend_name, solve_with):
    if made(backend_name).needs_process:
        pytest.skip(f"{backend_name} cannot be stopped; see the isolated test")
    result = solve_with(knapsack, stopped_once_found(backend_name != "pulp"), time_limit=HANG)
    assert (result.status, result.limit) == ("feasible", "interrupt")
    holds(knapsack, result)


def test_an_interrupt_without_an_incumbent_leaves_no_answer(market_split, backend_name, solve_with):
    if made(backend_name).needs_process:
        pytest.skip(f"{backend_name} cannot be stopped; see the isolated test")
    result = solve_with(market_split, stopped_after(SHORT), time_limit=120)
    assert (result.status, result.limit) == ("unknown", "interrupt")
    assert result.answer is None


def test_an_interrupt_before_the_run_ends_it_at_once(knapsack, backend_name, solve_with):
    if made(backend_name).needs_process:
        pytest.skip(f"{backend_name} cannot be stopped; see the isolated test")
    control = Control()
    control.stop()
    assert solve_with(knapsack, control, time_limit=HANG).limit == "interrupt"


def test_any_backend_can_be_ended_in_a_process_of_its_own(market_split, backend_name):
    if ProgramBackend.missing(made(backend_name), market_split):
        pytest.skip(f"{backend_name} takes no {market_split.kind}")
    result = run_isolated(backend_name, market_split, Options(time_limit=HANG), stopped_after(2 * SHORT))
    assert (result.status, result.limit) == ("unknown", "interrupt")


def test_progress_is_published_and_ends_at_the_result(knapsack, backend_name, solve_with):
    if made(backend_name).needs_process:
        pytest.skip(f"{backend_name} shows no progress")
    for seconds in LONGER:
        events = []
        control = Control(events.append)
        result = solve_with(knapsack, control, time_limit=2 * seconds)
        if control.bound is not None and result.answer is not None:
            break
    assert control.bound is not None
    assert control.bound >= result.objective - TOLERANCE
    assert events
    if control.answer is not None:
        assert knapsack.residual(control.answer) <= TOLERANCE
        assert control.objective == pytest.approx(knapsack.value(control.answer), abs=1e-6)


def test_a_second_model_with_other_threads_in_one_process(backend_name, solve_with):
    if made(backend_name).needs_process:
        pytest.skip(f"{backend_name} has a process of its own each time")
    # HiGHS 1.12 refuses another number of threads until its scheduler is reset.
    rng = np.random.default_rng(0)
    a = rng.integers(10, 1000, (6, 30)).astype(float)
    milp = program(rng.integers(10, 1000, 30).tolist(), a, -np.inf, np.floor(a.sum(axis=1) / 2), 0, 1, integer=range(30), sense="max")
    values = []
    for threads in (1, 2, 1):
        result = solve_with(milp, threads=threads)
        assert result.status == "optimal"
        values.append(result.objective)
    assert values == pytest.approx([values[0]] * 3)


@pytest.mark.slow
def test_a_feasible_start_is_used(knapsack, backend_name, solve_with):
    if backend_name in NO_START:
        pytest.skip(f"{backend_name} takes no start")
    good = next(r for r in (solve_with(knapsack, time_limit=limit) for limit in LONGER) if r.answer is not None)
    again = solve_with(knapsack, start=good.answer, iterations=1, time_limit=60)
    holds(knapsack, again)
    assert again.objective >= good.objective - TOLERANCE
    assert again.statistics["start"] == "used"


def test_an_infeasible_start_does_no_harm(backend_name, solve_with, check_optimum):
    milp = program([5, 4, 3], [[2, 3, 1], [4, 1, 2], [3, 4, 2]], -np.inf, [5, 11, 8], 0, 9, integer=[0, 1, 2], sense="max")
    check_optimum(milp, solve_with(milp, start=np.array([9.0, 9.0, 9.0])), 13.0)


def test_a_partial_start_is_completed_or_ignored(solve_with, check_optimum):
    milp = program([5, 4, 3], [[2, 3, 1], [4, 1, 2], [3, 4, 2]], -np.inf, [5, 11, 8], 0, 9, integer=[0, 1, 2], sense="max")
    check_optimum(milp, solve_with(milp, start=np.array([2.0, np.nan, np.nan])), 13.0)
