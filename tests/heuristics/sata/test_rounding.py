from __future__ import annotations

import numpy as np
import pytest

from waybound.heuristics.sata.rounding import largest_shares
from waybound.instances.errors import UsageError
from waybound.instances.sata.sensing_graph import graph_of_edges

GRAPH = graph_of_edges([0, 0, 1, 1, 1, 2], [0, 1, 2, 3, 4], [0, 0, 0, 0, 0], robots=4, targets=1)


def test_each_robot_takes_its_largest_share() -> None:
    shares = np.array([0.3, 0.7, 0.5, 0.2, 0.3, 0.0])
    for ties in ("last", "first", "random"):
        assert largest_shares(GRAPH, shares, ties, np.random.default_rng(1)).tolist() == [1, 2]


def test_ties_follow_the_rule_also_where_rounding_tells_shares_apart() -> None:
    shares = np.array([0.5, 0.5 - 1e-13, 0.4 - 1e-12, 0.4, 0.2, 0.0])
    assert largest_shares(GRAPH, shares).tolist() == [1, 3]
    assert largest_shares(GRAPH, shares, "first").tolist() == [0, 2]
    drawn = {tuple(largest_shares(GRAPH, shares, "random", np.random.default_rng(seed)).tolist()) for seed in range(40)}
    assert drawn == {(0, 2), (0, 3), (1, 2), (1, 3)}


def test_shares_that_differ_by_more_are_no_tie() -> None:
    assert largest_shares(GRAPH, np.array([0.5 + 1e-6, 0.5 - 1e-6, 0, 0, 1, 0])).tolist() == [0, 4]


def test_shares_of_other_robots_join_no_tie() -> None:
    count = 1000  # robots with two actions each; all shares together are a run without a gap
    shares = np.full(2 * count, 0.5)
    shares[0::2] += np.arange(1, count + 1) * 0.9e-9
    shares[1::2] -= np.arange(1, count + 1) * 0.9e-9
    robots = np.repeat(np.arange(count), 2)
    graph = graph_of_edges(robots, np.arange(2 * count), np.zeros(2 * count), robots=count, targets=1)
    assert largest_shares(graph, shares).tolist() == list(range(0, 2 * count, 2))


def test_robots_without_shares_take_no_action_and_the_order_of_actions_is_free() -> None:
    graph = graph_of_edges([2, 0, 2, 0], [0, 1, 2, 3], [0, 0, 0, 0], robots=3, targets=1)
    assert largest_shares(graph, np.array([0.5, 0.9, 0.5, 0.1])).tolist() == [1, 2]
    assert largest_shares(graph, np.zeros(4)).tolist() == []


def test_an_unknown_rule_and_random_without_a_generator_are_refused() -> None:
    with pytest.raises(UsageError, match="ties must be last, first or random"):
        largest_shares(GRAPH, np.zeros(6), "lowest")
    with pytest.raises(UsageError, match="random generator"):
        largest_shares(GRAPH, np.zeros(6), "random")
