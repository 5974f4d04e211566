from collections.abc import Callable

import numpy as np
import pytest
from draws import draws
from knapsack_assignments import enumerated, random_assignment

import waybound as wb
from waybound.formulations.auctions.generalised_assignment import GeneralisedAssignment
from waybound.formulations.stop import Stop
from waybound.heuristics.auctions.shmoys_tardos import rounded, within_capacities
from waybound.solvers.linear_programs import LinearPrograms


def relaxed(problem: GeneralisedAssignment) -> tuple[float, np.ndarray] | None:
    raw = LinearPrograms().solve(problem.compile(relax=True).program)
    if raw.status != "optimal":
        return None
    parts = np.zeros(problem.fitting.shape)
    parts[np.nonzero(problem.fitting)] = raw.answer
    return float(raw.objective), parts


def generated(k: int) -> GeneralisedAssignment:
    return wb.generate("generalised-assignment", agents=2 + k % 4, jobs=5 + k % 13, costs="cd"[k % 2], seed=k)


def tight(k: int) -> GeneralisedAssignment:
    """Few large jobs beside small ones, rooms that hardly suffice, forbidden pairs; whole numbers or not."""
    rng = np.random.default_rng([k, 7])
    m, n = int(rng.integers(1, 5)), int(rng.integers(1, 14))
    used = np.where(rng.random((m, n)) < 0.3, rng.uniform(5, 10, (m, n)), rng.uniform(0.1, 1, (m, n)))
    used = np.ceil(used) if k % 2 else used
    costs = np.where(rng.random((m, n)) < 0.15, np.inf, rng.integers(0, 20, (m, n)).astype(float))
    return GeneralisedAssignment.from_arrays(costs, used, np.maximum(used.max(axis=1), used.sum(axis=1) / m * rng.uniform(0.7, 1.3)))


def overloaded(problem: GeneralisedAssignment) -> bool | None:
    """Whether the rounding, which is checked, exceeds a capacity; None where not even parts of jobs have room."""
    found = relaxed(problem)
    if found is None:
        return None
    answer = rounded(problem, found[1])
    assert answer is not None
    judged = problem.evaluate(answer)
    scale = float(np.abs(problem.instance.values[problem.fitting]).max()) * problem.num_jobs
    assert judged.values[0] <= found[0] + 1e-9 * scale
    used = problem.instance.consumption
    largest = np.where(problem.fitting, used, 0.0).max(axis=1)
    loads = np.array(problem.loads(answer))
    assert (loads <= (problem.instance.capacity + largest) * (1 + 1e-9)).all()
    assert {v.check for v in judged.violations} <= {"capacity"}
    moved, moves = within_capacities(problem, answer)
    excess = [np.maximum(np.array(problem.loads(a)) - problem.instance.capacity, 0.0).sum() for a in (answer, moved)]
    assert excess[1] <= excess[0] and (moves > 0) == (moved != answer)
    return not judged.feasible


@pytest.mark.parametrize("made", [generated, tight])
def test_a_rounding_costs_no_more_and_loads_one_job_more_at_most(made: Callable[[int], GeneralisedAssignment]) -> None:
    over = [overloaded(made(k)) for k in range(draws(40))]
    assert True in over, "some roundings exceed a capacity"


@pytest.mark.long
def test_thousands_of_roundings() -> None:
    over = [overloaded(made(k)) for made in (generated, tight) for k in range(100, 2100)]
    assert sum(found is not None for found in over) > 3000


def test_answers_keep_all_rules_or_there_is_none() -> None:
    rng = np.random.default_rng(9)
    for _ in range(draws(40)):
        problem = random_assignment(rng, 5)
        if problem.objective != "cost":
            continue
        found, best = wb.solve(problem, heuristic="shmoys-tardos", bound_time=0), enumerated(problem)
        assert found.answer is None or (best is not None and found.objective >= best - 1e-9)


def test_parts_that_make_up_no_job_are_not_rounded() -> None:
    problem = GeneralisedAssignment.from_arrays(np.ones((2, 2)), np.ones((2, 2)), 1.0)
    assert rounded(problem, np.zeros((2, 2))) is None
    assert rounded(problem, np.full((2, 2), 0.5)) in ((0, 1), (1, 0))


def test_moves_end_where_they_are_stopped() -> None:
    problem = GeneralisedAssignment.from_arrays(np.ones((2, 2)), np.ones((2, 2)), 1.0)
    stop = Stop()
    assert within_capacities(problem, (0, 0), stop) == ((1, 0), 1)
    stop.ask()
    assert within_capacities(problem, (0, 0), stop) == ((0, 0), 0)


def test_a_small_one_is_solved() -> None:
    found = wb.solve(wb.generate("generalised-assignment", agents=5, jobs=30, seed=1), heuristic="shmoys-tardos", bound_time=60.0)
    assert found.certificate.feasible and found.objective == pytest.approx(575) and found.gap < 0.1
