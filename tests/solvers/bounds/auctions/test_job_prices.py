"""Lagrangean bounds of generalised assignments: never beyond the optimum, and beyond the linear relaxation where knapsacks are whole."""

import math

import numpy as np
from draws import draws
from knapsack_assignments import enumerated, random_assignment, worked

import waybound as wb
from waybound.formulations.auctions.generalised_assignment import GeneralisedAssignment
from waybound.formulations.stop import NEVER, Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds import BOUNDS
from waybound.solvers.bounds.auctions.job_prices import compute
from waybound.solvers.bounds.linear_relaxation import linear_relaxation_bound
from waybound.solvers.linear_programs import LinearPrograms


def test_the_bound_lies_between_relaxation_and_optimum() -> None:
    rng = np.random.default_rng(8)
    closed = 0
    for _ in range(draws(40)):
        problem = random_assignment(rng, 5)
        best, evidence = enumerated(problem), compute(problem, NEVER, LinearPrograms())
        if evidence is None or best is None:
            continue
        bound = verified_bound(problem, evidence)
        assert bound <= best if problem.sense == "min" else bound >= best
        relaxed = linear_relaxation_bound(problem)
        if relaxed is not None:
            weaker = verified_bound(problem, relaxed)
            assert bound >= weaker if problem.sense == "min" else bound <= weaker
        closed += math.isclose(bound, best, rel_tol=1e-9)
    assert closed


def test_the_worked_one_is_closed() -> None:
    for objective, value in (("cost", 6.0), ("profit", 12.0)):
        evidence = compute(worked(objective), NEVER, LinearPrograms())
        assert evidence is not None and verified_bound(worked(objective), evidence) == value


def test_as_much_is_proved_whatever_unit_consumption_is_told_in() -> None:
    """Halves and quarters are whole in one unit and not in another."""
    rng = np.random.default_rng(5)
    for _ in range(draws(10)):
        values, used = rng.integers(1, 20, (2, 5)).astype(float), rng.integers(1, 9, (2, 5)).astype(float)
        found = []
        for unit in (1.0, 0.25, 2.0**30):
            problem = GeneralisedAssignment.from_arrays(values, used * unit, used.sum(axis=1) * unit * 0.4, "profit")
            evidence = compute(problem, NEVER, LinearPrograms())
            assert evidence is not None
            found.append(verified_bound(problem, evidence))
        assert len(set(found)) == 1


def test_bins_within_a_horizon() -> None:
    """Two robots, nine steps each: retrievals of 3, 3, 6 and 6 steps all fit, of three of 5 steps two."""
    for lengths, best in (((3.0, 3.0, 6.0, 6.0), 4.0), ((5.0, 5.0, 5.0), 2.0)):
        problem = GeneralisedAssignment.from_arrays(np.ones((2, len(lengths))), lengths, 9.0, "profit")
        found = wb.solve(problem, bound_time=10)
        assert (found.objective, found.bound, found.bound_kind) == (best, best, "verified")


def test_stopped_it_still_proves_something_or_nothing() -> None:
    stop = Stop()
    stop.ask()
    evidence = compute(worked(), stop, LinearPrograms())
    assert evidence is None or verified_bound(worked(), evidence) <= 6.0
    assert BOUNDS["job-prices"].missing(wb.BinAssignment.from_matrix([[1.0]])) == {"bin-assignment problems"}
