"""Joint risks from 1e-12 to 1/2 against quadrature: proved limits always hold, those of samples but for the doubt that they state."""

from collections import Counter
from collections.abc import Callable

import numpy as np
import pytest
from one_factor import drawn
from scipy.stats import binom

from waybound.formulations.risk.joint_normal import CONFIDENCE, any_fails

SEED = 92

QUADRATURE = 1e-10
"""Relative: by how much the truth is known."""


@pytest.mark.share(2)
@pytest.mark.parametrize("part", range(4))
def test_no_limit_is_missed_beyond_its_confidence(part: int, share: Callable[[int, int], int], tally: Counter[str]) -> None:
    rng, cases, sampled, missed = np.random.default_rng([SEED, part]), share(25, 2500), 0, 0
    for case in range(cases):
        slack, covariance, truth = drawn(rng)
        found = any_fails(slack, covariance)
        least, most = truth * (1.0 - QUADRATURE), truth * (1.0 + QUADRATURE)
        assert least <= found.most, (case, truth, found)
        outside = not (found.low <= most and least <= found.high)
        assert not outside or found.confidence < 1.0, (case, truth, found)
        sampled, missed = sampled + (found.confidence < 1.0), missed + outside
    assert missed <= binom.isf(1e-3, sampled, 1.0 - CONFIDENCE)
    tally["joint risks against quadrature"] += cases
