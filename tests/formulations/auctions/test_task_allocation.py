import numpy as np
import pytest
from task_problems import OBJECTIVES, all_paths, drawn, line
from truth.auctions import TaskTruth

import waybound as wb
from waybound.instances.errors import UsageError


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_values_are_what_the_legs_come_to(objective):
    rng = np.random.default_rng(4)
    for k in range(10):
        team = drawn(rng, tasks=4, matrix=k % 2 == 1)
        problem = wb.TaskAllocation(team, objective)
        known = TaskTruth(problem)
        for paths in list(all_paths(team.num_robots, team.num_tasks))[::7]:
            verdict = problem.evaluate(paths)
            assert verdict.feasible
            assert verdict.values[0] == pytest.approx(float(known.worth(paths)[0]), rel=1e-14)


def test_the_example_by_hand():
    paths = ((0, 2), (1, 3))  # 0 to 4 and 1, 10 to 6 and 9
    assert [line([0, 10], [4, 6, 1, 9], objective).value(paths) for objective in OBJECTIVES] == [14, 7, (4 + 7 + 4 + 7) / 4]
    quantities = line([0, 10], [4, 6, 1, 9]).evaluate(((0, 1, 2, 3), ())).quantities
    assert quantities == {"busy_robots": 1, "total_length": 19, "longest_path": 19}


def test_a_frame_has_a_row_a_task():
    frame = line([0, 10], [4, 6, 1]).answer_to_frame(((0, 2), (1,)))
    assert frame.to_dict("list") == {
        "robot": ["1", "1", "2"], "place": [1, 2, 1], "task": ["1", "3", "2"], "leg": [4, 3, 4], "distance": [4, 7, 4],
    }  # fmt: skip


def test_it_is_read_from_files_with_its_setting(tmp_path):
    (tmp_path / "t.csv").write_text("role,name,x,y\nrobot,r,0,0\ntask,a,3,4\n")
    problem = wb.read(tmp_path / "t.csv", objective="mini-max")
    assert (problem.problem, problem.objective, problem.features()) == ("task-allocation", "mini-max", {"objective:mini-max"})
    with pytest.raises(UsageError, match="objective must be one of mini-sum, mini-max, mini-ave"):
        wb.read(tmp_path / "t.csv", objective="mini-mean")
    with pytest.raises(UsageError, match="task-allocation has no setting 'vehicles'"):
        wb.read(tmp_path / "t.csv", vehicles=3)


def test_the_digest_is_of_what_matters():
    assert line([0], [1, 2]).digest() != line([0], [1, 2], "mini-max").digest()
    assert line([0], [1, 2]).digest() != line([0], [1, 3]).digest()
    assert line([0], [1, 2]).digest() == line([5], [6, 7]).digest()
    heavy = wb.TaskAllocation(wb.RobotTasks.of_positions([0], [1, 2], weights=[1, 1]))
    assert heavy.digest() == line([0], [1, 2]).digest()
