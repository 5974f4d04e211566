"""Heuristics that break what they state, registered while a test runs."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from waybound import Evidence, Guarantee, Selection
from waybound.heuristics.heuristic import HEURISTICS, Heuristic, Outcome
from waybound.reports.ratios.guarantees import GuaranteePlan, run_plan
from waybound.reports.ratios.judged_runs import Configuration
from waybound.reports.studies.sata.families.selection import random_families
from waybound.reports.studies.study import Report, StudySetting

HALF = Guarantee(2.0, "f(S) >= f(OPT) / 2", (), "nowhere")


def _worst(problem, setting):
    """The elements that are worth least."""
    singles = [problem.value([e]) for e in range(problem.num_elements)]
    return Outcome(Selection.of(np.argsort(singles)[: problem.constraint.limit]), HALF)


def _shy(problem, setting):
    """Greedy's answer without its guarantee."""
    return Outcome(HEURISTICS["greedy"].run(problem, setting).answer)


def _boastful(problem, setting):
    """Greedy's answer, with evidence that is said to prove a bound of 0 and proves less."""
    found = HEURISTICS["greedy"].run(problem, setting)
    return Outcome(found.answer, found.guarantee, (Evidence("marginal-gains", "a lie", 0.0, {"prefix": []}),))


def _garbled(problem, setting):
    """Greedy's answer, with evidence that nobody can read."""
    found = HEURISTICS["greedy"].run(problem, setting)
    return Outcome(found.answer, found.guarantee, (Evidence("marginal-gains", "garbled", 0.0, {"prefix": [-1]}),))


def _greedy_for_more(problem, setting):
    """One element too many."""
    return Outcome(Selection(tuple(range(min(problem.num_elements, problem.constraint.limit + 1)))), HALF)


def _crash(problem, setting):
    raise IndexError("out of range")


def _unlucky(problem, setting):
    """Greedy's answer one time in five, nothing otherwise; states 1/2 in expectation."""
    found = HEURISTICS["greedy"].run(problem, setting)
    return Outcome(found.answer if setting.rng.random() < 0.2 else Selection(), HALF)


def _lucky(problem, setting):
    """Greedy's answer three times in four, nothing otherwise: 1/2 in expectation holds, though many single runs are worth nothing."""
    found = HEURISTICS["greedy"].run(problem, setting)
    return Outcome(found.answer if setting.rng.random() < 0.75 else Selection(), HALF)


BAD = {
    "bad-worst": _worst, "bad-shy": _shy, "bad-boastful": _boastful, "bad-garbled": _garbled, "bad-greedy-for-more": _greedy_for_more,
    "bad-crash": _crash,
    "bad-unlucky": _unlucky, "lucky": _lucky,
}  # fmt: skip


@pytest.fixture
def bad_heuristics(registered: Any) -> None:
    features = frozenset({"function:coverage", "function:facility-location", "function:user", "constraint:cardinality"})
    for name, run in BAD.items():
        registered(HEURISTICS, name, Heuristic(name, ("selection",), features, run, "for tests", "1/2"))


@pytest.fixture
def measured(bad_heuristics: None) -> Callable[..., Report]:
    """``measured("bad-worst", expected=2.0)``: the report of a study of one of them."""

    def run(name: str, expected: float | None = 2.0, instances: int = 40, repeats: int = 1) -> Report:
        plan = GuaranteePlan((Configuration(name, name, lambda problem: expected, {}, repeats),), random_families("cardinality", 7))
        return run_plan(f"study of {name}".replace(" ", "-"), "for tests", plan, StudySetting(instances, seed=3))

    return run
