import math
from itertools import pairwise

import numpy as np
import pytest
from random_sensing import optimum

from waybound.instances.sata.sensing_graph import graph_of_edges
from waybound.reports.benchmarks.saddle import FAMILIES
from waybound.solvers.engines.sata.saddle_steps import whole_game
from waybound.solvers.engines.sata.saddle_steps.halpern import HalpernPrimalDual
from waybound.solvers.engines.sata.saddle_steps.whole_game import GrowingPace, Pace, play


def paced(*gaps_by_work: tuple[float, float], kind: type[Pace] = Pace) -> Pace:
    pace = kind()
    for work, gap in gaps_by_work:
        pace.note(work, 1.0, 1.0 + gap)
    return pace


def test_the_work_left_follows_the_power_of_the_past():
    assert paced((1.0, 1e-1), (2.0, 0.5e-1)).left(1e-2) == pytest.approx(8.0)  # gap = 0.1 / work: 10 in all
    assert paced((1.0, 1e-1), (10.0, 1e-3)).left(1e-5) == pytest.approx(90.0)


def test_nothing_is_known_before_two_turns_and_standing_still_is_without_hope():
    assert paced((1.0, 1e-1)).left(1e-2) == 0.0
    assert paced((1.0, 1e-1), (5.0, 1e-1)).left(1e-2) == math.inf
    assert paced((1.0, 1e-1), (5.0, 1e-3)).left(1e-2) == 0.0
    assert paced((1.0, math.inf), (5.0, 1e-1)).left(1e-2) == 0.0


def test_turns_that_grow_are_projected():
    doubling = tuple((2.0**k, 0.5**k) for k in range(1, 7))  # a turn costs twice the one before, and halves the gap
    for first in range(4):
        pace = paced(*doubling[first:], kind=GrowingPace)
        assert pace.projected(0.5**9) == pytest.approx(64.0 + 128.0 + 256.0) and pace.left(0.5**9) >= pace.projected(0.5**9)
    assert paced((1.0, 0.1), (2.0, 0.05), kind=GrowingPace).projected(1e-9) == 0.0
    assert paced((1.0, math.inf), (2.0, 0.1), (3.0, 0.01), kind=GrowingPace).projected(1e-9) == 0.0


def test_a_costly_first_turn_does_not_make_growing_ones_look_cheap():
    """After a first turn of 250, turns of 70 and 120 halve the gap each: as a power of the work that is steep, but the next is of 200."""
    turns = (250.0, 8e-3), (320.0, 4e-3), (440.0, 2e-3)
    assert paced(*turns).left(2.5e-4) < 600.0 < 1000.0 < paced(*turns, kind=GrowingPace).left(2.5e-4)


@pytest.mark.parametrize("family", ["torus", "expander", "planted"])
def test_both_methods_are_tried_and_the_gap_is_closed(family, make_game):
    graph = FAMILIES[family](400)
    game = make_game(graph, 1e-6)
    matched, pointed = play(game)
    assert matched > 0 and pointed > 0
    assert game.record.closed() and game.record.value == pytest.approx(optimum(graph), rel=2e-6)


def test_without_a_normal_matrix_regret_matching_goes_on_alone(make_game):
    rng = np.random.default_rng(0)
    robot, target = np.repeat(np.arange(8), 300), np.tile(np.arange(150), 16)
    graph = graph_of_edges(np.arange(16) // 2, np.repeat(np.arange(16), 150), target, rng.uniform(0.5, 1.5, len(robot)), robots=8)
    game = make_game(graph, 1e-3)
    matched, pointed = play(game)
    assert matched > 0 and pointed == 0 and game.record.closed()


def test_an_interior_point_that_cannot_move_leaves_the_rest_to_regret_matching(make_game, monkeypatch):
    monkeypatch.setattr(whole_game.InteriorPoint, "step", lambda self: False)
    game = make_game(FAMILIES["expander"](100), 1e-3)
    matched, pointed = play(game)
    assert matched > whole_game.FIRST_STEPS and pointed == 0 and game.record.closed()


def test_an_interior_point_that_is_given_up_rests_longer_each_time(make_game, monkeypatch):
    game, began, spent = make_game(FAMILIES["expander"](400), 1e-6), [], [0.0]

    def given_up(self) -> bool:
        began.append(game.limits.work - spent[0])
        spent[0] += game.limits.most_work - game.limits.work
        game.limits.work = game.limits.most_work
        return False

    monkeypatch.setattr(whole_game.InteriorPoint, "step", given_up)
    monkeypatch.setattr(whole_game, "_refine_few", lambda *given: None)
    play(game)
    assert game.record.closed() and len(began) > 2
    assert all(after >= 2.0 ** (k + 1) * before for k, (before, after) in enumerate(pairwise(began)))


@pytest.mark.parametrize("share", [0.31, 0.29])
def test_an_answer_is_levelled_out_once_few_targets_fall_short(share, make_game):
    graph = FAMILIES["planted"](2000)
    game = make_game(graph, 1e-3)
    method = HalpernPrimalDual(game)
    method.run(200)
    shares, cover = method.conclude()
    wanted = np.quantile(cover, share)
    game.record.bound = wanted * (1.0 + game.record.gap)  # as if it were proved
    before, work = game.record.value, game.limits.work
    whole_game._refine_few(game, shares.copy(), cover, method.work)
    assert (game.record.value > before) == (share < whole_game.LEVELLED)
    assert game.limits.work <= work + (whole_game.LEVEL_SHARE + whole_game.REFINE_SHARE) * method.work + game.pass_work
