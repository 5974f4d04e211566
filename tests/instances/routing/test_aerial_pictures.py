import math

import numpy as np
import pytest
from coded import coded

from waybound.instances.errors import InputError
from waybound.instances.routing.aerial_pictures import Arms


def test_one_place_above_each_square_of_a_footprint():
    arms = Arms((20, 20), [70, 10, 40], 0.1, 0.5)
    assert [(layer.altitude, layer.side, len(layer.cells), layer.noise) for layer in arms.layers] == [
        (10, 1, 400, 5.0), (40, 4, 17**2, 20.0), (70, 7, 14**2, 35.0),
    ]  # fmt: skip
    assert len(arms) == 400 + 17**2 + 14**2
    assert arms.places[0].tolist() == [0.5, 0.5, 10] and arms.places[400].tolist() == [2.0, 2.0, 40]
    assert arms.cells(401).tolist() == [20 * y + x for y in range(4) for x in range(1, 5)]
    assert set(np.concatenate([layer.cells.ravel() for layer in arms.layers]).tolist()) == set(range(400))


def test_every_footprint_is_centred_below_its_place():
    arms = Arms((5, 7), [10, 30], 0.1, 1.0)
    y, x = np.mgrid[:5, :7] + 0.5
    np.testing.assert_allclose(arms.means(x.ravel()), arms.places[:, 0])
    np.testing.assert_allclose(arms.means(y.ravel()), arms.places[:, 1])
    assert arms.sums(np.ones(35)).tolist() == [1.0] * 35 + [9.0] * 15


@pytest.mark.parametrize(
    ("altitudes", "view", "noise", "message", "code"),
    [
        ([], 0.1, 1.0, "no altitude", "missing"),
        ([10, 10], 0.1, 1.0, "given once each", "out-of-range"),
        ([-5], 0.1, 1.0, "must be positive", "out-of-range"),
        ([math.inf], 0.1, 1.0, "must be positive", "out-of-range"),
        ([10], 0.1, 0.0, "noise of a measurement", "out-of-range"),
        ([10, 40], 0.1, 1.0, "from 40 m is larger than the field; expected at most 3 x 5 cells; found 4 x 4", "out-of-range"),
    ],
)
def test_altitudes_and_noise_that_make_no_pictures_are_refused(altitudes, view, noise, message, code):
    with pytest.raises(InputError, match=message, check=coded(code)):
        Arms((3, 5), altitudes, view, noise)
