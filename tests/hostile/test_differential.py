"""Random tiny problems of every family, at every scale, against brute force in exact arithmetic: no false word is shown."""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from exact_truth import Truth, truth
from hostile_instances import FAMILIES, Units
from hostile_judging import of_bound, of_samples, of_solution

import waybound as wb
from waybound.formulations.certificate import verified_bound
from waybound.formulations.problem import Problem
from waybound.heuristics.heuristic import HEURISTICS
from waybound.instances.errors import InputError
from waybound.solvers.backend import BACKENDS
from waybound.solvers.bounding import find_bounds

SEED = 81


def own_methods(problem: Problem) -> list[dict[str, str]]:
    """Everything of ours that takes the problem, as keywords of ``solve``."""
    found = [{"heuristic": name} for name in HEURISTICS if not HEURISTICS[name].missing(problem)]
    if problem.family == "max-min" and not BACKENDS["saddle"]().missing(problem):
        found.append({"solver": "saddle"})
    return found


def own_faults(problem: Problem, exact: Truth, rng: np.random.Generator, methods: int) -> Iterator[str]:
    """False words of our own heuristics, engine, bounds and judge on one problem."""
    evidence = find_bounds(problem, 5.0)  # no target: every method has its say
    for e in evidence:
        yield from of_bound(exact, verified_bound(problem, e), f"{e.kind}: {e.source}")
    yield from of_samples(problem, exact, evidence)
    able = own_methods(problem)
    for k in rng.permutation(len(able))[:methods].tolist():
        start = exact.samples[int(rng.integers(len(exact.samples)))] if exact.samples and rng.random() < 0.25 else None
        solution = wb.solve(problem, **able[k], time_limit=20.0, bound_time=5.0, seed=int(rng.integers(5)), start=start)  # type: ignore[arg-type]
        yield from of_solution(exact, solution)


def faults_of(family: str, case: int, methods: int = 1) -> list[str]:
    """False words, and exceptions, on one drawn problem; each begins with its kind and a colon."""
    rng = np.random.default_rng([SEED, case])
    problem = FAMILIES[family](rng, Units.drawn(rng))
    try:
        return list(own_faults(problem, truth(problem), rng, methods))
    except Exception as fault:
        if isinstance(fault, InputError) and "needs weights of ordinary size" in str(fault):
            return []  # refused before anything is run, which is as good
        return [f"raised {type(fault).__name__}: {fault} {''.join(traceback.format_tb(fault.__traceback__)[-1:])}"]


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("family", FAMILIES)
def test_no_false_word_of_ours(family: str, share: Callable[[int, int], int], tally: Any) -> None:
    cases = share(400, 24_000) // len(FAMILIES)
    found = {case: faults for case in range(cases) if (faults := faults_of(family, case))}
    tally[f"random problems against brute force: {family}"] += cases
    assert not found, f"{len(found)} of {cases}: {dict(list(found.items())[:5])}"
