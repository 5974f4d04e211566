import numpy as np
import pytest

from waybound.reports.benchmarks.saddle import FAMILIES
from waybound.solvers.engines.sata.saddle_steps.halpern import HalpernPrimalDual
from waybound.solvers.engines.sata.saddle_steps.restarts import Restarts


def after(*went: float, steps: int = 1000) -> Restarts:
    """One after steps that each went as far as told, where it was looked at them; the dual side stays where it is."""
    method = Restarts(np.zeros(1), np.zeros(1), (np.ones(1), np.ones(1)), 1.0)
    method.note(steps)
    method.since = 0
    for far in went:
        method.note(1)
        at = method.since
        method.point[0][:] = at / (at + 1) * 2.0 * far  # reflected from 0, and drawn to an anchor of 0
        method.ahead[0][:] = far
        method.look()
    return method


@pytest.mark.parametrize(
    ("went", "restarts"),
    [((1.0, 0.9, 0.5), 0), ((1.0, 0.19), 1), ((1.0, 0.5, 0.6), 1), ((1.0, 0.5, 0.9), 0), ((1.0, 0.19, 1.0, 0.9), 1)],
)
def test_a_restart_comes_where_steps_are_short_or_grow_again(went, restarts):
    assert after(*went).count == restarts


def test_a_restart_comes_after_a_share_of_all_steps():
    assert after(1.0, 1.0, 1.0, 1.0, steps=3).count == 1 and after(1.0, steps=0).count == 0


def test_a_restart_goes_on_from_the_last_plain_step_and_weighs_the_sides_by_how_far_they_came():
    method = Restarts(np.zeros(2), np.ones(1), (np.full(2, 0.25), np.ones(1)), 2.0)
    for shares in (4.0, 0.4):
        method.note(1)
        method.ahead[0][0], method.ahead[1][0] = shares, 1.4
        method.point[0][0], method.point[1][0] = (shares, 1.4) if method.since == 1 else (4 * shares / 3, 1 + 1.6 / 3)
        method.look()
    assert method.count == 1 and method.since == 0
    assert method.weight == pytest.approx(np.sqrt(2.0 * 0.8 / 0.4))  # 0.4 in parts of sqrt(0.25), and 0.4
    for values in (method.point, method.anchor):
        assert values[0].tolist() == [0.4, 0.0] and values[1].tolist() == [1.4]


def test_restarts_pay(make_game, monkeypatch):
    gaps = []
    for look in (Restarts.look, lambda self: None):
        monkeypatch.setattr(Restarts, "look", look)
        game = make_game(FAMILIES["planted"](900))
        method = HalpernPrimalDual(game)
        method.run(1500)
        method.conclude()
        gaps.append(game.record.bound / game.record.value - 1)
    assert gaps[0] < 0.5 * gaps[1]
