"""Matchings of the most pairs, and what proves them so."""

from __future__ import annotations

import numpy as np
from bin_assignments import enumerated, random_costs
from draws import draws

from waybound.formulations.auctions.bin_assignment import BinAssignment
from waybound.formulations.auctions.matching import largest_matching, surplus_rows


def test_matchings_are_as_large_as_enumeration_says_and_covers_are_no_larger() -> None:
    rng = np.random.default_rng(5)
    for _ in range(draws(150)):
        costs = random_costs(rng, 5)
        problem = BinAssignment.from_matrix(costs)
        found = largest_matching(problem.indptr, problem.bins, problem.num_bins)
        used = found[found >= 0]
        assert len(set(used.tolist())) == len(used) == enumerated(costs)[0]
        assert np.isfinite(costs[np.nonzero(found >= 0)[0], used]).all()
        rows, columns = surplus_rows(problem.indptr, problem.bins, problem.num_bins, found)
        assert (~rows[problem.robots] | columns[problem.bins]).all(), "a pair that neither of them meets"
        assert int((~rows).sum() + columns.sum()) == len(used)
