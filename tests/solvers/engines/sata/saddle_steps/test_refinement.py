import numpy as np
import pytest
from random_sensing import chain_graph, even_graph, optimum, random_graph

from waybound.formulations.sata.balls import coverage, even_shares
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.solvers.engines.sata.saddle_steps.refinement import refine


def check(game, best):
    record = game.record
    assert record.value == coverage(game.graph, record.shares).min()
    assert record.value <= best * (1 + 1e-9)
    assert record.bound >= best * (1 - 1e-9)


@pytest.mark.share(3)
@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("seed", range(4))
def test_a_gap_that_is_a_matter_of_clusters_is_closed(seed, gap, make_game):
    graph = random_graph(seed, robots=500, targets=400)
    game = make_game(graph, gap)
    refine(game, even_shares(graph), 1e8)
    check(game, optimum(graph))
    assert game.record.closed()
    assert game.record.bound <= game.record.value * (1 + gap)


def test_it_works_on_the_targets_that_fall_short_alone(make_game):
    # One robot has two targets for itself; all others have plenty.
    graph = random_graph(1, robots=3000, targets=1000, sees=4)
    owner = np.append(graph.robot_of_action, [3000, 3000])
    action = np.append(graph.action_of_edge, [graph.num_actions, graph.num_actions + 1])
    joined = graph_of_edges(
        owner, action, np.append(graph.indices, [1000, 1001]), np.append(graph.weights, [0.2, 0.2]), robots=3001, targets=1002
    )
    game = make_game(joined, 1e-4)
    refine(game, even_shares(joined), 1e8)
    assert game.record.value == pytest.approx(0.1)
    assert game.record.closed()
    assert set(game.record.targets.tolist()) <= {1000, 1001}
    assert game.limits.work < 0.05 * joined.num_edges


def test_what_matters_far_away_is_left_with_a_valid_record(make_game):
    graph = even_graph(2, 3000)
    game = make_game(graph, 1e-6)
    refine(game, even_shares(graph), 1e6)
    assert not game.record.closed()
    assert game.record.value < game.record.bound


def test_small_graphs_are_solved_by_one_program_whatever_their_kind(make_game):
    graph = even_graph(3, 300)
    game = make_game(graph, 1e-7)
    refine(game, even_shares(graph), 1e7)
    check(game, optimum(graph))
    assert game.record.closed()


def test_chains_are_priced_by_balls_that_grow(make_game):
    graph = chain_graph(4, 200)
    game = make_game(graph, 1e-5)
    refine(game, even_shares(graph), 1e8)
    check(game, optimum(graph))
    assert game.record.closed()


def test_a_start_that_is_good_is_not_made_worse(make_game):
    graph = random_graph(6)
    game = make_game(graph, 1e-9)
    refine(game, even_shares(graph), 1e8)
    again = make_game(graph, 1e-3)
    refine(again, game.record.shares.copy(), 0.0)
    assert again.record.value == game.record.value


def test_it_ends_at_a_limit_with_an_answer_and_a_bound(make_game):
    graph = even_graph(7, 2000)
    game = make_game(graph, 1e-9, most_work=1e4)
    refine(game, even_shares(graph), 1e9)
    assert game.limits.reached() == "iterations"
    assert 0 < game.record.value < game.record.bound < np.inf
