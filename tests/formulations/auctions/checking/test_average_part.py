import numpy as np
import pytest
from task_problems import best_partition_value, drawn, parts

from waybound import BalancedPartition, RobotTasks
from waybound.formulations.evidence import CHECKERS

check = CHECKERS["average-part"]


@pytest.mark.parametrize("edges", ["mst", "clique", "none"])
@pytest.mark.parametrize("scale", [2.0**-60, 1.0, 2.0**60])
def test_it_passes_no_optimum(edges, scale):
    rng = np.random.default_rng(7)
    for _ in range(25):
        team = drawn(rng, tasks=5)
        scaled = RobotTasks.of_distances(team.starts * scale, team.between * scale, weights=team.weights * scale)
        for objective in ("min-max", "min-difference"):
            best = best_partition_value(BalancedPartition(team, objective, edges)) * scale
            assert check(BalancedPartition(scaled, objective, edges), {}) <= best


def test_it_is_the_mean_of_what_all_parts_must_cost():
    assert check(parts([0, 1, 2, 6, 7]), {}) == pytest.approx(1.5, rel=1e-12)  # the tree of 7 without its edge of 4
    assert check(parts([0, 1, 2, 6, 7], edges="clique"), {}) == pytest.approx(2.5, rel=1e-12)  # four pairs: 1, 1, 1 and 2
    assert check(parts([0, 0], weights=[8, 1], edges="none"), {}) == pytest.approx(8.0, rel=1e-12)  # the heaviest alone
    assert check(parts([0, 0], weights=[8, 1], objective="min-difference"), {}) == 0.0


def test_parts_that_cannot_be_equal_differ():
    def bound(weights, robots=2, edges="none", tasks=None):
        return check(parts(tasks or [0] * len(weights), robots, weights=weights, edges=edges, objective="min-difference"), {})

    assert bound([3, 2, 2]) == 1.0 and bound([6, 4, 4]) == 2.0, "7 units are no two equal parts"
    assert bound([2, 2, 2, 2]) == 0.0 and bound([3, 3, 3, 3], 3) == 3.0 and bound([-3, 2, 2]) == 1.0
    assert bound([0.3, 0.2, 0.2]) == pytest.approx(0.1) and bound([0.3, 0.2, 0.2]) <= 0.1
    assert bound([9, 1, 1, 1]) == pytest.approx(6.0) and bound([9, 1, 1, 1], 3) == pytest.approx(7.5)
    assert bound([5, 3], 3) == pytest.approx(5.0) and bound([5, 3], 3) <= 5.0 and bound([0, 0], 3, "mst", [0, 4]) == 0.0


def test_no_least_difference_of_weights_is_below():
    rng = np.random.default_rng(8)
    for k in range(60):
        weights = rng.integers(-2 if k % 3 == 0 else 0, 9, int(rng.integers(1, 6))) * (1.0, 3.0, 0.1)[k % 3]
        asked = parts([0.0] * len(weights), int(rng.integers(1, 4)), weights=weights, edges="none", objective="min-difference")
        assert check(asked, {}) <= best_partition_value(asked)
