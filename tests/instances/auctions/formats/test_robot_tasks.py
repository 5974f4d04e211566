import pytest
from file_cases import check_refused

from waybound import InputError, RobotTasks, UsageError
from waybound.instances.reading import read_instance
from waybound.instances.writing import write_instance

TEXT = (
    "# name: yard\n# problem: balanced-partition\n# metric: manhattan\nrole,name,x,y,weight\nrobot,r,0,0,\ntask,a,1,2.5,3\ntask,b,-1,0,0\n"
)


def read(tmp_path, text):
    path = tmp_path / "yard.csv"
    path.write_text(text)
    return read_instance(path)


def test_a_table_is_read_and_written(tmp_path):
    team = read(tmp_path, TEXT)
    assert (team.name, team.format, team.problem, team.robot_names, team.task_names) == (
        "yard", "robot-tasks", "balanced-partition", ("r",), ("a", "b"),
    )  # fmt: skip
    assert team.distances.tolist() == [[3.5, 1], [0, 4.5], [4.5, 0]] and team.weights.tolist() == [3, 0]
    write_instance(team, tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_text() == TEXT


def test_little_is_needed(tmp_path):
    team = read(tmp_path, "role;x;y\ntask;1;1\nrobot;0;0\n")
    assert (team.name, team.metric, team.problem, team.num_robots, team.num_tasks) == ("yard", "euclidean", "task-allocation", 1, 1)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("task,a", "drone,a", "yard.csv:6: role is unknown; expected robot or task; found 'drone'"),
        ("manhattan", "polar", "yard.csv:3: metric 'polar' is unknown; expected euclidean"),
        ("2.5", "far", "yard.csv:6: y must be a finite number"),
        ("0,0,\n", "0,0,7\n", "yard.csv:5: a robot has no weight"),
        ("2.5,3", "2.5,", "yard.csv:6: weight must be a finite number"),
        ("task,b", "task,a", "yard.csv:7: the task 'a' stands twice, first in line 6"),
        ("task,b", "task,", "yard.csv:7: a task must have a name"),
        ("robot,r,0,0,\n", "", "there are no robots"),
    ],
)
def test_tables_that_break_a_rule_are_refused_with_their_line(tmp_path, old, new, message):
    check_refused(InputError, message, read, tmp_path, TEXT.replace(old, new))


def test_a_matrix_has_no_place_in_it(tmp_path):
    with pytest.raises(UsageError, match="no place for a matrix of distances; use json"):
        write_instance(RobotTasks.of_distances([[1]], [[0]]), tmp_path / "m.csv")
