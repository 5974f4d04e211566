from __future__ import annotations

import numpy as np
import pytest
from random_sensing import even_graph, optimum, random_graph

from waybound.formulations.sata.balls import coverage, weights_bound
from waybound.solvers.engines.sata.saddle_steps.regret import RegretMatching


def dense_play(graph, steps):
    """The same game by its definition: mean shares and mean prices, with weights t^2."""
    weights = np.zeros((graph.num_actions, graph.num_targets))
    weights[graph.action_of_edge, graph.indices] = graph.weights
    owner = graph.robot_of_action
    count = np.bincount(owner)
    x, y = 1.0 / count[owner], np.full(graph.num_targets, 1.0 / graph.num_targets)
    r, s = np.zeros(len(x)), np.zeros(len(y))
    plays = []
    for _ in range(steps):
        worth = weights @ y
        ahead = worth - np.bincount(owner, worth * x)[owner]
        r = np.maximum(r + ahead, 0.0)
        next_x = np.maximum(r + ahead, 0.0)
        total = np.bincount(owner, next_x)[owner]
        x = np.where(total > 0, next_x / np.where(total > 0, total, 1.0), x)
        cover = x @ weights
        behind = cover @ y - cover
        s = np.maximum(s + behind, 0.0)
        next_y = np.maximum(s + behind, 0.0)
        y = next_y / next_y.sum() if next_y.sum() > 0 else y
        plays.append((x, y))
    square = np.arange(1, steps + 1) ** 2
    return tuple(np.average([p[k] for p in plays], axis=0, weights=square) for k in (0, 1))


def test_the_compiled_game_is_the_game_by_its_definition(make_game):
    graph = random_graph(1)
    matching = RegretMatching(make_game(graph))
    matching.run(3)
    matching.run(22)
    shares, prices = dense_play(graph, 25)
    found, cover = matching.conclude()
    assert found == pytest.approx(shares, abs=1e-12)
    assert cover == pytest.approx(coverage(graph, shares), abs=1e-12)
    assert matching._mean_prices == pytest.approx(prices, abs=1e-12)


@pytest.mark.slow
def test_means_are_answers_and_prices_and_the_gap_between_them_shrinks(make_game):
    graph = even_graph(2, 1000)
    game, gaps = make_game(graph), []
    matching, best = RegretMatching(game), optimum(graph)
    for steps in (50, 350, 2800):
        matching.run(steps)
        shares, _ = matching.conclude()
        assert np.bincount(graph.robot_of_action, shares) == pytest.approx(np.ones(graph.num_robots))
        assert game.record.value <= best * (1 + 1e-9)
        assert game.record.bound >= best * (1 - 1e-9)
        gaps.append(game.record.bound / game.record.value - 1)
    assert gaps[1] < gaps[0] / 4
    assert gaps[2] < gaps[1] / 4


def test_prices_prove_the_bound_of_the_record(make_game):
    graph = random_graph(3)
    game = make_game(graph)
    matching = RegretMatching(game)
    matching.run(100)
    matching.conclude()
    assert weights_bound(graph, game.record.targets, game.record.weights) == pytest.approx(game.record.bound, rel=1e-12)


def test_it_stops_at_a_limit(make_game):
    graph = random_graph(4)
    game = make_game(graph)
    game.limits.most_work = 10 * game.pass_work
    matching = RegretMatching(game)
    matching.run(1000)
    assert matching.steps == 10
