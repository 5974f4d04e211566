"""Form ``errand-choice``: points and answers, and rows."""

from __future__ import annotations

import numpy as np
import pytest
from draws import draws
from joint_assignments import WORKED, random_joint

from waybound.formulations.auctions.joint_assignment import JointAssignment
from waybound.instances.errors import InputError


def test_answers_are_points_at_their_time_and_points_answers() -> None:
    rng = np.random.default_rng(6)
    for _ in range(draws(30)):
        problem = random_joint(rng)
        made, answer = problem.compile("errand-choice"), problem.answer_at_hand()
        if not made.program.cost.size:
            continue
        vector = made.encode(answer)
        assert made.program.residual(vector) == 0.0 and made.decode(vector) == answer
        assert made.program.cost @ vector == pytest.approx(problem.evaluate(answer).values[0])


def test_each_row_says_what_its_name_does() -> None:
    program = WORKED.compile("errand-choice").program
    names = [program.variable_name(k) for k in range(len(program.cost))]
    assert len(names) == 2 * 8 and names[:3] == ["y[1,1,1]", "y[1,1,2]", "y[1,1,none]"] and "y[1,none,none]" not in names
    blocks = {block.name: block for block in program.rows}
    assert list(blocks) == ["robot", "bin", "request", "pickups", "deliveries"]
    fetching = [names[k] for k in blocks["pickups"].indices]
    assert len(fetching) == 12 and not any(",none," in name for name in fetching) and blocks["pickups"].lower.tolist() == [2.0]
    assert {names[k] for k in blocks["deliveries"].indices} == {name for name in names if not name.endswith("none]")}


def test_errands_that_are_not_allowed_are_no_points() -> None:
    barred = JointAssignment.from_arrays([[np.inf, 1.0]], [[1.0]], [[0.0, 0.0]])
    with pytest.raises(InputError, match="an errand that is not allowed"):
        barred.compile("errand-choice").encode(((0, -1),))
