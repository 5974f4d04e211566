from pathlib import Path

import pytest
from coded import coded
from knapsack_assignments import worked
from program_text import expected, written

from waybound.instances.errors import InputError

YARD = """
    agent,job,cost,consumption,capacity
    p,,,,4
    q,,,,3
    p,a,2,2,
    q,a,4,3,
    p,b,6,0,
    q,b,1,9,
"""


def test_assignment_knapsacks_from_text_to_text(tmp_path: Path) -> None:
    """Job b fits p alone, and consumes nothing there."""
    assert written(YARD, "assignment-knapsacks", tmp_path) == expected("""
        assignment-knapsacks, exact
        min 2 x[p,a] + 6 x[p,b] + 4 x[q,a]
        job[a]: x[p,a] + x[q,a] = 1
        job[b]: x[p,b] = 1
        capacity[p]: 2 x[p,a] <= 4
        capacity[q]: 3 x[q,a] <= 3
        x[p,a], x[p,b], x[q,a] binary
    """)


def test_profits_leave_jobs_undone(tmp_path: Path) -> None:
    assert "0 <= x[p,a] + x[q,a] <= 1" in written(YARD.replace("cost", "profit"), "assignment-knapsacks", tmp_path)


def test_answers_are_points_and_points_answers() -> None:
    made = worked().compile("assignment-knapsacks")
    vector = made.encode((0, 1, 0))
    assert made.program.residual(vector) == 0.0 and made.decode(vector) == (0, 1, 0)
    assert made.program.cost @ vector == 6.0
    tight = worked().from_arrays([[1.0], [2.0]], [[9.0], [1.0]], 2.0).compile("assignment-knapsacks")
    with pytest.raises(InputError, check=coded("unsupported")):
        tight.encode((0,))
