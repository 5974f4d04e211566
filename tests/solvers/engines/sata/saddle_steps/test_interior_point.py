import dataclasses

import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings
from random_sensing import even_graph, optimum, random_graph
from ratio_strategies import graphs

from waybound.formulations.sata.balls import coverage, even_shares, weights_bound
from waybound.formulations.stop import Stop
from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.reports.benchmarks.saddle import FAMILIES
from waybound.solvers.engines.sata.saddle_steps.game import Game, Limits, Record
from waybound.solvers.engines.sata.saddle_steps.interior_point import InteriorPoint
from waybound.solvers.engines.sata.saddle_steps.normal_kernels import move_robots
from waybound.solvers.engines.sata.saddle_steps.programs import Programs


def point_of(game: Game) -> InteriorPoint:
    found = InteriorPoint.begun(game, even_shares(game.graph), np.ones(game.graph.num_targets))
    assert found is not None
    return found


def closed(game: Game, most: int = 100) -> InteriorPoint:
    point = point_of(game)
    while not game.record.closed() and point.steps < most and point.step():
        pass
    return point


@settings(deadline=None, max_examples=draws(60))
@given(graphs(every_target_seen=True))
def test_each_point_is_a_division_and_a_bound(graph):
    game = Game(graph, Record(graph, 1e-6), Limits(Stop(60.0)), Programs(Stop(60.0)))
    point, best = point_of(game), optimum(graph)
    for _ in range(12):
        if not point.step():
            break
        record = game.record
        load = np.bincount(graph.robot_of_action, record.shares, minlength=graph.num_robots)[graph.robot_of_action]
        assert load == pytest.approx(np.ones(graph.num_actions))
        assert coverage(graph, record.shares).min() == pytest.approx(record.value, rel=1e-12)
        assert weights_bound(graph, record.targets, record.weights) <= record.bound
        assert record.value <= best * (1 + 1e-9) <= record.bound * (1 + 2e-9)


@pytest.mark.parametrize("family", ["torus", "expander", "planted"])
def test_it_closes_the_gap_where_all_targets_are_priced(family, make_game):
    graph = FAMILIES[family](400)
    game, best = make_game(graph, 1e-7), optimum(graph)
    closed(game)
    assert game.record.closed()
    assert game.record.value == pytest.approx(best, rel=2e-7)


@pytest.mark.parametrize("make", [random_graph, even_graph])
@pytest.mark.parametrize("seed", range(3))
def test_it_closes_the_gap_of_random_graphs(seed, make, make_game):
    graph = make(seed, 300)
    game = make_game(graph, 1e-5)
    closed(game)
    assert game.record.closed()
    assert game.record.value == pytest.approx(optimum(graph), rel=2e-5)


def test_a_robot_that_cannot_go_the_whole_step_goes_part_of_it_and_has_the_value_of_the_central_path(make_game):
    """Two robots of two actions each; the change takes the first one's second share below 0."""
    layout = make_game(graph_of_edges([0, 0, 1, 1], [0, 1, 2, 3], [0, 1, 0, 1], np.ones(4), robots=2)).layout
    worth, change, aim = np.array([1.0, 0.9, 0.5, 0.4]), np.array([0.3, -0.3, 0.1, -0.1]), 0.02
    shares, slacks, values = np.array([0.8, 0.2, 0.7, 0.3]), np.empty(4), np.array([1.03, 0.525])
    curved = move_robots(layout, worth, change, aim, 0.1, 0.1, shares, slacks, values)
    assert curved == 1
    assert shares == pytest.approx([0.98, 0.02, 0.8, 0.2])  # a tenth of the second share is left; the second robot goes all the way
    assert slacks == pytest.approx(np.repeat(values, 2) - worth) and (aim / slacks[:2]).sum() == pytest.approx(1.0)
    assert values[1] == 0.525


def test_targets_may_end_without_a_price(make_game):
    """Two robots that share nothing: the target that is covered twice as well has price 0 in the end."""
    graph = graph_of_edges([0, 1], [0, 1], [0, 1], [1.0, 2.0], robots=2)
    game = make_game(graph, 1e-6)
    closed(game)
    assert game.record.closed() and game.record.value == pytest.approx(1.0)
    assert game.record.weights[1] < 1e-4 * game.record.weights[0]


@pytest.mark.parametrize("decades", [9, 120, 290])
def test_weights_of_all_sizes_leave_true_claims(decades, make_game):
    graph = random_graph(3, robots=12, targets=8)
    weights = 10.0 ** np.random.default_rng(3).uniform(-decades, decades, graph.num_edges)
    graph = dataclasses.replace(graph, weights=weights)
    game = make_game(graph, 1e-6)
    point = point_of(game)
    while point.steps < 50 and point.step():
        pass
    record = game.record
    assert record.value == -np.inf or record.value == pytest.approx(coverage(graph, record.shares).min(), rel=1e-12)
    assert record.value <= record.bound * (1 + 1e-12)
    if np.isfinite(record.bound):
        assert weights_bound(graph, record.targets, record.weights) <= record.bound


def test_a_work_limit_stops_it_with_the_point_as_it_was(make_game):
    graph = FAMILIES["torus"](400)
    free = make_game(graph, 1e-6)
    closed(free)
    for share in (0.3, 0.7):
        game = make_game(graph, 1e-6, most_work=share * free.limits.work)
        point = point_of(game)
        while point.step():
            pass
        assert game.limits.work <= game.limits.most_work
        assert point.steps > 0 and 0 < game.record.value == point.value < free.record.value
        steps, game.limits.most_work = point.steps, np.inf
        assert point.step() and point.steps == steps + 1


def test_a_wish_to_stop_ends_it(make_game):
    game = make_game(FAMILIES["torus"](400))
    point = point_of(game)
    assert point.step()
    value = game.record.value
    game.limits.stop.ask()
    assert not point.step() and game.record.value == value


def test_robots_that_see_too_many_targets_at_once_are_left_to_regret_matching(make_game):
    targets = np.arange(200)
    graph = graph_of_edges(np.zeros(1), np.zeros(200), targets, np.ones(200), robots=1)
    assert InteriorPoint.begun(make_game(graph), even_shares(graph), np.ones(200)) is None
