import itertools
import math

import numpy as np
import pytest
from small_routing import small
from truth.routing import best_values

from waybound.formulations.stop import NEVER
from waybound.solvers.bounds.routing.restricted_master import Pool
from waybound.solvers.bounds.routing.routes_at_hand import best_choice
from waybound.solvers.bounds.routing.set_partition import set_partition


@pytest.mark.parametrize("feature", ["capacity", "limited-fleet", "heterogeneous-fleet", "multiple-depots", "prizes", "reward"])
@pytest.mark.parametrize("seed", range(2))
def test_of_all_routes_the_best_answer_is_chosen(feature: str, seed: int) -> None:
    problem = small(feature, seed, "exact")
    partition, best = set_partition(problem), best_values(problem)
    assert partition is not None and best is not None
    pool, n = Pool(), len(partition.row)
    every = [walk for size in range(1, n) for walk in itertools.permutations(range(1, n), size)]
    routes = [(kind, np.array(walk)) for kind in range(len(partition.types)) for walk in every]
    for kind, walk in routes:
        alone = problem.evaluate(partition.routes([(kind, walk)]))
        if {violation.check for violation in alone.violations} <= {"visits"}:  # others are missing
            pool.add([(kind, walk)])
    answer = best_choice(pool, partition, np.zeros(len(pool)), math.inf, 30.0, NEVER)
    assert answer is not None and problem.evaluate(answer).values[0] == pytest.approx(best[0])


def test_nothing_is_chosen_where_routes_do_not_go_together() -> None:
    partition, pool = set_partition(small("capacity", 1, "exact")), Pool()
    assert partition is not None
    pool.add([(0, np.array([1, 2])), (0, np.array([2, 3])), (0, np.array([4, 4]))])
    assert best_choice(pool, partition, np.zeros(3), math.inf, 30.0, NEVER) is None
    assert best_choice(pool, partition, np.ones(3), 0.5, 30.0, NEVER) is None
