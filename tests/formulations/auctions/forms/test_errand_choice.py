from pathlib import Path

import numpy as np
import pytest
from coded import coded
from draws import draws
from joint_assignments import WORKED, random_joint
from program_text import expected, written

from waybound import InputError, JointAssignment

YARD = """
    {"waybound": 1, "kind": "joint-assignment", "name": "yard", "problem": "joint-assignment",
     "robots": {"count": 2, "name": ["p", "q"]}, "bins": {"count": 2, "name": ["a", "b"], "filled": [0, 2]},
     "requests": {"count": 1, "name": ["r"]},
     "to_bin": [[1, null], [2, 5]], "to_request": [[null], [3]], "between": [[4, 0]]}
"""


def test_errand_choice_from_text_to_text(tmp_path: Path) -> None:
    """Robot p brings nothing and cannot get to b; q by r takes 3 + 4 to a, and 3 to b, which is full by then."""
    assert written(YARD, "errand-choice", tmp_path, ".json") == expected("""
        errand-choice, exact
        min y[p,a,none] + 7 y[q,a,r] + 2 y[q,a,none] + 3 y[q,b,r] + 5 y[q,b,none] + 3 y[q,none,r]
        robot[p]: y[p,a,none] <= 1
        robot[q]: y[q,a,r] + y[q,a,none] + y[q,b,r] + y[q,b,none] + y[q,none,r] <= 1
        bin[a]: y[p,a,none] + y[q,a,r] + y[q,a,none] <= 1
        bin[b]: y[q,b,r] + y[q,b,none] <= 1
        request[r]: y[q,a,r] + y[q,b,r] + y[q,none,r] <= 1
        pickups: y[p,a,none] + y[q,a,r] + y[q,a,none] + y[q,b,r] + y[q,b,none] = 2
        deliveries: y[q,a,r] + y[q,b,r] + y[q,none,r] = 1
        y[p,a,none], y[q,a,r], y[q,a,none], y[q,b,r], y[q,b,none], y[q,none,r] binary
    """)


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
    with pytest.raises(InputError, check=coded("unsupported")):
        barred.compile("errand-choice").encode(((0, -1),))
