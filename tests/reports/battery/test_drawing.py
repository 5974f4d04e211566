import numpy as np

from waybound.reports.battery.drawing import HUGE, TINY, weights, whole


def test_whole_numbers_reach_both_ends() -> None:
    drawn = whole(np.random.default_rng(1), 1000, -2, 3)
    assert sorted(set(drawn.tolist())) == [-2.0, -1.0, 0.0, 1.0, 2.0, 3.0]
    assert np.frexp([TINY, HUGE])[0].tolist() == [0.5, 0.5]  # exact factors


def test_weights_are_positive_and_of_all_sizes() -> None:
    rng = np.random.default_rng(2)
    drawn = [weights(rng, (2, 3)) for _ in range(200)]
    assert all(made.shape == (2, 3) and (made > 0.0).all() for made in drawn)
    assert min(made.min() for made in drawn) < 1e-4 and max(made.max() for made in drawn) > 1e9
    assert (weights(np.random.default_rng(3), 5) == weights(np.random.default_rng(3), 5)).all()
