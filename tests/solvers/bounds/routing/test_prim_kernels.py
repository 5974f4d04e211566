import itertools
import math

import numpy as np
import pytest
from scipy.sparse.csgraph import minimum_spanning_tree

from waybound.formulations.stop import NEVER, Stop
from waybound.solvers.bounds.routing.prim_kernels import spanning_tree_degrees


def symmetric(rng: np.random.Generator, n: int) -> np.ndarray:
    d = rng.integers(1, 12, (n, n)).astype(float)
    return np.minimum(d, d.T)


def trees(n: int):
    """The edges of every tree on n nodes, from its sequence of Prüfer."""
    for sequence in itertools.product(range(n), repeat=n - 2):
        degree = np.bincount(sequence, minlength=n) + 1
        edges = []
        for node in sequence:
            leaf = int(np.argmax(degree == 1))
            edges.append((leaf, node))
            degree[leaf] -= 1
            degree[node] -= 1
        edges.append(tuple(np.nonzero(degree)[0].tolist()))
        yield edges


@pytest.mark.parametrize("seed", range(8))
def test_the_tree_is_the_lightest_of_all_trees_with_prices_of_nodes(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 5
    d, price = symmetric(rng, n), rng.integers(-6, 7, n).astype(float)
    weight, degree = spanning_tree_degrees(NEVER.flag, d, price)
    best = min(sum(d[i, j] + price[i] + price[j] for i, j in edges) for edges in trees(n))
    assert weight == pytest.approx(best)
    assert degree.sum() == 2 * (n - 1) and (degree >= 1).all()


def test_degrees_are_those_of_the_tree() -> None:
    """A star around node 2 is lightest; paid prices count once an edge."""
    d = np.full((4, 4), 9.0)
    d[2, :] = d[:, 2] = 1.0
    weight, degree = spanning_tree_degrees(NEVER.flag, d, np.zeros(4))
    assert weight == 3.0 and degree.tolist() == [1, 1, 3, 1]
    weight, _ = spanning_tree_degrees(NEVER.flag, d, np.array([0.0, 0.0, 10.0, 0.0]))
    assert weight == 27.0 + 2.0  # two edges of 9 around node 2, which is met once, at 11


def test_large_ones_agree_with_scipy() -> None:
    d = symmetric(np.random.default_rng(1), 80)
    weight, degree = spanning_tree_degrees(NEVER.flag, d, np.zeros(80))
    tree = minimum_spanning_tree(np.triu(d, 1))
    assert weight == pytest.approx(tree.sum()) and degree.sum() == 158


def test_nodes_that_no_edge_joins_make_it_infinite() -> None:
    d = np.full((4, 4), math.inf)
    d[0, 1] = d[1, 0] = d[2, 3] = d[3, 2] = 1.0
    assert spanning_tree_degrees(NEVER.flag, d, np.zeros(4))[0] == math.inf


def test_one_node_is_a_tree() -> None:
    weight, degree = spanning_tree_degrees(NEVER.flag, np.zeros((1, 1)), np.array([5.0]))
    assert weight == 0.0 and degree.tolist() == [0]


def test_who_is_asked_to_stop_gives_no_weight() -> None:
    stop = Stop()
    stop.ask()
    weight, _ = spanning_tree_degrees(stop.flag, symmetric(np.random.default_rng(2), 50), np.zeros(50))
    assert math.isnan(weight)
