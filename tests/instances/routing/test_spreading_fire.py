import numpy as np
from hypothesis import given, strategies as st

from waybound.instances.routing.spreading_fire import spreading_fire


def test_a_fire_without_wind_or_roughness_is_round_and_with_wind_an_ellipse():
    rng = np.random.default_rng(1)
    fire, _ = spreading_fire(rng, 41, 0.5, 0.0, 0.0, 2.0)
    x, y = np.meshgrid(np.arange(41) - 20, np.arange(41) - 20)
    distance = np.hypot(x, y)
    assert (fire.arrival >= distance / 0.5 * (1 - 1e-12)).all()
    assert (fire.arrival <= 1.03 * distance / 0.5 + 1e-9).all()  # sixteen directions
    windy, wind = spreading_fire(rng, 41, 0.5, 0.8, 0.0, 2.0)
    origin = np.argwhere(windy.arrival == 0)[0][::-1]
    ahead, behind = origin + np.rint(5 * wind).astype(int), origin - np.rint(5 * wind).astype(int)
    ratio = windy.arrival[tuple(behind[::-1])] / windy.arrival[tuple(ahead[::-1])]
    assert 6.5 < ratio <= 9.0 + 1e-9  # (1 + e) / (1 - e) = 9 where the wind blows along one of the directions
    assert windy.intensity[tuple(ahead[::-1])] > 5 * windy.intensity[tuple(behind[::-1])]


@given(st.integers(0, 10**6))
def test_fires_spread_and_fronts_lie_between_burnt_and_free(seed):
    fire, _ = spreading_fire(np.random.default_rng(seed), 20, 0.5, 0.7, 0.5, 3.0)
    assert (fire.arrival == 0).sum() == 1 and np.isfinite(fire.arrival).all()
    for time in (5, 20):
        burnt, front = fire.arrival <= time, fire.front(time)
        free = np.pad(~burnt, 1)
        beside = free[:-2, 1:-1] | free[2:, 1:-1] | free[1:-1, :-2] | free[1:-1, 2:]
        assert (front == (burnt & beside)).all()
