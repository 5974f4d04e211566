"""Form ``time-expanded``: answers are points of their gain, and points answers."""

from __future__ import annotations

import numpy as np
import pytest
from draws import draws
from explorations import path, random_map

import waybound as wb
from waybound.instances.errors import InputError, UnsupportedError


def test_answers_are_points_and_points_answers() -> None:
    rng = np.random.default_rng(5)
    for _ in range(draws(12)):
        problem = random_map(rng)
        made = problem.compile("time-expanded")
        for answer in (problem.answer_at_hand(), wb.solve(problem, heuristic="heard-greedy", bound_time=0).answer):
            vector = made.encode(answer)
            assert made.program.residual(vector) == 0.0 and made.decode(vector) == answer
            assert made.program.cost @ vector == problem.evaluate(answer).values[0]


def test_contact_over_a_relay_is_a_flow() -> None:
    problem = path(4, 0, 3, 2, 2, heard=((0, 1), (1, 2)))
    answer = (((1, 0), (1, 0), (0, 0)), ((1, 0), (2, 0), (1, 0)))
    made = problem.compile("time-expanded")
    vector = made.encode(answer)
    assert made.program.residual(vector) == 0.0
    named = {made.program.variable_name(k): vector[k] for k in np.nonzero(vector)[0].tolist()}
    assert named["f[1,2,2]"] == 1.0 and named["c[1,2,2]"] == 1.0


def test_what_breaks_a_rule_is_no_point_and_too_large_maps_are_refused() -> None:
    problem = path(3, 0, 2)
    with pytest.raises(InputError, match="without contact"):
        problem.compile("time-expanded").encode((((1, 0), (0, 0)),))
    with pytest.raises(UnsupportedError, match="moves"):
        path(200, 0, 1000).compile("time-expanded")
