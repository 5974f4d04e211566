"""Random tiny problems of every family, at every scale, against brute force in exact arithmetic: no false word is shown."""

import traceback
from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hostile_instances import AT_RISK, FAMILIES as CERTAIN, Units
from hostile_judging import ENDED, away, of_bound, of_samples, of_solution
from truth.families import Truth, truth

import waybound as wb
from waybound import CheckFailedError, InputError, Problem, UnsupportedError
from waybound.formulations.verified_bounds import verified_bound
from waybound.heuristics.heuristic import HEURISTICS
from waybound.solvers.backend import BACKENDS
from waybound.solving.bounding import find_bounds

SEED = 81
FAMILIES = CERTAIN | AT_RISK


def own_methods(problem: Problem) -> list[dict[str, str]]:
    """Everything of ours that takes the problem, as keywords of ``solve``."""
    found = [{"heuristic": name} for name in HEURISTICS if not HEURISTICS[name].missing(problem)]
    if problem.family == "max-min" and not BACKENDS["saddle"]().missing(problem):
        found.append({"solver": "saddle"})
    return found


def own_faults(problem: Problem, exact: Truth, rng: np.random.Generator, methods: int) -> Iterator[str]:
    """False words of our own heuristics, engine, bounds and judge on one problem."""
    evidence = find_bounds(problem, 1.0)  # no target: every method has its say
    for e in evidence:
        yield from of_bound(exact, verified_bound(problem, e), f"{e.kind}: {e.source}")
    yield from of_samples(problem, exact, evidence)
    able = own_methods(problem)
    for k in rng.permutation(len(able))[:methods].tolist():
        start = exact.samples[int(rng.integers(len(exact.samples)))] if exact.samples and rng.random() < 0.25 else None
        solution = wb.solve(problem, **able[k], time_limit=20.0, bound_time=1.0, seed=int(rng.integers(5)), start=start)  # type: ignore[arg-type]
        yield from of_solution(exact, solution)


def faults_of(family: str, case: int, methods: int = 1) -> list[str]:
    """False words, and exceptions, on one drawn problem; each begins with its kind and a colon."""
    rng = np.random.default_rng([SEED, case])
    problem = FAMILIES[family](rng, Units.drawn(rng))
    found: list[str] = []
    try:
        for word in own_faults(problem, truth(problem), rng, methods):
            found.append(word)
    except Exception as fault:
        # A refusal by name, before anything is run, is as good as an answer.
        if not isinstance(fault, UnsupportedError) and "needs weights of ordinary size" not in str(fault):
            found.append(f"raised {type(fault).__name__}: {fault} {''.join(traceback.format_tb(fault.__traceback__)[-1:])}")
    return found


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("family", FAMILIES)
def test_no_false_word_of_ours(family: str, share: Callable[[int, int], int], tally: Any) -> None:
    dear = {"routing-at-risk": 200, "routing": 700}  # they take ten times as long; 20,000 in all
    cases = share(60 // len(FAMILIES), dear.get(family, (20_000 - sum(dear.values())) // (len(FAMILIES) - len(dear)) + 1))
    found = {case: faults for case in range(cases) if (faults := faults_of(family, case))}
    tally[f"random problems against brute force: {family}"] += cases
    assert not found, f"{len(found)} of {cases}: {dict(list(found.items())[:5])}"


SOLVERS = {
    "highs": 80, "scip": 40, "cpsat": 40, "pulp": 20, "pulp:HiGHS": 2, "mathopt:highs": 2, "mathopt:gscip": 40, "mathopt:glop": 30,
    "mathopt:cp-sat": 30, "mathopt:pdlp": 10, "cvxpy": 1, "cvxpy:HIGHS": 1, "cvxpy:SCS": 2, "pyvrp": 25, "ortools": 6,
    "vroom": 6, "vrpsolver": 6,
}  # fmt: skip
"""Solvers of others, and how many problems of each family they get."""


def claim_faults(family: str, case: int, solver: str, tally: Any) -> list[str]:
    """What is false though we verified it. A solver's own false claim is counted only, and one that was seen and said is none."""
    rng = np.random.default_rng([SEED, case])
    problem = FAMILIES[family](rng, Units.drawn(rng))
    limits = {"iterations": 30} if solver in ("pyvrp", "ortools") else {}
    try:
        solution = wb.solve(problem, solver, time_limit=10.0, bound_time=1.0, **limits)  # type: ignore[arg-type]
    except UnsupportedError:
        return []
    except CheckFailedError:
        tally[f"claims of {solver} that were refuted, and said to be"] += 1
        return []
    except InputError:
        tally[f"problems that {solver} refuses"] += 1
        return []
    exact = truth(problem)
    exact.parts = 10**6
    tally[f"random problems given to {solver}"] += 1
    best, told = exact.best, solution.evaluation
    wrong = solution.status in ("infeasible", "unbounded") and (best is not None) and not solution.certificate.infeasible
    if solution.status == "optimal" and best is not None and told is not None:
        wrong = exact.better(best, tuple(map(Fraction, told.values))) and any(
            away(a, b) > ENDED for a, b in zip(told.values, best, strict=True)
        )
    tally[f"false claims of {solver} beside what was verified"] += wrong
    return [f"{family} {case} {solver}: {word}" for word in of_solution(exact, solution, ours=False)]


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("solver", [pytest.param(s, marks=[] if s == "highs" else pytest.mark.hostile) for s in SOLVERS])
def test_what_is_verified_beside_the_claims_of_others(solver: str, share: Callable[[int, int], int], tally: Any) -> None:
    if not BACKENDS[solver.partition(":")[0]].installed():
        pytest.skip(f"{solver} is not installed")
    cases = share(min(6, SOLVERS[solver]), SOLVERS[solver])
    found = [fault for family in FAMILIES for case in range(cases) for fault in claim_faults(family, case, solver, tally)]
    assert not found, f"{len(found)}: {found[:5]}"
