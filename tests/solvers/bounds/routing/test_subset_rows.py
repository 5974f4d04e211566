import itertools

import numpy as np
import pytest
from draws import draws

from waybound.solvers.bounds.routing.restricted_master import Pool
from waybound.solvers.bounds.routing.subset_rows import LEAST, SubsetRow, violated


def pairs(route: list[int], cut: SubsetRow) -> int:
    """Pairs of visits by the definition."""
    odd, number = False, 0
    for node in route:
        odd = odd and bool(cut.memory[node])
        if node in cut.customers:
            number, odd = number + odd, not odd
    return number


@pytest.mark.parametrize("seed", range(draws(20)))
def test_coefficients_count_pairs_within_the_memory(seed: int) -> None:
    rng = np.random.default_rng(seed)
    routes = [rng.integers(1, 8, int(rng.integers(1, 9))) for _ in range(10)]
    pool = Pool()
    pool.add([(0, route) for route in routes])
    cuts = []
    for size in (3, 3, 5):
        customers = tuple(rng.choice(np.arange(1, 8), size, replace=False).tolist())
        memory = rng.random(8) < 0.6
        memory[list(customers)] = True
        cuts.append(SubsetRow(customers, memory))
    table = SubsetRow.coefficients(cuts, pool, 4)
    assert table.tolist() == [[pairs(route.tolist(), cut) for cut in cuts] for route in routes[4:]]
    for split in range(20):  # any answer: an order of all, cut anywhere
        order = np.random.default_rng(split).permutation(np.arange(1, 8)).tolist()
        ends = [0, *sorted(np.random.default_rng(split + 99).choice(np.arange(1, 7), 2, replace=False).tolist()), 7]
        answer = [order[a:b] for a, b in itertools.pairwise(ends)]
        assert all(sum(pairs(route, cut) for route in answer) <= cut.right for cut in cuts)


@pytest.mark.parametrize("seed", range(draws(20)))
def test_violated_cuts_are_found_with_memories_that_do(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pool = Pool()
    pool.add([(0, rng.permutation(np.arange(1, 7))[: int(rng.integers(2, 5))]) for _ in range(8)])
    values = rng.uniform(0.0, 0.8, len(pool))
    found = violated(pool, values, 7, {})
    truth = {}
    for three in itertools.combinations(range(1, 7), 3):
        full = SubsetRow(three, np.ones(7, dtype=bool))
        truth[three] = sum(v * pairs(r.tolist(), full) for v, r in zip(values.tolist(), pool.routes, strict=True)) - 1.0
    assert all(cut.memory[list(cut.customers)].all() for cut in found)
    for cut in found:
        here = float(values @ SubsetRow.coefficients([cut], pool, 0)[:, 0]) - cut.right
        assert here == pytest.approx(truth[cut.customers]) and here > LEAST
    assert bool(found) == (max(truth.values()) > LEAST)
