import math

import numpy as np
import pytest
from coded import coded

from waybound.instances.errors import InputError
from waybound.instances.routing.aerial_pictures import Arms
from waybound.instances.routing.gaussian_process import SquaredExponential
from waybound.instances.routing.worlds.hotspot_identification import HotspotWorld, read_field
from waybound.instances.worlds import make_world

FIELD = np.arange(12.0).reshape(3, 4)


def world(field=FIELD, noise=1e-8, **how):
    arms = Arms(field.shape, [10, 20], 0.1, noise)
    return HotspotWorld(field, arms, SquaredExponential(5.0, 0.3), np.random.default_rng(0), **{"budget": 30.0, **how})


def test_time_is_spent_on_flights_and_pictures():
    w = world(sensing_time=2.0)
    w.step({0: 5})
    assert w.place.tolist() == [1.5, 1.5, 10] and w.left == pytest.approx(30 - math.hypot(1.5, 1.5) - 2)
    w.step({0: 12})
    assert w.place.tolist() == [1.0, 1.0, 20] and w.left == pytest.approx(28 - math.hypot(1.5, 1.5) - math.hypot(0.5, 0.5, 10) - 2)
    assert (w.time, w.taken) == (2, (5, 12))
    assert w.metrics()["collected"] == pytest.approx(5.0 + (0 + 1 + 4 + 5) / 4)
    w.step({0: 12})
    assert w.metrics()["collected"] == pytest.approx(7.5) and w.metrics()["pictures"] == 3


def test_measurements_are_of_the_field_below():
    w = world(pixels=1)
    w.step({0: 11})
    assert w.belief.mean[11] == pytest.approx(11.0, abs=1e-3)
    assert w.metrics()["point"] == 100.0
    w.step({0: 12})  # between the cells 0, 1, 4 and 5
    assert w.belief.mean[[0, 1, 4, 5]] == pytest.approx([2.5 * math.exp(-0.25 / 0.09)] * 4, rel=0.25)


def test_noise_grows_with_altitude_and_is_drawn_whatever_is_decided():
    off = []
    for arm, cell in ((5, 5), (12, 5)):  # from 10 m, and from 30 m, where the same cell is in the middle
        errors = []
        for seed in range(100):
            arms = Arms((3, 4), [10, 30], 0.1, 0.4)
            w = HotspotWorld(np.full((3, 4), 8.0), arms, SquaredExponential(1e4, 1e-3), np.random.default_rng(seed), pixels=1)
            w.step({0: arm})
            errors.append(w.belief.mean[cell] - 8.0)
        off.append(np.array(errors))
    np.testing.assert_allclose(off[1], math.sqrt(3.0) * off[0], atol=1e-5)
    assert off[0].std() == pytest.approx(2.0, rel=0.2)


def test_the_flight_ends_without_an_order_or_without_time():
    w = world()
    assert not w.over
    w.step({})
    assert w.over and w.time == 1
    with pytest.raises(InputError, match="no time is left for arm 0; expected at most 0", check=coded("contradiction")):
        w.step({0: 0})
    w = world(budget=3.0, sensing_time=2.0)
    w.step({0: 0})
    assert w.over


@pytest.mark.parametrize(
    ("actions", "message", "code"),
    [
        ({1: 0}, "no such robot", "unknown-name"),
        ({0: 18}, "told no arm; expected 0 to 17", "malformed"),
        ({0: 1.5}, "told no arm", "malformed"),
        ({0: 17}, "no time is left for arm 17", "contradiction"),
    ],
)
def test_orders_that_cannot_be_followed_change_nothing(actions, message, code):
    w = world(budget=9.0)
    w.step({0: 0})
    before = (w.left, w.taken, w.belief, w.metrics())
    with pytest.raises(InputError, match=message, check=coded(code)):
        w.step(actions)
    assert (w.left, w.taken, w.belief, w.metrics()) == before


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ({"budget": 0.5}, "the budget does not suffice for one picture; expected at least 1.7"),
        ({"field": np.zeros((3, 3))}, "a field needs finite intensities"),
        ({"field": np.full((3, 3), -1.0)}, "a field needs finite intensities"),
        ({"field": np.full((3, 3), np.nan)}, "a field needs finite intensities"),
        ({"noise": 1e-10}, "the noise is too small beside the deviation of the prior; expected at least 2.5e-08"),
        ({"field": np.ones((61, 60))}, "too many cells; expected at most 3600; found 3660"),
        ({"noise": -1.0}, "noise of a measurement must be positive"),
        ({"start": (-1.0, 0.0)}, "starts outside the field"),
        ({"start": (0.0, np.nan)}, "starts outside the field"),
        ({"budget": np.nan}, "budget be finite"),
        ({"sensing_time": -1.0}, "must take time"),
        ({"pixels": 0}, "a pixel be measured"),
    ],
)
def test_what_cannot_be_flown_is_refused_at_once(how, message):
    with pytest.raises(InputError, match=message, check=coded("out-of-range")):
        world(**how)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"altitudes": "10;40"}, "altitudes are numbers with commas"),
        ({"altitudes": "10,-40"}, "altitudes must be positive"),
        ({"size": 5}, "a picture from 70 m is larger than the field"),
        ({"budget": 0}, "does not suffice for one picture"),
    ],
)
def test_settings_that_fit_nothing_are_refused(settings, message):
    with pytest.raises(InputError, match=message):
        make_world("hotspot-identification", 1, **settings)


def test_a_field_of_ones_own(tmp_path):
    path = tmp_path / "field.csv"
    path.write_text("1,2,3\n4,5,6\n")
    assert read_field(str(path)).tolist() == [[4, 5, 6], [1, 2, 3]]
    w = make_world("hotspot-identification", 1, file=str(path), altitudes="10,20")
    assert w.values.tolist() == [4, 5, 6, 1, 2, 3]
    path.write_text("1,2,3\n4,5\n")
    with pytest.raises(InputError, match="cannot be read as a table"):
        read_field(str(path))
    for text, message in (("", "is empty"), ("###\n###\n", "cannot be read as a table of numbers")):
        path.write_text(text)
        with pytest.raises(InputError, match=message):
            read_field(str(path))
    path.write_text("1,-2,3\n4,5,6\n")
    with pytest.raises(InputError, match="finite intensities of at least 0"):
        make_world("hotspot-identification", 1, file=str(path), altitudes="10")


def test_fields_have_the_largest_intensity_asked_for_and_are_the_seeds():
    one, same, other = (make_world("hotspot-identification", seed) for seed in (5, 5, 6))
    assert one.values.max() == pytest.approx(50.0) and one.values.min() >= 0.0
    assert np.array_equal(one.values, same.values) and not np.array_equal(one.values, other.values)
