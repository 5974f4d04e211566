"""The least largest cost by thresholds."""

from __future__ import annotations

import numpy as np
from bin_assignments import enumerated, random_costs
from draws import draws

from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.engines.auctions.assignment_steps.thresholds import least_threshold


def test_answer_and_evidence_meet_at_what_enumeration_says() -> None:
    rng = np.random.default_rng(14)
    for _ in range(draws(100)):
        costs = random_costs(rng, 5)
        problem = BinAssignment.from_matrix(costs, objective="bottleneck")
        most, _, largest = enumerated(costs)
        found = least_threshold(problem, NEVER)
        assert found.complete and problem.evaluate(found.answer).feasible
        if most:
            assert found.evidence is not None and found.evidence.value == largest == problem.evaluate(found.answer).values[0]


def test_stopped_it_has_an_answer_all_the_same() -> None:
    stop = Stop()
    stop.ask()
    problem = BinAssignment.from_matrix(np.arange(9.0).reshape(3, 3), objective="bottleneck")
    found = least_threshold(problem, stop)
    assert not found.complete and problem.evaluate(found.answer).feasible and found.evidence is not None and found.evidence.value == 0.0
