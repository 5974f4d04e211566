import itertools
import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from waybound.instances.sata.phd_filter import Mixture
from waybound.instances.sata.tracks import TrackRules, Tracks, forecast, ospa


def mixture(*places, weight=1.0, variance=1.0):
    means = np.array(places, dtype=float).reshape(-1, 2)
    return Mixture(np.full(len(means), weight), means, np.tile(variance * np.eye(2), (len(means), 1, 1)))


@pytest.mark.parametrize(
    ("ones", "others", "distance"),
    [
        ([(0, 0)], [(3, 4)], 5.0), ([(9 * k, k) for k in range(8)], [(9 * k, k) for k in range(10)], 44.721360),
        ([(0, 0), (10, 0)], [(0, 3), (10, 4), (50, 50)], 57.807151), ([], [], 0.0), ([], [(1, 1)], 100.0), ([(0, 0)], [(500, 0)], 100.0),
    ],
)  # fmt: skip
def test_known_distances(ones, others, distance):
    assert ospa(np.array(ones, dtype=float).reshape(-1, 2), np.array(others, dtype=float).reshape(-1, 2)) == pytest.approx(
        distance, abs=1e-6
    )


@given(st.integers(0, 10**6), st.integers(0, 5), st.integers(0, 5), st.sampled_from([1.0, 2.0]))
def test_distances_agree_with_all_assignments(seed, count, further, order):
    rng = np.random.default_rng(seed)
    ones, others, third = (rng.normal(size=(n, 2)) * 60 for n in (count, further, 3))
    small, large = sorted((ones, others), key=len)
    best = min(
        sum(min(math.dist(a, large[k]), 100.0) ** order for a, k in zip(small, chosen, strict=True))
        + 100.0**order * (len(large) - len(small))
        for chosen in itertools.permutations(range(len(large)), len(small))
    )
    expected = (best / len(large)) ** (1 / order) if len(large) else 0.0
    assert ospa(ones, others, order=order) == pytest.approx(expected)
    assert ospa(others, ones, order=order) == pytest.approx(expected)
    assert ospa(ones, others, order=order) <= ospa(ones, third, order=order) + ospa(third, others, order=order) + 1e-9


def test_a_track_counts_from_its_third_step_and_outlives_gaps():
    tracks = Tracks(TrackRules(confirm=3, patience=1))
    lengths = []
    for places in ([(0, 0)], [(1, 0)], [(2, 0)], [], [(3, 0)], [], [], [(3, 0)]):
        tracks.follow(mixture(*places))
        lengths.append((len(tracks.confirmed), [track.length for track in tracks.all]))
    assert lengths == [(0, [1]), (0, [2]), (1, [3]), (0, [3]), (1, [4]), (0, [4]), (0, []), (0, [1])]


def test_light_components_are_no_targets_and_doubles_no_tracks():
    tracks = Tracks(TrackRules())
    tracks.follow(mixture((0, 0), weight=0.5))
    assert not tracks.all
    tracks.follow(mixture((0, 0), (50, 0)))
    tracks.follow(mixture((50.5, 0), (0.2, 0), (1.0, 0)))  # the third is in the gate of the first track, which has a nearer one
    assert [track.component for track in tracks.all] == [1, 0]


def test_the_nearest_pair_comes_first():
    tracks = Tracks(TrackRules())
    tracks.follow(mixture((0, 0), (3, 0)))
    tracks.follow(mixture((2.0, 0), (4.5, 0)))
    assert [track.path[-1].tolist() for track in tracks.all] == [[0.0, 0.0], [2.0, 0.0]] and tracks.all[0].component is None


def test_motion_does_not_depend_on_where_the_origin_is():
    """With a prior mean of 0, as printed, predictions of a target at rest fall back to the origin."""
    assert forecast(np.tile([100.0, 40.0], (10, 1)), 20.0, 0.5) == pytest.approx([100, 40])
    line = np.column_stack([np.arange(20.0), np.zeros(20)])
    assert forecast(line + np.array([70, -9]), 20.0, 0.1) == pytest.approx(forecast(line, 20.0, 0.1) + np.array([70, -9]))
    assert 18.5 < forecast(line, 20.0, 0.1)[0] < 20.5


def test_the_forecast_is_a_gaussian_process():
    """Against the formula written out: one datum y = 2 at distance 1 with unit kernel and noise variance 0.1 gives 1.102783."""
    assert 2 * math.exp(-0.5) / 1.1 == pytest.approx(1.102783, abs=1e-6)
    path, scale, noise = np.array([[0.0, 1.0], [2.0, 0.0], [1.0, 5.0]]), 2.0, math.sqrt(0.1)
    kernel = np.array([[math.exp(-0.5 * ((i - j) / scale) ** 2) + 0.1 * (i == j) for j in range(3)] for i in range(3)])
    near = np.array([math.exp(-0.5 * ((3 - j) / scale) ** 2) for j in range(3)])
    centre = path.mean(axis=0)
    assert forecast(path, scale, noise) == pytest.approx(centre + near @ np.linalg.inv(kernel) @ (path - centre))


def test_only_confirmed_tracks_move():
    tracks = Tracks(TrackRules(confirm=3, length_scale=20.0, kernel_noise=0.1))
    for k in range(5):
        own = mixture((k, 0), (90, 90)) if k < 3 else mixture((k, 0))
        tracks.follow(own)
    own = mixture((4, 0), (60, 60))
    tracks.follow(own)
    moved = tracks.predict(own)
    assert moved.means[0, 0] != 4 and moved.means[1].tolist() == [60, 60]
    tracks = Tracks(TrackRules(window=0))
    for _ in range(4):
        tracks.follow(own)
    assert np.array_equal(tracks.predict(own).means, own.means)
