from itertools import combinations

import numpy as np
import pytest

from waybound.solvers.bounds.routing.restricted_master import Pool
from waybound.solvers.bounds.routing.route_rows import KINDS, LEAST, RouteLoad, RouteRow, violated_rows, visited


@pytest.mark.parametrize("seed", range(4))
def test_rows_that_are_found_are_violated_and_no_partition_violates_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pairs = [pair for part in np.split(rng.permutation(np.arange(1, 13)), 4) for pair in combinations(part.tolist(), 2)]
    visits, values = np.array([np.isin(np.arange(13), pair) for pair in pairs]).T, np.full(12, 0.5)
    rows = violated_rows(visits, values, set())
    assert rows and len({row.key for row in rows}) == len(rows)
    for row in rows:
        assert values @ row.counted(visits.T) > row.right + LEAST
        for _ in range(20):
            parts = np.array_split(rng.permutation(np.arange(1, 13)), int(rng.integers(1, 6)))
            assert row.counted(np.array([np.isin(np.arange(13), part) for part in parts])).sum() <= row.right
    assert not {row.key for row in rows} & {row.key for row in violated_rows(visits, values, {row.key for row in rows})}


def test_coefficients_are_those_of_whom_routes_visit() -> None:
    pool = Pool()
    pool.add([(0, np.array([1, 2, 3])), (0, np.array([4])), (0, np.array([5, 1, 4]))])
    rows = [RouteRow((1, 2, 3)), RouteRow((1, 4, 5, 2), (2, 1, 1, 1), 3)]
    assert RouteRow.coefficients(rows, pool, 0).tolist() == [[1.0, 1.0], [0.0, 0.0], [0.0, 1.0]]
    assert RouteRow.coefficients(rows, pool, 2).tolist() == [[0.0, 1.0]]
    assert RouteLoad.coefficients([RouteLoad((4, 5), 2.0)], pool, 0).tolist() == [[0.0], [1.0], [1.0]]
    assert visited(pool, 1, 6)[0].tolist() == [False, False, False, False, True, False]
    assert all(RouteRow(tuple(range(1, len(w) + 1)), w, d).right == sum(w) // d for w, d in KINDS)
