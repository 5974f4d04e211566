import numpy as np
import pytest
from bin_assignments import enumerated, random_costs
from draws import draws
from scipy.sparse.csgraph import maximum_bipartite_matching

from waybound.formulations.auctions import matching
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


@pytest.mark.parametrize("looks", [8, 0])
def test_paths_of_many_pairs_find_as_many_as_hopcroft_and_karp(looks: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without a look left they give up, and say so."""
    from scipy.sparse import random as random_matrix

    monkeypatch.setattr(matching, "MANY_PAIRS", 0)
    monkeypatch.setattr(matching, "LOOKS", looks)
    rng = np.random.default_rng(4)
    for _ in range(draws(150)):
        n, m = (int(k) for k in rng.integers(1, 40, 2))
        density = float(rng.choice([0.03, 0.1, 0.3]))
        graph = random_matrix(n, m, density=density, format="csr", random_state=rng)
        found = matching.largest_matching(graph.indptr, graph.indices, m)
        held = found[found >= 0]
        assert len(np.unique(held)) == len(held) and all(graph[i, j] for i, j in enumerate(found.tolist()) if j >= 0)
        assert len(held) == (maximum_bipartite_matching(graph, perm_type="column") >= 0).sum()
