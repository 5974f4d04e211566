import networkx as nx
import numpy as np
import pandas as pd
import pytest
from coded import coded
from file_cases import check_refused

import waybound as wb
from waybound.instances.auctions.robot_tasks import RobotTasks
from waybound.instances.errors import InputError


def test_distances_follow_the_metric():
    given = {m: RobotTasks.of_positions([(0, 0)], [(3, 4), (3, 0)], m).distances.tolist() for m in ("euclidean", "manhattan", "chebyshev")}
    assert given["euclidean"] == [[5, 3], [0, 4], [4, 0]]
    assert given["manhattan"] == [[7, 3], [0, 4], [4, 0]]
    assert given["chebyshev"] == [[4, 3], [0, 4], [4, 0]]


def test_a_line_is_a_plane_and_a_matrix_is_taken_as_it_is():
    team = RobotTasks.of_positions([0, 10], [4, 6])
    assert team.starts.tolist() == [[4, 6], [6, 4]] and team.between.tolist() == [[0, 2], [2, 0]]
    one_way = RobotTasks.of_distances([[1, 2]], [[9, 3], [4, 9]])
    assert one_way.between.tolist() == [[0, 3], [4, 0]]
    assert one_way.positions is None and one_way.metric == "matrix"


def test_names_weights_and_digest():
    team = RobotTasks.of_positions([0], [1, 2], robot_names=("ann",), task_names=("a", "b"), weights=[1, -2])
    assert (team.robot_name(0), team.task_name(1), team.row_name(0), team.row_name(2)) == ("ann", "b", "robot ann", "task b")
    assert team.facts()["weights"] == -1
    assert team.digest() != RobotTasks.of_positions([0], [1, 2]).digest()
    assert team.digest() == RobotTasks.of_positions([0], [1, 2], weights=[1, -2]).digest()
    assert wb.RobotTasks is RobotTasks


def test_nothing_of_it_can_be_written_to():
    team = RobotTasks.of_positions([0], [1, 2])
    for array in (team.distances, team.weights, team.positions):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: RobotTasks.of_positions(np.zeros((0, 2)), [1]), "there are no robots; expected one at least"),
        (lambda: RobotTasks.of_positions([1], np.zeros((0, 2))), "there are no tasks"),
        (lambda: RobotTasks.of_positions([(1, 2, 3)], [1]), "robot positions must be two numbers each"),
        (lambda: RobotTasks.of_positions([[1, 2], [3]], [1]), "robot positions must be numbers, as many in each row"),
        (lambda: RobotTasks.of_positions([np.nan], [1]), "must be finite"),
        (lambda: RobotTasks.of_positions([1e200], [1]), r"coordinates of robot 1 must be at most 1e\+150"),
        (lambda: RobotTasks.of_positions([1], [1], "polar"), "unknown metric 'polar'; expected euclidean"),
        (lambda: RobotTasks(1, 1), "the metric euclidean needs positions"),
        (lambda: RobotTasks(1, 1, "matrix"), "needs a matrix of distances"),
        (lambda: RobotTasks(1, 1, positions=np.zeros((2, 2)), matrix=np.zeros((2, 1))), "measures distances itself"),
        (lambda: RobotTasks.of_distances([[1, 2]], [[0]]), r"must be of shapes \(robots, tasks\) and \(tasks, tasks\)"),
        (lambda: RobotTasks.of_distances([[1], [2, 3]], [[0]]), "distances from the robots must be numbers, as many in each row"),
        (lambda: RobotTasks.of_distances([[-1]], [[0]]), r"the distance from robot 1 to task 1 must be from 0 to 1e\+150; found -1"),
        (lambda: RobotTasks.of_distances([[1, np.nan]], [[0, 1], [1, 0]]), "the distance from robot 1 to task 2"),
        (lambda: RobotTasks.of_positions([1], [1, 2], weights=[1]), "one weight a task; expected 2"),
        (lambda: RobotTasks.of_positions([1], [1], weights=[np.inf]), "the weight of task 1 must be a number of at most"),
        (lambda: RobotTasks.of_positions([1], [1, 2], task_names=("a", "a")), "two tasks have the name 'a'"),
    ],
)
def test_what_makes_no_sense_is_refused_in_one_line(make, message):
    with pytest.raises(InputError, match=message) as fault:
        make()
    assert "\n" not in str(fault.value)


def test_frames_are_read_with_names_and_weights():
    robots = pd.DataFrame({"name": ["ann"], "x": [0], "y": [0]})
    tasks = pd.DataFrame({"x": [3.0, 0], "y": [4, 1], "weight": [1, 2]})
    team = RobotTasks.from_frame(robots, tasks)
    assert team.starts.tolist() == [[5, 1]]
    assert (team.robot_names, team.task_names, team.weights.tolist(), team.format) == (("ann",), None, [1, 2], "frame")


@pytest.mark.parametrize(
    ("robots", "tasks", "message"),
    [
        ({"x": [0]}, {"x": [0], "y": [0]}, "robots lacks the column 'y'"),
        ({"x": [0], "y": [0], "weight": [1]}, {"x": [0], "y": [0]}, "column 'weight' of robots is unknown"),
        ({"x": [0], "y": [0]}, {"x": ["far"], "y": [0]}, "column 'x' of tasks must hold numbers"),
        ({"x": [], "y": []}, {"x": [0], "y": [0]}, "there are no robots"),
    ],
)
def test_other_frames_are_refused(robots, tasks, message):
    check_refused(InputError, message, RobotTasks.from_frame, pd.DataFrame(robots), pd.DataFrame(tasks))
    check_refused(InputError, "robots must be a pandas frame", RobotTasks.from_frame, [1], pd.DataFrame(tasks))


def test_on_a_graph_distances_are_shortest_paths():
    graph = nx.path_graph(5)
    graph.add_edge(0, 4, weight=1.5)
    team = RobotTasks.from_networkx(graph, [0, 0], [2, 3, 4])
    assert team.starts.tolist() == [[2, 2.5, 1.5]] * 2
    assert team.between.tolist() == [[0, 1, 2], [1, 0, 1], [2, 1, 0]]
    assert (team.robot_names, team.task_names) == (None, ("2", "3", "4"))
    free = nx.Graph()
    free.add_edge("a", "b", weight=0)
    assert RobotTasks.from_networkx(free, ["a"], ["b"]).starts.tolist() == [[0]]
    one_way = nx.DiGraph([(0, 1), (1, 0), (1, 2), (2, 1)])
    one_way.edges[0, 1]["weight"] = 5
    assert RobotTasks.from_networkx(one_way, [0], [1, 2]).starts.tolist() == [[5, 6]]


def test_walls_and_strange_lengths_are_refused():
    graph = nx.Graph([(0, 1)])
    graph.add_node(2)
    with pytest.raises(InputError, match="no way leads from robot 0 to task 2"):
        RobotTasks.from_networkx(graph, [0], [2])
    with pytest.raises(InputError, match="a task stands at 9, which is no node", check=coded("unknown-name")):
        RobotTasks.from_networkx(graph, [0], [9])
    graph.edges[0, 1]["weight"] = -1
    with pytest.raises(InputError, match="the length of edge 0 to 1 must be finite and not negative"):
        RobotTasks.from_networkx(graph, [0], [1])
