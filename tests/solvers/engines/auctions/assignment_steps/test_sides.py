import numpy as np
import pytest
from bin_assignments import enumerated, random_costs, worked
from draws import draws

from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.stop import NEVER
from waybound.solvers.engines.auctions.assignment_steps.auction import auction
from waybound.solvers.engines.auctions.assignment_steps.sides import joined, least_paid, price_evidence, sides, split

INF = np.inf


def test_the_fewer_bid() -> None:
    assert [part.rows_are_robots for part in sides(worked("F"))] == [True]
    (part,) = sides(worked("E"))
    assert not part.rows_are_robots and (part.num_rows, part.num_columns) == (2, 3)
    np.testing.assert_array_equal(part.cost.reshape(2, 3), worked("E").matrix().T)


def test_both_halves_are_kept_apart_and_a_level_makes_one_proof_of_them() -> None:
    """Two robots for one bin, and a robot that may be sent there too, but has two bins of its own."""
    problem = BinAssignment.from_matrix([[4.0, INF, INF], [3.0, INF, INF], [1.0, 5.0, 7.0]])
    parts = sides(problem)
    assert [(p.rows_are_robots, p.row_numbers.tolist(), p.column_numbers.tolist()) for p in parts] == [
        (True, [2], [1, 2]),
        (False, [0], [0, 1]),
    ]
    made = auction(problem, NEVER)
    assert made.answer == (-1, 0, 1) and split(problem, parts, made.answer)[1].tolist() == [1]
    assert joined(problem, parts, split(problem, parts, made.answer)) == made.answer
    assert made.evidence(problem, "x").value == 8.0


def test_prices_of_the_sides_prove_what_they_do_there() -> None:
    rng = np.random.default_rng(9)
    for _ in range(draws(80)):
        costs = random_costs(rng, 5)
        problem = BinAssignment.from_matrix(costs)
        parts = sides(problem)
        prices = [np.zeros(part.num_columns) for part in parts]
        own = sum(float(least_paid(part, given).sum()) for part, given in zip(parts, prices, strict=True))
        assert price_evidence(problem, parts, prices, "x").value == pytest.approx(own, abs=1e-9)
        assert own <= enumerated(costs)[1] + 1e-9
