"""Random answers over the whole vocabulary of routing problems: every output tells one schedule, by which all was judged."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from told_schedules import a_problem, an_answer, changed, faults_of, of_changed

SEED = 29
EACH = 5
"""Answers a problem."""


@pytest.mark.share(2)
@pytest.mark.parametrize("part", range(8))
def test_every_output_tells_one_schedule(share: Callable[[int, int], int], tally: Any, part: int) -> None:
    for number in range(part, share(160, 4000), 8):
        problem = a_problem(SEED, number)
        rng = np.random.default_rng([SEED, number, 2])
        for k in range(EACH):
            answer = an_answer(problem, rng)
            found = faults_of(problem, answer, picture=number % 80 == part and k == 0, sheets=number % 40 == part and k == 0)
            assert not found, (number, k, answer, found)
            tally["answers whose outputs tell one schedule"] += 1
            frame, by = changed(problem, answer, rng)
            found = of_changed(problem, frame, every=k == 0)
            assert not found, (number, k, answer, by, found)
            tally["timetables judged, one time of them moved"] += 1
