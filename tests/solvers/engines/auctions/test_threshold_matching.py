import numpy as np
import pytest
from bin_assignments import BOTTLENECKS, enumerated, random_costs, worked
from draws import draws

import waybound as wb
from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.engines.auctions.threshold_matching import least_threshold


@pytest.mark.parametrize("name", BOTTLENECKS)
def test_worked_bottlenecks_are_optimal_by_what_meets_all_cheaper_pairs(name: str) -> None:
    found = wb.solve(worked(name, objective="bottleneck"))
    assert (found.solver, found.objective, found.bound) == ("threshold-matching", BOTTLENECKS[name], BOTTLENECKS[name])
    assert found.bound_kind == "verified" and found.status == "optimal"


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
