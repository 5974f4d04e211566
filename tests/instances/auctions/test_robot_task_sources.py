"""Robots and tasks out of frames and graphs."""

from __future__ import annotations

import networkx as nx
import pandas as pd
import pytest

from waybound.instances.auctions.robot_tasks import RobotTasks
from waybound.instances.errors import InputError


def test_frames_are_read_with_names_and_weights():
    robots = pd.DataFrame({"name": ["ann"], "x": [0], "y": [0]})
    tasks = pd.DataFrame({"x": [3.0, 0], "y": [4, 1], "weight": [1, 2]})
    team = RobotTasks.from_frame(robots, tasks)
    assert team.starts.tolist() == [[5, 1]]
    assert (team.robot_names, team.task_names, team.weights.tolist(), team.format) == (("ann",), None, [1, 2], "frame")


@pytest.mark.parametrize(
    ("robots", "tasks", "message"),
    [
        ({"x": [0]}, {"x": [0], "y": [0]}, "column 'y' of robots is missing"),
        ({"x": [0], "y": [0], "weight": [1]}, {"x": [0], "y": [0]}, "column 'weight' of robots is unknown"),
        ({"x": [0], "y": [0]}, {"x": ["far"], "y": [0]}, "column 'x' of tasks must hold numbers"),
        ({"x": [], "y": []}, {"x": [0], "y": [0]}, "there are no robots"),
    ],
)
def test_other_frames_are_refused(robots, tasks, message):
    with pytest.raises(InputError, match=message):
        RobotTasks.from_frame(pd.DataFrame(robots), pd.DataFrame(tasks))
    with pytest.raises(InputError, match="robots must be a pandas frame"):
        RobotTasks.from_frame([1], pd.DataFrame(tasks))


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
    with pytest.raises(InputError, match="a task stands at 9, which is no node"):
        RobotTasks.from_networkx(graph, [0], [9])
    graph.edges[0, 1]["weight"] = -1
    with pytest.raises(InputError, match="the length of edge 0 to 1 must be finite and not negative"):
        RobotTasks.from_networkx(graph, [0], [1])
