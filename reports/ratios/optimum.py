"""Optima of small instances, each with an answer that attains it, found without any heuristic of the toolkit."""

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...formulations.problem import Problem
from ...instances.errors import CheckFailedError, UsageError
from ...instances.registry import Registry


@dataclass(frozen=True)
class Optimum:
    """The optimum, recomputed from an answer by ``problem.evaluate``, and its source."""

    value: float
    answer: Any
    source: str


OPTIMA: Registry[Callable[[Any], Optimum]] = Registry("family with optima", "waybound.reports.studies.*.families.optima")
"""Functions from a small problem to its optimum, by the name of its family. Each raises UsageError for a problem too large, or another."""


def optimum(problem: Problem) -> Optimum:
    """The optimum of a small problem. Raises UsageError if nothing finds it, CheckFailedError if it does not hold up."""
    if problem.family not in OPTIMA:
        raise UsageError(f"no optimum is known for {problem.problem} problems", "unsupported")
    return OPTIMA[problem.family](problem)


def attained(problem: Problem, answer: Any, source: str) -> Optimum:
    """The value of ``answer``, which is said to be optimal. Raises CheckFailedError if it fails its check."""
    judged = problem.evaluate(answer)
    if not judged.feasible:
        raise CheckFailedError(f"the answer of {source} to {problem.name} fails its check: {judged.violations[0].message}")
    return Optimum(judged.values[0], answer, source)


@functools.cache
def subsets(n: int) -> NDArray[np.bool_]:
    """Which of ``n`` things each subset holds, shape (2^n, n): bit e of the position is thing e."""
    members: NDArray[np.bool_] = (np.arange(1 << n)[:, None] >> np.arange(n)) & 1 == 1
    members.setflags(write=False)
    return members
