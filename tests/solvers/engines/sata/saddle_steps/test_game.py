import numpy as np
import pytest
from draws import draws
from hypothesis import given, settings
from random_sensing import even_graph, optimum, random_graph
from ratio_strategies import graphs
from sata_cases import dense_weights

from waybound.formulations.sata.balls import coverage, even_shares, weights_bound
from waybound.formulations.sata.bottleneck_sata import BottleneckSATA
from waybound.formulations.stop import Stop
from waybound.formulations.verified_bounds import verified_bound
from waybound.solvers.bounds.sata.ball import weights_evidence
from waybound.solvers.engines.sata.saddle_steps.game import Game, Limits, Record, RegretMatching
from waybound.solvers.engines.sata.saddle_steps.halpern import HalpernPrimalDual
from waybound.solvers.engines.sata.saddle_steps.programs import Programs


def deficit(cover, level):
    return float((np.maximum(level - cover, 0.0) ** 2).sum())


def is_division(graph, shares):
    load = np.bincount(graph.robot_of_action, shares, minlength=graph.num_robots)
    return (shares >= 0).all() and load == pytest.approx(np.ones(graph.num_robots))


@settings(deadline=None, max_examples=draws(60))
@given(graphs(every_target_seen=True))
def test_descent_never_raises_the_deficits_and_keeps_shares_a_division(graph):
    game = Game(graph, Record(graph, 1e-3), Limits(Stop(60.0)), Programs(Stop(60.0)))
    shares = even_shares(graph)
    cover = coverage(graph, shares)
    level, before = 2.0 * float(cover.min()), deficit(cover, 2.0 * float(cover.min()))
    game.descend(shares, cover, level, 1e-6 * level, 1e5)
    assert is_division(graph, shares)
    assert cover == pytest.approx(coverage(graph, shares), rel=1e-9, abs=1e-9)
    assert deficit(cover, level) <= before * (1 + 1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_descent_at_a_level_that_can_be_had_reaches_it(seed, make_game):
    graph = random_graph(seed, robots=60, targets=30)
    game, shares = make_game(graph), even_shares(graph)
    cover, level = coverage(graph, shares), 0.97 * optimum(graph)
    assert game.descend(shares, cover, level, 1e-6, 1e8)
    assert coverage(graph, shares).min() >= level - 1e-3


@pytest.mark.parametrize("seed", range(5))
def test_deficits_at_a_rest_are_weights_of_a_bound_below_the_level(seed, make_game):
    graph = random_graph(seed, robots=60, targets=30)
    game, shares, best = make_game(graph), even_shares(graph), optimum(graph)
    cover, level = coverage(graph, shares), 1.1 * best
    assert game.descend(shares, cover, level, 1e-9, 1e9)
    short = np.nonzero(level - cover > 1e-9)[0]
    bound = weights_bound(graph, short, level - cover[short])
    assert best * (1 - 1e-9) <= bound < level
    d = level - cover[short]
    assert bound == pytest.approx(level - (d @ d) / d.sum(), rel=1e-4)


def test_descent_looks_at_no_robot_far_from_a_deficit(make_game):
    graph = random_graph(3, robots=2000, targets=2000, sees=2)
    game, shares = make_game(graph), even_shares(graph)
    cover = coverage(graph, shares)
    level = float(np.sort(cover)[3])
    game.descend(shares, cover, level, 1e-9, 1e9)
    assert 0 < game.limits.work < 0.1 * graph.num_edges


def test_descent_ends_with_its_work(make_game):
    graph = even_graph(1, 3000)
    game, shares = make_game(graph), even_shares(graph)
    assert not game.descend(shares, coverage(graph, shares), 3.0, 1e-9, 1e5)
    assert 1e5 <= game.limits.work < 2e5


def test_the_record_keeps_the_best_of_what_it_is_offered(make_game):
    graph = random_graph(4)
    record, news = make_game(graph).record, []
    record._news = lambda record, what: news.append(what)
    good, bad = even_shares(graph), np.zeros(graph.num_actions)
    record.offer(bad)
    record.offer(good)
    record.offer(bad)
    assert (record.value, news) == (coverage(graph, good).min(), ["answer", "answer"])
    record.prove(np.arange(3), np.ones(3))
    first = record.bound
    record.prove(np.arange(3), np.ones(3), 2 * first)
    assert (record.bound, len(record.targets), news[2:]) == (first, 3, ["bound"])


def test_the_record_rounds_bounds_up_as_the_checker_does(make_game):
    graph = random_graph(5)
    record, rng = make_game(graph).record, np.random.default_rng(0)
    problem = BottleneckSATA(graph, fractional=True)
    for _ in range(50):
        weights = rng.random(4)
        record.bound = np.inf
        record.prove(np.arange(4), weights)
        assert verified_bound(problem, weights_evidence(record.targets, record.weights, 0.0, "")) <= record.bound


def test_limits_name_what_is_reached():
    assert Limits(Stop(60.0)).reached() == ""
    assert Limits(Stop(0.0)).reached() == "time"
    asked = Stop(60.0)
    asked.ask()
    assert Limits(asked).reached() == "interrupt"
    limits = Limits(Stop(60.0), most_work=10.0)
    limits.work = 10.0
    assert limits.reached() == "iterations"


# -- regret matching on the whole game ----------------------------------------------------------------------------------


def dense_play(graph, steps):
    """The same game by its definition: mean shares and mean prices, with weights t^2."""
    weights = dense_weights(graph)
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


@pytest.mark.parametrize("method", [RegretMatching, HalpernPrimalDual])
def test_prices_prove_the_bound_of_the_record(method, make_game):
    graph = random_graph(3)
    game = make_game(graph)
    playing = method(game)
    playing.run(100)
    playing.conclude()
    assert weights_bound(graph, game.record.targets, game.record.weights) == pytest.approx(game.record.bound, rel=1e-12)


def test_it_stops_at_a_limit(make_game):
    graph = random_graph(4)
    game = make_game(graph)
    game.limits.most_work = 10 * game.pass_work
    matching = RegretMatching(game)
    matching.run(1000)
    assert matching.steps == 10
