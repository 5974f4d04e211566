import math

import numpy as np
import pytest

from waybound.instances.generators.draw import Draw


def draw(seed: int = 1) -> Draw:
    return Draw(np.random.default_rng(seed))


class Given(np.random.Generator):
    """A generator whose uniform numbers are given; whatever else is asked of it fails."""

    def __init__(self, *numbers: float) -> None:
        super().__init__(np.random.PCG64(0))
        self.numbers = list(numbers)

    def random(self, size=None, *rest, **more):  # type: ignore[no-untyped-def]
        if size is None:
            return self.numbers.pop(0)
        taken, self.numbers = self.numbers[: math.prod(np.atleast_1d(size))], self.numbers[math.prod(np.atleast_1d(size)) :]
        return np.array(taken).reshape(size)

    def __getattribute__(self, name):  # type: ignore[no-untyped-def]
        if name in ("integers", "normal", "uniform", "choice", "permutation", "shuffle", "triangular", "standard_normal"):
            raise AssertionError(f"numpy's {name} may change between releases")
        return super().__getattribute__(name)


JUST_BELOW_1 = 1.0 - 2.0**-53


def test_both_ends_of_whole_numbers_are_drawn_and_nothing_beyond() -> None:
    assert Draw(Given(0.0, JUST_BELOW_1, 0.5)).integers(3, 5, 3).tolist() == [3, 5, 4]
    assert Draw(Given(JUST_BELOW_1)).integer(-2, -2) == -2
    counts = np.bincount(draw().integers(0, 4, 50_000), minlength=5)
    assert len(counts) == 5 and abs(counts - 10_000).max() < 500


def test_uniform_numbers_span_their_range() -> None:
    assert Draw(Given(0.0, 0.5, 0.25, 0.75)).uniform(-1.0, 3.0, (2, 2)).tolist() == [[-1.0, 1.0], [0.0, 2.0]]


def test_normal_numbers_are_those_of_box_and_muller() -> None:
    """Of u = (1 - e^-2, 0): sqrt(4) cos 0 = 2 deviations above the mean; of (.., 1/2) as many below."""
    made = Draw(Given(1 - math.exp(-2), 1 - math.exp(-2), 0.0, 0.0, 0.5, 0.25)).normal(10.0, 3.0, 3)
    assert made == pytest.approx([16.0, 4.0, 10.0])
    many = draw().normal(5.0, 2.0, 50_000)
    assert (many.mean(), many.std()) == pytest.approx((5.0, 2.0), abs=0.05)
    assert np.isfinite(Draw(Given(0.0, JUST_BELOW_1, 0.0, 0.0)).normal(0.0, 1.0, 2)).all()


def test_triangular_numbers_invert_their_distribution() -> None:
    """On [0, 4] with its mode at 1, F(1) = 1/4, F(x) = x^2 / 4 below, 1 - (4 - x)^2 / 12 above."""
    for u, x in ((0.0, 0.0), (0.0625, 0.5), (0.25, 1.0), (1 - 4 / 12, 2.0), (1 - 1 / 12, 3.0)):
        assert Draw(Given(u)).triangular(0.0, 1.0, 4.0) == pytest.approx(x)


def test_weights_are_the_chances_of_their_values() -> None:
    assert Draw(Given(0.0, 0.2499, 0.25, JUST_BELOW_1)).weighted([7, 8, 9], [1, 0, 3], 4).tolist() == [7, 7, 9, 9]


def test_permutations_and_choices_have_every_number_once() -> None:
    assert Draw(Given(0.9, 0.1, 0.5, 0.1)).permutation(4).tolist() == [1, 3, 2, 0]
    assert sorted(draw().permutation(1000).tolist()) == list(range(1000))
    assert Draw(Given(0.9, 0.1, 0.5, 0.1)).chosen(2, 4).tolist() == [False, True, False, True]
    assert draw().chosen(0, 3).sum() == 0 and draw().chosen(3, 3).all()


def test_the_same_seed_draws_the_same() -> None:
    assert draw(7).permutation(50).tolist() == draw(7).permutation(50).tolist() != draw(8).permutation(50).tolist()
