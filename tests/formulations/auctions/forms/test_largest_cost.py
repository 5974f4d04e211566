"""Form ``largest-cost``: the bottleneck as a mixed-integer program."""

from __future__ import annotations

import numpy as np
import pytest
from bin_assignments import BOTTLENECKS, enumerated, random_costs, worked
from draws import draws

import waybound as wb
from waybound.formulations.auctions.bin_assignment import BinAssignment


@pytest.mark.parametrize("name", BOTTLENECKS)
def test_worked_bottlenecks(name: str) -> None:
    found = wb.solve(worked(name, objective="bottleneck"), "highs")
    assert (found.objective, found.bound, found.bound_kind, found.form) == (BOTTLENECKS[name],) * 2 + ("verified", "largest-cost")


def test_the_program_agrees_with_enumeration_negative_costs_and_forbidden_pairs_included() -> None:
    rng = np.random.default_rng(8)
    for _ in range(draws(25)):
        costs = random_costs(rng, 4)
        most, _, largest = enumerated(costs)
        found = wb.solve(BinAssignment.from_matrix(costs, objective="bottleneck"), "highs", bound_time=0)
        assert found.objective == (largest if most else 0.0) and not found.faults


def test_an_answer_is_a_point_of_the_program() -> None:
    made = worked("K4", objective="bottleneck").compile("largest-cost")
    assert made.encode is not None
    vector = made.encode((1, 2, 3, 0))
    assert made.program.residual(vector) == 0.0 and made.program.value(vector) == 12.0
