import math

import numpy as np
import pytest
from explorations import path
from joint_assignments import WORKED
from orchard_cases import TWO_ROUTES, lane, retrievals
from task_problems import line, parts

import waybound as wb
from waybound.reports.tables.facts import facts, facts_table

PROFITS = wb.GeneralisedAssignment.from_arrays([[1.0, -math.inf], [2.5, 3.0]], [[1.0, 2.0], [3.0, 4.0]], [5.0, 6.0], "profit")


BINS = wb.BinAssignment.from_matrix([[1.0, np.inf], [2.0, 3.5], [4.0, 5.0]], filled=np.array([0.0, 2.0]))
BARRED = wb.GeneralisedAssignment.from_arrays([[math.inf]], [[1.0]], [5.0])
DAY = wb.OrchardDay(wb.OrchardJobs.of_routes(lane(TWO_ROUTES, 2), TWO_ROUTES))


@pytest.mark.parametrize(
    ("problem", "told"),
    [
        (BINS, {"problem": "bin-assignment, min sum of the costs of 2 pairs", "pairs asked for": "2", "pairs": "5, 1 forbidden"}),
        (BINS, {"robots": "3, each for 1 to 2 bins", "bins": "2, each for 2 to 3 robots", "costs": "1 to 5"}),
        (BINS, {"waiting": "1 bins are not yet full", "positions": "none"}),
        (PROFITS, {"agents": "2, capacities 5 to 6, 11 together", "jobs": "2, 1 pairs forbidden"}),
        (PROFITS, {"profits": "1 to 3", "consumption": "1 to 4"}),
        (BARRED, {"costs": "none"}),
        (WORKED, {"robots": "2, 2 of them have something to bring", "bins": "2, 1 of them not yet full", "requests": "2"}),
        (DAY, {"orchard": "1 lanes of 6 cells", "robots": "2", "bins": "8, 6 of them to be brought; 16 steps to fill all"}),
        (retrievals(((0, 2),), (0,), ((0, 0), (0, 6))), {"robots": "2, 1 of them in the field"}),
        (path(4, 1, 5, 2), {"rooms": "4, 3 doors, 1 rooms are heard at the base"}),
        (path(4, 1, 5, 2), {"robots": "2, 5 steps each, 1 of them in a row without contact"}),
        (line([0, 10], [4, 6, 1], "mini-max"), {"problem": "task-allocation, min mini-max", "robots": "2", "tasks": "3"}),
        (line([0, 10], [4, 6, 1], "mini-max"), {"distances": "euclidean, 1 to 9"}),
        (parts([0, 1], weights=[1, 2.5]), {"tasks": "2, of weight 3.5 together", "edges": "mst"}),
    ],
    ids=lambda case: getattr(case, "problem", ""),
)
def test_a_problem_is_told_by_its_sizes(problem: wb.Problem, told: dict[str, str]) -> None:
    rows = dict(facts_table(facts(problem)).rows)
    assert {name: rows[name] for name in told} == told
