import functools

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings, strategies as st

from waybound.heuristics.routing.tour_steps.matching_kernels import minimum_weight_perfect_matching

GO, HALT = np.zeros(1, np.int64), np.ones(1, np.int64)


def least_weight(weights: np.ndarray) -> int:
    n = len(weights)

    @functools.cache
    def rest(matched: int) -> int:
        free = [k for k in range(n) if not matched >> k & 1]
        return min((int(weights[free[0], k]) + rest(matched | 1 << free[0] | 1 << k) for k in free[1:]), default=0)

    return rest(0)


def weight_of(weights: np.ndarray, partner: np.ndarray) -> int:
    every = np.arange(len(weights))
    assert (partner[partner] == every).all() and (partner != every).all()
    return int(weights[every, partner].sum()) // 2


@settings(max_examples=draws(300), deadline=None)
@given(st.integers(0, 10**6), st.integers(0, 7), st.sampled_from([2, 4, 30, 10**9]), st.booleans())
def test_it_weighs_least(seed: int, half: int, most: int, plane: bool) -> None:
    rng, n = np.random.default_rng(seed), 2 * half
    if plane:
        xy = rng.integers(0, most, (n, 2))
        weights = np.abs(xy[:, None] - xy[None]).sum(axis=-1)
    else:
        upper = np.triu(rng.integers(-most // 2, most, (n, n)), 1)
        weights = upper + upper.T
    assert weight_of(weights, minimum_weight_perfect_matching(GO, weights)) == least_weight(weights)


@pytest.mark.parametrize("seed", range(3))
def test_it_weighs_as_much_as_that_of_another_library(seed: int) -> None:
    networkx = pytest.importorskip("networkx")
    rng = np.random.default_rng(seed)
    xy = rng.integers(0, 60, (60, 2))  # many ties, and blossoms within blossoms
    weights = np.abs(xy[:, None] - xy[None]).max(axis=-1)
    graph = networkx.Graph()
    graph.add_weighted_edges_from((i, j, int(weights[i, j])) for i in range(60) for j in range(i))
    theirs = sum(int(weights[i, j]) for i, j in networkx.min_weight_matching(graph))
    assert weight_of(weights, minimum_weight_perfect_matching(GO, weights)) == theirs


def test_asked_to_stop_it_leaves_some_without_a_partner() -> None:
    xy = np.random.default_rng(1).integers(0, 1000, (40, 2))
    assert (minimum_weight_perfect_matching(HALT, np.abs(xy[:, None] - xy[None]).sum(axis=-1)) < 0).any()
