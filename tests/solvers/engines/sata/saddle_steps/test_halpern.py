import numpy as np
import pytest
from random_sensing import even_graph, optimum, random_graph
from sata_cases import dense_weights

from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.reports.benchmarks.saddle import FAMILIES
from waybound.solvers.engines.sata.saddle_steps import restarts
from waybound.solvers.engines.sata.saddle_steps.halpern import FIRST_WEIGHT, HalpernPrimalDual


def onto_simplex(values, total, lengths):
    """The least-squares projection, distances in parts of ``lengths``, by trying each set of positive entries that a threshold leaves."""
    for level in sorted(-values / lengths):
        kept = -values / lengths <= level
        found = (total - values[kept].sum()) / lengths[kept].sum()
        moved = np.maximum(0.0, values + found * lengths)
        if moved.sum() == pytest.approx(total):
            return moved
    raise AssertionError


def dense_steps(graph, steps):
    """The same method by its definition, on a dense matrix and without a restart."""
    weights, owner = dense_weights(graph), graph.robot_of_action
    heaviest = np.array([weights[owner == i].sum(axis=1).max() for i in range(graph.num_robots)])
    tau, sigma = FIRST_WEIGHT / heaviest[owner], 1.0 / weights.sum(axis=0) / FIRST_WEIGHT
    x = first_x = 1.0 / np.bincount(owner)[owner]
    y = first_y = np.ones(graph.num_targets)
    for step in range(steps):
        aim, new_x = x + tau * (weights @ y), np.empty(len(x))
        for i in range(graph.num_robots):
            new_x[owner == i] = onto_simplex(aim[owner == i], 1.0, np.ones((owner == i).sum()))
        new_y = onto_simplex(y - sigma * ((2 * new_x - x) @ weights), float(len(y)), sigma)
        part = (step + 1) / (step + 2)
        x, y = part * (2 * new_x - x) + (1 - part) * first_x, part * (2 * new_y - y) + (1 - part) * first_y
    return new_x, new_y


@pytest.mark.parametrize("seed", range(4))
def test_the_compiled_steps_are_the_method_by_its_definition(seed, make_game, monkeypatch):
    monkeypatch.setattr(restarts.Restarts, "look", lambda self: None)
    graph = random_graph(seed)
    method = HalpernPrimalDual(make_game(graph))
    method.run(3)
    method.run(22)
    shares, prices = method.means()
    wanted = dense_steps(graph, 25)
    assert shares == pytest.approx(wanted[0], abs=1e-9)
    assert prices == pytest.approx(wanted[1], abs=1e-9)


def test_answers_and_prices_are_feasible_and_the_gap_closes(make_game):
    graph = even_graph(2, 1000)
    game, best = make_game(graph), optimum(graph)
    method = HalpernPrimalDual(game)
    for _ in range(20):
        method.run(100)
        shares, _ = method.conclude()
        assert np.bincount(graph.robot_of_action, shares) == pytest.approx(np.ones(graph.num_robots))
        assert shares.min() >= 0.0
        assert game.record.value <= best * (1 + 1e-9)
        assert game.record.bound >= best * (1 - 1e-9)
    assert game.record.bound / game.record.value - 1 < 1e-4


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_no_unit_matters(unit, make_game):
    graph = FAMILIES["expander"](100)
    edges = graph.robot_of_action, graph.action_of_edge, graph.indices
    game = make_game(graph_of_edges(*edges, graph.weights * unit, robots=graph.num_robots))
    method = HalpernPrimalDual(game)
    method.run(200)
    method.conclude()
    plain = make_game(graph)
    other = HalpernPrimalDual(plain)
    other.run(200)
    other.conclude()
    assert game.record.value == pytest.approx(unit * plain.record.value, rel=1e-6)


def test_it_stops_at_a_limit(make_game):
    game = make_game(random_graph(4))
    game.limits.most_work = 10 * game.pass_work
    method = HalpernPrimalDual(game)
    method.run(1000)
    assert method.steps == 10
