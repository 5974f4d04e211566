import itertools
import math

import numpy as np
import pytest
from bin_assignments import enumerated, random_costs, worked
from coded import coded
from draws import draws

from waybound import BinAssignment, InputError
from waybound.formulations.auctions.checking.pair_cover import check_pair_cover


def test_no_choice_of_robots_and_bins_proves_more_than_the_least_largest_cost_and_some_proves_it() -> None:
    rng = np.random.default_rng(4)
    for _ in range(draws(60)):
        costs = random_costs(rng, 4)
        problem = BinAssignment.from_matrix(costs, objective="bottleneck")
        n, m = costs.shape
        found = [
            check_pair_cover(problem, {"robots": list(robots), "bins": list(bins)})
            for a in range(n + 1) for robots in itertools.combinations(range(n), a)
            for b in range(m + 1) for bins in itertools.combinations(range(m), b)
        ]  # fmt: skip
        most, _, largest = enumerated(costs)
        if most:
            assert max(found) == largest


def test_of_sums_it_proves_only_that_there_is_no_answer() -> None:
    assert check_pair_cover(worked("O"), {"robots": [], "bins": []}) == -math.inf
    none = BinAssignment.from_matrix([[1.0, math.inf], [2.0, math.inf]], match="robots")
    assert check_pair_cover(none, {"robots": [], "bins": [0]}) == math.inf
    assert check_pair_cover(none, {"robots": [0], "bins": []}) == -math.inf


def test_evidence_of_another_shape_is_refused() -> None:
    for data in ({}, {"robots": [0]}, {"robots": [2], "bins": []}, {"robots": [0.0], "bins": []}, {"robots": [True], "bins": []}):
        with pytest.raises(InputError, check=coded("malformed")):
            check_pair_cover(worked("O"), data)
