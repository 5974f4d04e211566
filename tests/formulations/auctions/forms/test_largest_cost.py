"""Form ``largest-cost``: the bottleneck as a mixed-integer program."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from bin_assignments import BOTTLENECKS, enumerated, random_costs, worked
from draws import draws
from program_text import expected, program_text

import waybound as wb
from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.problem import problem_from_instance
from waybound.instances.reading import read_instance


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


def test_largest_cost_from_text_to_text(tmp_path: Path) -> None:
    """Costs count from the least of them, 1.5; of p and q one gets bin a, the only one of both, so that there are two pairs."""
    (tmp_path / "t.csv").write_text("robot/bin,a,b,c\np,4,-,-\nq,3,-,-\nr,5,1.5,7\n")
    made = problem_from_instance(read_instance(tmp_path / "t.csv"), "bottleneck-assignment").compile("largest-cost")
    assert (made.form, made.exactness.value) == ("largest-cost", "exact")
    assert program_text(made.program) == expected(
        """
        min t + 1.5
        cost[p]: 2.5 x[p,a] - t <= 0
        cost[q]: 1.5 x[q,a] - t <= 0
        cost[r]: 3.5 x[r,a] + 5.5 x[r,c] - t <= 0
        robot[p]: 0 <= x[p,a] <= 1
        robot[q]: 0 <= x[q,a] <= 1
        robot[r]: 0 <= x[r,a] + x[r,b] + x[r,c] <= 1
        bin[a]: 0 <= x[p,a] + x[q,a] + x[r,a] <= 1
        bin[b]: 0 <= x[r,b] <= 1
        bin[c]: 0 <= x[r,c] <= 1
        pairs: x[p,a] + x[q,a] + x[r,a] + x[r,b] + x[r,c] = 2
        x[p,a], x[q,a], x[r,a], x[r,b], x[r,c] binary
        0 <= t <= 5.5
        """
    )
