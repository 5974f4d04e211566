import numpy as np
import pytest
from knapsack_assignments import worked

import waybound as wb


@pytest.mark.parametrize("objective", ["cost", "profit"])
def test_each_agent_is_a_column_of_its_jobs_below_its_capacity(objective: str) -> None:
    problem = worked(objective)
    solution = wb.solve(problem, "highs", bound_time=0)
    ax = solution.plot()
    assert [column.get_height() for column in ax.patches] == pytest.approx(problem.loads(solution.answer))
    assert [line[0, 1] for line in ax.collections[0].get_segments()] == pytest.approx(problem.instance.capacity)
    done = sum(agent >= 0 for agent in solution.answer)
    assert len(ax.lines) == done
    assert any(f"{done} of {problem.num_jobs} jobs" in text.get_text() for text in ax.texts)
    assert np.isfinite(ax.get_ylim()).all()
