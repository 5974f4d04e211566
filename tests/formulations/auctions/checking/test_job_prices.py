import math

import numpy as np
import pytest
from coded import coded
from draws import draws
from knapsack_assignments import enumerated, random_assignment, worked

from waybound import GeneralisedAssignment, InputError
from waybound.formulations.auctions.checking import job_prices
from waybound.formulations.auctions.checking.job_prices import check_capacity_need, check_job_prices


@pytest.mark.share(5)
@pytest.mark.parametrize("scale", [1.0, 2.0**-40, 1e-9, 1e9, 1e140])
def test_any_prices_prove_no_more_than_what_holds(scale: float) -> None:
    rng = np.random.default_rng(3)
    proved = 0
    for _ in range(draws(100)):
        problem = random_assignment(rng, 4, scale)
        best = enumerated(problem)
        n = problem.num_jobs
        for prices in (rng.integers(-5, 25, n) * scale, rng.random(n) * 20 * scale, np.zeros(n)):
            bound = check_job_prices(problem, {"prices": prices.tolist()})
            if best is not None:
                assert bound <= best if problem.objective == "cost" else bound >= best
                proved += bound == best
        weights = rng.random(problem.num_agents) * scale
        if best is not None:
            nothing = -math.inf if problem.objective == "cost" else math.inf
            assert check_capacity_need(problem, {"weights": weights.tolist()}) == nothing
    assert proved


@pytest.mark.parametrize("unit", [1.0, 2.0**-46, 2.0**-1000, 2.0**46, 0.75])
def test_what_is_packed_exactly_is_in_any_unit(unit: float) -> None:
    """One agent, room for 9, jobs of 5 and one of nothing: values of sqrt(2) have no step to which the bound in parts could be rounded."""
    values = math.sqrt(2.0) * np.array([[1.0, 2.0, 3.0, 1.0]])
    problem = GeneralisedAssignment.from_arrays(values, np.array([[5.0, 5.0, 5.0, 0.0]]) * unit, [9.0 * unit], "profit")
    assert check_job_prices(problem, {"prices": [0.0] * 4}) == pytest.approx(4.0 * math.sqrt(2.0), rel=1e-12)


def test_whole_consumption_is_packed_exactly_and_other_in_part(monkeypatch: pytest.MonkeyPatch) -> None:
    """One agent, room for 9, jobs of 5: one is done; in parts nine fifths of one would be."""
    problem = GeneralisedAssignment.from_arrays(np.ones((1, 3)), np.full((1, 3), 5.0), [9.0], "profit")
    prices = {"prices": [0.0, 0.0, 0.0]}
    assert check_job_prices(problem, prices) == 1.0
    monkeypatch.setattr(job_prices, "MOST_STEPS", 0.0)
    assert check_job_prices(problem, prices) == 1.0, "1.8 lies between whole numbers"
    uneven = GeneralisedAssignment.from_arrays([[1.0, math.sqrt(2.0)]], [[5.0, 5.0]], [9.0], "profit")
    assert check_job_prices(uneven, {"prices": [0.0, 0.0]}) == pytest.approx(math.sqrt(2.0) + 0.8)


def test_jobs_that_need_more_than_there_is_prove_that_there_is_no_answer() -> None:
    crowded = GeneralisedAssignment.from_arrays(np.ones((2, 2)), np.full((2, 2), 3.0), [3.0, 2.0])
    assert check_capacity_need(crowded, {"weights": [1.0, 1.0]}) == math.inf
    assert check_capacity_need(crowded, {"weights": [0.0, 1.0]}) == -math.inf
    enough = GeneralisedAssignment.from_arrays(np.ones((2, 2)), np.full((2, 2), 3.0), [3.0, 3.0])
    assert check_capacity_need(enough, {"weights": [1.0, 1.0]}) == -math.inf, "the need is met exactly"
    tiny = GeneralisedAssignment.from_arrays(np.ones((1, 3)), np.full((1, 3), 5e-324), [1.5e-323])
    assert check_capacity_need(tiny, {"weights": [0.5]}) == -math.inf, "subnormal numbers round"


def test_evidence_of_another_shape_is_refused() -> None:
    for data in ({}, {"prices": [1.0]}, {"prices": [1.0, 2.0, None]}, {"prices": [1.0, 2.0, math.inf]}, {"prices": [1.0, 2.0, True]}):
        with pytest.raises(InputError, check=coded("malformed")):
            check_job_prices(worked(), data)


def test_overflow_proves_nothing() -> None:
    assert check_job_prices(worked(), {"prices": [1e299, -1e299, 1e299]}) < 6.0
    huge = GeneralisedAssignment.from_arrays(np.full((2, 2), 1e150), np.full((2, 2), 1e150), 1e150)
    assert check_job_prices(huge, {"prices": [1e150, 1e150]}) <= 2e150
