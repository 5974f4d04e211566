import numpy as np
import pytest
from bin_assignments import OPTIMA, enumerated, random_costs, worked
from draws import draws

import waybound as wb
from waybound import BinAssignment, Exactness
from waybound.solvers.backend import BACKENDS, Control, Options


def flow(problem: BinAssignment):
    return BACKENDS["min-cost-flow"]().run(problem, Options(), Control())


def test_random_assignments_agree_with_enumeration() -> None:
    rng = np.random.default_rng(17)
    for _ in range(draws(60)):
        costs = random_costs(rng, 5)
        problem = BinAssignment.from_matrix(costs)
        raw = flow(problem)
        assert problem.evaluate(raw.answer).feasible
        assert raw.objective == pytest.approx(enumerated(costs)[1], abs=1e-9)


def test_whole_costs_are_exact_and_others_are_rounded_which_is_said() -> None:
    assert flow(worked("K4")).holds is Exactness.EXACT
    raw = flow(BinAssignment.from_matrix([[0.1, 1e-9], [0.3, 0.7]]))
    assert raw.holds is Exactness.RESTRICTION and raw.links[0].told.startswith("costs counted in steps of")


@pytest.mark.slow
def test_through_solve_its_prices_prove_the_optimum() -> None:
    found = wb.solve(worked("K4"), "min-cost-flow", bound_time=60)
    assert (found.objective, found.bound, found.bound_kind, found.status) == (OPTIMA["K4"], 38.0, "verified", "optimal")
