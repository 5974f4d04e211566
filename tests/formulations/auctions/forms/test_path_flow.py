from pathlib import Path

import numpy as np
import pytest
from program_text import expected, written
from task_problems import OBJECTIVES, all_paths, best_paths_value, drawn, line

from waybound import InputError, TaskAllocation
from waybound.solvers.backend import Control, Options, solver_named


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_every_answer_is_a_point_at_its_value(objective):
    rng = np.random.default_rng(8)
    for k in range(6):
        team = drawn(rng, tasks=4, matrix=k % 2 == 1)
        problem = TaskAllocation(team, objective)
        made = problem.compile("path-flow")
        for paths in list(all_paths(team.num_robots, team.num_tasks))[::11]:
            vector = made.encode(paths)
            assert made.program.residual(vector) <= 1e-12
            assert made.program.value(vector) == pytest.approx(problem.value(paths), rel=1e-12)
            assert made.decode(vector) == paths


@pytest.mark.share(3)
@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("scale", [1e-7, 1.0, 1e7])
def test_its_optimum_is_that_of_the_problem(objective, scale):
    rng = np.random.default_rng(9)
    for k in range(3):
        team = drawn(rng, tasks=4, matrix=k % 2 == 1)
        scaled = team.of_distances(team.starts * scale, team.between * scale)
        made = TaskAllocation(scaled, objective).compile()
        found = solver_named("highs").run(made.program, Options(time_limit=20.0), Control())
        assert found.status == "optimal"
        value = made.problem.evaluate(made.decode(found.answer)).values[0]
        assert value == pytest.approx(best_paths_value(team, objective) * scale, rel=1e-6)


def test_rows_have_names_and_no_answer_is_no_point():
    made = line([0], [1, 2], "mini-max").compile("path-flow")
    names = [made.program.row_name(k) for k in range(made.program.num_rows)]
    assert {"enter[task 1]", "leave[robot 1]", "flow[task 2]", "link[robot 1,task 2]", "remaining[task 1]", "longest[robot 1]"} <= set(
        names
    )
    with pytest.raises(InputError, match="nobody does task 2"):
        made.encode(((0,),))


def test_tasks_all_in_one_place_are_a_program_too():
    for objective in OBJECTIVES:
        made = line([0, 0], [0, 0], objective).compile()
        found = solver_named("highs").run(made.program, Options(time_limit=20.0), Control())
        assert made.problem.evaluate(made.decode(found.answer)).values == (0.0,)


TEAM = """
    role,name,x,y
    robot,r,0,0
    robot,s,9,0
    task,a,4,0
    task,b,4,3
"""


def test_path_flow_from_text_to_text(tmp_path: Path) -> None:
    """Arcs from both robots and between both tasks, with as much flow as tasks are still to come."""
    assert written(TEAM, "path-flow", tmp_path) == expected("""
        path-flow, exact
        min 4 x[robot r,task a] + 5 x[robot r,task b] + 5 x[robot s,task a] + 5.83095 x[robot s,task b] + 3 x[task a,task b] + 3
            x[task b,task a]
        enter[task a]: x[robot r,task a] + x[robot s,task a] + x[task b,task a] = 1
        enter[task b]: x[robot r,task b] + x[robot s,task b] + x[task a,task b] = 1
        leave[robot r]: x[robot r,task a] + x[robot r,task b] <= 1
        leave[robot s]: x[robot s,task a] + x[robot s,task b] <= 1
        leave[task a]: x[task a,task b] <= 1
        leave[task b]: x[task b,task a] <= 1
        flow[task a]: f[robot r,task a] + f[robot s,task a] - f[task a,task b] + f[task b,task a] = 1
        flow[task b]: f[robot r,task b] + f[robot s,task b] + f[task a,task b] - f[task b,task a] = 1
        link[robot r,task a]: - 2 x[robot r,task a] + f[robot r,task a] <= 0
        link[robot r,task b]: - 2 x[robot r,task b] + f[robot r,task b] <= 0
        link[robot s,task a]: - 2 x[robot s,task a] + f[robot s,task a] <= 0
        link[robot s,task b]: - 2 x[robot s,task b] + f[robot s,task b] <= 0
        link[task a,task b]: - x[task a,task b] + f[task a,task b] <= 0
        link[task b,task a]: - x[task b,task a] + f[task b,task a] <= 0
        x[robot r,task a], x[robot r,task b], x[robot s,task a], x[robot s,task b], x[task a,task b], x[task b,task a] binary
        0 <= f[robot r,task a], f[robot r,task b], f[robot s,task a], f[robot s,task b] <= 2
        0 <= f[task a,task b], f[task b,task a] <= 1
    """)
