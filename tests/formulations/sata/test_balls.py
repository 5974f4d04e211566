from dataclasses import replace

import numpy as np
import pytest
from random_sensing import chain_graph, random_graph
from sata_cases import dense_weights

from waybound.formulations.sata.balls import (  # fmt: skip
    actions_of,
    ball_graph,
    coverage,
    even_shares,
    grown,
    near_one,
    num_edges,
    robots_seeing,
    targets_seen,
    weights_bound,
)
from waybound.instances.sata.sensing_graph import graph_of_edges


@pytest.fixture
def graph():
    return random_graph(1)


def test_neighbours_are_those_of_the_dense_matrix(graph):
    weights, targets = dense_weights(graph), np.array([0, 7, 11])
    seeing = np.unique(graph.robot_of_action[weights[:, targets].any(axis=1)])
    assert robots_seeing(graph, targets).tolist() == seeing.tolist()
    actions = np.nonzero(np.isin(graph.robot_of_action, seeing))[0]
    assert sorted(actions_of(graph, seeing)) == actions.tolist()
    assert targets_seen(graph, actions).tolist() == np.nonzero(weights[actions].any(axis=0))[0].tolist()


def test_a_ball_has_the_edges_of_its_targets_and_no_others(graph):
    weights, targets = dense_weights(graph), np.array([2, 3, 17])
    ball = ball_graph(graph, targets)
    actions = np.nonzero(weights[:, targets].any(axis=1))[0]
    assert np.array_equal(dense_weights(ball), weights[np.ix_(actions, targets)])
    robots = np.unique(graph.robot_of_action[actions])
    assert robots[ball.robot_of_action].tolist() == graph.robot_of_action[actions].tolist()
    assert (ball.num_robots, ball.num_edges) == (len(robots), num_edges(graph, targets))


def test_the_ball_of_all_targets_is_the_graph_without_idle_actions(graph):
    ball = ball_graph(graph, np.arange(graph.num_targets))
    assert ball.num_edges == graph.num_edges
    assert not len(ball.unseen_targets)


def test_a_ball_grows_to_twice_its_edges_by_whole_hops():
    graph = chain_graph(0, 50)
    assert grown(graph, np.array([10]), 1000).tolist() == [9, 10, 11]
    assert grown(graph, np.array([9, 10, 11]), 1000).tolist() == [7, 8, 9, 10, 11, 12, 13]


def test_a_ball_stops_growing_when_it_is_whole_or_would_be_too_large():
    graph = chain_graph(0, 50)
    assert grown(graph, np.arange(50), 1000) is None
    assert grown(graph, np.array([10]), 5) is None
    apart = graph_of_edges([0, 1], [0, 1], [0, 1], robots=2, targets=2)
    assert grown(apart, np.array([0]), 1000) is None


def test_weights_bound_is_the_best_weighted_sum_over_the_sum_of_weights(graph):
    rng = np.random.default_rng(3)
    targets, y = np.array([1, 4, 5, 9]), rng.random(4)
    worth = dense_weights(graph)[:, targets] @ y
    best = sum(worth[graph.robot_of_action == i].max() for i in range(graph.num_robots))
    assert weights_bound(graph, targets, y) == pytest.approx(best / y.sum(), rel=1e-12)


def test_even_shares_and_their_coverage(graph):
    shares = even_shares(graph)
    assert np.bincount(graph.robot_of_action, shares) == pytest.approx(np.ones(graph.num_robots))
    assert coverage(graph, shares) == pytest.approx(shares @ dense_weights(graph))


@pytest.mark.parametrize("size", [1e-250, 1e-3, 1.0, 1e9])
def test_a_unit_near_the_value_changes_no_digit(graph, size):
    large = replace(graph, weights=graph.weights * size)
    near, unit = near_one(large)
    assert np.array_equal(near.weights, large.weights * unit)
    assert np.array_equal(near.weights / unit, large.weights)
    assert 1 / 8 <= coverage(near, even_shares(near)).min() <= 8
    assert (unit == 1.0) == (size == 1.0)


def test_weights_of_all_sizes_at_once_stay_as_they_are():
    graph = graph_of_edges([0, 1], [0, 1], [0, 1], [1e-300, 1e300], robots=2)
    assert near_one(graph) == (graph, 1.0)
