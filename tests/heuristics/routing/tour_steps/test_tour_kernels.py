import itertools

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st

from waybound.heuristics.routing.tour_steps.tour_kernels import close, improve, nearest_neighbour, shortcut, spanning_tree

GO, HALT = np.zeros(1, np.int64), np.ones(1, np.int64)


def plane(rng: np.random.Generator, n: int, most: int = 20) -> np.ndarray:
    xy = rng.integers(0, most, (n, 2)).astype(float)
    return np.asarray(np.hypot(*(xy[:, None] - xy[None]).transpose(2, 0, 1)))


def length(costs: np.ndarray, tour: np.ndarray) -> float:
    return float(costs[tour, np.roll(tour, -1)].sum())


def nearest(costs: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(np.argsort(costs + np.diag(np.full(len(costs), np.inf)), axis=1, kind="stable")[:, :-1])


@settings(max_examples=draws(100), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 12))
def test_paths_are_shortest(seed: int, n: int) -> None:
    matrix = np.random.default_rng(seed).integers(0, 30, (n, n)).astype(float)
    np.fill_diagonal(matrix, 0.0)
    paths = matrix.copy()
    assert close(GO, paths)
    least = matrix
    for _ in range(n):
        least = np.minimum(least, (least[:, :, None] + matrix[None]).min(axis=1))
    assert (paths == least).all()
    assert not close(HALT, matrix)


@settings(max_examples=draws(100), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 6))
def test_the_tree_is_the_lightest_of_all(seed: int, n: int) -> None:
    costs = plane(np.random.default_rng(seed), n, 6)
    parent = spanning_tree(GO, costs)
    weight = sum(costs[k, parent[k]] for k in range(1, n))
    trees = (p for p in itertools.product(range(n), repeat=n - 1) if _rooted(p))
    assert weight == pytest.approx(min(sum(costs[k + 1, q] for k, q in enumerate(p)) for p in trees))
    assert _rooted(tuple(parent[1:]))
    assert n == 1 or len(spanning_tree(HALT, costs)) == 0


def _rooted(parents: tuple[int, ...]) -> bool:
    for node in range(1, len(parents) + 1):
        at, steps = node, 0
        while at and steps <= len(parents):
            at, steps = parents[at - 1], steps + 1
        if at:
            return False
    return True


@settings(max_examples=draws(100), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 15))
def test_a_walk_around_a_doubled_tree_meets_everybody_once_within_twice_its_weight(seed: int, n: int) -> None:
    costs = plane(np.random.default_rng(seed), n)
    parent, child = spanning_tree(GO, costs), np.arange(1, n)
    tour = shortcut(np.r_[child, child], np.r_[parent[1:], parent[1:]], n)
    assert sorted(tour) == list(range(n))
    assert length(costs, tour) <= 2 * sum(costs[k, parent[k]] for k in range(1, n)) + 1e-9


@settings(max_examples=draws(200), deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 14), st.integers(2, 30))
def test_no_move_is_left_that_shortens_the_tour(seed: int, n: int, most: int) -> None:
    rng = np.random.default_rng(seed)
    costs, tour = plane(rng, n, most), rng.permutation(n)
    before = length(costs, tour)
    improve(GO, tour, costs, nearest(costs))
    assert sorted(tour) == list(range(n))
    after = length(costs, tour)
    assert after <= before + 1e-9
    if n < 5:
        return
    for i, j in itertools.combinations(range(n), 2):
        assert length(costs, np.r_[tour[:i], tour[i : j + 1][::-1], tour[j + 1 :]]) >= after - 1e-6, "2-opt"
    for start, size in itertools.product(range(n), range(1, min(3, n - 3) + 1)):
        rolled = np.roll(tour, -start)
        path, rest = rolled[:size], rolled[size:]
        saved = costs[rest[-1], path[0]] + costs[path[-1], rest[0]] - costs[rest[-1], rest[0]]
        for at in range(len(rest)):
            for moved in (path, path[::-1]):
                if min(costs[rest[at - 1], moved[0]], costs[moved[-1], rest[at]]) < saved:
                    assert length(costs, np.r_[rest[:at], moved, rest[at:]]) >= after - 1e-6, "Or-opt"


def test_nearest_neighbour_takes_the_first_of_equals() -> None:
    costs = np.abs(np.subtract.outer([0.0, 1, -1, 3, -5], [0.0, 1, -1, 3, -5]))
    assert nearest_neighbour(GO, costs).tolist() == [0, 1, 2, 3, 4]
    assert sorted(nearest_neighbour(HALT, costs)) == [0, 1, 2, 3, 4]
